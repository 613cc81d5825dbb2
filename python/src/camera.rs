//! Cameras.

use pyo3::prelude::*;

use crate::scene::Scene;

/// Where a scene is seen from. Cannot be pickled: make it where it is used.
#[pyclass(frozen, module = "shiftvox")]
pub(crate) struct Camera {
    pub(crate) camera: Kind,
}

/// The library's two kinds of cameras.
#[derive(Clone)]
pub(crate) enum Kind {
    Fitted(shiftvox::FittedCamera),
    Placed(shiftvox::Camera),
}

#[pymethods]
impl Camera {
    /// A camera that sees all of a scene. Angles in degrees: azimuth around the up axis (0 the front, 90 the right),
    /// elevation above the horizon, fov the vertical field of view. zoom: magnification, above 0.
    ///
    /// `render` raises `Error` for a zoom or a field of view that is out of range.
    #[staticmethod]
    #[pyo3(signature = (scene, *, azimuth=None, elevation=None, zoom=1.0, fov=None))]
    fn fit(
        scene: &Scene,
        azimuth: Option<f64>,
        elevation: Option<f64>,
        zoom: f64,
        fov: Option<f64>,
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
        Self {
            camera: Kind::Fitted(camera),
        }
    }

    /// A camera at `eye` that has `target` in the middle; three numbers each, world units. up: a direction, (0, 0, 1)
    /// unless given. fov: the vertical field of view, degrees.
    ///
    /// `render` raises `Error` where eye and target are one, and for an up along the view.
    #[staticmethod]
    #[pyo3(signature = (eye, target, *, up=None, fov=None))]
    fn look_at(eye: [f64; 3], target: [f64; 3], up: Option<[f64; 3]>, fov: Option<f64>) -> Self {
        let mut camera = shiftvox::Camera::look_at(eye, target);
        if let Some(direction) = up {
            camera = camera.up(direction);
        }
        if let Some(degrees) = fov {
            camera = camera.field_of_view(degrees);
        }
        Self {
            camera: Kind::Placed(camera),
        }
    }
}
