//! Cameras that move.

use glam::DVec3;
use serde::Serialize;

use shiftvox::project::{Camera, CameraError};

/// How a camera moves from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "motion", rename_all = "lowercase")]
pub enum Motion {
    /// Around its target, about the direction that is up.
    Turntable {
        /// Degrees a frame.
        degrees: f64,
    },
    /// Towards its target.
    Dolly {
        /// The part of the distance that a frame takes away, below 1.
        share: f64,
    },
    /// To the right, without turning.
    Pan {
        /// Pixels a frame, by which what is at the target's distance moves to the left.
        pixels: f64,
    },
}

impl Motion {
    /// The three motions of the experiment: half a degree, a hundredth, an eighth of a pixel.
    pub const ALL: [Self; 3] = [
        Self::Turntable { degrees: 0.5 },
        Self::Dolly { share: 0.01 },
        Self::Pan { pixels: 0.125 },
    ];

    /// What tables call it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Turntable { .. } => "turntable",
            Self::Dolly { .. } => "dolly",
            Self::Pan { .. } => "pan",
        }
    }

    /// The camera after so many frames.
    ///
    /// # Errors
    /// When the camera cannot see.
    pub fn after(&self, camera: &Camera, frames: u32) -> Result<Camera, CameraError> {
        let axes = camera.axes()?;
        let frames = f64::from(frames);
        let to_eye = camera.eye - camera.target;
        let mut moved = *camera;
        match self {
            Self::Turntable { degrees } => {
                moved = turned(camera, degrees * frames);
            }
            Self::Dolly { share } => {
                moved.eye = camera.target + to_eye * libm::pow(1.0 - share, frames);
            }
            Self::Pan { pixels } => {
                let pixel = to_eye.length() / axes.focal_px;
                let by = axes.right * (pixel * pixels * frames);
                moved.eye += by;
                moved.target += by;
            }
        }
        Ok(moved)
    }
}

/// A camera that went around its target, about the direction that is up.
fn turned(camera: &Camera, degrees: f64) -> Camera {
    let axis = camera.up.normalize_or_zero();
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let offset = camera.eye - camera.target;
    let along = axis * axis.dot(offset);
    let around: DVec3 = (offset - along) * cos + axis.cross(offset) * sin;
    Camera {
        eye: camera.target + along + around,
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(0.0, -10.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov_degrees: 90.0,
            width: 100,
            height: 100,
        }
    }

    fn after(motion: Motion, frames: u32) -> Camera {
        motion.after(&camera(), frames).unwrap()
    }

    #[test]
    fn motions_go_where_they_should() {
        for motion in Motion::ALL {
            let still = after(motion, 0);
            assert!((still.eye - camera().eye).length() < 1e-12, "{motion:?}");
        }
        let turned = after(Motion::Turntable { degrees: 45.0 }, 2);
        assert!((turned.eye - DVec3::new(10.0, 0.0, 0.0)).length() < 1e-12);
        assert_eq!(turned.target, DVec3::ZERO);
        let nearer = after(Motion::Dolly { share: 0.5 }, 2);
        assert!((nearer.eye - DVec3::new(0.0, -2.5, 0.0)).length() < 1e-12);
        // 90 degrees over 100 pixels from 10 away: a pixel is a fifth.
        let panned = after(Motion::Pan { pixels: 0.5 }, 3);
        let by = DVec3::new(0.3, 0.0, 0.0);
        assert!((panned.eye - camera().eye - by).length() < 1e-12);
        assert!((panned.target - by).length() < 1e-12);
    }

    #[test]
    fn a_turn_keeps_height_and_distance() {
        let camera = Camera {
            eye: DVec3::new(5.0, 1.0, 7.0),
            target: DVec3::new(2.0, 1.0, 3.0),
            up: DVec3::Z * 4.0,
            fov_degrees: 60.0,
            width: 1,
            height: 1,
        };
        let quarter = turned(&camera, 90.0).eye;
        assert!(
            (quarter - DVec3::new(2.0, 4.0, 7.0)).length() < 1e-12,
            "{quarter}"
        );
        assert_eq!(turned(&camera, 0.0), camera);
    }
}
