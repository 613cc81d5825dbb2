//! A scene: a voxel graph, its place, and its vertical axis.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::Error;
use super::kept::start_threads;
use crate::graph::{Builder, Crop, Graph, Placement, Silent, Voxel, vxg};
use crate::project::Bounds;
pub use crate::project::Up;
use crate::scene::{NoMeshes, OpenOptions, Opened, SceneFile, Source, open_bytes, open_source};

/// A voxel graph in world coordinates, to be drawn.
///
/// World units are those of the file; a voxel of index `(i, j, k)` fills `[i, i+1) x [j, j+1) x [k, k+1)` unless the
/// file gives another size and place.
#[derive(Debug)]
pub struct Scene {
    graph: Graph,
    up: Up,
    warnings: Vec<String>,
    is_verified: bool,
    mapped: Option<PathBuf>,
}

impl Scene {
    /// Opens a voxel file or a voxel graph (`spec/input.md`), recognised by content. Meshes are opened by the crate
    /// `shiftvox-mesh`.
    ///
    /// A `.vxg` file is mapped, and its pages are read while it is drawn. A program that writes to the file meanwhile
    /// changes later pictures, or makes them wrong, but causes no panic. One that cuts it short ends this process by the
    /// signal SIGBUS on Unix, which the program `shiftvox` reports as an error and a library cannot. Replacing the file
    /// by another, as [`Scene::save_vxg`] does, is safe. [`Scene::from_bytes`] of a file that was read does not map it.
    ///
    /// Of a `.vxg` file of more than 1 MiB, only the header is checked and only what is seen is read: see
    /// [`Scene::verify`].
    ///
    /// # Errors
    /// [`Error::Open`] if the file cannot be read, is damaged or of another format, or does not fit in memory.
    /// [`Error::Threads`] if `rayon`'s global threads, which all functions start that make a scene, cannot be started.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        start_threads()?;
        let file = SceneFile::open(path.as_ref()).map_err(|e| Error::Open(e.into()))?;
        let source = Source::File(file);
        let opened = open_source(source, &OpenOptions::default(), &NoMeshes, &Silent);
        Ok(opened.map_err(|e| Error::Open(e.into()))?.into())
    }

    /// [`Scene::open`] of bytes in memory; errors call them `name`.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, Error> {
        start_threads()?;
        let opened = open_bytes(bytes, name, &OpenOptions::default(), &NoMeshes, &Silent);
        Ok(opened.map_err(|e| Error::Open(e.into()))?.into())
    }

    /// Generates a scene, such as `terrain,depth=9,seed=1` (`spec/generators.md`).
    ///
    /// # Errors
    /// [`Error::Open`] for a wrong specification, [`Error::Threads`] as in [`Scene::open`].
    pub fn generate(specification: &str) -> Result<Self, Error> {
        start_threads()?;
        let text = format!("{}{specification}", crate::scene::generate::PREFIX);
        let source = Source::Generated(text);
        let opened = open_source(source, &OpenOptions::default(), &NoMeshes, &Silent);
        Ok(opened.map_err(|e| Error::Open(e.into()))?.into())
    }

    /// Builds a scene of voxels in any order, Z up. Of voxels with the same index the last one is kept.
    ///
    /// # Errors
    /// [`Error::Build`] for no voxel, for a span of more than 2^21 along an axis, for 2^32 voxels or nodes, and for too
    /// little memory; [`Error::Threads`] as in [`Scene::open`].
    pub fn from_voxels(voxels: impl IntoIterator<Item = Voxel>) -> Result<Self, Error> {
        start_threads()?;
        let mut builder = Builder::default();
        for voxel in voxels {
            builder.push(voxel);
        }
        let place = Placement::default();
        let graph = builder.finish((place.world_origin, place.voxel_size), &Silent);
        Ok(graph.map_err(|e| Error::Build(e.into()))?.into())
    }

    /// The voxels whose indices in the file lie within ranges along x, y and z, in the same place, to look inside. They
    /// have no opacities, and those that the ranges lay open have normals of their own.
    ///
    /// ```
    /// use shiftvox::Scene;
    ///
    /// let sponge = Scene::generate("menger,depth=2")?;
    /// let below = sponge.cropped([i64::MIN..i64::MAX, i64::MIN..i64::MAX, 0..4])?;
    /// assert!(below.voxels() < sponge.voxels());
    /// # Ok::<(), shiftvox::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Build`] if no voxel is left, for a scene of more than 2^28 voxels, and as [`Scene::from_voxels`].
    pub fn cropped(&self, ranges: [Range<i64>; 3]) -> Result<Self, Error> {
        let part = self.graph.cropped(&Crop(ranges), &Silent);
        let part: Self = part.map_err(|e| Error::Build(e.into()))?.into();
        Ok(part.with_up(self.up))
    }

    /// With another axis up, for [`Camera::fit`](super::Camera::fit).
    #[must_use]
    pub fn with_up(mut self, up: Up) -> Self {
        self.up = up;
        if let Some(mesh) = &mut self.graph.placement.mesh {
            mesh.y_up = up == Up::Y;
        }
        self
    }

    /// Voxels of the finest level, counted with repetition in graphs that share parts.
    #[must_use]
    pub fn voxels(&self) -> u64 {
        self.graph.voxels
    }

    /// Levels below the root: the object's cube has `2^depth` finest voxels a side.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.graph.depth
    }

    /// Bytes of the graph, in memory or in the mapped file.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.graph.bytes()
    }

    /// Lowest and highest corner of the box around all voxels, world units.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let bounds = Bounds::of_voxels(&self.graph);
        [bounds.low.to_array(), bounds.high.to_array()]
    }

    /// Writes a `.vxg` file, which opens without being built, or replaces one; whole or not at all.
    ///
    /// # Errors
    /// [`Error::Write`] where the system refuses.
    pub fn save_vxg(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        vxg::write(&self.graph, path.as_ref(), true).map_err(|e| Error::Write(e.into()))
    }

    /// The vertical axis: Z for voxels, Y for most meshes, or that of [`Scene::with_up`].
    #[must_use]
    pub fn up(&self) -> Up {
        self.up
    }

    /// Warnings about the opened file, one sentence each.
    ///
    /// ```
    /// use shiftvox::Scene;
    ///
    /// let mut bytes = std::fs::read("assets/tree.vox").unwrap();
    /// bytes.extend(*b"more");
    /// let scene = Scene::from_bytes(&bytes, "tree.vox")?;
    /// assert_eq!(scene.warnings(), ["4 bytes after the end of the file's main chunk were not read"]);
    /// assert!(scene.is_verified());
    /// # Ok::<(), shiftvox::Error>(())
    /// ```
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Whether the whole file was checked, and not only the header, as of a `.vxg` file of more than 1 MiB until
    /// [`Scene::verify`].
    #[must_use]
    pub fn is_verified(&self) -> bool {
        self.is_verified
    }

    /// Checks all of a mapped `.vxg` file: checksums, padding and every index. This reads the whole file. Scenes of other
    /// files were checked when they were opened. After an error, [`Scene::is_verified`] is false.
    ///
    /// ```
    /// # use shiftvox::Scene;
    /// # let folder = tempfile::tempdir().unwrap();
    /// # let path = folder.path().join("large.vxg");
    /// # Scene::generate("menger,depth=2")?.save_vxg(&path)?;
    /// let mut scene = Scene::open(&path)?;
    /// if !scene.is_verified() {
    ///     scene.verify()?;
    /// }
    /// # scene.verify()?;
    /// # Ok::<(), shiftvox::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Open`] with the damaged section.
    pub fn verify(&mut self) -> Result<(), Error> {
        let Some(path) = &self.mapped else {
            return Ok(());
        };
        self.is_verified = false;
        let verified = vxg::verify_mapped(&self.graph, path);
        self.graph = verified.map_err(|e| Error::Open(e.into()))?;
        // As in `with_up`.
        if let Some(mesh) = &mut self.graph.placement.mesh {
            mesh.y_up = self.up == Up::Y;
        }
        self.is_verified = true;
        Ok(())
    }

    /// The graph.
    #[doc(hidden)]
    #[must_use]
    pub fn graph(&self) -> &Graph {
        &self.graph
    }
}

