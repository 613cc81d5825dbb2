//! A mesh in which much is hidden: blocks, a wall, thin masts.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{self, FarCounts, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarData, FarFile, build};
use shiftvox_mesh::raster::{Light, RasterCamera, RasterPicture};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::shared::{cuboid, looking, sheet};

/// About 4000 triangles, 40 units wide: alone, or on a ground behind a high wall.
pub(crate) fn city(is_walled: bool) -> Mesh {
    let mut builder = MeshBuilder::new();
    for color in [[200, 60, 50], [60, 160, 70], [70, 80, 200], [220, 210, 90]] {
        builder.material(Material::of_srgb("a colour", color));
    }
    for x in 0..16u32 {
        for z in 0..16u32 {
            let height = 1.0 + ((x * 7 + z * 13) % 11) as f32 * 0.4;
            let (left, front) = (x as f32 * 2.5, z as f32 * 2.5);
            let high = [left + 1.6, height, front + 1.7];
            cuboid(&mut builder, [left, 0.0, front], high, (x + z) % 4);
            if (x + z) % 3 == 0 {
                let low = [left + 0.8, height, front + 0.8];
                let high = [left + 0.9, height + 3.0, front + 0.9];
                cuboid(&mut builder, low, high, 3);
            }
        }
    }
    // A wall in many small parts, which hides much from +z.
    for i in 0..80u32 {
        let low = [(i / 4) as f32 * 2.0, (i % 4) as f32 * 1.5, 42.0];
        let high = [low[0] + 2.0, low[1] + 1.5, 42.1];
        cuboid(&mut builder, low, high, (i / 4 + i % 4) % 4);
    }
    if is_walled {
        let at = |i, j| DVec3::new(f64::from(i) * 3.0, -0.2, f64::from(j) * 3.0);
        sheet(&mut builder, [14, 14], 1, at);
        for i in 0..400 {
            let (x, y) = ((i % 20) as f32 * 4.0 - 20.0, (i / 20) as f32 * 2.0 - 10.0);
            cuboid(&mut builder, [x, y, 70.0], [x + 4.0, y + 2.0, 70.5], 2);
        }
    }
    builder.finish("city").unwrap()
}

pub(crate) fn options() -> BuildOptions {
    BuildOptions {
        rays: Some(150_000),
        leaf_triangles: 60,
        grid: 24,
        distance_voxels: 40.0,
        ..BuildOptions::default()
    }
}

pub(crate) fn far(is_walled: bool) -> FarData {
    build(&city(is_walled), &options(), &Silent).unwrap()
}

pub(crate) fn file_of(data: &FarData) -> FarFile {
    FarFile::from_bytes(&encode(data).unwrap()).unwrap()
}

pub(crate) fn view(degrees: f64, height: f64, distance: f64, size: u32) -> RasterCamera {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let target = DVec3::new(20.0, 2.0, 21.0);
    let eye = target + DVec3::new(sin, height, cos).normalize() * distance;
    looking(eye, target, [size; 2], f64::from(size))
}

/// Lit from above and behind the eye, before a bright background.
pub(crate) fn lit(view: &RasterCamera, voxel_px: f64) -> ViewOptions {
    let towards = (view.up + view.right * 0.5 - view.forward).normalize();
    let ambient = 90;
    ViewOptions {
        voxel_px,
        light: Some(Light { towards, ambient }),
        background: Some([240, 240, 245]),
        ..ViewOptions::default()
    }
}

pub(crate) fn draw(
    file: &FarFile,
    view: &RasterCamera,
    options: &ViewOptions,
) -> (RasterPicture, FarCounts) {
    view::draw(file, view, options).unwrap()
}
