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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

    use super::*;
    use crate::{Camera, Coverage, EngineError, EngineKind, Error, Renderer, Scene};

    /// A drawing ends at the question that is answered with yes, and the next one is drawn again from the beginning.
    #[test]
    fn every_engine_stops_in_the_middle() {
        let scene = Scene::generate("menger,depth=3").unwrap();
        let camera = Camera::fit(&scene);
        // The fast engine asks before each band, of which there may be one.
        for (engine, coverage, at) in [
            (EngineKind::Fast, Coverage::Exact, 0),
            (EngineKind::Fast, Coverage::Any, 1),
            (EngineKind::Machine, Coverage::Exact, 1),
            (EngineKind::Rays, Coverage::Exact, 1),
        ] {
            let questions = Arc::new(AtomicU32::new(0));
            let asked = Arc::clone(&questions);
            let stop = Stop::when(move || asked.fetch_add(1, Relaxed) == at);
            let renderer = Renderer::new()
                .engine(engine)
                .coverage(coverage)
                .hashed(true);
            let whole = renderer.render(&scene, &camera, 200, 200).unwrap();
            let renderer = renderer.stopped_by(&stop);
            let stopped = renderer.render(&scene, &camera, 200, 200);
            let is_stopped = matches!(stopped, Err(Error::Engine(EngineError::Stopped)));
            assert!(is_stopped, "{engine:?}, {coverage:?}");
            let again = renderer.render(&scene, &camera, 200, 200).unwrap();
            assert_eq!(again.hash().unwrap(), whole.hash().unwrap());
            assert!(questions.load(Relaxed) > at + 1);
        }
    }
}
