//! Cameras and light as renderers of meshes want them.

use glam::DVec3;

use super::voxels::Look;
use crate::mesh::Surface;
use crate::mesh::raster::{self, Light, Pattern, RasterOptions, Samples, View};
use crate::picture::{AMBIENT, KEY_LIGHT, Shading};
use crate::project::{Camera, CameraError};

use super::reference::Reference;
use crate::graph::Progress;

/// Share of the distance to the farthest corner below which nothing is drawn.
const NEAR: f64 = 1e-6;

/// A camera's view of what is in a box.
///
/// # Errors
/// When the camera has no direction or a number that is not finite.
pub fn mesh_view(camera: &Camera, (low, high): (DVec3, DVec3)) -> Result<View, CameraError> {
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

/// The light of all engines, as a view has it; none for flat shading.
#[must_use]
pub fn mesh_light(view: &View, shading: Shading) -> Option<Light> {
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

/// Draws triangles at 256 samples a pixel, at random in its squares: another seed, another picture.
///
/// # Errors
/// When the camera cannot see, or the picture is too large.
pub(super) fn draw_reference(
    surface: &dyn Surface,
    camera: &Camera,
    look: Look,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Reference, String> {
    let view = mesh_view(camera, surface.bounds()).map_err(|e| e.to_string())?;
    let options = RasterOptions {
        samples: Samples::new(256, Pattern::Stratified { seed }).map_err(|e| e.to_string())?,
        light: mesh_light(&view, look.shading),
        background: Some(look.background),
    };
    let drawn = raster::draw(surface, &view, &options, progress).map_err(|e| e.to_string())?;
    Ok(Reference {
        width: drawn.width,
        height: drawn.height,
        rgba: drawn.rgba,
        shares: drawn.coverage,
    })
}
