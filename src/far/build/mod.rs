//! Triangles into far voxels: hierarchy, rays, fitting.
//!
//! The same triangles and options give the same bytes on any number of
//! threads: a node's rays depend on its number and on nothing else.

mod chance;
mod coarser;
mod compare;
mod count;
mod grid;
mod parts;
mod rays;
mod sample;
mod shader_fit;
mod shot;
mod split;
mod surface;
mod touch;

#[cfg(test)]
mod known;

use glam::DVec3;
use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_64;

pub use grid::Grid;

use super::FarData;
use super::blend::Blend;
use super::record::{LeafTriangle, Node, Opacity};
use super::store::pack::pack;
use super::store::surface::lay_out;
use crate::graph::{PackedNormal, Progress, place};
use crate::mesh::{Surface, barycentric, linear_to_srgb, mesh_box};
use count::SurfaceSample;
use rays::Occluders;
use sample::Rays;
use shot::{Own, Target};
use split::{Branch, split};
use surface::{MOST_TRIANGLES, Surfaces};

/// How far voxels are built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BuildOptions {
    /// Rays of all nodes together; `None`: as many as find what is visible, and
    /// [`RAYS_PER_VOXEL`] for each voxel that is.
    pub rays: Option<u64>,
    /// Nodes with fewer triangles are leaves; 2 or more.
    pub leaf_triangles: u32,
    /// Voxels along the longest side of a node, 2 to 255.
    pub grid: u32,
    /// Least distance from which a node is used, in its voxels: where the eye
    /// may be and what may hide the node follow from it.
    pub distance_voxels: f64,
    /// What opacities are stored for: of `Six`, those that differ; of `None`, none.
    pub opacity: Opacity,
    /// How opacities of main directions are blended.
    pub opacity_blend: Blend,
    /// How normals and materials of main directions are blended.
    pub shader_blend: Blend,
    /// Whether what is wider than a voxel stays a surface, decimated.
    pub hybrid: bool,
}

/// Rays for each voxel that is kept, where no number of rays is given.
pub const RAYS_PER_VOXEL: u32 = 24;
/// Most rays of a node: what its memory is kept to.
const MOST_RAYS: u32 = 1 << 22;

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            rays: None,
            leaf_triangles: 1000,
            grid: 64,
            distance_voxels: 256.0,
            opacity: Opacity::Six,
            opacity_blend: Blend::Cosines,
            shader_blend: Blend::Squares,
            hybrid: false,
        }
    }
}

/// Why nothing was built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// No triangles.
    #[error("there are no triangles to build far voxels of")]
    Empty,
    /// More triangles or voxels than 32 bits number.
    #[error("{0} are more than 32 bits can number")]
    TooMany(String),
    /// An option out of its range.
    #[error("{0}")]
    Option(&'static str),
    /// The surface of a node.
    #[error("the surface of a node could not be made: {0}")]
    Surface(String),
    /// Coordinates that single precision does not hold.
    #[error("the mesh is too large or too small for numbers of single precision")]
    Range,
}

