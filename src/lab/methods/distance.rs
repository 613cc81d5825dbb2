//! Cameras farther and farther off.

use crate::project::Camera;

/// The camera `2^halvings` times as far from its target, whose picture is as
/// many times smaller: what is around the target, at the same pixels per unit of slope.
#[must_use]
pub fn at_distance(camera: &Camera, halvings: u32) -> Camera {
    let factor = f64::from(1u32 << halvings.min(31));
    let tangent = libm::tan(camera.fov_degrees.to_radians() / 2.0);
    let side = |pixels: u32| (pixels >> halvings.min(31)).max(1);
    // The height may have been rounded down.
    let share = f64::from(side(camera.height)) / f64::from(camera.height);
    Camera {
        eye: camera.target + (camera.eye - camera.target) * factor,
        fov_degrees: 2.0 * libm::atan(tangent * share).to_degrees(),
        width: side(camera.width),
        height: side(camera.height),
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_pixel_stays_a_pixel() {
        let camera = Camera {
            eye: DVec3::new(0.0, -10.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: 256,
            height: 250,
        };
        let far = at_distance(&camera, 3);
        assert_eq!((far.width, far.height), (32, 31));
        assert_eq!(far.eye, DVec3::new(0.0, -80.0, 0.0));
        let focal = |camera: &Camera| camera.axes().unwrap().focal_px;
        assert!((focal(&far) - focal(&camera)).abs() < 1e-9);
    }
}
