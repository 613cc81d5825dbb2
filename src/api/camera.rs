//! Cameras of the public API.

use super::{Error, Scene};
use crate::project;
use crate::project::{Bounds, DEFAULT_FOV, Direction, Lens, Up, fit_camera};

/// A camera at a chosen place. [`Camera::fit`] makes one that finds its own place.
///
/// ```
/// # use shiftvox::{Camera, Renderer, Scene};
/// # let scene = Scene::generate("menger,depth=2")?;
/// let inside = Camera::look_at([4.5, 0.5, 4.5], [4.5, 9.0, 4.5]).field_of_view(90.0);
/// Renderer::new().render(&scene, &inside, 64, 64)?;
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Camera(project::Camera);

impl Camera {
    /// A camera at `eye` with `target` in its middle, world units. Z is up, the vertical field of view is 40 degrees.
    #[must_use]
    pub fn look_at(eye: [f64; 3], target: [f64; 3]) -> Self {
        let (eye, target) = (eye.into(), target.into());
        Self(project::Camera::looking(eye, target, DEFAULT_FOV, (0, 0)))
    }

    /// A camera that sees all of a scene at any size of picture: azimuth 45, elevation 35.264, vertical field of view 40
    /// degrees.
    #[must_use]
    pub fn fit(scene: &Scene) -> FittedCamera {
        FittedCamera {
            bounds: Bounds::of(scene.graph()),
            up: scene.up(),
            direction: Direction::CORNER,
            zoom: 1.0,
            lens: Lens::Degrees(DEFAULT_FOV),
        }
    }

    setters! {
        /// The direction that points up in the picture, not parallel to the view. Scenes with Y up ([`Scene::up`]) need
        /// `.up([0.0, 1.0, 0.0])`.
        up(direction: [f64; 3]) 0.up = direction.into();
        /// Vertical field of view, degrees, above 0 and below 180.
        field_of_view(degrees: f64) 0.fov_degrees = degrees;
        /// Parallel rays: the picture is `height` world units high, above 0. The field of view does not count, and what lies
        /// behind the eye is seen, too.
        orthographic(height: f64) 0.ortho = Some(height);
    }
}

/// A camera that finds a place from which it sees all of a scene: [`Camera::fit`].
///
/// ```
/// # use shiftvox::{Camera, Renderer, Scene};
/// # let scene = Scene::generate("menger,depth=2")?;
/// let from_above = Camera::fit(&scene).azimuth(30.0).elevation(60.0).zoom(1.5);
/// Renderer::new().render(&scene, &from_above, 64, 64)?;
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCamera {
    bounds: Bounds,
    up: Up,
    direction: Direction,
    zoom: f64,
    lens: Lens,
}

impl FittedCamera {
    setters! {
        /// Degrees around the up axis: 0 from the front, 90 from the right.
        azimuth(degrees: f64) direction.azimuth = degrees;
        /// Degrees above the horizon.
        elevation(degrees: f64) direction.elevation = degrees;
        /// Magnification, above 0: 2 halves the eye's distance.
        zoom(factor: f64) zoom = factor;
        /// Vertical field of view, degrees, above 0 and below 180.
        field_of_view(degrees: f64) lens = Lens::Degrees(degrees);
    }

    /// Parallel rays. From the default direction that is an isometric picture, at 30 degrees of elevation one whose
    /// horizontal edges rise one pixel in two.
    #[must_use]
    pub fn orthographic(mut self) -> Self {
        self.lens = Lens::Ortho;
        self
    }

    /// Keeps the same distance for every azimuth, for turntables.
    #[must_use]
    pub fn for_turning(mut self) -> Self {
        self.bounds = self.bounds.revolved(self.up);
        self
    }
}

/// A camera of either kind: [`Camera`] or [`FittedCamera`].
pub trait View: private::Sealed {
    /// The camera of a picture of this size, pixels.
    #[doc(hidden)]
    fn of_size(&self, width: u32, height: u32) -> Result<project::Camera, Error>;
}

impl View for Camera {
    fn of_size(&self, width: u32, height: u32) -> Result<project::Camera, Error> {
        Ok(self.0.of_size(width, height))
    }
}

impl View for FittedCamera {
    fn of_size(&self, width: u32, height: u32) -> Result<project::Camera, Error> {
        let &Self {
            up,
            direction,
            zoom,
            lens,
            ..
        } = self;
        if !(zoom.is_finite() && zoom > 0.0) {
            let reason = format!("the zoom must be above 0, not {zoom}");
            return Err(Error::Setting(reason));
        }
        let size = (width, height);
        let camera = fit_camera(&self.bounds, up, direction, lens, zoom, size);
        Ok(camera)
    }
}

mod private {
    /// Only this crate has cameras.
    #[expect(unnameable_types, reason = "a sealed trait")]
    pub trait Sealed {}
    impl Sealed for super::Camera {}
    impl Sealed for super::FittedCamera {}
}
