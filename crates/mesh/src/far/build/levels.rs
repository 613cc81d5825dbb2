//! Coarser nodes above the root, the choice of nodes that have voxels, and their rays (`spec/far.md`, Grid).

use rayon::prelude::*;

use super::node::{MOST_RAYS, Maker};
use super::sample::Rays;
use super::split::Branch;
use super::touch::{self, Touches};
use crate::texture::paint::Paint;
use shiftvox::graph::Progress;

/// Rays for each kept voxel, if no number is given.
const RAYS_PER_VOXEL: u32 = 20;

/// Of the side of the next node above that has voxels.
const STEP: f64 = 0.7;
/// Most voxels of a node per triangle. So many take 180 bytes or more, a triangle 15 to 35.
const MOST_VOXELS: usize = 16;
/// Where triangles fill their voxels. Then a pixel sees one, and they cost less than the voxels and look better.
const MOST_FILLED_VOXELS: usize = 2;
/// Of a voxel's face, the mean area of triangles in it. Blades of grass have 0.2, leaves 0.5, solids 0.6 to 1.1.
const FILLED: f64 = 0.6;

/// Whether a node is drawn as its triangles instead of voxels.
fn is_left_out(touched: &Touches, triangles: usize) -> bool {
    let is_filled = touched.faces >= FILLED * f64::from(touched.voxels);
    let most = match is_filled {
        true => MOST_FILLED_VOXELS,
        false => MOST_VOXELS,
    };
    touched.voxels as usize / most >= triangles
}

/// The rays of each node, none where it has no voxels.
pub(super) fn rays(
    maker: &Maker<'_>,
    branches: &[Branch],
    progress: &dyn Progress,
) -> Vec<Option<Rays>> {
    let Maker {
        options,
        triangles,
        coarser,
        ..
    } = *maker;
    let surface = triangles.surface;
    progress.begin("find voxels", surface.len() as u64);
    // A hybrid keeps all its nodes, unless most are of voxels, which may take more than their triangles.
    let is_painted = |&number: &usize| {
        let (paint, _) = maker.textures.paint(&surface.triangle(number));
        paint != Paint::NONE
    };
    let painted = (0..surface.len()).filter(is_painted);
    let keeps_nodes = options.hybrid && 2 * painted.count() <= surface.len();
    let mut has_voxels = match options.hybrid {
        true => vec![true; branches.len()],
        false => with_voxels(branches, coarser),
    };
    let touched = |(number, branch): (usize, &Branch)| {
        if branch.children.is_none() {
            progress.advance(branch.count as u64);
            return None;
        }
        let grid = has_voxels[number].then(|| maker.grid(number, branch))?;
        let may_be_left = !keeps_nodes && number > coarser;
        let is_of_use = options.rays.is_some() || may_be_left;
        let corners = branch.triangles().map(|number| triangles.corners(number));
        is_of_use.then(|| touch::count(&grid, corners))
    };
    let touched: Vec<Option<Touches>> = branches.par_iter().enumerate().map(touched).collect();
    if !keeps_nodes {
        let counted = branches.iter().zip(&touched).zip(&mut has_voxels);
        for ((branch, touched), has_voxels) in counted.skip(coarser + 1) {
            let touched = touched.as_ref();
            *has_voxels &= !touched.is_some_and(|n| is_left_out(n, branch.count));
        }
    }
    progress.end();
    let voxels = |number: usize| match &touched[number] {
        Some(touched) if has_voxels[number] => touched.voxels,
        _ => 0,
    };
    let all: u64 = (0..branches.len())
        .map(|number| u64::from(voxels(number)))
        .sum();
    let share = |number: usize| match options.rays {
        None => Rays::PerVoxel(RAYS_PER_VOXEL),
        Some(rays) => {
            let own = voxels(number);
            let share = u128::from(rays) * u128::from(own) / u128::from(all.max(1));
            Rays::InAll(share.clamp(u128::from(own > 0), u128::from(MOST_RAYS)) as u32)
        }
    };
    (0..branches.len())
        .map(|number| has_voxels[number].then(|| share(number)))
        .collect()
}

/// Whether each node is a leaf or has voxels; `coarser` nodes above the root of the hierarchy, and the root, have.
fn with_voxels(branches: &[Branch], coarser: usize) -> Vec<bool> {
    let mut has_voxels = vec![true; branches.len()];
    let mut above = vec![f64::INFINITY; branches.len()];
    for (number, branch) in branches.iter().enumerate() {
        let Some(children) = branch.children else {
            continue;
        };
        let side = (branch.high - branch.low).max_element();
        has_voxels[number] = number <= coarser || side <= STEP * above[number];
        for child in children.into_iter().filter(|&child| child > 0) {
            above[child] = if has_voxels[number] {
                side
            } else {
                above[number]
            };
        }
    }
    has_voxels
}

/// The fewest voxels along a node above another one. Thin tubes would lose area in larger voxels.
const LEAST: u32 = 32;

/// Puts nodes of half the voxels along a side, and so on, above a root with children. Returns how many.
pub(super) fn put_above(branches: &mut Vec<Branch>, grid: u32) -> usize {
    let Some(root) = branches.first().filter(|root| root.children.is_some()) else {
        return 0;
    };
    let count = (grid / LEAST).max(1).ilog2();
    let coarser: Vec<Branch> = (0..count)
        .map(|level| Branch {
            level,
            // No node's second child is the first of all.
            children: Some([level as usize + 1, 0]),
            ..root.clone()
        })
        .collect();
    for branch in branches.iter_mut() {
        branch.level += count;
        if let Some(children) = &mut branch.children {
            *children = children.map(|child| child + count as usize);
        }
    }
    branches.splice(0..0, coarser);
    count as usize
}
