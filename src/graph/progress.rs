//! How long work tells how far it is, without knowing who listens.

/// Told by long work how far it is. All calls may come from any thread.
pub trait Progress: Sync {
    /// A piece of work begins: what it is, and how many steps it has (0: unknown).
    fn begin(&self, what: &str, steps: u64);
    /// So many steps more are done.
    fn advance(&self, steps: u64);
    /// The piece of work is done.
    fn end(&self);
}

/// Nobody listens.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _what: &str, _steps: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
}
