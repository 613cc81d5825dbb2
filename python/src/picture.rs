//! Pictures, whose buffers move into NumPy arrays without copies.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{Element, IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyBytes};
use shiftvox::picture::npy::Values;
use shiftvox::picture::png::Pixels;
use shiftvox::{Background, Buffer, Renderer, Shading};

use crate::arguments::{self, CAGES, ENGINES, color, count, one_of, whole};
use crate::camera::{Camera, Kind};
use crate::pool::on_all_threads;
use crate::scene::Scene;
use crate::{Error, refused};

/// A finished picture. The arrays are its buffers, without copies; each access returns the same array. Cannot be
/// pickled; its arrays can.
#[pyclass(frozen, get_all, module = "shiftvox")]
pub(crate) struct Picture {
    /// uint8 (height, width, 4): red, green, blue in sRGB, and alpha, not premultiplied.
    rgba: Py<PyAny>,
    /// float32 (height, width), along the view axis, world units. Infinity for background.
    depth: Py<PyAny>,
    /// float32 (height, width, 3), unit length, world directions. Zero for background.
    normals: Py<PyAny>,
    /// int32 (height, width, 4): index of the visible voxel, and its level (0 the root). (0, 0, 0, -1) for background.
    voxels: Py<PyAny>,
    /// int32 (height, width): the visible node of the graph. -1 for background.
    nodes: Py<PyAny>,
    /// Counters of the engine, by name.
    counters: BTreeMap<&'static str, u64>,
    /// Hash of all buffers as drawn: 32 hexadecimal digits, the same on every computer. None unless all buffers were
    /// requested.
    hash: Option<String>,
    /// Pixels across.
    width: u32,
    /// Pixels down.
    height: u32,
}

const BUFFERS: [(&str, Buffer); 4] = [
    ("depth", Buffer::Depth),
    ("normals", Buffer::Normal),
    ("voxels", Buffer::Voxel),
    ("nodes", Buffer::Node),
];

/// A buffer as an array that owns it.
pub(crate) fn array(py: Python<'_>, values: Values, shape: &[usize]) -> PyResult<Py<PyAny>> {
    fn shaped<T: Element>(py: Python<'_>, flat: Vec<T>, shape: &[usize]) -> PyResult<Py<PyAny>> {
        let array = flat.into_pyarray(py).reshape(shape)?;
        Ok(array.into_any().unbind())
    }
    match values {
        Values::U8(values) => shaped(py, values, shape),
        Values::I32(values) => shaped(py, values, shape),
        Values::F32(values) => shaped(py, values, shape),
    }
}

impl Picture {
    fn pixels(&self, py: Python<'_>) -> PyResult<Pixels> {
        let rgba = self.rgba.bind(py).cast::<PyArrayDyn<u8>>()?;
        let rgba = rgba.try_readonly().map_err(refused)?;
        let pixels = rgba.as_slice().map_err(refused)?;
        let pixels = pixels.as_chunks::<4>().0.to_vec();
        if pixels.len() != self.width as usize * self.height as usize {
            return Err(Error::new_err("rgba: another type or size was given to it"));
        }
        Ok(Pixels::new(self.width, self.height, pixels))
    }
}

#[pymethods]
impl Picture {
    /// Write the colours as a PNG, replacing an existing file. Raises `Error` if the system refuses.
    fn save_png(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let pixels = self.pixels(py)?;
        let write = || {
            shiftvox::whole::write_with(&path, true, |file| {
                pixels.write(file).map_err(std::io::Error::other)
            })
        };
        py.detach(write).map_err(refused)
    }

    /// The colours as a PNG, which notebooks show.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        self.pixels(py)?.write(&mut bytes).map_err(refused)?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn __repr__(&self) -> String {
        let Self { width, height, .. } = self;
        format!("<shiftvox.Picture of {width} x {height} pixels>")
    }
}

