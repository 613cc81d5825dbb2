//! How scenes are read.

use clap::Args;

use super::setting::{Setting, word};
use shiftvox::project::Up;
use shiftvox::scene::OutOfBounds;
use shiftvox_mesh::ColorSpace;
use shiftvox_mesh::voxelize::{DEFAULT_DEPTH, MAX_DEPTH};

/// How scenes are read.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Scene")]
pub struct SceneArgs {
    /// Voxels outside a .vox model's SIZE (VoxelShop writes them, modulo 256)
    #[arg(long, value_enum, default_value_t)]
    pub oob: OutOfBounds,
    /// Levels that a mesh is voxelised at: at most 2^N voxels a side [default: 9]
    #[arg(long, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_DEPTH)))]
    pub depth: Option<u32>,
    /// Give the voxels of a mesh six opacities, for --coverage alpha; of a mesh that is drawn with
    /// that they are found anyway
    #[arg(long)]
    pub opacities: bool,
    /// Up axis, for fitted cameras [default: y of .obj, .ply, .gltf and .glb meshes and
    /// of files made of them, else z]
    #[arg(long, value_enum)]
    pub mesh_up: Option<Up>,
    /// How the colours of an .obj mesh's .mtl are meant; the format does not say
    #[arg(long, value_enum, default_value_t)]
    pub mesh_colors: ColorSpace,
}

impl SceneArgs {
    /// Levels that a mesh is voxelised at.
    #[must_use]
    pub fn mesh_depth(&self) -> u32 {
        self.depth.unwrap_or(DEFAULT_DEPTH)
    }

    /// The up axis of a file whose own axis is `up`.
    #[must_use]
    pub fn up_or(&self, up: Up) -> Up {
        self.mesh_up.unwrap_or(up)
    }

    /// Flags of the command line that say how voxels and meshes are read, by their long names.
    pub fn given(&self) -> impl Iterator<Item = &'static str> {
        let flags = [
            ("depth", self.depth.is_some()),
            ("opacities", self.opacities),
            ("oob", self.oob != OutOfBounds::default()),
            ("mesh-colors", self.mesh_colors != ColorSpace::default()),
        ];
        let given = flags.into_iter().filter(|&(_, is_given)| is_given);
        given.map(|(name, _)| name)
    }

    /// Every setting, for a configuration file.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let mut settings = vec![
            ("oob", word(&self.oob)),
            ("mesh-colors", word(&self.mesh_colors)),
            ("opacities", self.opacities.into()),
        ];
        settings.extend(self.depth.map(|depth| ("depth", i64::from(depth).into())));
        settings.extend(self.mesh_up.map(|up| ("mesh-up", word(&up))));
        settings
    }
}
