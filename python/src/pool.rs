//! The threads that work is spread over.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::refused;

/// Bytes of stack of a thread: as much as a program's first thread has.
const STACK: usize = 8 << 20;

/// The pool, and the process whose threads it has.
///
/// A child made by `fork` inherits a pool without its threads and would wait for them for ever, as it would in
/// Rayon's global pool. It makes a pool of its own instead. Only a thread that holds the GIL locks this, and `fork`
/// is called by such a thread, so that no child inherits it locked.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process, made when it is first asked for.
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
    // Not dropped: that would wake threads that are not there.
    std::mem::forget(pool.replace((process, Arc::clone(&new))));
    Ok(new)
}

/// Does work on all threads, while other Python threads run.
pub(crate) fn on_all_threads<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let pool = pool(py)?;
    Ok(py.detach(|| pool.install(work)))
}
