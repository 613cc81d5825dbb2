//! From a camera to the integers of a frame, and what engines have in common.

pub mod camera;
pub mod engine;
pub mod setup;

pub use camera::{Camera, CameraError};
pub use engine::{Engine, EngineError, Stats};
pub use setup::{CageKind, Coverage, FrameSetup, SetupError, SetupOptions};
