//! The thread pool of the process.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use shiftvox::Stop;

use crate::refused;

/// Bytes of stack per thread, as many as a program's first thread has.
const STACK: usize = 8 << 20;
/// Time between two checks for signals.
const SIGNALS: Duration = Duration::from_millis(20);

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

/// Works on all threads, while other Python threads run. After a signal such as Ctrl-C, Python's exception is raised and
/// the work is to stop. Work that never checks its `Stop` ends later, in the background, and
/// its result is dropped.
pub(crate) fn on_all_threads<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> T + Send + 'static,
) -> PyResult<T> {
    let is_over = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&is_over);
    let stop = Stop::when(move || asked.load(Ordering::Relaxed));
    let (sender, mut receiver) = mpsc::channel();
    pool(py)?.spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&stop)));
        let _ = sender.send(done);
    });
    loop {
        let wait = move || (receiver.recv_timeout(SIGNALS), receiver);
        let (done, again) = py.detach(wait);
        match done {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(_) => {
                let signals = py.check_signals();
                signals.inspect_err(|_| is_over.store(true, Ordering::Relaxed))?;
            }
        }
        receiver = again;
    }
}
