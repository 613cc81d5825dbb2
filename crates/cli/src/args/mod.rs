mod camera;
mod engine;
mod picture;
mod scene;
mod values;

pub(crate) use camera::CameraArgs;
pub(crate) use engine::{EngineArgs, EngineName, RuleArgs};
pub(crate) use picture::PictureArgs;
pub(crate) use scene::SceneArgs;
pub(crate) use values::{Size, bytes, tolerance};
