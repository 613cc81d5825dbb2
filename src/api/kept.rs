//! Threads, engine and frame of a renderer, kept from picture to picture.

use std::error::Error as _;
use std::fmt;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use hwmodel::Overflow;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::{EngineKind, Error};
use crate::drawing::Canvas;

pub(super) const MOST_THREADS: usize = 1024;

/// The settings on which an engine and its threads depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Key {
    pub(super) engine: EngineKind,
    pub(super) overflow: Overflow,
    /// 0: the threads of the caller's pool.
    pub(super) threads: usize,
}

/// For `shiftvox-mesh`: starts the threads of the global pool of `rayon`, which panics where it uses one that does not
/// start. Nothing happens inside another pool. Errors: [`Error::Threads`] with the system's reason.
pub fn start_threads() -> Result<(), Error> {
    static REFUSED: OnceLock<Option<String>> = OnceLock::new();
    // WebAssembly has no threads: `rayon` works on the caller's.
    if cfg!(target_family = "wasm") || rayon::current_thread_index().is_some() {
        return Ok(());
    }
    let refused = REFUSED.get_or_init(|| {
        let error = ThreadPoolBuilder::new().build_global().err()?;
        // Without a source, the pool has been started already.
        let refused = error.source()?;
        Some(format!("cannot start the threads: {refused}"))
    });
    match refused.as_deref() {
        Some(reason) => Err(Error::Threads(reason.into())),
        None => Ok(()),
    }
}

pub(super) struct Job {
    key: Key,
    pub(super) pool: Option<ThreadPool>,
    pub(super) canvas: Option<Canvas>,
}

/// Idle jobs: as many as ever drew at the same time.
#[derive(Default)]
pub(super) struct Kept(Mutex<Vec<Job>>);

impl Kept {
    /// An idle job with these settings, or a new one without a canvas.
    pub(super) fn take(&self, key: Key) -> Result<Job, Error> {
        let threads = key.threads;
        if threads > MOST_THREADS {
            let reason = format!("threads: 0 to {MOST_THREADS}, not {threads}");
            return Err(Error::Setting(reason));
        }
        let idle = self.idle().pop();
        if let Some(job) = idle.filter(|job| job.key == key) {
            return Ok(job);
        }
        let pool = match threads {
            0 => {
                start_threads()?;
                None
            }
            _ => Some(
                ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .map_err(|e| Error::Threads(e.into()))?,
            ),
        };
        Ok(Job {
            key,
            pool,
            canvas: None,
        })
    }

    pub(super) fn idle(&self) -> MutexGuard<'_, Vec<Job>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Clone for Kept {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Kept")
    }
}
