//! Voxels as they are pushed, in sorted runs.
//!
//! Morton order counts from the lowest corner, which is known only at the end. Each run is sorted from the lowest
//! corner so far. Runs with another corner are sorted again at the end; most scenes have few.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

use rayon::Yield;
use rayon::prelude::*;

use super::buffer_sizes::BufferSizes;
use super::record::{key, moved, placed, pushed};
use super::runs::{Merge, Runs};
use super::scratch::Scratch;
use crate::graph::{Progress, Voxel};

type Sorted = io::Result<(Vec<u128>, Runs)>;

#[derive(Debug)]
pub(super) struct Gather {
    sizes: BufferSizes,
    scratch: Arc<Scratch>,
    buffer: Vec<u128>,
    /// Of the previous run, which is sorted and written meanwhile.
    running: Option<Receiver<Sorted>>,
    /// The corner from which each run is sorted.
    corners: Vec<[i32; 3]>,
    pub(super) min: [i32; 3],
    pub(super) max: [i32; 3],
    pub(super) pushed: u64,
    failure: Option<io::Error>,
}

impl Gather {
    pub(super) fn new(sizes: BufferSizes, scratch: Arc<Scratch>) -> Self {
        Self {
            sizes,
            scratch,
            buffer: Vec::new(),
            running: None,
            corners: Vec::new(),
            min: [i32::MAX; 3],
            max: [i32::MIN; 3],
            pushed: 0,
            failure: None,
        }
    }

    pub(super) fn push(&mut self, voxel: &Voxel) {
        self.pushed += 1;
        if self.failure.is_some() {
            return;
        }
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(voxel.index[axis]);
            self.max[axis] = self.max[axis].max(voxel.index[axis]);
        }
        if self.buffer.capacity() == 0 {
            self.buffer.reserve_exact(self.sizes.run_records);
        }
        self.buffer.push(pushed(voxel, self.buffer.len()));
        if self.buffer.len() >= self.sizes.run_records
            && let Err(error) = self.spill()
        {
            self.failure = Some(error);
        }
    }

    fn spill(&mut self) -> io::Result<()> {
        let (spare, mut runs) = self.waited()?;
        let mut records = std::mem::replace(&mut self.buffer, spare);
        let corner = self.min;
        self.corners.push(corner);
        let sort = move || -> Sorted {
            records
                .par_iter_mut()
                .for_each(|record| *record = placed(*record, corner));
            records.par_sort_unstable();
            records.dedup_by_key(|record| key(*record));
            runs.add(&records)?;
            records.clear();
            Ok((records, runs))
        };
        let (sender, receiver) = mpsc::channel();
        rayon::spawn(move || {
            if let Ok(sorted) = catch_unwind(AssertUnwindSafe(sort)) {
                let _ = sender.send(sorted);
            }
        });
        self.running = Some(receiver);
        Ok(())
    }

    /// A thread of a pool works for the pool meanwhile. If all of them only waited, none would sort.
    fn waited(&mut self) -> Sorted {
        let Some(running) = self.running.take() else {
            return Ok((Vec::new(), Runs::new(&self.scratch)?));
        };
        loop {
            let time = match rayon::yield_now() {
                None => Duration::MAX,
                Some(Yield::Executed) => Duration::ZERO,
                Some(Yield::Idle) => Duration::from_micros(100),
            };
            match running.recv_timeout(time) {
                Ok(sorted) => return sorted,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(io::Error::other("the thread that sorts has failed"));
                }
            }
        }
    }

    /// All voxels in Morton order from the lowest corner, and the number of runs.
    pub(super) fn merged(mut self, progress: &dyn Progress) -> io::Result<(Merge, usize)> {
        if let Some(failure) = self.failure.take() {
            return Err(failure);
        }
        progress.begin("sort voxels", 0);
        if !self.buffer.is_empty() {
            self.spill()?;
        }
        let (mut buffer, mut runs) = self.waited()?;
        for (run, &corner) in self.corners.iter().enumerate() {
            if corner != self.min {
                runs.rekey(run, &mut buffer, |record| moved(record, corner, self.min))?;
            }
        }
        drop((buffer, std::mem::take(&mut self.buffer)));
        let count = runs.len();
        let merge = runs.merged(&self.sizes, &self.scratch)?;
        progress.end();
        Ok((merge, count))
    }
}

/// Waits, so that nothing is written once the builder is gone.
impl Drop for Gather {
    fn drop(&mut self) {
        let _ = self.waited();
    }
}
