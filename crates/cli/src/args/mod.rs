//! Arguments that several commands share.

mod camera;
mod engine;
mod output;
mod picture;
mod scene;
mod setting;
mod values;

pub use camera::{CameraArgs, ViewName, camera_line, camera_settings};
pub use engine::{EngineArgs, EngineName, Erosion, RuleArgs};
pub use output::OutputArgs;
pub use picture::PictureArgs;
pub use scene::SceneArgs;
pub use setting::Setting;
#[cfg(feature = "view")]
pub(crate) use setting::word;
pub use values::{DataBudget, Memory, Point, Size, ThreadCounts, Tolerance};
