//! How scenes are read.

use clap::Args;

use shiftvox::graph::Crop;
use shiftvox::project::Up;
use shiftvox_mesh::ColorSpace;
use shiftvox_mesh::voxelize::{DEFAULT_DEPTH, MAX_DEPTH};

#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Scene")]
pub(crate) struct SceneArgs {
    /// Side of a voxel, in the file's units, for clouds of points (.ply .xyz .pcd .npy) whose
    /// coordinates are not voxel indices
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) voxel_size: Option<f64>,
    /// Voxelise meshes with N levels, at most 2^N voxels per side [default: 9]
    #[arg(long, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_DEPTH)))]
    pub(crate) depth: Option<u32>,
    /// Give the voxels of a mesh six opacities, as --coverage alpha does for itself
    #[arg(long)]
    pub(crate) opacities: bool,
    /// Only the voxels within a box, to look inside: ranges of voxel indices along x, y and z without
    /// their ends, such as ..20,..,3..9
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) crop: Option<Crop>,
    /// Up axis, for fitted cameras [default: y of .obj, .ply, .gltf and .glb meshes and
    /// of files made of them, else z]
    #[arg(long, value_enum)]
    pub(crate) mesh_up: Option<Up>,
    /// Colour space of an .obj mesh's .mtl, which the format does not define
    #[arg(long, value_enum, default_value_t)]
    pub(crate) mesh_colors: ColorSpace,
}

fn size(text: &str) -> Result<f64, String> {
    let size = text
        .parse()
        .ok()
        .filter(|size: &f64| size.is_normal() && *size > 0.0);
    size.ok_or_else(|| "it is not a number above 0".to_owned())
}

impl SceneArgs {
    pub(crate) fn mesh_depth(&self) -> u32 {
        self.depth.unwrap_or(DEFAULT_DEPTH)
    }

    /// The up axis of a file whose own axis is `up`.
    pub(crate) fn up_or(&self, up: Up) -> Up {
        self.mesh_up.unwrap_or(up)
    }

    /// Given flags, by their long names.
    pub(crate) fn given(&self) -> impl Iterator<Item = &'static str> {
        let flags = [
            ("depth", self.depth.is_some()),
            ("crop", self.crop.is_some()),
            ("opacities", self.opacities),
            ("voxel-size", self.voxel_size.is_some()),
            ("mesh-colors", self.mesh_colors != ColorSpace::default()),
        ];
        let given = flags.into_iter().filter(|&(_, is_given)| is_given);
        given.map(|(name, _)| name)
    }
}
