//! Scenes.

use std::path::PathBuf;

use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use shiftvox::{SceneOptions, Up, Voxel};

use crate::{Error, refused};

#[pyclass(frozen, module = "shiftvox")]
pub(crate) struct Scene {
    pub(crate) scene: shiftvox::Scene,
}

fn options(depth: u32, opacities: bool, up: Option<&str>) -> PyResult<SceneOptions> {
    let options = SceneOptions::new().mesh_depth(depth).opacities(opacities);
    Ok(match up {
        None => options,
        Some("y") => options.up(Up::Y),
        Some("z") => options.up(Up::Z),
        Some(other) => return Err(Error::new_err(format!("up: {other:?} is none of y, z"))),
    })
}

/// Rows of an array that must have three columns.
fn rows_of_three<T: Copy + numpy::Element>(
    what: &str,
    array: &PyReadonlyArray2<'_, T>,
) -> PyResult<Vec<[T; 3]>> {
    let [_, 3] = array.shape() else {
        let told = format!("{what}: the shape is {:?}, not (N, 3)", array.shape());
        return Err(Error::new_err(told));
    };
    let rows = array.as_array();
    let rows = rows.rows();
    Ok(rows
        .into_iter()
        .map(|row| [row[0], row[1], row[2]])
        .collect())
}

/// A colour for each of `rows`, or grey.
fn colors_of(colors: Option<&PyReadonlyArray2<'_, u8>>, rows: usize) -> PyResult<Vec<[u8; 3]>> {
    let Some(colors) = colors else {
        return Ok(vec![[200; 3]; rows]);
    };
    let colors = rows_of_three("colors", colors)?;
    match colors.len() == rows {
        true => Ok(colors),
        false => {
            let told = format!("colors: {} rows for {rows}", colors.len());
            Err(Error::new_err(told))
        }
    }
}

/// A binary PLY file of a mesh, which the library reads.
fn ply(positions: &[[f64; 3]], colors: &[[u8; 3]], triangles: &[[i64; 3]]) -> PyResult<Vec<u8>> {
    let properties = [
        "double x",
        "double y",
        "double z",
        "uchar red",
        "uchar green",
        "uchar blue",
    ];
    let properties: String = properties.map(|p| format!("property {p}\n")).concat();
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n{properties}element face {}\n\
         property list uchar uint vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    for (position, color) in positions.iter().zip(colors) {
        bytes.extend(position.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(color);
    }
    for (number, triangle) in triangles.iter().enumerate() {
        bytes.push(3);
        for &corner in triangle {
            let is_there = usize::try_from(corner).is_ok_and(|c| c < positions.len());
            let corner = u32::try_from(corner).ok().filter(|_| is_there);
            let corner = corner.ok_or_else(|| {
                Error::new_err(format!(
                    "triangles: row {number} has a corner that is no row of positions"
                ))
            })?;
            bytes.extend(corner.to_le_bytes());
        }
    }
    Ok(bytes)
}

#[pymethods]
impl Scene {
    #[staticmethod]
    #[pyo3(signature = (path, *, depth=9, opacities=false, up=None))]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        depth: u32,
        opacities: bool,
        up: Option<&str>,
    ) -> PyResult<Self> {
        let options = options(depth, opacities, up)?;
        let scene = py.detach(|| options.open(path)).map_err(refused)?;
        Ok(Self { scene })
    }

    #[staticmethod]
    fn generate(py: Python<'_>, specification: &str) -> PyResult<Self> {
        let scene = py
            .detach(|| shiftvox::Scene::generate(specification))
            .map_err(refused)?;
        Ok(Self { scene })
    }

    #[staticmethod]
    #[pyo3(signature = (indices, colors=None, *, up="z"))]
    fn from_numpy(
        py: Python<'_>,
        indices: PyReadonlyArray2<'_, i32>,
        colors: Option<PyReadonlyArray2<'_, u8>>,
        up: &str,
    ) -> PyResult<Self> {
        let indices = rows_of_three("indices", &indices)?;
        let colors = colors_of(colors.as_ref(), indices.len())?;
        let up = match up {
            "y" => Up::Y,
            "z" => Up::Z,
            other => return Err(Error::new_err(format!("up: {other:?} is none of y, z"))),
        };
        let voxels = indices.into_iter().zip(colors);
        let voxels = voxels.map(|(index, color)| Voxel {
            index,
            color,
            normal: None,
        });
        let scene = py
            .detach(|| shiftvox::Scene::from_voxels(voxels))
            .map_err(refused)?;
        Ok(Self {
            scene: scene.with_up(up),
        })
    }

    #[staticmethod]
    #[pyo3(signature = (positions, triangles, colors=None, *, depth=9, opacities=false, up=None))]
    fn from_mesh(
        py: Python<'_>,
        positions: PyReadonlyArray2<'_, f64>,
        triangles: PyReadonlyArray2<'_, i64>,
        colors: Option<PyReadonlyArray2<'_, u8>>,
        depth: u32,
        opacities: bool,
        up: Option<&str>,
    ) -> PyResult<Self> {
        let positions = rows_of_three("positions", &positions)?;
        let triangles = rows_of_three("triangles", &triangles)?;
        let colors = colors_of(colors.as_ref(), positions.len())?;
        let options = options(depth, opacities, up)?;
        let bytes = ply(&positions, &colors, &triangles)?;
        let scene = py
            .detach(|| options.from_bytes(&bytes, "the mesh"))
            .map_err(refused)?;
        Ok(Self { scene })
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.scene.save_vxg(path)).map_err(refused)
    }

    #[getter]
    fn voxels(&self) -> u64 {
        self.scene.voxels()
    }

    #[getter]
    fn depth(&self) -> u32 {
        self.scene.depth()
    }

    #[getter]
    fn bytes(&self) -> u64 {
        self.scene.bytes()
    }

    #[getter]
    fn bounds(&self) -> [[f64; 3]; 2] {
        self.scene.bounds()
    }

    fn __repr__(&self) -> String {
        format!(
            "<shiftvox.Scene of {} voxels, {} levels>",
            self.voxels(),
            self.depth()
        )
    }
}
