//! Settings for opening scenes.

use std::path::Path;

use shiftvox::graph::Silent;
use shiftvox::scene::{self, OpenError, Opened, SceneFile, Source};
use shiftvox::{Error, Scene, Up, start_threads};

use crate::open::{OpenOptions, open_bytes};

/// Opens scenes with other settings than the defaults.
///
/// ```
/// use shiftvox::{Camera, Coverage, Renderer};
/// use shiftvox_mesh::SceneOptions;
///
/// # std::env::set_current_dir("../..").unwrap();
/// // 2^6 voxels along the longest side, with opacities for pictures that blend.
/// let scene = SceneOptions::new().mesh_depth(6).opacities(true).open("assets/wires.obj")?;
/// assert_eq!(scene.depth(), 6);
/// let renderer = Renderer::new().coverage(Coverage::Alpha);
/// let picture = renderer.render(&scene, &Camera::fit(&scene), 64, 64)?;
/// # assert!(picture.rgba().iter().any(|pixel| pixel[3] != 0));
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct SceneOptions {
    options: OpenOptions,
    up: Option<Up>,
}

impl SceneOptions {
    /// The defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// The depth of a voxelised mesh, 1 to 20, by default 9. Its longest side has at most `2^depth` voxels.
    #[must_use]
    pub fn mesh_depth(mut self, depth: u32) -> Self {
        self.options.mesh.depth = depth;
        self
    }

    /// Whether voxels of meshes get opacities for [`Coverage::Alpha`](shiftvox::Coverage::Alpha); no by default.
    #[must_use]
    pub fn opacities(mut self, opacities: bool) -> Self {
        self.options.mesh.opacities = opacities;
        self
    }

    /// The side of a voxel of a cloud of points, in units of the file, above 0. Without it, coordinates are indices.
    #[must_use]
    pub fn voxel_size(mut self, size: f64) -> Self {
        self.options.voxels.read.voxel_size = Some(size);
        self
    }

    /// The axis that points up, by default that of the file's format.
    #[must_use]
    pub fn up(mut self, up: Up) -> Self {
        self.up = Some(up);
        self
    }

    /// Opens a file: [`Scene::open`].
    ///
    /// # Errors
    /// As [`Scene::open`], and where a setting is out of its range.
    pub fn open(&self, path: impl AsRef<Path>) -> Result<Scene, Error> {
        start_threads()?;
        let OpenOptions { voxels, mesh } = &self.options;
        let opened = SceneFile::open(path.as_ref())
            .map_err(OpenError::from)
            .and_then(|file| scene::open_source(Source::File(file), voxels, mesh, &Silent));
        self.placed(opened)
    }

    /// Opens a file in memory: [`Scene::from_bytes`].
    ///
    /// # Errors
    /// As [`SceneOptions::open`].
    pub fn from_bytes(&self, bytes: &[u8], name: &str) -> Result<Scene, Error> {
        start_threads()?;
        self.placed(open_bytes(bytes, name, &self.options, &Silent))
    }

    fn placed(&self, opened: Result<Opened, OpenError>) -> Result<Scene, Error> {
        let scene = Scene::from(opened.map_err(|e| Error::Open(e.into()))?);
        Ok(match self.up {
            Some(up) => scene.with_up(up),
            None => scene,
        })
    }
}