impl From<Opened> for Scene {
    fn from(opened: Opened) -> Self {
        Self {
            warnings: opened.info.warnings,
            is_verified: opened.is_verified,
            mapped: opened.mapped,
            ..opened.graph.into()
        }
    }
}

impl From<Graph> for Scene {
    /// It counts as verified.
    fn from(graph: Graph) -> Self {
        Self {
            up: Up::of(&graph),
            graph,
            warnings: Vec::new(),
            is_verified: true,
            mapped: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_any_name_are_opened_as_files() {
        let folder = tempfile::tempdir().expect("a folder");
        let bytes = std::fs::read("tests/data/axes.vox").expect("a scene");
        let mut names = vec![std::ffi::OsString::from("gen:menger")];
        #[cfg(target_os = "linux")]
        names.push(std::os::unix::ffi::OsStringExt::from_vec(
            b"tree\xff.vox".to_vec(),
        ));
        for name in names {
            let path = folder.path().join(name);
            std::fs::write(&path, &bytes).expect("a file");
            let scene = Scene::open(&path).expect("a scene");
            assert!(scene.voxels() > 0);
        }
        // Never a generator's scene.
        let missing = Scene::open("gen:menger,depth=2").expect_err("there is no such file");
        assert!(matches!(missing, Error::Open(_)), "{missing}");
        assert!(Scene::generate("menger,depth=2").is_ok());
    }

    #[test]
    fn a_mapped_file_is_verified_on_request_and_its_damage_is_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("menger.vxg");
        let made = Scene::generate("menger,depth=2").expect("a scene");
        made.save_vxg(&path).expect("written");
        let mut bytes = std::fs::read(&path).expect("bytes");
        let options = OpenOptions {
            verify_up_to: bytes.len() as u64 - 1,
            ..OpenOptions::default()
        };
        let source = Source::find(&path).expect("a file");
        let opened = open_source(source, &options, &NoMeshes, &Silent).expect("a graph");
        let mut scene = Scene::from(opened).with_up(Up::Y);
        assert!(!scene.is_verified() && scene.graph.voxels == made.graph.voxels);
        scene.verify().expect("sound");
        assert!(scene.is_verified() && scene.up() == Up::Y);
        if cfg!(target_endian = "big") {
            // The scene is not mapped, but a copy in the order of the processor, which was checked.
            return;
        }
        // Another program changes the last byte of a section, in place, and then the header.
        for (at, section) in [(bytes.len() - 1, "section NRML"), (30, "header")] {
            bytes[at] ^= 1;
            let file = std::fs::File::options().write(true).open(&path);
            let written = std::io::Write::write_all(&mut file.expect("a file"), &bytes);
            written.expect("written in place");
            let found = scene.verify().expect_err("damaged").to_string();
            assert!(
                found.contains(section) && found.contains("menger.vxg"),
                "{found}"
            );
            assert!(!scene.is_verified());
        }
        assert!(made.is_verified());
    }
}
