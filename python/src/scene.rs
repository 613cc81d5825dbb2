//! Scenes.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyAny, PyBytes};
use shiftvox::Voxel;
use shiftvox::graph::{BuildError, vxg::write_to};
use shiftvox::picture::npy::Values;
use shiftvox_mesh::SceneOptions;

use crate::arguments::{AXES, count, one_of, rows_of_three, whole};
use crate::picture::array;
use crate::ply::ply;
use crate::pool::on_all_threads;
use crate::{Error, refused};

/// A graph of voxels. World units are those of the file. A voxel of index i fills [i, i + 1) along each axis, unless
/// the file sets another size and place. A pickle has the whole graph: for large scenes pass the name of a file instead.
#[pyclass(frozen, module = "shiftvox")]
pub(crate) struct Scene {
    pub(crate) scene: Arc<shiftvox::Scene>,
}

/// Ends of a range, or none.
type Ends = (Option<i64>, Option<i64>);

/// A pickle: a function and its arguments.
type Reduced = (Py<PyAny>, (Py<PyBytes>, bool));

fn options(depth: i64, opacities: bool, axis: Option<&str>) -> PyResult<SceneOptions> {
    let depth = count("depth", depth)?;
    let options = SceneOptions::new().mesh_depth(depth).opacities(opacities);
    Ok(match axis {
        None => options,
        Some(axis) => options.up(one_of("up", axis, &AXES)?),
    })
}

fn colors_of(colors: Option<&Bound<'_, PyAny>>, rows: usize) -> PyResult<Vec<[u8; 3]>> {
    let Some(colors) = colors else {
        return Ok(vec![[200; 3]; rows]);
    };
    let colors = rows_of_three("colors", colors)?;
    if colors.len() != rows {
        let told = format!("colors: {} rows for {rows}", colors.len());
        return Err(Error::new_err(told));
    }
    Ok(colors)
}

/// Indices and colours of a grid's voxels; other arrays as they are.
fn entries_of_grid<'py>(
    grid: &Bound<'py, PyAny>,
    colors: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Option<Bound<'py, PyAny>>)> {
    let numpy = grid.py().import("numpy")?;
    let grid = numpy.call_method1("asarray", (grid,))?;
    if grid.getattr("ndim")?.extract::<usize>()? != 3 {
        return Ok((grid, colors.cloned()));
    }
    let colors = colors.map(|colors| {
        let colors = numpy.call_method1("asarray", (colors,))?;
        let [of_grid, of_colors] = [&grid, &colors].map(|array| {
            let shape = array.getattr("shape")?;
            shape.extract::<Vec<usize>>()
        });
        let (shape, found) = (of_grid?, of_colors?);
        if found.split_last() != Some((&3, &shape)) {
            let told =
                format!("colors: the shape is {found:?}, not that of the grid {shape:?} and 3");
            return Err(Error::new_err(told));
        }
        colors.get_item(grid.call_method1("__ne__", (0,))?)
    });
    let indices = numpy.call_method1("argwhere", (&grid,))?;
    Ok((indices, colors.transpose()?))
}

fn made(
    py: Python<'_>,
    make: impl FnOnce() -> Result<shiftvox::Scene, shiftvox::Error> + Send + 'static,
) -> PyResult<Scene> {
    let scene = on_all_threads(py, |_| make())?.map_err(refused)?;
    Ok(Scene {
        scene: Arc::new(scene),
    })
}