/// Draw a scene, by default with a fitted camera at 512 x 512 pixels. Other Python threads run meanwhile.
///
/// - size: pixels, one number or (width, height).
/// - samples: 1, 2 or 4 along each axis of a pixel.
/// - engine: "fast", "machine" (counts operations in the hardware's words) or "rays" (the oracle).
/// - coverage: "exact" (default), "alpha", "center" or "any".
/// - lod: size in pixels up to which nodes are drawn as one voxel.
/// - tolerance: pixels, for coverages center and any.
/// - cage: "frame" (default) or "corners".
/// - bits, frac: width of a word, 16 to 64, and its fraction.
/// - paper: the rules of the image-order paper, which set coverage, tolerance and cage.
/// - background: three numbers, 0 to 255 in sRGB; excludes transparent.
/// - threads: up to 1024, 0 for all; the picture is the same.
/// - buffers: of "depth", "normals", "voxels" and "nodes", by default all. Others are None in the picture.
///
/// Raises `Error` for settings out of range or in conflict, and for overflow of a word.
#[pyfunction]
#[pyo3(signature = (scene, camera=None, size=None, *, samples=1, engine="fast", coverage=None, lod=None,
    tolerance=None, cage=None, bits=64, frac=None, paper=false, shaded=true, background=None, transparent=false,
    threads=0, buffers=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn render(
    py: Python<'_>,
    scene: &Scene,
    camera: Option<&Camera>,
    size: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = whole)] samples: i64,
    engine: &str,
    coverage: Option<&str>,
    lod: Option<f64>,
    tolerance: Option<f64>,
    cage: Option<&str>,
    #[pyo3(from_py_with = whole)] bits: i64,
    frac: Option<&Bound<'_, PyAny>>,
    paper: bool,
    shaded: bool,
    background: Option<&Bound<'_, PyAny>>,
    transparent: bool,
    #[pyo3(from_py_with = whole)] threads: i64,
    buffers: Option<Vec<String>>,
) -> PyResult<Picture> {
    let [width, height] = size.map_or(Ok([512, 512]), arguments::size)?;
    let frac = frac.map(whole).transpose()?;
    let frac = frac.map(|frac| count("frac", frac)).transpose()?;
    let mut renderer = Renderer::new()
        .engine(one_of("engine", engine, &ENGINES)?)
        .samples(count("samples", samples)?)
        .word(count("bits", bits)?, frac)
        .threads(count("threads", threads)? as usize);
    let rules = [
        ("coverage", coverage.is_some()),
        ("tolerance", tolerance.is_some()),
        ("cage", cage.is_some()),
    ];
    if paper {
        if let Some((rule, _)) = rules.iter().find(|(_, is_given)| *is_given) {
            let told = format!("{rule}: paper=True sets it, leave one of them out");
            return Err(Error::new_err(told));
        }
        renderer = renderer.paper();
    }
    if let Some(word) = coverage {
        renderer = renderer.coverage(arguments::coverage(word)?);
    }
    if let Some(word) = cage {
        renderer = renderer.cage(one_of("cage", word, &CAGES)?);
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
    renderer = match (background, transparent) {
        (None, false) => renderer,
        (None, true) => renderer.background(Background::None),
        (Some(given), false) => renderer.background(Background::Color(color("background", given)?)),
        (Some(_), true) => {
            let told = "background: transparent=True has none, leave one of them out";
            return Err(Error::new_err(told));
        }
    };
    let renderer = match &buffers {
        None => renderer
            .buffers(BUFFERS.map(|(_, buffer)| buffer))
            .hashed(true),
        Some(names) => {
            let names = names.iter();
            let wanted = names.map(|name| one_of("buffers", name, &BUFFERS));
            renderer.buffers(wanted.collect::<PyResult<Vec<_>>>()?)
        }
    };
    let scene = Arc::clone(&scene.scene);
    let camera = camera.map_or_else(
        || Kind::Fitted(shiftvox::Camera::fit(&scene)),
        |camera| camera.camera.clone(),
    );
    let picture = on_all_threads(py, move |stop| {
        let renderer = renderer.stopped_by(stop);
        match &camera {
            Kind::Fitted(camera) => renderer.render(&scene, camera, width, height),
            Kind::Placed(camera) => renderer.render(&scene, camera, width, height),
        }
    })?
    .map_err(refused)?;
    let [rows, columns] = [height, width].map(|side| side as usize);
    let mut made = Picture {
        rgba: py.None(),
        depth: py.None(),
        normals: py.None(),
        voxels: py.None(),
        nodes: py.None(),
        counters: picture.counters().iter().copied().collect(),
        hash: picture.hash().ok().map(str::to_owned),
        width,
        height,
    };
    let (rgba, buffers) = picture.into_buffers();
    made.rgba = array(py, Values::U8(rgba.into_flattened()), &[rows, columns, 4])?;
    for (buffer, values) in buffers {
        let entries = buffer.entries();
        let shape = [rows, columns, entries];
        let array = array(py, values, if entries == 1 { &shape[..2] } else { &shape })?;
        match buffer {
            Buffer::Depth => made.depth = array,
            Buffer::Normal => made.normals = array,
            Buffer::Voxel => made.voxels = array,
            _ => made.nodes = array,
        }
    }
    Ok(made)
}
