//! Cameras.

use pyo3::prelude::*;

use crate::scene::Scene;

/// A view of a scene. Cannot be pickled: make it where it is used.
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
    #[pyo3(signature = (eye, target, *, up=None, fov=None, ortho=None))]
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
}
