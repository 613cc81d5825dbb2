//! Cameras that move, and cameras farther off.

use shiftvox::project::{Camera, CameraError};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Motion {
    /// Half a degree around the target per frame.
    Turntable,
    /// A hundredth of the way towards the target per frame.
    Dolly,
    /// An eighth of a pixel to the right per frame.
    Pan,
}

impl Motion {
    /// Columns of its film: flicker, and that of the worst step.
    pub(super) fn columns(&self) -> [&'static str; 2] {
        match self {
            Self::Turntable => ["flicker_turntable", "flicker_turntable_worst"],
            Self::Dolly => ["flicker_dolly", "flicker_dolly_worst"],
            Self::Pan => ["flicker_pan", "flicker_pan_worst"],
        }
    }

    pub fn after(&self, camera: &Camera, frames: u32) -> Result<Camera, CameraError> {
        let axes = camera.axes()?;
        let frames = f64::from(frames);
        let to_eye = camera.eye - camera.target;
        let mut moved = *camera;
        match self {
            Self::Turntable => {
                let (sin, cos) = libm::sincos((0.5 * frames).to_radians());
                let axis = camera.up.normalize_or_zero();
                let along = axis * axis.dot(to_eye);
                moved.eye =
                    camera.target + along + (to_eye - along) * cos + axis.cross(to_eye) * sin;
            }
            Self::Dolly => {
                moved.eye = camera.target + to_eye * libm::pow(0.99, frames);
            }
            Self::Pan => {
                let pixel = to_eye.length() / axes.focal_px;
                let by = axes.right * (pixel * 0.125 * frames);
                moved.eye += by;
                moved.target += by;
            }
        }
        Ok(moved)
    }
}

/// The camera so much farther from its target that its picture is so many pixels high: what is
/// around the target, at the same pixels per unit of slope.
pub fn at_distance(camera: &Camera, height: u32) -> Camera {
    let share = f64::from(height) / f64::from(camera.height);
    let tangent = libm::tan(camera.fov_degrees.to_radians() / 2.0);
    let width = libm::round(f64::from(camera.width) * share).max(1.0);
    Camera {
        eye: camera.target + (camera.eye - camera.target) / share,
        fov_degrees: 2.0 * libm::atan(tangent * share).to_degrees(),
        width: width as u32,
        height,
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const CAMERA: Camera = Camera {
        eye: DVec3::new(5.0, 1.0, 7.0),
        target: DVec3::new(2.0, 1.0, 3.0),
        up: DVec3::new(0.0, 0.0, 4.0),
        fov_degrees: 90.0,
        ortho: None,
        width: 100,
        height: 100,
    };

    #[test]
    fn motions_end_where_they_should() {
        // 90 degrees over 100 pixels from 5 away: a pixel is a tenth.
        for (motion, frames, eye, target) in [
            (Motion::Turntable, 180, [2.0, 4.0, 7.0], [2.0, 1.0, 3.0]),
            (Motion::Dolly, 2, [4.9403, 1.0, 6.9204], [2.0, 1.0, 3.0]),
            (Motion::Pan, 16, [5.0, 1.2, 7.0], [2.0, 1.2, 3.0]),
            (Motion::Pan, 0, [5.0, 1.0, 7.0], [2.0, 1.0, 3.0]),
        ] {
            let moved = motion.after(&CAMERA, frames).unwrap();
            let off = moved.eye.distance(eye.into()) + moved.target.distance(target.into());
            assert!(off < 1e-12, "{motion:?}: {moved:?}");
        }
    }

    #[test]
    fn a_pixel_stays_a_pixel_farther_off() {
        let far = at_distance(&CAMERA, 31);
        assert_eq!((far.width, far.height), (31, 31));
        let eye = CAMERA.target + DVec3::new(3.0, 0.0, 4.0) * 100.0 / 31.0;
        assert!(far.eye.distance(eye) < 1e-9);
        let [focal, far_focal] = [CAMERA, far].map(|of| of.axes().unwrap().focal_px);
        assert!((focal - far_focal).abs() < 1e-9);
    }
}
