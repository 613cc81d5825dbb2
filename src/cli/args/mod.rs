//! Arguments that several verbs share.

mod camera;
mod engine;
mod output;
mod picture;
mod scene;
mod values;

pub use camera::{CameraArgs, ViewName, camera_line, camera_settings};
pub use engine::{
    CageName, CoverageName, EngineArgs, EngineName, Erosion, FarOpacityName, Isa, OverflowName,
    RuleArgs,
};
pub use output::OutputArgs;
pub use picture::{Aov, PictureArgs};
pub use scene::{ColorName, OutOfBoundsName, SceneArgs, UpName};
pub use values::{DataBudget, Memory, Point, Size, ThreadCounts, Tolerance};

/// A setting as a configuration file has it: the flag's long name and its value.
pub type Setting = (&'static str, toml::Value);

/// A choice among names, in the words of the command line.
pub(crate) fn word(value: &impl clap::ValueEnum) -> toml::Value {
    let name = value
        .to_possible_value()
        .map_or_else(String::new, |possible| possible.get_name().to_owned());
    toml::Value::String(name)
}
