//! The public API: a scene, a camera, a renderer, a picture.

mod camera;
mod error;
mod kept;
mod picture;
mod renderer;
mod scene;

pub use camera::{Camera, FittedCamera, View};
pub use error::Error;
pub use picture::Picture;
pub use renderer::{EngineKind, Renderer};
pub use scene::{Scene, Up};
