//! Progress of long work.

/// Receives the progress of long work, from any thread.
pub trait Progress: Sync {
    /// A piece of work with `steps` steps begins (0: unknown).
    fn begin(&self, what: &str, steps: u64);
    /// `steps` more steps are done.
    fn advance(&self, steps: u64);
    /// The piece of work is done.
    fn end(&self);
}

/// Ignores all progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _what: &str, _steps: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
}
