//! Cameras and light of renderers of meshes.

use glam::DVec3;

use crate::raster::{Light, RasterCamera};
use shiftvox::picture::{AMBIENT, KEY_LIGHT, Shading};
use shiftvox::project::{Camera, CameraError};

/// Share of the distance to the farthest corner below which nothing is drawn.
const NEAR: f64 = 1e-6;

/// A camera's view of the contents of a box.
pub fn view_of(camera: &Camera, (low, high): (DVec3, DVec3)) -> Result<RasterCamera, CameraError> {
    let axes = camera.axes()?;
    let farthest = (camera.eye - low)
        .abs()
        .max((high - camera.eye).abs())
        .length();
    Ok(RasterCamera {
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

/// The key light of all engines, which moves with the camera; none for flat shading.
pub fn light_of(view: &RasterCamera, shading: Shading) -> Option<Light> {
    let key = KEY_LIGHT.normalize();
    let light = Light {
        towards: view.right * key.x + view.up * key.y - view.forward * key.z,
        ambient: AMBIENT,
    };
    match shading {
        Shading::Lambert => Some(light),
        Shading::Flat => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_light_is_above_and_behind_the_camera() {
        // It looks along +y, with x to the right and z up. The farthest corner is at y = 1.
        let camera = Camera {
            eye: DVec3::NEG_Y * 10.0,
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: 64,
            height: 64,
        };
        let view = view_of(&camera, (DVec3::splat(-1.0), DVec3::ONE)).unwrap();
        let farthest = DVec3::new(1.0, 11.0, 1.0).length();
        assert!((view.near - 1e-6 * farthest).abs() < 1e-12);
        let light = light_of(&view, Shading::Lambert).unwrap();
        let [right, up, behind] = KEY_LIGHT.normalize().to_array();
        let expected = DVec3::new(right, -behind, up);
        assert!((light.towards - expected).length() < 1e-12);
    }
}
