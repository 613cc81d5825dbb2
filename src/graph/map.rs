//! Mapping a file into memory: the only unsafe code below the engines.

use std::fs::File;
use std::io;
use std::sync::Arc;

use memmap2::Mmap;

pub fn map(file: &File) -> io::Result<Arc<Mmap>> {
    // SAFETY: a map must not change while it is borrowed. It is private and read-only, and this program never changes
    // files in place: a new file takes the name. That no other program changes the file is the user's part
    // (`spec/graph.md`). No index is followed unchecked, so changed bytes give a wrong picture. A file truncated under
    // the map ends the process (SIGBUS); the command line reports why (`crates/cli/src/fatal_signals.rs`).
    let map = unsafe { Mmap::map(file) }?;
    Ok(Arc::new(map))
}

/// Advises the system that all of the file is read, or scattered pages, where it has such a call.
pub(in crate::graph) fn advise(map: &Mmap, is_whole: bool) {
    #[cfg(unix)]
    {
        let advice = match is_whole {
            true => memmap2::Advice::Sequential,
            false => memmap2::Advice::Random,
        };
        let _ = map.advise(advice);
    }
    #[cfg(not(unix))]
    let _ = (map, is_whole);
}

/// Drops the pages of a range of bytes. False where the system has no such call, or refuses it.
pub fn release(map: &Mmap, from: usize, bytes: usize) -> bool {
    #[cfg(unix)]
    {
        if from > map.len() || bytes > map.len() - from {
            return false;
        }
        // SAFETY: the map is read-only, so there are no changes to lose. References into a dropped page stay valid.
        let dropped =
            unsafe { map.unchecked_advise_range(memmap2::UncheckedAdvice::DontNeed, from, bytes) };
        dropped.is_ok()
    }
    #[cfg(not(unix))]
    {
        let _ = (map, from, bytes);
        false
    }
}
