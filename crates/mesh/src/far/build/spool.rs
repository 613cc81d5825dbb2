//! Data of finished nodes in a file, in any order.

use std::io::{self, Read, Seek, SeekFrom, Write};

use xxhash_rust::xxh3::xxh3_64;

use crate::far::record::Node;

#[derive(Debug, Clone, Copy)]
pub(super) struct Done {
    pub(super) node: Node,
    pub(super) bytes: u64,
    at: u64,
}

#[derive(Debug)]
pub(super) struct Spool<F> {
    file: F,
    pub(super) bytes: u64,
    done: Vec<Option<Done>>,
}

impl<F: Read + Write + Seek> Spool<F> {
    pub(super) fn new(file: F, nodes: usize) -> Self {
        Self {
            file,
            bytes: 0,
            done: vec![None; nodes],
        }
    }

    pub(super) fn add(&mut self, number: usize, mut node: Node, data: &[u8]) -> io::Result<()> {
        node.checksum = xxh3_64(data);
        self.file.write_all(data)?;
        let bytes = data.len() as u64;
        self.done[number] = Some(Done {
            node,
            bytes,
            at: self.bytes,
        });
        self.bytes += bytes;
        Ok(())
    }

    pub(super) fn nodes(&self) -> impl Iterator<Item = Done> {
        self.done.iter().flatten().copied()
    }

    pub(super) fn copy_to(&mut self, out: &mut dyn Write) -> io::Result<()> {
        for done in self.done.iter().flatten() {
            self.file.seek(SeekFrom::Start(done.at))?;
            io::copy(&mut (&mut self.file).take(done.bytes), out)?;
        }
        Ok(())
    }
}
