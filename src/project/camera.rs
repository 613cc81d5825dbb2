//! The camera, in world units.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A pinhole camera, or one of parallel rays, and the size of its picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    pub eye: DVec3,
    pub target: DVec3,
    /// Not along the view axis.
    pub up: DVec3,
    /// Vertical field of view, degrees, above 0 and below 180.
    pub fov_degrees: f64,
    /// For parallel rays (orthographic): world units from the picture's bottom to its top, above 0. Then the field of view
    /// does not count, and the eye only gives the direction and the zero of depth: what lies behind it is seen, too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ortho: Option<f64>,
    pub width: u32,
    pub height: u32,
}

/// Why a camera cannot see.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A coordinate is infinite or not a number.
    #[error("the camera has a coordinate that is not a finite number")]
    NotFinite,
    /// Eye and target coincide.
    #[error("the camera's eye and target are the same point, or too far apart for numbers")]
    NoDirection,
    /// The up direction is zero or lies along the view axis.
    #[error(
        "the camera's up direction is zero or lies along the view axis; give another, such as 0,1,0"
    )]
    NoUp,
    /// Field of view outside 0..180 degrees.
    #[error("the field of view must lie between 0 and 180 degrees, not {0}")]
    FieldOfView(f64),
    /// A height of parallel rays that is not a length.
    #[error(
        "the height of an orthographic picture must be a number of world units above 0, not {0}"
    )]
    Height(f64),
    /// The picture has no pixels, or too many.
    #[error("a picture has 1 to {MAX_SIDE} pixels a side, not {0} x {1}")]
    Size(u32, u32),
}

pub const MAX_SIDE: u32 = 1 << 15;

/// The camera's axes: orthonormal, right-handed as (right, up, back).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes {
    pub right: DVec3,
    pub up: DVec3,
    /// Along the view axis, away from the eye.
    pub forward: DVec3,
    /// Pixels per unit of slope: half the height divided by the tangent of half the field of view. Of parallel rays: pixels
    /// per world unit.
    pub focal_px: f64,
}

impl Camera {
    /// With +Z up, and no parallel rays.
    pub const fn looking(
        eye: DVec3,
        target: DVec3,
        fov_degrees: f64,
        (width, height): (u32, u32),
    ) -> Self {
        Self {
            eye,
            target,
            up: DVec3::Z,
            fov_degrees,
            ortho: None,
            width,
            height,
        }
    }

    #[must_use]
    pub const fn of_size(self, width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            ..self
        }
    }

    pub fn axes(&self) -> Result<Axes, CameraError> {
        let focal_px = match self.ortho {
            Some(height) if height > 0.0 && height.is_finite() => f64::from(self.height) / height,
            Some(height) => return Err(CameraError::Height(height)),
            None if self.fov_degrees > 0.0 && self.fov_degrees < 180.0 => {
                let half_angle = self.fov_degrees * (std::f64::consts::PI / 360.0);
                f64::from(self.height) / 2.0 / libm::tan(half_angle)
            }
            None => return Err(CameraError::FieldOfView(self.fov_degrees)),
        };
        if self.width == 0 || self.height == 0 || self.width > MAX_SIDE || self.height > MAX_SIDE {
            return Err(CameraError::Size(self.width, self.height));
        }
        if ![self.eye, self.target, self.up]
            .iter()
            .all(|v| v.is_finite())
        {
            return Err(CameraError::NotFinite);
        }
        // The order of operations fixes the bits.
        let forward = self.target - self.eye;
        let scale = 1.0 / length(forward);
        if !(scale.is_finite() && scale > 0.0) {
            return Err(CameraError::NoDirection);
        }
        let forward = forward * scale;
        let right = forward.cross(self.up);
        // Below this the two directions agree to within f64 rounding.
        let right_length = length(right);
        if right_length <= length(self.up) * 1e-12 || self.up == DVec3::ZERO {
            return Err(CameraError::NoUp);
        }
        let right = right * (1.0 / right_length);
        Ok(Axes {
            right,
            up: right.cross(forward),
            forward,
            focal_px,
        })
    }

    /// This camera as flags of the program, in the shortest decimals that are read as the same numbers.
    pub fn flags(&self) -> String {
        // Adding zero turns -0 into 0.
        let [eye, target, up] = [self.eye, self.target, self.up].map(|point| {
            let p = point + DVec3::ZERO;
            format!("{},{},{}", p.x, p.y, p.z)
        });
        let lens = match self.ortho {
            Some(height) => format!("--ortho={height}"),
            None => format!("--fov {}", self.fov_degrees),
        };
        format!("--eye {eye} --target {target} --up {up} {lens}")
    }
}

fn length(vector: DVec3) -> f64 {
    libm::sqrt(vector.dot(vector))
}
