//! Options of reading a voxel file, and the properties of a file that was read.

#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Side of a voxel, in units of the file, above 0: for clouds of points. Without it, their coordinates are indices.
    pub voxel_size: Option<f64>,
    /// Most voxels, with those at one index counted each. More are an error.
    pub most_voxels: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            voxel_size: None,
            most_voxels: u64::MAX,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneInfo {
    /// Voxels passed on; several at one index count each, a model with several equal placements once.
    pub voxels: u64,
    pub stored_voxels: u64,
    pub bounds: Option<([i32; 3], [i32; 3])>,
    pub models: u32,
    pub nodes: u32,
    /// Placements of models, including those that repeat another one.
    pub instances: u32,
    pub hidden_instances: u32,
    pub outside_size: u64,
    /// RGBA of colour indices 1, 2, ...; empty if the file has none.
    pub palette: Vec<[u8; 4]>,
    pub has_colors: bool,
    pub has_normals: bool,
    /// Of a cloud of points, if one was asked for.
    pub voxel_size: Option<f64>,
    /// Warnings about a file that could be read, one sentence each.
    pub warnings: Vec<String>,
}
