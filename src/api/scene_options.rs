//! How scenes are opened, where the defaults are not meant.

use std::path::Path;

use super::scene::{open_memory, open_path};
use super::{Error, Scene, Up};
use crate::scene::OpenOptions;

/// Opens scenes with other settings than the defaults.
///
/// ```
/// # #[cfg(feature = "mesh")] {
/// use shiftvox::{Coverage, Camera, Renderer, SceneOptions};
///
/// // 2^6 voxels along the longest side, with opacities for pictures that blend.
/// let scene = SceneOptions::new().mesh_depth(6).opacities(true).open("assets/wires.obj")?;
/// assert_eq!(scene.depth(), 6);
/// let renderer = Renderer::new().coverage(Coverage::Alpha);
/// let picture = renderer.render(&scene, &Camera::fit(&scene), 64, 64)?;
/// # assert!(picture.rgba().iter().any(|pixel| pixel[3] != 0));
/// # }
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct SceneOptions {
    options: OpenOptions,
    up: Option<Up>,
}

impl SceneOptions {
    /// The defaults, which are those of [`Scene::open`].
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Levels at which meshes are voxelised: at most `2^depth` voxels along the longest side, 1 to 20; 9 by default.
    #[cfg(feature = "mesh")]
    #[must_use]
    pub fn mesh_depth(mut self, depth: u32) -> Self {
        self.options.mesh.depth = depth;
        self
    }

    /// Whether the voxels of meshes get opacities, which [`Coverage::Alpha`](crate::Coverage::Alpha) blends; no by
    /// default.
    #[cfg(feature = "mesh")]
    #[must_use]
    pub fn opacities(mut self, opacities: bool) -> Self {
        self.options.mesh.opacities = opacities;
        self
    }

    /// Which axis is up, whatever the file's format has by custom.
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
        Ok(self.placed(open_path(path.as_ref(), &self.options)?))
    }

    /// Opens a file that is held in memory: [`Scene::from_bytes`].
    ///
    /// # Errors
    /// As [`SceneOptions::open`].
    pub fn from_bytes(&self, bytes: &[u8], name: &str) -> Result<Scene, Error> {
        Ok(self.placed(open_memory(bytes, name, &self.options)?))
    }

    fn placed(&self, scene: Scene) -> Scene {
        match self.up {
            Some(up) => scene.with_up(up),
            None => scene,
        }
    }
}
