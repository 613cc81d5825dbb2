//! Files that are used in place, mapped or held: the common parts of `.vxg`, `.far` and `.tvx`. A header of fixed
//! length with a checksum, then sections, each aligned to 64 bytes with zeros between.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytemuck::Pod;
use memmap2::Mmap;
use xxhash_rust::xxh3::xxh3_64;

use super::map::map;
use super::{Invalid, Opacity, PackedNormal};
use crate::bounded;
use crate::whole::WholeError;

pub const ALIGNMENT: u64 = 64;

#[derive(Debug, thiserror::Error)]
pub enum FileError {
    #[error("{}: cannot {doing}: {source}", file.display())]
    Io {
        file: PathBuf,
        doing: &'static str,
        source: io::Error,
    },
    #[error(transparent)]
    Write(#[from] WholeError),
    #[error(
        "{}: {}{section}, byte {offset}: expected {expected}; {advice}", file.display(), prefix(file)
    )]
    Malformed {
        file: PathBuf,
        section: &'static str,
        offset: u64,
        expected: String,
        advice: &'static str,
    },
    #[error("the graph cannot be stored: {0}")]
    Graph(#[from] Invalid),
}

const DAMAGED: &str = "the file is damaged: copy it again, or convert it again from its source";
const NEWER: &str = "the file is of another version: convert it again with this one";

/// Messages about `.far` and `.tvx` files give the bare name of a section.
fn prefix(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("far" | "tvx") => "",
        _ => "section ",
    }
}

impl FileError {
    pub fn damaged(
        path: &Path,
        section: &'static str,
        offset: u64,
        expected: impl Into<String>,
    ) -> Self {
        Self::Malformed {
            file: path.to_owned(),
            section,
            offset,
            expected: expected.into(),
            advice: DAMAGED,
        }
    }

    pub fn is_limit(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == io::ErrorKind::OutOfMemory)
    }

    fn refused(path: &Path, doing: &'static str) -> impl Fn(io::Error) -> Self {
        move |source| Self::Io {
            file: path.to_owned(),
            doing,
            source,
        }
    }
}

/// An open file, of which only the header was read.
pub struct Opened<'p> {
    file: File,
    path: &'p Path,
    pub bytes: u64,
    pub beginning: Vec<u8>,
}

/// Opens a regular file and reads its header. Callers check the length before they map the file.
pub fn open(path: &Path, header_bytes: usize) -> Result<Opened<'_>, FileError> {
    let refused = |doing| FileError::refused(path, doing);
    let mut file = bounded::open(path).map_err(refused("open it"))?;
    let metadata = file.metadata().map_err(refused("ask for its length"))?;
    let mut beginning = Vec::with_capacity(header_bytes);
    (&mut file)
        .take(header_bytes as u64)
        .read_to_end(&mut beginning)
        .map_err(refused("read its header"))?;
    Ok(Opened {
        file,
        path,
        bytes: metadata.len(),
        beginning,
    })
}

impl Opened<'_> {
    pub fn map(&self) -> Result<Arc<Mmap>, FileError> {
        map(&self.file).map_err(FileError::refused(self.path, "map it into memory"))
    }
}

#[derive(Debug)]
pub enum Bytes {
    Mapped(Arc<Mmap>),
    /// Words of 64 bits, so that records are aligned, and the number of bytes.
    Held(Vec<u64>, usize),
}

impl Bytes {
    pub fn held(bytes: &[u8]) -> Self {
        let mut words = vec![0u64; bytes.len().div_ceil(8)];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self::Held(words, bytes.len())
    }

    pub fn get(&self) -> &[u8] {
        match self {
            Self::Mapped(map) => map,
            Self::Held(words, length) => &bytemuck::cast_slice(words)[..*length],
        }
    }
}

/// Items of files. They are little-endian there, and used in place where that is the processor's order.
pub trait Stored: Pod {
    /// The counts and widths, bytes, of the numbers of an item.
    const NUMBERS: &'static [(usize, usize)];
}

