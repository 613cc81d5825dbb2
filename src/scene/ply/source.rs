//! Bytes, lines and numbers from a stream, and their offsets in the file.

use std::io::{BufRead, ErrorKind, Read};

use crate::scene::fault::{Fault, Problem};
use crate::scene::numbers::{Number, Scalar};

pub(in crate::scene) struct Source<'a, R> {
    reader: &'a mut R,
    pub(in crate::scene) offset: u64,
}

impl<'a, R: BufRead> Source<'a, R> {
    pub(in crate::scene) fn new(reader: &'a mut R) -> Self {
        Self { reader, offset: 0 }
    }

    /// Reads a line without its end; `false` at the end of the file.
    pub(in crate::scene) fn line(
        &mut self,
        line: &mut Vec<u8>,
        longest: usize,
        part: &str,
    ) -> Result<bool, Problem> {
        line.clear();
        let begin = self.offset;
        let most = longest as u64 + 1;
        let read = self.reader.by_ref().take(most).read_until(b'\n', line);
        let read = read.map_err(Problem::Read)? as u64;
        self.offset += read;
        if line.last() == Some(&b'\n') {
            line.pop();
            if line.last() == Some(&b'\r') {
                line.pop();
            }
        } else if read == most {
            return Err(Fault::new(
                part,
                begin,
                format!("lines of at most {longest} bytes, ended by a line feed"),
                "a longer one",
                "the file is damaged, or binary where its header says ascii; export it again",
            )
            .into());
        }
        Ok(read > 0)
    }

    /// Skips bytes; `false` if the file ends first.
    pub(in crate::scene) fn skip(&mut self, mut count: u64) -> Result<bool, Problem> {
        while count > 0 {
            let here = self.reader.fill_buf().map_err(Problem::Read)?.len();
            if here == 0 {
                return Ok(false);
            }
            let used = usize::try_from(count).unwrap_or(usize::MAX).min(here);
            self.reader.consume(used);
            self.offset += used as u64;
            count -= used as u64;
        }
        Ok(true)
    }

    /// Reads `count` bytes; `None` if the file ends first. `scratch` holds those that the reader's buffer cuts.
    #[inline]
    pub(in crate::scene) fn bytes<T>(
        &mut self,
        count: usize,
        scratch: &mut Vec<u8>,
        decode: impl FnOnce(&[u8]) -> T,
    ) -> Result<Option<T>, Problem> {
        let buffered = self.reader.fill_buf().map_err(Problem::Read)?.get(..count);
        let decoded = if let Some(bytes) = buffered {
            let decoded = decode(bytes);
            self.reader.consume(count);
            decoded
        } else {
            scratch.resize(count, 0);
            match self.reader.read_exact(scratch) {
                Ok(()) => decode(scratch),
                Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
                Err(error) => return Err(Problem::Read(error)),
            }
        };
        self.offset += count as u64;
        Ok(Some(decoded))
    }

    /// Skips blanks; whether more follows.
    pub(in crate::scene) fn has_more(&mut self) -> Result<bool, Problem> {
        loop {
            let here = self.reader.fill_buf().map_err(Problem::Read)?;
            if !here.iter().all(u8::is_ascii_whitespace) {
                return Ok(true);
            }
            let blanks = here.len();
            if blanks == 0 {
                return Ok(false);
            }
            self.reader.consume(blanks);
            self.offset += blanks as u64;
        }
    }

    /// Bytes that can be read without another call of the system.
    pub(in crate::scene) fn buffered(&mut self) -> Result<usize, Problem> {
        Ok(self.reader.fill_buf().map_err(Problem::Read)?.len())
    }

    pub(in crate::scene) fn number(
        &mut self,
        scalar: Scalar,
        big: bool,
    ) -> Result<Option<Number>, Problem> {
        self.bytes(scalar.size(), &mut Vec::new(), |bytes| {
            scalar.decode_one(big, bytes)
        })
    }
}
