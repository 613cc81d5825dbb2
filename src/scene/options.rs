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
    /// RGBA of colour indices 1, 2, ...; empty if the file has none.
    pub palette: Vec<[u8; 4]>,
    /// Of a cloud of points, if one was asked for.
    pub voxel_size: Option<f64>,
    /// Warnings about a file that could be read, one sentence each.
    pub warnings: Vec<String>,
}
