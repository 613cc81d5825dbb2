//! Cameras.

use pyo3::prelude::*;
use pyo3::types::PyAny;
use shiftvox::View;
use shiftvox::project::Camera as Place;

use crate::scene::Scene;
use crate::{Error, arguments, refused};

/// A view of a scene. Only one with a place, of `look_at` or `placed`, has an eye and can be pickled.
#[pyclass(frozen, module = "shiftvox")]
pub(crate) struct Camera {
    pub(crate) camera: Kind,
}

#[derive(Clone)]
pub(crate) enum Kind {
    Fitted(shiftvox::FittedCamera),
    Placed(shiftvox::Camera),
}

#[pymethods]
impl Camera {
    /// A camera that sees the whole scene. Angles are in degrees: azimuth around the up axis (0 front, 90 right),
    /// elevation above the horizon, vertical field of view (fov). The magnification `zoom` is above 0. `ortho` takes
    /// parallel rays.
    ///
    /// `render` raises `Error` for a zoom or field of view out of range.
    #[staticmethod]
    #[pyo3(signature = (scene, *, azimuth=None, elevation=None, zoom=1.0, fov=None, ortho=false))]
    fn fit(
        scene: &Scene,
        azimuth: Option<f64>,
        elevation: Option<f64>,
        zoom: f64,
        fov: Option<f64>,
        ortho: bool,
    ) -> Self {
        let mut camera = shiftvox::Camera::fit(&scene.scene).zoom(zoom);
        if let Some(degrees) = azimuth {
            camera = camera.azimuth(degrees);
        }
        if let Some(degrees) = elevation {
            camera = camera.elevation(degrees);
        }
        if let Some(degrees) = fov {
            camera = camera.field_of_view(degrees);
        }
        if ortho {
            camera = camera.orthographic();
        }
        Self {
            camera: Kind::Fitted(camera),
        }
    }

    /// A camera at `eye`, aimed at `target`, three numbers each, world units. The direction `up` is (0, 0, 1) by
    /// default, and `fov` the vertical field of view in degrees. `ortho` takes parallel rays, for a picture of that
    /// height in world units.
    ///
    /// `render` raises `Error` if eye and target coincide, or up is parallel to the view.
    #[staticmethod]
    #[pyo3(signature = (eye, target, up=None, fov=None, ortho=None))]
    fn look_at(
        eye: [f64; 3],
        target: [f64; 3],
        up: Option<[f64; 3]>,
        fov: Option<f64>,
        ortho: Option<f64>,
    ) -> Self {
        let mut camera = shiftvox::Camera::look_at(eye, target);
        if let Some(direction) = up {
            camera = camera.up(direction);
        }
        if let Some(degrees) = fov {
            camera = camera.field_of_view(degrees);
        }
        if let Some(height) = ortho {
            camera = camera.orthographic(height);
        }
        Self {
            camera: Kind::Placed(camera),
        }
    }

    /// This camera at the place from which it sees a picture of this size, in pixels: one number or (width, height).
    fn placed(&self, size: &Bound<'_, PyAny>) -> PyResult<Self> {
        let [width, height] = arguments::size(size)?;
        let placed = match &self.camera {
            Kind::Placed(camera) => camera.of_size(width, height),
            Kind::Fitted(camera) => camera.of_size(width, height),
        };
        let at = placed.map_err(refused)?;
        let lens = (at.ortho.is_none().then_some(at.fov_degrees), at.ortho);
        let [eye, target, up] = [at.eye, at.target, at.up].map(<[f64; 3]>::from);
        Ok(Self::look_at(eye, target, Some(up), lens.0, lens.1))
    }

    /// World units.
    #[getter]
    fn eye(&self) -> PyResult<[f64; 3]> {
        Ok(self.place()?.eye.into())
    }

    /// World units.
    #[getter]
    fn target(&self) -> PyResult<[f64; 3]> {
        Ok(self.place()?.target.into())
    }

    /// The direction that points up in the picture.
    #[getter]
    fn up(&self) -> PyResult<[f64; 3]> {
        Ok(self.place()?.up.into())
    }

    /// Vertical field of view, degrees. None with parallel rays.
    #[getter]
    fn fov(&self) -> PyResult<Option<f64>> {
        let place = self.place()?;
        Ok(place.ortho.is_none().then_some(place.fov_degrees))
    }

    /// Height of the picture with parallel rays, world units, otherwise None.
    #[getter]
    fn ortho(&self) -> PyResult<Option<f64>> {
        Ok(self.place()?.ortho)
    }

    #[expect(clippy::type_complexity, reason = "the arguments of look_at")]
    fn __reduce__(
        &self,
        py: Python<'_>,
    ) -> PyResult<(
        Py<PyAny>,
        ([f64; 3], [f64; 3], [f64; 3], Option<f64>, Option<f64>),
    )> {
        let look_at = py.get_type::<Self>().getattr("look_at")?.unbind();
        let [eye, target, up] = [self.eye()?, self.target()?, self.up()?];
        Ok((look_at, (eye, target, up, self.fov()?, self.ortho()?)))
    }

    fn __repr__(&self) -> String {
        let Ok(at) = self.place() else {
            return "<shiftvox.Camera that is fitted to a scene>".to_owned();
        };
        let lens = match at.ortho {
            Some(height) => format!("ortho={height}"),
            None => format!("fov={}", at.fov_degrees),
        };
        let [eye, target, up] = [at.eye, at.target, at.up].map(<[f64; 3]>::from);
        format!("Camera.look_at({eye:?}, {target:?}, up={up:?}, {lens})")
    }
}

impl Camera {
    fn place(&self) -> PyResult<Place> {
        match &self.camera {
            Kind::Placed(camera) => camera.of_size(1, 1).map_err(refused),
            Kind::Fitted(_) => Err(Error::new_err(
                "the place of a fitted camera depends on the picture: take camera.placed(size)",
            )),
        }
    }
}