macro_rules! stored {
    ($($item:ty: $count:literal x $width:literal;)*) => {
        $(impl Stored for $item {
            const NUMBERS: &'static [(usize, usize)] = &[($count, $width)];
        })*
    };
}
stored! {
    u8: 1 x 1;
    u32: 1 x 4;
    [u8; 3]: 3 x 1;
    PackedNormal: 1 x 2;
    Opacity: 3 x 1;
}

/// Turns items from the order of a file to that of the processor, or back.
pub fn turn<T: Stored>(bytes: &mut [u8]) {
    if cfg!(target_endian = "big") {
        reverse(bytes, T::NUMBERS);
    }
}

fn reverse(bytes: &mut [u8], numbers: &[(usize, usize)]) {
    let mut left = bytes;
    for &(count, width) in numbers.iter().cycle() {
        if left.is_empty() {
            return;
        }
        let (these, rest) = left.split_at_mut(count * width);
        these.chunks_exact_mut(width).for_each(<[u8]>::reverse);
        left = rest;
    }
}

/// Items as in a file.
pub fn to_file<T: Stored>(items: &[T]) -> Cow<'_, [u8]> {
    let mut bytes = Cow::Borrowed(bytemuck::cast_slice(items));
    if cfg!(target_endian = "big") {
        turn::<T>(bytes.to_mut());
    }
    bytes
}

/// Items from the bytes of a file.
pub fn from_file<T: Stored>(bytes: &[u8]) -> Vec<T> {
    let mut items = bytemuck::pod_collect_to_vec(bytes);
    turn::<T>(bytemuck::cast_slice_mut(&mut items));
    items
}

pub fn range([begin, end]: [u64; 2]) -> Range<usize> {
    begin as usize..end as usize
}

/// Begin and end of the next section after byte `end`, of `count` items. Saturates.
pub fn section_after(end: u64, count: u64, item_bytes: usize) -> [u64; 2] {
    let begin = end.div_ceil(ALIGNMENT).saturating_mul(ALIGNMENT);
    let bytes = count.saturating_mul(item_bytes as u64);
    [begin, begin.saturating_add(bytes)]
}

/// A format. All have version, header length and file length at the same places, and the header's checksum in its
/// last eight bytes.
pub struct Format {
    pub ending: &'static str,
    pub magic: [u8; 8],
    pub versions: &'static [u32],
    pub header_bytes: usize,
    pub signature: &'static str,
    pub not_ours: &'static str,
}

pub const HEADER_BYTES: usize = 128;

pub(super) mod at {
    pub(in crate::graph) const VERSION: usize = 8;
    pub(super) const HEADER_BYTES: usize = 12;
    pub(in crate::graph) const FILE_BYTES: usize = 16;
}

impl Format {
    /// A header. `fields` receives a function that puts bytes at an offset.
    pub fn header(
        &self,
        version: u32,
        file_bytes: u64,
        fields: impl FnOnce(&mut dyn FnMut(usize, &[u8])),
    ) -> Vec<u8> {
        let mut header = vec![0; self.header_bytes];
        let mut put = |offset: usize, bytes: &[u8]| {
            header[offset..offset + bytes.len()].copy_from_slice(bytes);
        };
        put(0, &self.magic);
        put(at::VERSION, &version.to_le_bytes());
        put(at::HEADER_BYTES, &(self.header_bytes as u32).to_le_bytes());
        put(at::FILE_BYTES, &file_bytes.to_le_bytes());
        fields(&mut put);
        let end = self.header_bytes - 8;
        let checksum = xxh3_64(&header[..end]);
        header[end..].copy_from_slice(&checksum.to_le_bytes());
        header
    }

