//! Temporary files, without a name where the system has such files: nothing is left behind if the program is killed.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

#[derive(Debug)]
pub(super) struct Scratch {
    folder: PathBuf,
    in_use: AtomicU64,
    peak: AtomicU64,
    written: AtomicU64,
}

impl Scratch {
    pub(super) fn new(folder: PathBuf) -> Arc<Self> {
        Arc::new(Self {
            folder,
            in_use: AtomicU64::new(0),
            peak: AtomicU64::new(0),
            written: AtomicU64::new(0),
        })
    }

    pub(super) fn peak(&self) -> u64 {
        self.peak.load(Ordering::Relaxed)
    }

    pub(super) fn written(&self) -> u64 {
        self.written.load(Ordering::Relaxed)
    }

    pub(super) fn file(self: &Arc<Self>) -> io::Result<ScratchFile> {
        Ok(ScratchFile {
            file: tempfile::tempfile_in(&self.folder)?,
            bytes: 0,
            scratch: Arc::clone(self),
        })
    }
}

#[derive(Debug)]
pub(super) struct ScratchFile {
    file: File,
    bytes: u64,
    scratch: Arc<Scratch>,
}

impl ScratchFile {
    pub(super) fn len(&self) -> u64 {
        self.bytes
    }

    pub(super) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.bytes))?;
        self.file.write_all(bytes)?;
        let count = bytes.len() as u64;
        self.bytes += count;
        self.scratch.written.fetch_add(count, Ordering::Relaxed);
        let now = self.scratch.in_use.fetch_add(count, Ordering::Relaxed) + count;
        self.scratch.peak.fetch_max(now, Ordering::Relaxed);
        Ok(())
    }

    pub(super) fn replace(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(offset))?;
        self.file.write_all(bytes)?;
        let count = bytes.len() as u64;
        self.scratch.written.fetch_add(count, Ordering::Relaxed);
        Ok(())
    }

    pub(super) fn read(&mut self, offset: u64, into: &mut [u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(offset))?;
        self.file.read_exact(into)
    }
}

impl Drop for ScratchFile {
    fn drop(&mut self) {
        self.scratch.in_use.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// A stream of bytes that is written, then read: a buffer, and a temporary file once the buffer was full.
#[derive(Debug)]
pub(super) struct Spool {
    buffer: Vec<u8>,
    room: usize,
    file: Option<ScratchFile>,
    scratch: Arc<Scratch>,
}

impl Spool {
    pub(super) fn new(scratch: &Arc<Scratch>, room: usize) -> Self {
        Self {
            buffer: Vec::new(),
            room,
            file: None,
            scratch: Arc::clone(scratch),
        }
    }

    pub(super) fn push(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.buffer.len() + bytes.len() > self.room {
            self.flush()?;
            if bytes.len() >= self.room {
                return self.append(bytes);
            }
        }
        self.buffer.extend_from_slice(bytes);
        Ok(())
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.file.is_none() {
            self.file = Some(self.scratch.file()?);
        }
        self.file.as_mut().map_or(Ok(()), |file| file.append(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.buffer.is_empty() {
            return Ok(());
        }
        let mut bytes = std::mem::take(&mut self.buffer);
        self.append(&bytes)?;
        bytes.clear();
        self.buffer = bytes;
        Ok(())
    }

    pub(super) fn len(&self) -> u64 {
        self.file.as_ref().map_or(0, ScratchFile::len) + self.buffer.len() as u64
    }

    pub(super) fn read(&mut self, offset: u64, into: &mut [u8]) -> io::Result<()> {
        let in_file = self.file.as_ref().map_or(0, ScratchFile::len);
        let from_file = in_file.saturating_sub(offset).min(into.len() as u64) as usize;
        let (first, rest) = into.split_at_mut(from_file);
        if let Some(file) = self.file.as_mut().filter(|_| from_file > 0) {
            file.read(offset, first)?;
        }
        if !rest.is_empty() {
            let start = (offset + from_file as u64 - in_file) as usize;
            let held = self.buffer.get(start..start + rest.len());
            rest.copy_from_slice(held.ok_or(io::ErrorKind::UnexpectedEof)?);
        }
        Ok(())
    }

    /// Passes all bytes to `each` in pieces of whole items (of 1, 2, 3, 4 or 16 bytes), and removes them.
    pub(super) fn drain(
        mut self,
        mut each: impl FnMut(&mut [u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let length = self.len();
        let mut piece = vec![0; (self.room as u64).min(length) as usize];
        let mut offset = 0;
        while offset < length {
            let count = (length - offset).min(piece.len() as u64) as usize;
            self.read(offset, &mut piece[..count])?;
            each(&mut piece[..count])?;
            offset += count as u64;
        }
        Ok(())
    }
}
