//! Cameras of pictures of meshes.

use glam::DVec3;

use crate::mesh::raster::{Light, View};
use crate::picture::{AMBIENT, KEY_LIGHT};
use crate::project::{Camera, CameraError};

/// Share of the distance to the farthest corner below which nothing is drawn.
const NEAR: f64 = 1e-6;

/// The camera as the rasteriser wants it, for something within a box.
///
/// # Errors
/// When the camera cannot see.
pub fn view_of(camera: &Camera, (low, high): (DVec3, DVec3)) -> Result<View, CameraError> {
    let axes = camera.axes()?;
    let farthest = (camera.eye - low)
        .abs()
        .max((high - camera.eye).abs())
        .length();
    Ok(View {
        eye: camera.eye,
        right: axes.right,
        up: axes.up,
        forward: axes.forward,
        focal_px: axes.focal_px,
        width: camera.width,
        height: camera.height,
        near: farthest * NEAR,
    })
}

/// The key light, which moves with the camera.
#[must_use]
pub fn key_light(view: &View) -> Light {
    let key = KEY_LIGHT.normalize();
    Light {
        towards: view.right * key.x + view.up * key.y - view.forward * key.z,
        ambient: AMBIENT,
    }
}

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
