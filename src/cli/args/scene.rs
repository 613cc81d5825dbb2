//! How scenes are read.

use clap::{Args, ValueEnum};

use super::{Setting, word};

/// What to do with voxels outside a model's SIZE.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum OutOfBoundsName {
    /// Take the coordinate modulo 256 that is nearest to the middle of SIZE.
    #[default]
    Wrap,
    /// Take the byte as it stands.
    Keep,
    /// Leave such voxels out.
    Drop,
    /// Refuse the file.
    Error,
}

/// How scenes are read.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Scene")]
pub struct SceneArgs {
    /// Voxels outside a .vox model's SIZE (VoxelShop writes them, modulo 256)
    #[arg(long, value_enum, default_value_t)]
    pub oob: OutOfBoundsName,
}

impl SceneArgs {
    /// Every setting, for a configuration file.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        vec![("oob", word(&self.oob))]
    }
}
