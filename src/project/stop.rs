//! How another thread stops a drawing.

use std::fmt;
use std::sync::Arc;

/// A question that engines ask every few milliseconds, from any thread: is the picture still wanted? If not, they fail
/// with [`EngineError::Stopped`](super::EngineError::Stopped). By default it always is.
#[derive(Clone, Default)]
pub struct Stop(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl Stop {
    /// Stops drawings as soon as `is_requested` is true.
    pub fn when(is_requested: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(is_requested)))
    }

    /// Whether drawings should end now.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.0.as_ref().is_some_and(|is_requested| is_requested())
    }
}

impl fmt::Debug for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() {
            "Stop::when(..)"
        } else {
            "Stop"
        })
    }
}
