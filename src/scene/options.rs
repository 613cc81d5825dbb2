//! What a caller may choose about reading, and what it learns besides the voxels.

/// What to do with `.vox` voxels whose coordinates lie outside their model's `SIZE`.
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
    /// Whether nodes and layers that are hidden in the editor are read too; only `.vox` has them.
    pub hidden: bool,
    /// Which frame of an animated `.vox` scene is read: the last key frame at or before this one.
    pub frame: u32,
    /// Which model, counted from 0, is read from a `.vox` that has several models
    /// but no scene graph; `None` reads all of them, each at its own coordinates.
    pub model: Option<u32>,
    /// sRGB colour of voxels in files without colours.
    pub default_color: [u8; 3],
    /// Most voxels that are handed on, those at one place counted each. More are an error: before the first is
    /// handed on where the file states their number, else as soon as there are more.
    pub most_voxels: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            oob: OutOfBounds::default(),
            hidden: false,
            frame: 0,
            model: None,
            default_color: [200; 3],
            most_voxels: u64::MAX,
        }
    }
}

/// What a file turned out to hold.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SceneInfo {
    /// Voxels that were handed on. Voxels that several models place at the
    /// same index are counted, and handed on, each time: the last one counts.
    /// A model that is placed where it is already is handed on once.
    pub voxels: u64,
    /// Voxels stored in the file: each model counted once, however often it is placed.
    pub stored_voxels: u64,
    /// Lowest and highest index handed on, both inclusive; `None` where there is no voxel.
    pub bounds: Option<([i32; 3], [i32; 3])>,
    /// Models in the file; 1 for a cloud.
    pub models: u32,
    /// Scene graph nodes in the file.
    pub nodes: u32,
    /// Placements of models that were read, or left out because the model is at that place already.
    pub instances: u32,
    /// Placements of models that were left out because they are hidden.
    pub hidden_instances: u32,
    /// Stored voxels outside their model's `SIZE`.
    pub outside_size: u64,
    /// The palette, RGBA, of colour indices 1, 2, ...; empty where the file has none of its own.
    pub palette: Vec<[u8; 4]>,
    /// Whether the voxels have colours of their own.
    pub has_colors: bool,
    /// Whether the voxels have normals.
    pub has_normals: bool,
    /// Warnings about a file that could be read, one sentence each.
    pub warnings: Vec<String>,
}