/// Builds far voxels of a surface.
///
/// # Errors
/// See [`BuildError`].
pub fn build<S: Surface + ?Sized>(
    surface: &S,
    options: &BuildOptions,
    progress: &dyn Progress,
) -> Result<FarData, BuildError> {
    check(surface, options)?;
    let centre = centre(surface)?;
    progress.begin("split triangles", 0);
    let (mut branches, order) = split(surface, options.leaf_triangles as usize);
    let coarser = coarser::put_above(&mut branches, options.grid, options.hybrid);
    progress.end();
    let corners = |place: usize| surface.corners(order[place] as usize).map(|p| p - centre);
    progress.begin("prepare rays", 0);
    let occluders = Occluders::new((0..order.len()).map(corners));
    progress.end();
    let hybrid = options.hybrid;
    let surfaces = hybrid.then(|| Surfaces::new(surface, &order, centre, options, &branches));
    let target = |number: usize, branch: &Branch| Target {
        occluders: &occluders,
        grid: {
            let side = coarser::grid_of(number, coarser, options.grid);
            Grid::around(branch.low - centre, branch.high - centre, side)
        },
        own: Own::all(branch.first..branch.first + branch.count),
        distance: options.distance_voxels,
        opacity_blend: options.opacity_blend,
        shader_blend: options.shader_blend,
    };
    let rays = match options.rays {
        None => vec![Rays::PerVoxel(RAYS_PER_VOXEL); branches.len()],
        Some(rays) => {
            progress.begin("find voxels", order.len() as u64);
            let touched: Vec<u32> = branches
                .par_iter()
                .enumerate()
                .map(|(number, branch)| {
                    if branch.children.is_none() {
                        progress.advance(branch.count as u64);
                        return 0;
                    }
                    let own = branch.first..branch.first + branch.count;
                    touch::count(&target(number, branch).grid, own.map(corners))
                })
                .collect();
            progress.end();
            share_rays(&touched, rays)
        }
    };
    progress.begin("shoot rays", order.len() as u64);
    let plane = |place: usize| {
        let [a, b, c] = corners(place);
        (b - a).cross(c - a).normalize_or(DVec3::Z)
    };
    let sample_at = |place: usize, point: DVec3, towards_eye: DVec3| {
        let mut triangle = surface.triangle(order[place] as usize);
        triangle.corners = triangle.corners.map(|p| p - centre);
        surface_sample(&triangle, point, towards_eye, plane(place))
    };
    let built: Vec<(Node, Vec<u8>)> = branches
        .par_iter()
        .enumerate()
        .map(|(number, branch)| {
            let mut node = outline(branch, centre);
            let own = branch.first..branch.first + branch.count;
            if branch.children.is_none() {
                // Every triangle is in one leaf: progress is counted by these.
                progress.advance(branch.count as u64);
                if let Some(surfaces) = &surfaces {
                    let bytes = surfaces.leaf(&mut node, own);
                    return Ok((node, bytes));
                }
                let triangles = leaf_triangles(surface, &order[own], centre);
                let bytes = lay_out(&mut node, &triangles, |_| true);
                return Ok((node, pack(&Default::default(), &bytes)));
            }
            let target = target(number, branch);
            set_grid(&mut node, &target.grid);
            // Whatever is above the root.
            let seed = (number as u64).wrapping_sub(coarser as u64);
            let voxels = |node: &mut Node, target: &Target<'_>| {
                let rays = rays[number];
                let sampled = target.sample(rays, MOST_RAYS, seed, corners, sample_at, plane);
                keep(node, &sampled, options)
            };
            match &surfaces {
                Some(surfaces) if branch.count <= MOST_TRIANGLES => {
                    surfaces.inner(&node, own, |node, thin| voxels(node, &target.of(thin)))
                }
                _ => {
                    let lists = voxels(&mut node, &target);
                    Ok((node, pack(&lists, &[])))
                }
            }
        })
        .collect::<Result<_, BuildError>>()?;
    progress.end();
    let mut data = assemble(built, centre, options)?;
    data.bevels = mesh_box(surface, data.y_up).bevels;
    Ok(data)
}

fn check<S: Surface + ?Sized>(surface: &S, options: &BuildOptions) -> Result<(), BuildError> {
    if surface.is_empty() {
        return Err(BuildError::Empty);
    }
    if u32::try_from(surface.len()).is_err() {
        return Err(BuildError::TooMany(format!("{} triangles", surface.len())));
    }
    if !(2..=255).contains(&options.grid) {
        return Err(BuildError::Option("a grid has 2 to 255 voxels a side"));
    }
    if options.leaf_triangles < 2 {
        return Err(BuildError::Option(
            "leaves have fewer than 2 triangles or more",
        ));
    }
    if !(options.distance_voxels >= 1.0 && options.distance_voxels <= 1e6) {
        return Err(BuildError::Option(
            "the least distance is 1 to 1,000,000 voxels",
        ));
    }
    Ok(())
}

/// What coordinates are relative to.
fn centre<S: Surface + ?Sized>(surface: &S) -> Result<DVec3, BuildError> {
    let (low, high) = surface.bounds();
    let extent = (high - low).max_element();
    let farthest = low.abs().max(high.abs()).max_element();
    if !(farthest < 1e30 && extent > 1e-30) {
        return Err(BuildError::Range);
    }
    Ok(place::centre(low.to_array(), high.to_array()).into())
}

/// Rays of each node, in proportion to the voxels that its triangles touch.
fn share_rays(touched: &[u32], rays: u64) -> Vec<Rays> {
    let all: u64 = touched.iter().map(|&n| u64::from(n)).sum();
    touched
        .iter()
        .map(|&n| {
            // No overflow: 64 bits by 32.
            let share = u128::from(rays) * u128::from(n) / u128::from(all.max(1));
            // A node with triangles gets a ray at least.
            let share = share.clamp(u128::from(n > 0), u128::from(MOST_RAYS));
            Rays::InAll(share as u32)
        })
        .collect()
}

