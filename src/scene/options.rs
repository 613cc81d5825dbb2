//! Options of reading a voxel file, and the properties of a file that was read.

/// The treatment of `.vox` voxels whose coordinates lie outside their model's `SIZE`.
///
/// VoxelShop writes such files when asked to fit the model to its bounding box:
/// coordinates left of the box, or far right of it, end up in one byte modulo 256.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum OutOfBounds {
    /// Take the coordinate modulo 256 that is nearest to the middle of SIZE.
    #[default]
    Wrap,
    /// Take the byte as it stands.
    Keep,
    /// Leave such voxels out.
    ///
    /// As MagicaVoxel does.
    Drop,
    /// Refuse the file.
    Error,
}

/// How to read a scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadOptions {
    /// Voxels outside `SIZE`; only `.vox` has them.
    pub oob: OutOfBounds,
    /// Most voxels, with those at one index counted each. More are an error, before the first voxel is passed on if
    /// the file states their number.
    pub most_voxels: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            oob: OutOfBounds::default(),
            most_voxels: u64::MAX,
        }
    }
}

/// Properties of a file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SceneInfo {
    /// Voxels that were passed on. Several at one index are counted each, and the last one is drawn.
    /// A model with several equal placements is passed on once.
    pub voxels: u64,
    /// Voxels stored in the file: each model counted once, however often it is placed.
    pub stored_voxels: u64,
    /// Lowest and highest index, both inclusive; `None` without voxels.
    pub bounds: Option<([i32; 3], [i32; 3])>,
    /// Models in the file; 1 for a cloud.
    pub models: u32,
    /// Scene graph nodes in the file.
    pub nodes: u32,
    /// Placements of models, including those that repeat another one.
    pub instances: u32,
    /// Placements of models that were skipped because they are hidden.
    pub hidden_instances: u32,
    /// Stored voxels outside their model's `SIZE`.
    pub outside_size: u64,
    /// The file's palette, RGBA, of colour indices 1, 2, ...; empty if it has none.
    pub palette: Vec<[u8; 4]>,
    /// Whether the voxels have colours of their own.
    pub has_colors: bool,
    /// Whether the voxels have normals.
    pub has_normals: bool,
    /// Warnings about a file that could be read, one sentence each.
    pub warnings: Vec<String>,
}
