//! From a camera to the integers of a frame, and the interface of the engines.

pub mod camera;
pub mod engine;
mod fit_camera;
mod opacity;
pub mod options;
mod reach;
mod real_view;
pub mod setup;
mod stop;
pub mod vector;
pub mod viewer;

pub use camera::{Camera, CameraError};
pub use engine::{Engine, EngineError, OCCLUSION_ORDER, Rendered, Stats, most_records, stat};
pub use fit_camera::{Bounds, DEFAULT_FOV, Direction, Lens, Up, fit_camera};
pub use opacity::{ALL_LEFT, OPAQUE_ENOUGH, OpacityEye, SHARES};
pub use options::{CageKind, Coverage, SetupOptions};
pub use setup::{FrameSetup, SetupError};
pub use stop::Stop;
pub use viewer::{Canvas, Contents, Viewer};