/// Normal and colour of a triangle at a point, seen from a side.
fn surface_sample(
    triangle: &crate::mesh::Triangle,
    point: DVec3,
    towards_eye: DVec3,
    plane: DVec3,
) -> SurfaceSample {
    let shares = barycentric(&triangle.corners, point);
    let blend = |of: &[DVec3; 3]| of[0] * shares[0] + of[1] * shares[1] + of[2] * shares[2];
    let face = if plane.dot(towards_eye) >= 0.0 {
        plane
    } else {
        -plane
    };
    let normal = blend(&triangle.normals).normalize_or(face);
    SurfaceSample {
        towards_eye,
        normal: if normal.dot(face) < 0.0 {
            -normal
        } else {
            normal
        },
        color: blend(&triangle.colors),
    }
}

/// A node without voxels.
fn outline(branch: &Branch, centre: DVec3) -> Node {
    let single = |p: DVec3| (p - centre).as_vec3().to_array();
    Node {
        low: single(branch.low),
        high: single(branch.high),
        is_leaf: u8::from(branch.children.is_none()),
        level: branch.level,
        // Fewer than 2^32 triangles, and fewer nodes than twice that: see `assemble`.
        children: branch.children.map_or([0; 2], |c| c.map(|c| c as u32)),
        first_triangle: branch.first as u32,
        triangles: branch.count as u32,
        ..bytemuck::Zeroable::zeroed()
    }
}

fn set_grid(node: &mut Node, grid: &Grid) {
    node.origin = grid.origin.as_vec3().to_array();
    node.voxel = grid.voxel as f32;
    node.cells = grid.cells;
}

/// Fits the voxels that were seen; gives their records, list by list.
fn keep(node: &mut Node, sampled: &sample::Sampled, options: &BuildOptions) -> [Vec<u8>; 6] {
    let mut lists: [Vec<u8>; 6] = Default::default();
    let mut square_error = 0.0;
    let mut samples = 0;
    for (seen, shown) in &sampled.seen {
        let voxel = shader_fit::fit(seen, shown.shader, options.opacity);
        let list = voxel.list();
        voxel.write(&mut lists[list]);
        node.counts[list] += 1;
        square_error += shown.square_error;
        samples += seen.samples.len();
        node.crossings = node.crossings.saturating_add(seen.crossings);
    }
    node.touched = sampled.touched;
    node.untested = sampled.untested;
    node.rays = sampled.rays;
    node.hits = sampled.hits;
    node.error = libm::sqrt(square_error / f64::from(samples.max(1) as u32)) as f32;
    lists
}

fn leaf_triangles<S: Surface + ?Sized>(
    surface: &S,
    order: &[u32],
    centre: DVec3,
) -> Vec<LeafTriangle> {
    order
        .iter()
        .map(|&number| {
            let triangle = surface.triangle(number as usize);
            LeafTriangle {
                corners: triangle.corners.map(|p| (p - centre).as_vec3().to_array()),
                normals: triangle.normals.map(|n| PackedNormal::encode(n).0),
                colors: triangle.colors.map(|c| c.to_array().map(linear_to_srgb)),
            }
        })
        .collect()
}

fn assemble(
    built: Vec<(Node, Vec<u8>)>,
    centre: DVec3,
    options: &BuildOptions,
) -> Result<FarData, BuildError> {
    if u32::try_from(built.len()).is_err() {
        return Err(BuildError::TooMany(format!("{} nodes", built.len())));
    }
    let items = |(node, _): &(Node, Vec<u8>)| node.voxels() + u64::from(node.surface);
    let numbered: u64 = built.iter().map(items).sum();
    if numbered >= u64::from(u32::MAX) {
        let what = format!("{numbered} voxels and triangles");
        return Err(BuildError::TooMany(what));
    }
    let mut nodes = Vec::with_capacity(built.len());
    let mut packed = Vec::with_capacity(built.iter().map(|(_, bytes)| bytes.len()).sum());
    for (mut node, bytes) in built {
        node.data_at = packed.len() as u64;
        node.checksum = xxh3_64(&bytes);
        packed.extend(bytes);
        nodes.push(node);
    }
    Ok(FarData {
        centre: centre.to_array(),
        distance_voxels: options.distance_voxels,
        opacity_blend: options.opacity_blend,
        shader_blend: options.shader_blend,
        leaf_triangles: options.leaf_triangles,
        grid: options.grid,
        y_up: true,
        bevels: [0; 8],
        nodes,
        packed,
    })
}