    /// Checks the common fields of a header, of a file of `file_bytes` bytes.
    pub fn read<'f>(
        &self,
        beginning: &'f [u8],
        file_bytes: u64,
        path: &'f Path,
    ) -> Result<Fields<'f>, FileError> {
        let other = |offset: usize, expected: String, advice: &'static str| FileError::Malformed {
            file: path.to_owned(),
            section: "header",
            offset: offset as u64,
            expected,
            advice,
        };
        if !beginning.starts_with(&self.magic) {
            return Err(other(0, self.signature.to_owned(), self.not_ours));
        }
        let bytes = self.header_bytes;
        let Some(header) = beginning.get(..bytes) else {
            let length = beginning.len();
            let expected = format!("a header of {bytes} bytes, not {length}");
            return Err(other(length, expected, DAMAGED));
        };
        let fields = Fields { header, path };
        let version = fields.u32_at(at::VERSION);
        let stored = fields.u64_at(bytes - 8);
        let sound = stored == xxh3_64(&header[..bytes - 8]);
        // A sound header of another version is no damage.
        if !self.versions.contains(&version) && sound {
            let names: Vec<String> = self.versions.iter().map(u32::to_string).collect();
            let expected = format!("version {}, not {version}", names.join(" or "));
            return Err(other(at::VERSION, expected, NEWER));
        }
        fields.ensure(sound, bytes - 8, || {
            format!("header checksum {stored:016x}")
        })?;
        let length = fields.u32_at(at::HEADER_BYTES);
        fields.ensure(length as usize == bytes, at::HEADER_BYTES, || {
            format!("a header length of {bytes}, not {length}")
        })?;
        let said = fields.u64_at(at::FILE_BYTES);
        fields.ensure(said == file_bytes, at::FILE_BYTES, || {
            format!("a file of {said} bytes, not {file_bytes}")
        })?;
        Ok(fields)
    }

    /// Checks that there are only zeros between header and sections, which come in order and lie within the file.
    pub fn check_padding(
        &self,
        all: &[u8],
        sections: impl Iterator<Item = [u64; 2]>,
        path: &Path,
    ) -> Result<(), FileError> {
        let mut end = self.header_bytes as u64;
        for section in sections {
            if all[range([end, section[0]])].iter().any(|&byte| byte != 0) {
                return Err(FileError::damaged(path, "padding", end, "zeros"));
            }
            end = section[1];
        }
        Ok(())
    }
}

/// A header whose common fields are sound. Offsets are within the header.
pub struct Fields<'f> {
    header: &'f [u8],
    path: &'f Path,
}

impl Fields<'_> {
    pub fn bytes_at<const N: usize>(&self, offset: usize) -> [u8; N] {
        std::array::from_fn(|i| self.header[offset + i])
    }

    pub fn byte_at(&self, offset: usize) -> u8 {
        self.header[offset]
    }

    pub fn u32_at(&self, offset: usize) -> u32 {
        u32::from_le_bytes(self.bytes_at(offset))
    }

    pub fn u64_at(&self, offset: usize) -> u64 {
        u64::from_le_bytes(self.bytes_at(offset))
    }

    pub fn f64s_at<const N: usize>(&self, offset: usize) -> [f64; N] {
        std::array::from_fn(|k| f64::from_bits(self.u64_at(offset + 8 * k)))
    }

    pub fn is_zero(&self, range: Range<usize>) -> bool {
        self.header[range].iter().all(|&byte| byte == 0)
    }

    pub fn ensure<E: Into<String>>(
        &self,
        holds: bool,
        offset: usize,
        expected: impl FnOnce() -> E,
    ) -> Result<(), FileError> {
        if holds {
            return Ok(());
        }
        Err(FileError::damaged(
            self.path,
            "header",
            offset as u64,
            expected(),
        ))
    }
}

pub fn write<'s>(
    header: &[u8],
    sections: impl Iterator<Item = ([u64; 2], &'s [u8])>,
    out: &mut dyn Write,
) -> io::Result<()> {
    out.write_all(header)?;
    let mut written = header.len() as u64;
    for ([begin, end], bytes) in sections {
        out.write_all(&[0; ALIGNMENT as usize][..(begin - written) as usize])?;
        out.write_all(bytes)?;
        written = end;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_records_are_turned() {
        let bytes: Vec<u8> = (0..14).collect();
        let mut turned = bytes.clone();
        let numbers = [(1, 4), (1, 1), (1, 2)];
        reverse(&mut turned, &numbers);
        assert_eq!(turned, [3, 2, 1, 0, 4, 6, 5, 10, 9, 8, 7, 11, 13, 12]);
        reverse(&mut turned, &numbers);
        assert_eq!(turned, bytes);
    }
}
