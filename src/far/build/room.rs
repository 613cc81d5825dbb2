//! Memory of the nodes that are sampled at the same time.

use std::sync::{Condvar, Mutex, PoisonError};

/// Bytes that nodes may take together.
pub(super) struct Room {
    most: u64,
    taken: Mutex<u64>,
    freed: Condvar,
}

/// Bytes that a node has taken, until this is dropped.
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
        // A number stays sound whoever panicked.
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
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
        let mut taken = self
            .room
            .taken
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *taken -= self.bytes;
        self.room.freed.notify_all();
    }
}
