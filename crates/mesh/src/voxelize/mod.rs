//! Triangles to voxels: every voxel whose closed cube a triangle touches. Rules: `spec/mesh.md`.
//!
//! Corners are rounded to one lattice of 2^30 points a side, where touching is decided exactly, in integers: a thin
//! triangle loses no voxel and a closed mesh has no hole. Memory grows with the triangles and not with the voxels.

mod coverage;
mod distinct;
mod grid;
mod mix;
mod opacity;
mod parts;
mod touch;
mod walk;

use rayon::prelude::*;

pub use grid::{DEFAULT_DEPTH, Grid, GridError, MAX_DEPTH, MOST_LOOKED_AT};
pub use opacity::opacities;

use super::{Surface, Triangle};
use distinct::Distinct;
use mix::{HOLE, HOLE_OF_OPACITIES, Mix};
use shiftvox::graph::{Progress, Voxel};
pub(crate) use touch::{OTHERS, Prepared, child};
use walk::{Subtree, walk};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct VoxelizeReport {
    pub voxels: u64,
    /// Pairs of a voxel and a triangle that touches it.
    pub touches: u64,
    /// Of these the pairs that were looked at: of equal triangles one.
    pub looked_at: u64,
}

/// Hands every voxel that a triangle touches, but not with a hole of its texture, to `sink`: once, in Morton order, on any
/// number of threads. Indices run from 0 to `2^depth - 1`. `with_opacities`: for [`opacities`].
pub fn voxelize(
    surface: &dyn Surface,
    grid: &Grid,
    with_opacities: bool,
    sink: &mut dyn FnMut(Voxel),
    progress: &dyn Progress,
) -> VoxelizeReport {
    let Distinct { numbers, repeated } = Distinct::of(surface, grid);
    let hole = if with_opacities {
        HOLE_OF_OPACITIES
    } else {
        HOLE
    };
    let cube = grid.cube();
    let (_, voxel_size) = grid.placement();
    let voxels = |subtree: Subtree<'_>| {
        let painted = |&number: &u32| {
            let repeated = repeated.get(&number).copied();
            repeated.unwrap_or_else(|| (surface.triangle(number as usize), 1))
        };
        let painted: Vec<(Triangle<'_>, u32)> = subtree.numbers.iter().map(painted).collect();
        let mut voxels = Vec::new();
        let mut report = VoxelizeReport::default();
        subtree.leaves(cube, |triangles, corner| {
            let mut mix = Mix::default();
            for &triangle in triangles {
                let prepared = &subtree.prepared[triangle as usize];
                let (triangle, times) = &painted[triangle as usize];
                mix.add(triangle, prepared, corner, cube.voxel, voxel_size);
                report.touches += u64::from(*times);
            }
            report.looked_at += triangles.len() as u64;
            if !mix.is_shown(hole) {
                return;
            }
            report.voxels += 1;
            let (color, normal) = mix.finish();
            voxels.push(Voxel {
                index: corner.map(|c| (c / cube.voxel) as i32),
                color,
                normal,
            });
        });
        (voxels, report)
    };
    let mut total = VoxelizeReport::default();
    let mut take = |(voxels, report): (Vec<Voxel>, VoxelizeReport)| {
        total.voxels += report.voxels;
        total.touches += report.touches;
        total.looked_at += report.looked_at;
        voxels.into_iter().for_each(&mut *sink);
    };
    walk(
        surface,
        grid,
        cube,
        numbers,
        &voxels,
        &mut take,
        ("voxelise", progress),
    );
    total
}

/// Pairs of a voxel and a triangle that touches it, at the least: of each triangle its area, or its longest side, in
/// faces of voxels. Equal triangles count as one where there are more than [`MOST_LOOKED_AT`] pairs.
pub fn least_looked_at(surface: &dyn Surface, grid: &Grid) -> u64 {
    let side = grid.cube().voxel as f64;
    let least = |number: u32| {
        let prepared = Prepared::new(grid.corners(surface, number));
        let largest = |of: [i64; 3]| of.iter().fold(0.0f64, |most, &c| most.max(c.abs() as f64));
        let area = largest(prepared.normal) / (2.0 * side * side);
        let length = largest(std::array::from_fn(|k| prepared.high[k] - prepared.low[k])) / side;
        area.max(length).max(1.0) as u64
    };
    let sum = |numbers: &[u32]| numbers.par_iter().map(|&number| least(number)).sum::<u64>();
    let all: Vec<u32> = (0..surface.len() as u32).collect();
    match sum(&all) {
        few if few <= MOST_LOOKED_AT => few,
        _ => sum(&Distinct::of(surface, grid).numbers),
    }
}
