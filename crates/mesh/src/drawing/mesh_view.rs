//! Cameras and light of renderers of meshes.

use glam::DVec3;

use crate::raster::{Light, RasterCamera};
use shiftvox::picture::{AMBIENT, KEY_LIGHT, Shading};
use shiftvox::project::{Camera, CameraError};

/// Share of the distance to the farthest corner below which nothing is drawn.
const NEAR: f64 = 1e-6;

/// Parallel rays are drawn from an eye at this distance, in heights of the picture. Over a scene as deep as the picture is
/// high, they converge by less than an 8,000th of the picture. Depths of 32 bits differ by a 4,000th of the height.
const ORTHO_HEIGHTS: f64 = 4096.0;

/// A camera's view of the contents of a box.
pub fn view_of(camera: &Camera, (low, high): (DVec3, DVec3)) -> Result<RasterCamera, CameraError> {
    let mut axes = camera.axes()?;
    let mut eye = camera.eye;
    if let Some(height) = camera.ortho {
        let distance = height * ORTHO_HEIGHTS;
        eye = camera.target - axes.forward * distance;
        axes.focal_px *= distance;
    }
    let farthest = (eye - low).abs().max((high - eye).abs()).length();
    Ok(RasterCamera {
        eye,
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
