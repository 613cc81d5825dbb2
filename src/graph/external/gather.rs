//! Voxels as they are pushed, in sorted runs.
//!
//! Morton order counts from the lowest corner, which is known only at the end. Each run is sorted from the lowest
//! corner so far. Runs with another corner are sorted again at the end; most scenes have few.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use super::buffer_sizes::BufferSizes;
use super::record::{key, moved, placed, pushed};
use super::runs::{Merge, Runs};
use super::scratch::Scratch;
use crate::graph::{Progress, Voxel};

type Sorted = io::Result<(Vec<u128>, Runs)>;

/// A run that no thread has begun to sort.
#[derive(Debug)]
struct Unsorted {
    records: Vec<u128>,
    corner: [i32; 3],
    runs: Runs,
}

impl Unsorted {
    /// Sorts and writes it, and returns the emptied memory.
    fn sorted(self) -> Sorted {
        let Self {
            mut records,
            corner,
            mut runs,
        } = self;
        records
            .par_iter_mut()
            .for_each(|record| *record = placed(*record, corner));
        records.par_sort_unstable();
        records.dedup_by_key(|record| key(*record));
        runs.add(&records)?;
        records.clear();
        Ok((records, runs))
    }
}

/// The thread that takes the run first sorts it: one of the pool, or the one that waits for it. So it is sorted even if
/// all threads of the pool wait.
#[derive(Debug)]
struct Running {
    unsorted: Arc<Mutex<Option<Unsorted>>>,
    sorted: Receiver<Sorted>,
}

fn take(unsorted: &Mutex<Option<Unsorted>>) -> Option<Unsorted> {
    let mut unsorted = unsorted.lock().unwrap_or_else(PoisonError::into_inner);
    unsorted.take()
}

#[derive(Debug)]
pub(super) struct Gather {
    sizes: BufferSizes,
    scratch: Arc<Scratch>,
    buffer: Vec<u128>,
    /// The previous run, which is sorted and written meanwhile.
    running: Option<Running>,
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
        let (spare, runs) = self.waited()?;
        let records = std::mem::replace(&mut self.buffer, spare);
        let corner = self.min;
        self.corners.push(corner);
        let unsorted = Arc::new(Mutex::new(Some(Unsorted {
            records,
            corner,
            runs,
        })));
        let (sender, sorted) = mpsc::channel();
        let own = Arc::clone(&unsorted);
        rayon::spawn(move || {
            if let Some(run) = take(&own)
                && let Ok(sorted) = catch_unwind(AssertUnwindSafe(|| run.sorted()))
            {
                let _ = sender.send(sorted);
            }
        });
        self.running = Some(Running { unsorted, sorted });
        Ok(())
    }

    fn waited(&mut self) -> Sorted {
        let Some(Running { unsorted, sorted }) = self.running.take() else {
            return Ok((Vec::new(), Runs::new(&self.scratch)?));
        };
        if let Some(run) = take(&unsorted) {
            return run.sorted();
        }
        let failed = |_| Err(io::Error::other("a run could not be sorted"));
        sorted.recv().unwrap_or_else(failed)
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
