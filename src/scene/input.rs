//! The bytes of a file, as a reader of voxels receives them.

use std::io::{self, BufReader, ErrorKind, Read, Seek};

/// A file, or bytes in memory.
pub(super) trait Stream: Read + Seek {}

impl<S: Read + Seek> Stream for S {}

/// A file at its beginning.
pub(super) struct Input<'f> {
    pub(super) reader: BufReader<&'f mut dyn Stream>,
    /// Bytes of the file.
    pub(super) length: u64,
}

impl<'f> Input<'f> {
    pub(super) fn new(stream: &'f mut dyn Stream, length: u64) -> Self {
        let reader = BufReader::with_capacity(1 << 16, stream);
        Self { reader, length }
    }

    /// The whole file.
    pub(super) fn bytes(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let length = usize::try_from(self.length).unwrap_or(usize::MAX);
        bytes
            .try_reserve_exact(length)
            .map_err(|refused| io::Error::new(ErrorKind::OutOfMemory, refused))?;
        self.reader.read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}
