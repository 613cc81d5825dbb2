//! Levels of detail of a mesh.

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use super::parts::widths;
use super::{Hybrid, Level};
use crate::far::store::{FarError, encode};
use crate::far::view::{FarPicture, ViewError, ViewOptions};
use crate::far::{self, BuildError, FarFile};
use crate::graph::{Progress, Silent};
use crate::mesh::decimate::{DecimateError, Decimation, compact, decimate};
use crate::mesh::raster::{Light, RasterCamera};
use crate::mesh::{Mesh, Surface, srgb_to_linear};

/// How a hybrid is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridOptions {
    /// Pixels along the longest side of the mesh, at the finest level; 16 to 255.
    pub finest: u32,
    /// The same of the coarsest.
    pub coarsest: u32,
    /// Parts narrower than so many pixels of a level are thin.
    pub thin_pixels: f64,
    /// How far triangles may be from the mesh, in pixels of a level.
    pub error_pixels: f64,
}

impl Default for HybridOptions {
    fn default() -> Self {
        Self {
            finest: 255,
            coarsest: 16,
            thin_pixels: 2.0,
            error_pixels: 0.3,
        }
    }
}

/// Why nothing was built.
#[derive(Debug, thiserror::Error)]
pub enum HybridError {
    /// Of the triangles.
    #[error(transparent)]
    Decimate(#[from] DecimateError),
    /// Of the voxels.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Of the voxels as a file.
    #[error(transparent)]
    File(#[from] FarError),
    /// Of a picture by which candidates are compared.
    #[error(transparent)]
    View(#[from] ViewError),
    /// An option.
    #[error(
        "levels have 16 to 255 pixels along the mesh, the finest at least as many as the coarsest"
    )]
    Levels,
}

/// What bytes weigh beside the error: a level of 32 times the bytes has to have half of it.
const BYTES_WEIGH: f64 = 0.2;
/// Shares of the greatest error at which small parts are kept, and thin ones.
const FINER: f64 = 1.0 / 3.0;
const FINEST: f64 = 0.1;
/// Bytes of the smallest voxel's record.
const LEAST_VOXEL_BYTES: f64 = 12.0;
/// Least distance of the eye in voxels: that of wide fields of view.
const DISTANCE_VOXELS: f64 = 8.0;
/// Light that comes from everywhere, as the engines have it: 0 to 256.
const AMBIENT: u32 = 64;
/// How far off the cameras are that compare, in extents of the mesh.
const DISTANCE: f64 = 4.0;
/// Directions from the mesh to cameras that compare.
const DIRECTIONS: [DVec3; 4] = [
    DVec3::new(1.0, 0.4, 0.3),
    DVec3::new(-0.5, 0.6, 1.0),
    DVec3::new(-0.8, 0.2, -0.6),
    DVec3::new(0.3, 1.0, -0.7),
];

/// Builds levels of detail of a mesh that has triangles.
///
/// # Errors
/// See [`HybridError`].
pub fn build(
    mesh: &Mesh,
    options: &HybridOptions,
    progress: &dyn Progress,
) -> Result<Hybrid, HybridError> {
    let (finest, coarsest) = (options.finest, options.coarsest);
    if !(16 <= coarsest && coarsest <= finest && finest <= 255) {
        return Err(HybridError::Levels);
    }
    let (low, high) = mesh.bounds();
    let extent = (high - low).max_element();
    let widths = widths(mesh);
    let mut levels = vec![Level::new(0.0, Some(compact(mesh)), None)];
    let count = (finest / coarsest).ilog2() + 1;
    progress.begin("levels of detail", u64::from(count));
    let coarser = (0..count).into_par_iter().map(|halvings| {
        let pixel = extent / f64::from(finest >> halvings);
        let level = level(mesh, &widths, pixel, options);
        progress.advance(1);
        level
    });
    levels.extend(coarser.collect::<Result<Vec<Level>, HybridError>>()?);
    progress.end();
    Ok(Hybrid { levels, low, high })
}

/// The level of a size of pixel: of several ways to make it the one with the least error times
/// a power of its bytes.
fn level(
    mesh: &Mesh,
    widths: &[f64],
    pixel: f64,
    options: &HybridOptions,
) -> Result<Level, HybridError> {
    let within = |pixels: f64, part: &Mesh, prunes: bool| {
        let how = Decimation {
            triangles: 0,
            error: Some(pixels * pixel),
            prunes,
        };
        decimate(part, &how)
    };
    let error = options.error_pixels;
    let of =
        |surface: Option<Mesh>, thin| Level::new(pixel, surface.map(|mesh| compact(&mesh)), thin);
    let mut candidates = vec![of(within(error, mesh, true)?, None)];
    let is_thin = |&number: &usize| widths[number] < options.thin_pixels * pixel;
    let (thin, wide): (Vec<usize>, Vec<usize>) = (0..mesh.len()).partition(is_thin);
    // One triangle has no hierarchy.
    if thin.len() >= 2 {
        // Small parts may matter.
        candidates.push(of(within(error * FINER, mesh, true)?, None));
        let wide = match wide.is_empty() {
            true => None,
            false => within(error, &mesh.part(&wide), true)?,
        };
        let thin = mesh.part(&thin);
        let lines = within(error * FINEST, &thin, false)?;
        let both = Mesh::of_parts([wide.clone(), lines].into_iter().flatten());
        let both = of(both, None);
        // There is a voxel at the least for each square of a pixel.
        let least = area(&thin) / (pixel * pixel) * LEAST_VOXEL_BYTES;
        if least < both.bytes as f64 {
            candidates.push(of(wide, Some(voxels(&thin, pixel)?)));
        }
        candidates.push(both);
    }
    if candidates.len() == 1 {
        return Ok(candidates.swap_remove(0));
    }
    let view = Comparison::of(mesh, pixel)?;
    let mut costs = Vec::new();
    for candidate in &candidates {
        let square = view.square_error(candidate)?;
        costs.push(libm::sqrt(square) * libm::pow(candidate.bytes as f64, BYTES_WEIGH));
    }
    let least = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    Ok(candidates.swap_remove(least.unwrap_or(0)))
}

fn area(mesh: &Mesh) -> f64 {
    let triangle = |number| {
        let [a, b, c] = Surface::corners(mesh, number);
        (b - a).cross(c - a).length() / 2.0
    };
    (0..mesh.len()).map(triangle).sum()
}

/// Voxels of one grid around triangles, of a size.
fn voxels(part: &Mesh, voxel: f64) -> Result<FarFile, HybridError> {
    let (low, high) = part.bounds();
    let extent = (high - low).max_element();
    let options = far::BuildOptions {
        // Its root alone is an inner node.
        leaf_triangles: u32::try_from(part.len()).unwrap_or(u32::MAX),
        // 2 to 255.
        grid: libm::ceil(extent / voxel).clamp(2.0, 255.0) as u32,
        distance_voxels: DISTANCE_VOXELS,
        ..far::BuildOptions::default()
    };
    let data = far::build(part, &options, &Silent)?;
    let bytes = encode(&data).map_err(|error| FarError::Io {
        file: "(memory)".into(),
        doing: "write",
        source: std::io::Error::other(error),
    })?;
    Ok(FarFile::from_bytes(&bytes)?)
}

/// Cameras from which candidates are compared with the mesh.
struct Comparison {
    views: Vec<(RasterCamera, Light, Vec<DVec4>)>,
}

/// Samples along each axis of a pixel: of the mesh, which is right, and of candidates.
const SAMPLES_ACROSS: [u32; 2] = [4, 2];

impl Comparison {
    fn of(mesh: &Mesh, pixel: f64) -> Result<Self, ViewError> {
        let (low, high) = mesh.bounds();
        let (middle, extent) = ((low + high) / 2.0, (high - low).max_element());
        let whole = Level {
            pixel: 0.0,
            surface: Some(mesh.clone()),
            thin: None,
            bytes: 0,
        };
        // At most 255 pixels by the root of three.
        let side = libm::ceil((high - low).length() * 1.2 / pixel) as u32;
        let mut views = Vec::new();
        for direction in DIRECTIONS {
            let towards = direction.normalize_or(DVec3::X);
            let forward = -towards;
            let right = forward.cross(DVec3::Y).normalize_or(DVec3::X);
            let up = right.cross(forward);
            let distance = DISTANCE * extent;
            let view = RasterCamera {
                eye: middle + towards * distance,
                right,
                up,
                forward,
                focal_px: distance / pixel,
                width: side,
                height: side,
                near: extent * 1e-3,
            };
            let light = Light {
                towards: (towards + up * 0.7 + right * 0.4).normalize_or(up),
                ambient: AMBIENT,
            };
            let (picture, _) = whole.draw(&view, &drawn_with(light, SAMPLES_ACROSS[0]))?;
            views.push((view, light, light_and_cover(&picture)));
        }
        Ok(Self { views })
    }

