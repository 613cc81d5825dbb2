//! The bytes of a file, as a reader of voxels receives them.

use std::io::{self, BufReader, Read, Seek};

use crate::bounded;

pub(super) trait Stream: Read + Seek {}

impl<S: Read + Seek> Stream for S {}

pub(super) struct Input<'f> {
    pub(super) reader: BufReader<&'f mut dyn Stream>,
    pub(super) length: u64,
}

impl<'f> Input<'f> {
    pub(super) fn new(stream: &'f mut dyn Stream, length: u64) -> Self {
        let reader = BufReader::with_capacity(1 << 16, stream);
        Self { reader, length }
    }

    pub(super) fn bytes(&mut self) -> io::Result<Vec<u8>> {
        bounded::rest(&mut self.reader, self.length)
    }
}
