//! Where a picture is seen from.

use glam::DVec3;

use super::{Error, Scene};
use crate::project;
use crate::project::{Bounds, DEFAULT_FOV, Direction, Up, fit_camera};

/// Where a picture is seen from: fitted to a scene, or placed. The size of the picture is the renderer's. A call
/// that does not fit the kind of camera makes the renderer fail: [`Error::Setting`](crate::Error::Setting).
///
/// ```
/// # use shiftvox::{Camera, Scene};
/// # let scene = Scene::generate("menger,depth=2")?;
/// let from_above = Camera::fit(&scene).azimuth(30.0).elevation(60.0).zoom(1.5);
/// let inside = Camera::look_at([4.5, 0.5, 4.5], [4.5, 9.0, 4.5]).field_of_view(90.0);
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    place: Place,
    fov_degrees: f64,
    /// Why a call does not apply.
    misapplied: Option<&'static str>,
}

#[derive(Debug, Clone, PartialEq)]
enum Place {
    Fitted {
        bounds: Bounds,
        up: Up,
        direction: Direction,
        zoom: f64,
    },
    Placed {
        eye: DVec3,
        target: DVec3,
        up: DVec3,
    },
}

impl Camera {
    /// A camera that sees all of a scene, and of voxels that were made of a mesh all of the mesh, whatever the
    /// picture's size: from the front right and above
    /// (azimuth 45, elevation 35.264 degrees), with a vertical field of view of 40 degrees.
    #[must_use]
    pub fn fit(scene: &Scene) -> Self {
        Self {
            place: Place::Fitted {
                bounds: Bounds::of(scene.graph()),
                up: scene.up(),
                direction: Direction::CORNER,
                zoom: 1.0,
            },
            fov_degrees: DEFAULT_FOV,
            misapplied: None,
        }
    }

    /// A camera at `eye` that has `target` in the middle of its picture, world units. Z is up; for scenes in which Y
    /// is ([`Scene::up`]) add `.up([0.0, 1.0, 0.0])`.
    #[must_use]
    pub fn look_at(eye: [f64; 3], target: [f64; 3]) -> Self {
        Self {
            place: Place::Placed {
                eye: eye.into(),
                target: target.into(),
                up: DVec3::Z,
            },
            fov_degrees: DEFAULT_FOV,
            misapplied: None,
        }
    }

    /// Degrees around the up axis: 0 from the front, 90 from the right. For a fitted camera.
    #[must_use]
    pub fn azimuth(mut self, degrees: f64) -> Self {
        match &mut self.place {
            Place::Fitted { direction, .. } => direction.azimuth = degrees,
            Place::Placed { .. } => {
                self.misapplied = Some("an azimuth is for a fitted camera, not a placed one");
            }
        }
        self
    }

    /// Degrees above the horizon. For a fitted camera.
    #[must_use]
    pub fn elevation(mut self, degrees: f64) -> Self {
        match &mut self.place {
            Place::Fitted { direction, .. } => direction.elevation = degrees,
            Place::Placed { .. } => {
                self.misapplied = Some("an elevation is for a fitted camera, not a placed one");
            }
        }
        self
    }

    /// Magnification, above 0: 2 halves the eye's distance. For a fitted camera.
    #[must_use]
    pub fn zoom(mut self, factor: f64) -> Self {
        match &mut self.place {
            Place::Fitted { zoom, .. } => *zoom = factor,
            Place::Placed { .. } => {
                self.misapplied = Some("a zoom is for a fitted camera, not a placed one");
            }
        }
        self
    }

    /// Keeps a fitted camera at the same distance from all sides: for turntables.
    #[must_use]
    pub fn for_turning(mut self) -> Self {
        match &mut self.place {
            Place::Fitted { bounds, up, .. } => *bounds = bounds.revolved(*up),
            Place::Placed { .. } => {
                self.misapplied = Some("turning is for a fitted camera, not a placed one");
            }
        }
        self
    }

    /// Another direction that is seen pointing up; not along the view. For a placed camera; a fitted one has
    /// that of its scene ([`Scene::with_up`]).
    #[must_use]
    pub fn up(mut self, direction: [f64; 3]) -> Self {
        match &mut self.place {
            Place::Placed { up, .. } => *up = direction.into(),
            Place::Fitted { .. } => {
                self.misapplied = Some(
                    "another up is for a placed camera; give the scene of a fitted one another",
                );
            }
        }
        self
    }

    /// Vertical field of view, degrees, above 0 and below 180.
    #[must_use]
    pub fn field_of_view(mut self, degrees: f64) -> Self {
        self.fov_degrees = degrees;
        self
    }

    /// Whether all that was asked of the camera can be done.
    pub(super) fn check(&self) -> Result<(), Error> {
        if let Some(reason) = self.misapplied {
            return Err(Error::Setting(reason.to_owned()));
        }
        match self.place {
            Place::Fitted { zoom, .. } if !(zoom.is_finite() && zoom > 0.0) => Err(Error::Setting(
                format!("the zoom must be above 0, not {zoom}"),
            )),
            _ => Ok(()),
        }
    }

    /// The camera of a picture of a size, pixels.
    pub(super) fn of_size(&self, width: u32, height: u32) -> project::Camera {
        match &self.place {
            &Place::Placed { eye, target, up } => project::Camera {
                eye,
                target,
                up,
                fov_degrees: self.fov_degrees,
                width,
                height,
            },
            Place::Fitted {
                bounds,
                up,
                direction,
                zoom,
            } => fit_camera(
                bounds,
                *up,
                *direction,
                self.fov_degrees,
                *zoom,
                (width, height),
            ),
        }
    }
}