#[pymethods]
impl Scene {
    /// Open a voxel file, a voxel graph or a mesh; spec/input.md and spec/mesh.md list the formats. A mesh is
    /// voxelised with 2**depth voxels along its longest side, depth 1 to 20. `opacities`: for `coverage="alpha"`.
    /// `up`: the up axis, by default the format's. `verify`: check also a .vxg file of more than 1 MiB in full.
    /// `voxel_size`: the side of a voxel, for clouds of points with any coordinates.
    ///
    /// Raises `Error` for a file that is missing, damaged, unknown or too large.
    #[staticmethod]
    #[pyo3(signature = (path, *, depth=9, opacities=false, up=None, verify=false, voxel_size=None))]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        #[pyo3(from_py_with = whole)] depth: i64,
        opacities: bool,
        up: Option<&str>,
        verify: bool,
        voxel_size: Option<f64>,
    ) -> PyResult<Self> {
        let mut options = options(depth, opacities, up)?;
        if let Some(side) = voxel_size {
            options = options.voxel_size(side);
        }
        made(py, move || {
            let mut scene = options.open(path)?;
            if verify && !scene.is_verified() {
                scene.verify()?;
            }
            Ok(scene)
        })
    }

    /// A generated scene, such as "terrain,depth=7,seed=1"; spec/generators.md lists them.
    ///
    /// Raises `Error` for an unknown generator or a wrong parameter.
    #[staticmethod]
    fn generate(py: Python<'_>, specification: &str) -> PyResult<Self> {
        let specification = specification.to_owned();
        made(py, move || shiftvox::Scene::generate(&specification))
    }

    /// A scene of voxels. Indices (N, 3) are 32-bit integers, and colours (N, 3) are integers 0 to 255 in sRGB, by
    /// default grey. Of rows with the same index the last counts. Or a grid (X, Y, Z), whose entries other than 0 (False)
    /// are voxels, with colours (X, Y, Z, 3) for all its entries.
    ///
    /// Raises `Error` for other shapes and numbers, for no voxels, and for voxels more than 2**21 apart.
    #[staticmethod]
    #[pyo3(signature = (indices, colors=None, *, up="z"))]
    fn from_numpy(
        py: Python<'_>,
        indices: &Bound<'_, PyAny>,
        colors: Option<&Bound<'_, PyAny>>,
        up: &str,
    ) -> PyResult<Self> {
        let (indices, colors) = entries_of_grid(indices, colors)?;
        let indices = rows_of_three("indices", &indices)?;
        let colors = colors_of(colors.as_ref(), indices.len())?;
        let up = one_of("up", up, &AXES)?;
        let voxels = indices.into_iter().zip(colors);
        let voxels = voxels.map(|(index, color)| Voxel {
            index,
            color,
            normal: None,
        });
        made(py, move || {
            Ok(shiftvox::Scene::from_voxels(voxels)?.with_up(up))
        })
    }

    /// A mesh, voxelised as by `open`. Positions (V, 3) are any numbers, triangles (T, 3) rows of positions, and
    /// colours (V, 3) integers 0 to 255 in sRGB, by default grey.
    ///
    /// Raises `Error` for other shapes and numbers, for no triangles, and for a corner that is not a row of positions.
    #[staticmethod]
    #[pyo3(signature = (positions, triangles, colors=None, *, depth=9, opacities=false, up=None))]
    fn from_mesh(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        colors: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = whole)] depth: i64,
        opacities: bool,
        up: Option<&str>,
    ) -> PyResult<Self> {
        let positions = rows_of_three("positions", positions)?;
        let triangles = rows_of_three("triangles", triangles)?;
        let colors = colors_of(colors, positions.len())?;
        let options = options(depth, opacities, up)?;
        let bytes = ply(&positions, &colors, &triangles)?;
        made(py, move || options.from_bytes(&bytes, "the mesh"))
    }

    /// The voxels whose indices in the file lie within ranges (from, to) along the axes, without `to`: `z=(None, 69)`.
    ///
    /// Raises `Error` if no voxel is left, and for a scene of more than 2**28 voxels.
    #[pyo3(signature = (*, x=None, y=None, z=None))]
    fn crop(
        &self,
        py: Python<'_>,
        x: Option<Ends>,
        y: Option<Ends>,
        z: Option<Ends>,
    ) -> PyResult<Self> {
        let ranges = [x, y, z].map(|ends| {
            let (from, to) = ends.unwrap_or_default();
            from.unwrap_or(i64::MIN)..to.unwrap_or(i64::MAX)
        });
        let scene = Arc::clone(&self.scene);
        made(py, move || scene.cropped(ranges))
    }

    /// Write a .vxg file, replacing an existing one. Raises `Error` if the system refuses.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let scene = Arc::clone(&self.scene);
        on_all_threads(py, move |_| scene.save_vxg(path))?.map_err(refused)
    }

    /// Indices int32 (N, 3) and colours uint8 (N, 3) of the finest voxels, as `from_numpy` takes them.
    ///
    /// Raises `Error` for more than 2**28 voxels.
    fn to_numpy(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        let scene = Arc::clone(&self.scene);
        let (indices, colors) = on_all_threads(py, move |stop| {
            let voxels = scene.graph().finest_voxels()?;
            let voxels = voxels.take_while(|_| !stop.is_requested());
            let rows = voxels.map(|voxel| (voxel.index, voxel.color));
            Ok(rows.collect::<(Vec<_>, Vec<_>)>())
        })?
        .map_err(|error: BuildError| refused(error))?;
        let shape = [indices.len(), 3];
        Ok((
            array(py, Values::I32(indices.into_flattened()), &shape)?,
            array(py, Values::U8(colors.into_flattened()), &shape)?,
        ))
    }

    fn __reduce__(&self, py: Python<'_>) -> PyResult<Reduced> {
        let scene = Arc::clone(&self.scene);
        let bytes = on_all_threads(py, move |_| {
            let mut bytes = Vec::new();
            write_to(scene.graph(), &mut bytes).map(|()| bytes)
        })?;
        let bytes = bytes.map_err(refused)?;
        let unpickle = py.get_type::<Self>().getattr("_unpickle")?.unbind();
        let is_y_up = self.scene.up() == shiftvox::Up::Y;
        Ok((unpickle, (PyBytes::new(py, &bytes).unbind(), is_y_up)))
    }

    #[staticmethod]
    fn _unpickle(py: Python<'_>, bytes: Vec<u8>, is_y_up: bool) -> PyResult<Self> {
        let up = shiftvox::project::Up::y_or_z(is_y_up);
        made(py, move || {
            Ok(shiftvox::Scene::from_bytes(&bytes, "the pickle")?.with_up(up))
        })
    }

    /// Voxels of the finest level.
    #[getter]
    fn voxels(&self) -> u64 {
        self.scene.voxels()
    }

    /// Levels below the root: the cube around the voxels has 2**depth voxels per side.
    #[getter]
    fn depth(&self) -> u32 {
        self.scene.depth()
    }

    /// Bytes of the graph, in memory or in its mapped file.
    #[getter]
    fn bytes(&self) -> u64 {
        self.scene.bytes()
    }

    /// The lowest and the highest corner of the voxels, world units.
    #[getter]
    fn bounds(&self) -> [[f64; 3]; 2] {
        self.scene.bounds()
    }

    /// Whether the whole file was checked, and not only the header.
    #[getter]
    fn is_verified(&self) -> bool {
        self.scene.is_verified()
    }

    /// Warnings about the opened file, one sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings().to_vec()
    }

    fn __repr__(&self) -> String {
        format!(
            "<shiftvox.Scene of {} voxels, {} levels>",
            self.voxels(),
            self.depth()
        )
    }
}