    /// Mean over the cameras.
    fn square_error(&self, level: &Level) -> Result<f64, ViewError> {
        let mut sum = 0.0;
        for (view, light, truth) in &self.views {
            let (picture, _) = level.draw(view, &drawn_with(*light, SAMPLES_ACROSS[1]))?;
            let errors = light_and_cover(&picture).into_iter().zip(truth);
            let errors = errors.map(|(seen, right)| (seen - *right).length_squared());
            sum += errors.sum::<f64>() / truth.len() as f64;
        }
        Ok(sum / self.views.len() as f64)
    }
}

fn drawn_with(light: Light, samples_across: u32) -> ViewOptions {
    ViewOptions {
        samples_across,
        light: Some(light),
        background: Some([0; 3]),
        ..ViewOptions::default()
    }
}

/// Light before black, and how much of each pixel is covered, which light or dark grounds show.
fn light_and_cover(picture: &FarPicture) -> Vec<DVec4> {
    let pixels = picture.rgba.iter().zip(&picture.coverage);
    let pixel = |(&[r, g, b, _], &cover): (&[u8; 4], &f32)| {
        let [r, g, b] = [r, g, b].map(|byte| f64::from(srgb_to_linear(byte)));
        DVec4::new(r, g, b, f64::from(cover))
    };
    pixels.map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{Kind, generate};

    fn built(kind: Kind) -> Hybrid {
        let options = HybridOptions {
            finest: 64,
            ..HybridOptions::default()
        };
        build(&generate(kind, 3), &options, &Silent).unwrap()
    }

    #[test]
    fn a_solid_has_triangles_alone_and_fewer_from_level_to_level() {
        let hybrid = built(Kind::Scan);
        assert_eq!(hybrid.levels.len(), 4);
        assert!(hybrid.levels.iter().all(|level| level.thin.is_none()));
        let bytes: Vec<u64> = hybrid.levels.iter().map(|level| level.bytes).collect();
        assert!(
            bytes.windows(2).all(|pair| pair[1] * 2 < pair[0]),
            "{bytes:?}"
        );
    }

    #[test]
    fn leaves_become_voxels_and_the_house_does_not() {
        let hybrid = built(Kind::Garden);
        let coarsest = &hybrid.levels[3];
        let thin = coarsest.thin.as_ref().expect("leaves");
        let surface = coarsest.surface.as_ref().expect("a house");
        assert!(thin.nodes()[0].voxels() > 100);
        assert!((10..2000).contains(&surface.len()));
        assert!(coarsest.bytes * 10 < hybrid.levels[0].bytes);
    }
}
