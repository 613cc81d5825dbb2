//! The thread pool of the process.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::refused;

/// Bytes of stack per thread, as many as a program's first thread has.
const STACK: usize = 8 << 20;

/// The pool and its process.
///
/// A child made by `fork` inherits a pool without its threads, so it makes its own. Only a thread that holds the GIL locks
/// this, and such a thread calls `fork`, so no child inherits a lock.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

fn pool(_holds_the_gil: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, there)) = &*pool
        && *owner == process
    {
        return Ok(Arc::clone(there));
    }
    let new = ThreadPoolBuilder::new().stack_size(STACK).build();
    let new = Arc::new(new.map_err(refused)?);
    // Dropping it would wake threads that do not exist.
    std::mem::forget(pool.replace((process, Arc::clone(&new))));
    Ok(new)
}

/// Works on all threads, while other Python threads run.
pub(crate) fn on_all_threads<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let pool = pool(py)?;
    Ok(py.detach(|| pool.install(work)))
}
