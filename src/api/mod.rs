//! The public API: a scene, a camera, a renderer, a picture.

/// Methods of a builder that set one field each.
macro_rules! setters {
    ($($(#[$doc:meta])* $name:ident($value:ident: $type:ty) $($field:tt).+ = $to:expr;)+) => {
        $(
            $(#[$doc])*
            #[must_use]
            pub fn $name(mut self, $value: $type) -> Self {
                self.$($field).+ = $to;
                self
            }
        )+
    };
}

mod camera;
mod error;
mod kept;
mod picture;
mod renderer;
mod scene;

pub use camera::{Camera, FittedCamera, View};
pub use error::Error;
pub use kept::start_threads;
pub use picture::Picture;
pub use renderer::{EngineKind, Renderer};
pub use scene::{Scene, Up};
