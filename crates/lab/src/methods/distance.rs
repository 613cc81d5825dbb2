//! Cameras farther and farther off.

use shiftvox::project::Camera;

/// The camera so much farther from its target that its picture is so many pixels high: what is
/// around the target, at the same pixels per unit of slope.
#[must_use]
pub fn at_distance(camera: &Camera, height: u32) -> Camera {
    let share = f64::from(height) / f64::from(camera.height);
    let tangent = libm::tan(camera.fov_degrees.to_radians() / 2.0);
    let width = libm::round(f64::from(camera.width) * share).max(1.0);
    Camera {
        eye: camera.target + (camera.eye - camera.target) / share,
        fov_degrees: 2.0 * libm::atan(tangent * share).to_degrees(),
        // No larger than the picture that was given, or not much.
        width: width as u32,
        height,
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
        let far = at_distance(&camera, 31);
        assert_eq!((far.width, far.height), (32, 31));
        assert!((far.eye.y + 10.0 * 250.0 / 31.0).abs() < 1e-9);
        let focal = |camera: &Camera| camera.axes().unwrap().focal_px;
        assert!((focal(&far) - focal(&camera)).abs() < 1e-9);
        let same = at_distance(&camera, 250);
        assert_eq!((same.width, same.eye), (256, camera.eye));
    }
}
