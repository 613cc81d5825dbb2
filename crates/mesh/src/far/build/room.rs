//! Memory of a build: shares of a budget, and nodes that wait for room.

use std::sync::{Condvar, Mutex, PoisonError};

use super::BuildError;
use super::clusters::{CLUSTER, MADE, MAKING};
use crate::list::lock;

/// Most bytes per triangle while the parts of a hybrid are found.
const PARTS_BYTES: u64 = 160;
const LEAST_ROOM: u64 = 44 << 20;

pub(super) struct Shares {
    pub(super) clusters: Option<u64>,
    pub(super) nodes: u64,
}

pub(super) fn shares(
    triangles: usize,
    hybrid: bool,
    memory: Option<u64>,
) -> Result<Shares, BuildError> {
    let Some(given) = memory else {
        return Ok(Shares {
            clusters: None,
            nodes: u64::MAX,
        });
    };
    let triangles = triangles as u64;
    // The order of the triangles, twice while they are split, and a branch and a record per node.
    let fixed = triangles * if hybrid { 10 + PARTS_BYTES } else { 10 };
    let making = MAKING * triangles.min(CLUSTER as u64);
    let threads = rayon::current_num_threads() as u64;
    let cluster = MADE * triangles.min(CLUSTER as u64);
    let needed = fixed + making.max(LEAST_ROOM + cluster * threads);
    if given < needed {
        return Err(BuildError::Memory { needed, given });
    }
    let all = triangles * MADE;
    let rest = given - fixed;
    let nodes = (rest - cluster * threads - LEAST_ROOM) / 4 + LEAST_ROOM;
    let room = rest - nodes;
    let fits = all + making <= room;
    Ok(Shares {
        clusters: (!fits).then(|| (room.saturating_sub(making)).max(cluster)),
        nodes,
    })
}

pub(super) struct Room {
    most: u64,
    taken: Mutex<u64>,
    freed: Condvar,
}

pub(super) struct Taken<'r> {
    room: &'r Room,
    bytes: u64,
}

impl Room {
    pub(super) fn new(most: u64) -> Self {
        Self {
            most,
            taken: Mutex::new(0),
            freed: Condvar::new(),
        }
    }

    /// Waits until there are so many bytes, or no other node has any.
    pub(super) fn take(&self, bytes: u64) -> Taken<'_> {
        let mut taken = lock(&self.taken);
        while *taken > 0 && taken.saturating_add(bytes) > self.most {
            let woken = self.freed.wait(taken);
            taken = woken.unwrap_or_else(PoisonError::into_inner);
        }
        *taken += bytes;
        Taken { room: self, bytes }
    }
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        *lock(&self.room.taken) -= self.bytes;
        self.room.freed.notify_all();
    }
}
