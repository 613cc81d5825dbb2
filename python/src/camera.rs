//! Cameras.

use pyo3::prelude::*;

use crate::scene::Scene;

#[pyclass(frozen, module = "shiftvox")]
pub(crate) struct Camera {
    pub(crate) camera: shiftvox::Camera,
}

#[pymethods]
impl Camera {
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
        Self { camera }
    }

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
        Self { camera }
    }
}
