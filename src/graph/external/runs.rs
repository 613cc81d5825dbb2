//! Sorted runs in a temporary file, and their merge.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::io;
use std::sync::Arc;

use rayon::prelude::*;

use super::buffer_sizes::BufferSizes;
use super::record::key;
use super::scratch::{Scratch, ScratchFile};

const RECORD_BYTES: u64 = size_of::<u128>() as u64;

#[derive(Debug, Clone, Copy)]
struct Run {
    offset: u64,
    records: u64,
}

/// Runs of records, each sorted and without equal keys.
#[derive(Debug)]
pub(super) struct Runs {
    file: ScratchFile,
    runs: Vec<Run>,
}

impl Runs {
    pub(super) fn new(scratch: &Arc<Scratch>) -> io::Result<Self> {
        Ok(Self {
            file: scratch.file()?,
            runs: Vec::new(),
        })
    }

    pub(super) fn len(&self) -> usize {
        self.runs.len()
    }

    pub(super) fn add(&mut self, sorted: &[u128]) -> io::Result<()> {
        let offset = self.file.len();
        self.file.append(bytemuck::cast_slice(sorted))?;
        self.runs.push(Run {
            offset,
            records: sorted.len() as u64,
        });
        Ok(())
    }

    /// Changes the keys of a run, which must stay distinct, and sorts it again.
    pub(super) fn rekey(
        &mut self,
        run: usize,
        buffer: &mut Vec<u128>,
        change: impl Fn(u128) -> u128 + Sync,
    ) -> io::Result<()> {
        let Run { offset, records } = self.runs[run];
        buffer.clear();
        buffer.resize(records as usize, 0);
        self.file.read(offset, bytemuck::cast_slice_mut(buffer))?;
        buffer
            .par_iter_mut()
            .for_each(|record| *record = change(*record));
        buffer.par_sort_unstable();
        self.file.replace(offset, bytemuck::cast_slice(buffer))
    }

    /// All records in order; of equal keys, the one of the last run stays.
    pub(super) fn merged(
        mut self,
        sizes: &BufferSizes,
        scratch: &Arc<Scratch>,
    ) -> io::Result<Merge> {
        while self.runs.len() > sizes.fan_in {
            let mut fewer = Self::new(scratch)?;
            let mut block = Vec::new();
            let all = std::mem::take(&mut self.runs);
            // Neighbours are merged, so the order of runs is kept.
            for group in all.chunks(sizes.fan_in) {
                let offset = fewer.file.len();
                let mut merge = Merge::new(self.file, group, sizes.merge_bytes)?;
                while let Some(record) = merge.next()? {
                    block.push(record);
                    if block.len() as u64 * RECORD_BYTES >= merge.reader_bytes {
                        fewer.file.append(bytemuck::cast_slice(&block))?;
                        block.clear();
                    }
                }
                fewer.file.append(bytemuck::cast_slice(&block))?;
                block.clear();
                let records = (fewer.file.len() - offset) / RECORD_BYTES;
                fewer.runs.push(Run { offset, records });
                self.file = merge.file;
            }
            self = fewer;
        }
        let runs = std::mem::take(&mut self.runs);
        Merge::new(self.file, &runs, sizes.merge_bytes)
    }
}

#[derive(Debug)]
struct Reader {
    rest: Run,
    piece: Vec<u128>,
    next: usize,
}

#[derive(Debug)]
pub(super) struct Merge {
    file: ScratchFile,
    readers: Vec<Reader>,
    heads: BinaryHeap<Reverse<(u64, Reverse<u32>)>>,
    last: Option<u64>,
    reader_bytes: u64,
}

impl Merge {
    fn new(file: ScratchFile, runs: &[Run], bytes: usize) -> io::Result<Self> {
        let each = bytes as u64 / runs.len().max(1) as u64;
        let mut merge = Self {
            file,
            readers: Vec::with_capacity(runs.len()),
            heads: BinaryHeap::with_capacity(runs.len()),
            last: None,
            reader_bytes: each.clamp(RECORD_BYTES, 4 << 20) / RECORD_BYTES * RECORD_BYTES,
        };
        for (number, &run) in (0u32..).zip(runs) {
            merge.readers.push(Reader {
                rest: run,
                piece: Vec::new(),
                next: 0,
            });
            if merge.refill(number)? {
                let first = key(merge.readers[number as usize].piece[0]);
                merge.heads.push(Reverse((first, Reverse(number))));
            }
        }
        Ok(merge)
    }

    fn refill(&mut self, number: u32) -> io::Result<bool> {
        let reader = &mut self.readers[number as usize];
        let records = reader.rest.records.min(self.reader_bytes / RECORD_BYTES);
        if records == 0 {
            reader.piece = Vec::new();
            return Ok(false);
        }
        reader.piece.resize(records as usize, 0);
        reader.next = 0;
        let into = bytemuck::cast_slice_mut(&mut reader.piece);
        self.file.read(reader.rest.offset, into)?;
        reader.rest.offset += records * RECORD_BYTES;
        reader.rest.records -= records;
        Ok(true)
    }

    pub(super) fn next(&mut self) -> io::Result<Option<u128>> {
        loop {
            let Some(&Reverse((head, Reverse(number)))) = self.heads.peek() else {
                return Ok(None);
            };
            let reader = &mut self.readers[number as usize];
            let record = reader.piece[reader.next];
            reader.next += 1;
            let more = reader.next < reader.piece.len() || self.refill(number)?;
            if let Some(mut top) = self.heads.peek_mut() {
                if more {
                    let reader = &self.readers[number as usize];
                    *top = Reverse((key(reader.piece[reader.next]), Reverse(number)));
                } else {
                    PeekMut::pop(top);
                }
            }
            if self.last != Some(head) {
                self.last = Some(head);
                return Ok(Some(record));
            }
        }
    }
}

#[derive(Debug)]
pub(super) struct Sorter {
    buffer: Vec<u128>,
    room: usize,
    runs: Runs,
}

impl Sorter {
    pub(super) fn new(scratch: &Arc<Scratch>, room: usize) -> io::Result<Self> {
        Ok(Self {
            buffer: Vec::new(),
            room,
            runs: Runs::new(scratch)?,
        })
    }

    pub(super) fn push(&mut self, record: u128) -> io::Result<()> {
        self.buffer.push(record);
        if self.buffer.len() < self.room {
            return Ok(());
        }
        self.spill()
    }

    fn spill(&mut self) -> io::Result<()> {
        self.buffer.par_sort_unstable();
        self.runs.add(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }

    pub(super) fn merged(
        mut self,
        sizes: &BufferSizes,
        scratch: &Arc<Scratch>,
    ) -> io::Result<Merge> {
        self.spill()?;
        drop(self.buffer);
        self.runs.merged(sizes, scratch)
    }
}
