//! Pictures: their buffers move into NumPy arrays, nothing is copied.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::{Element, IntoPyArray, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray};
use pyo3::prelude::*;
use pyo3::types::PyAny;
use shiftvox::{Background, Renderer, Shading};

use crate::camera::Camera;
use crate::scene::Scene;
use crate::settings::{cage, coverage, engine};
use crate::{Error, refused};

#[pyclass(frozen, get_all, module = "shiftvox")]
pub(crate) struct Picture {
    rgba: Py<PyArray3<u8>>,
    depth: Py<PyArray2<f32>>,
    normals: Py<PyArray3<f32>>,
    voxels: Py<PyArray3<i32>>,
    nodes: Py<PyArray2<i32>>,
    counters: BTreeMap<&'static str, u64>,
    hash: String,
}

/// Pixels and their entries as an array that owns them.
fn grid<T: Element, const N: usize>(
    py: Python<'_>,
    pixels: Vec<[T; N]>,
    [height, width]: [usize; 2],
) -> PyResult<Py<PyArray3<T>>> {
    let flat = pixels.into_flattened().into_pyarray(py);
    Ok(flat.reshape([height, width, N])?.unbind())
}

#[pymethods]
impl Picture {
    #[getter]
    fn width(&self, py: Python<'_>) -> usize {
        self.depth.bind(py).dims()[1]
    }

    #[getter]
    fn height(&self, py: Python<'_>) -> usize {
        self.depth.bind(py).dims()[0]
    }

    fn save_png(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let rgba: PyReadonlyArray<'_, u8, _> =
            self.rgba.bind(py).try_readonly().map_err(refused)?;
        let pixels = rgba
            .as_slice()
            .map_err(refused)?
            .as_chunks::<4>()
            .0
            .to_vec();
        let (width, height) = (self.width(py) as u32, self.height(py) as u32);
        let pixels = shiftvox::picture::png::Pixels::new(width, height, pixels);
        let write = || {
            shiftvox::whole::write_with(&path, true, |file| {
                pixels.write(file).map_err(std::io::Error::other)
            })
        };
        py.detach(write).map_err(refused)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!(
            "<shiftvox.Picture of {} x {} pixels>",
            self.width(py),
            self.height(py)
        )
    }
}

/// Pixels across and down: one number for a square.
fn size_of(size: &Bound<'_, PyAny>) -> PyResult<(u32, u32)> {
    if let Ok(side) = size.extract::<u32>() {
        return Ok((side, side));
    }
    size.extract::<(u32, u32)>()
        .map_err(|_| Error::new_err("size: one number, or (width, height), in pixels"))
}

#[pyfunction]
#[pyo3(signature = (scene, camera=None, size=None, *, samples=1, engine="fast", coverage="exact", lod=None,
    tolerance=None, cage="frame", bits=64, frac=None, paper=false, shaded=true, background=None, transparent=false,
    threads=0))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn render(
    py: Python<'_>,
    scene: &Scene,
    camera: Option<&Camera>,
    size: Option<&Bound<'_, PyAny>>,
    samples: u32,
    engine: &str,
    coverage: &str,
    lod: Option<f64>,
    tolerance: Option<f64>,
    cage: &str,
    bits: u32,
    frac: Option<u32>,
    paper: bool,
    shaded: bool,
    background: Option<[u8; 3]>,
    transparent: bool,
    threads: usize,
) -> PyResult<Picture> {
    let (width, height) = size.map_or(Ok((512, 512)), size_of)?;
    let mut renderer = Renderer::new()
        .engine(self::engine(engine)?)
        .coverage(self::coverage(coverage)?)
        .cage(self::cage(cage)?)
        .samples(samples)
        .word(bits, frac)
        .threads(threads);
    if paper {
        renderer = renderer.paper();
    }
    if let Some(pixels) = lod {
        renderer = renderer.level_of_detail(pixels);
    }
    if let Some(pixels) = tolerance {
        renderer = renderer.tolerance(pixels);
    }
    if !shaded {
        renderer = renderer.shading(Shading::Flat);
    }
    if let Some(color) = background {
        renderer = renderer.background(Background::Color(color));
    }
    if transparent {
        renderer = renderer.background(Background::None);
    }
    let camera = camera.map_or_else(|| shiftvox::Camera::fit(&scene.scene), |c| c.camera.clone());
    let drawn = py.detach(|| {
        let picture = renderer.render(&scene.scene, &camera, width, height)?;
        Ok::<_, shiftvox::Error>((picture.hash(), picture))
    });
    let (hash, picture) = drawn.map_err(refused)?;
    let counters = picture.counters().iter().copied().collect();
    let buffers = picture.into_buffers();
    let shape = [buffers.height as usize, buffers.width as usize];
    Ok(Picture {
        rgba: grid(py, buffers.rgba, shape)?,
        depth: buffers.depth.into_pyarray(py).reshape(shape)?.unbind(),
        normals: grid(py, buffers.normal, shape)?,
        voxels: grid(py, buffers.voxel, shape)?,
        nodes: buffers.node.into_pyarray(py).reshape(shape)?.unbind(),
        counters,
        hash,
    })
}
