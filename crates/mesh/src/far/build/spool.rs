//! Finished nodes in a file, in any order, from which an interrupted build resumes.
//!
//! The file begins with hashes of the mesh and the options. Then follow the nodes, each with its number, record, data
//! and checksums.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use bytemuck::{Pod, Zeroable};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::{BuildError, BuildOptions};
use crate::Surface;
use crate::far::record::Node;

/// How an unfinished file begins; the last byte is the version of the layout and of the build.
const MAGIC: [u8; 8] = *b"\x89FARPRT\x01";

#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Origin {
    magic: [u8; 8],
    mesh: u64,
    options: u64,
}

impl Origin {
    pub(super) fn of(surface: &dyn Surface, options: &BuildOptions) -> Self {
        let mut mesh = Xxh3::new();
        for number in 0..surface.len() {
            let triangle = surface.triangle(number);
            for point in [triangle.corners, triangle.normals, triangle.colors].as_flattened() {
                mesh.update(bytemuck::bytes_of(&point.to_array()));
            }
        }
        let program = env!("CARGO_PKG_VERSION");
        Self {
            magic: MAGIC,
            mesh: mesh.digest(),
            options: xxh3_64(format!("{program} {options:?}").as_bytes()),
        }
    }
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Head {
    number: u64,
    bytes: u64,
    node: Node,
    checksum: u64,
}

impl Head {
    fn check(&self) -> u64 {
        let bytes = bytemuck::bytes_of(self);
        xxh3_64(&bytes[..bytes.len() - size_of::<u64>()])
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Done {
    pub(super) node: Node,
    pub(super) bytes: u64,
    at: u64,
}

#[derive(Debug)]
pub(super) struct Spool<F> {
    file: F,
    end: u64,
    done: Vec<Option<Done>>,
}

impl<F: Read + Write + Seek> Spool<F> {
    pub(super) fn new(file: F) -> Self {
        Self {
            file,
            end: 0,
            done: Vec::new(),
        }
    }

    pub(super) fn expect(&mut self, nodes: usize) {
        self.done.resize(nodes, None);
    }

    pub(super) fn is_done(&self, number: usize) -> bool {
        self.done.get(number).is_some_and(Option::is_some)
    }

    pub(super) fn add(&mut self, number: usize, mut node: Node, data: &[u8]) -> io::Result<()> {
        node.checksum = xxh3_64(data);
        let mut head = Head {
            number: number as u64,
            bytes: data.len() as u64,
            node,
            checksum: 0,
        };
        head.checksum = head.check();
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(bytemuck::bytes_of(&head))?;
        self.file.write_all(data)?;
        self.note(&head);
        Ok(())
    }

    fn note(&mut self, head: &Head) {
        let at = self.end + size_of::<Head>() as u64;
        self.done[head.number as usize] = Some(Done {
            node: head.node,
            bytes: head.bytes,
            at,
        });
        self.end = at + head.bytes;
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

pub(super) fn open_part(path: &Path, origin: &Origin) -> Result<Spool<File>, BuildError> {
    let failed = |problem: String| BuildError::File {
        file: path.to_owned(),
        problem,
    };
    let refused = |e: io::Error| failed(e.to_string());
    let mut options = File::options();
    let mut file = options
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
        .map_err(refused)?;
    if file.try_lock().is_err() {
        return Err(failed("another build is writing it".to_owned()));
    }
    let mut bytes = [0; size_of::<Origin>()];
    let whole = file.metadata().map_err(refused)?.len() >= bytes.len() as u64;
    if whole {
        file.read_exact(&mut bytes).map_err(refused)?;
        let found: Origin = bytemuck::pod_read_unaligned(&bytes);
        let differs = match found {
            _ if found.magic != origin.magic => "by another program, or it is something else",
            _ if found.mesh != origin.mesh => "of another mesh",
            _ if found.options != origin.options => "with other options, or by another version",
            _ => "",
        };
        if !differs.is_empty() {
            let problem = format!(
                "it was begun {differs}, so it cannot be resumed: remove it, or build as it was begun"
            );
            return Err(failed(problem));
        }
    } else {
        file.set_len(0).map_err(refused)?;
        file.write_all(bytemuck::bytes_of(origin))
            .map_err(refused)?;
    }
    Ok(Spool {
        file,
        end: bytes.len() as u64,
        done: Vec::new(),
    })
}

impl Spool<File> {
    pub(super) fn resume(&mut self, nodes: usize) -> io::Result<()> {
        self.expect(nodes);
        let length = self.file.metadata()?.len();
        let mut data = Vec::new();
        loop {
            let mut head = [0; size_of::<Head>()];
            let left = length.saturating_sub(self.end + head.len() as u64);
            self.file.seek(SeekFrom::Start(self.end))?;
            if length < self.end + head.len() as u64 {
                break;
            }
            self.file.read_exact(&mut head)?;
            let head: Head = bytemuck::pod_read_unaligned(&head);
            let is_sound = head.checksum == head.check() && head.number < nodes as u64;
            if !is_sound || head.bytes > left {
                break;
            }
            data.resize(head.bytes as usize, 0);
            self.file.read_exact(&mut data)?;
            if xxh3_64(&data) != head.node.checksum {
                break;
            }
            self.note(&head);
        }
        self.file.set_len(self.end)
    }
}

/// The name of the unfinished file of a build.
pub fn part_of(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".part");
    name.into()
}
