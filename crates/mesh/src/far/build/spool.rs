//! Finished nodes in a file, in any order. The next build continues with the file of a stopped one.
//!
//! After a key of mesh and options follow the nodes: number, record and data, with checksums.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

use bytemuck::{Pod, Zeroable};
use xxhash_rust::xxh3::xxh3_64;

use crate::far::record::Node;

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Head {
    number: u32,
    pub(super) is_undecimated: u32,
    pub(super) bytes: u64,
    pub(super) node: Node,
    /// Of all before.
    checksum: u64,
}

const HEAD: u64 = size_of::<Head>() as u64;

impl Head {
    fn check(&self) -> u64 {
        let bytes = bytemuck::bytes_of(self);
        xxh3_64(&bytes[..bytes.len() - size_of::<u64>()])
    }
}

/// A finished node.
pub(super) struct Made {
    pub(super) node: Node,
    pub(super) data: Vec<u8>,
    /// Its triangles could not be decimated.
    pub(super) is_undecimated: bool,
}

#[derive(Debug)]
pub(super) struct Spool {
    file: File,
    end: u64,
    /// Finished nodes, and where the data of each begins.
    done: Vec<Option<(Head, u64)>>,
    /// The number of nodes that were added to those in the file.
    added: usize,
}

impl Spool {
    /// Takes the nodes that are whole in a file, and writes on behind them. `None`: the file has another key.
    pub(super) fn open(mut file: File, key: u64, nodes: usize) -> io::Result<Option<Self>> {
        let mut first = [0; 8];
        let length = file.seek(SeekFrom::End(0))?;
        file.rewind()?;
        if length == 0 {
            file.write_all(&key.to_le_bytes())?;
        } else {
            let read = file.read(&mut first)?;
            if read < first.len() || first != key.to_le_bytes() {
                return Ok(None);
            }
        }
        let mut spool = Self {
            file,
            end: first.len() as u64,
            done: vec![None; nodes],
            added: 0,
        };
        while let Some(head) = spool.next(length)? {
            spool.note(&head);
        }
        Ok(Some(spool))
    }

    /// The next node of the file, if it is whole.
    fn next(&mut self, length: u64) -> io::Result<Option<Head>> {
        let left = length.saturating_sub(self.end);
        if left < HEAD {
            return Ok(None);
        }
        let mut bytes = [0; HEAD as usize];
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.read_exact(&mut bytes)?;
        let head: Head = bytemuck::pod_read_unaligned(&bytes);
        let is_sound = head.checksum == head.check() && (head.number as usize) < self.done.len();
        if !is_sound || head.bytes > left - HEAD {
            return Ok(None);
        }
        let mut data = vec![0; head.bytes as usize];
        self.file.read_exact(&mut data)?;
        Ok((xxh3_64(&data) == head.node.checksum).then_some(head))
    }

    fn note(&mut self, head: &Head) {
        let at = self.end + HEAD;
        self.done[head.number as usize] = Some((*head, at));
        self.end = at + head.bytes;
    }

    pub(super) fn is_done(&self, number: usize) -> bool {
        self.done[number].is_some()
    }

    pub(super) fn add(&mut self, number: usize, made: &Made) -> io::Result<()> {
        let mut head = Head {
            number: number as u32,
            is_undecimated: made.is_undecimated.into(),
            bytes: made.data.len() as u64,
            node: made.node,
            checksum: 0,
        };
        head.node.checksum = xxh3_64(&made.data);
        head.checksum = head.check();
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(bytemuck::bytes_of(&head))?;
        self.file.write_all(&made.data)?;
        self.note(&head);
        self.added += 1;
        Ok(())
    }

    pub(super) fn nodes(&self) -> impl Iterator<Item = &Head> {
        self.done.iter().flatten().map(|(head, _)| head)
    }

    /// The number of nodes that were in the file.
    pub(super) fn taken(&self) -> usize {
        self.nodes().count() - self.added
    }

    /// Bytes of all data.
    pub(super) fn bytes(&self) -> u64 {
        self.nodes().map(|done| done.bytes).sum()
    }

    /// Fails where the file is no longer as it was written.
    pub(super) fn copy_to(&mut self, out: &mut dyn Write) -> io::Result<()> {
        let mut data = Vec::new();
        for (head, at) in self.done.iter().flatten() {
            data.resize(head.bytes as usize, 0);
            self.file.seek(SeekFrom::Start(*at))?;
            self.file.read_exact(&mut data)?;
            if xxh3_64(&data) != head.node.checksum {
                let told = "the file of unfinished nodes has changed";
                return Err(io::Error::new(io::ErrorKind::InvalidData, told));
            }
            out.write_all(&data)?;
        }
        Ok(())
    }
}
