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
    /// Levels at which a mesh is voxelised: 2^N voxels along its longest side [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16))]
    pub depth: Option<u32>,
}

impl SceneArgs {
    /// Every setting, for a configuration file.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let mut settings = vec![("oob", word(&self.oob))];
        settings.extend(self.depth.map(|depth| ("depth", i64::from(depth).into())));
        settings
    }
}
