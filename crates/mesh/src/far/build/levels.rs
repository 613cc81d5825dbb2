//! The nodes that have voxels.
//!
//! A box is halved across one axis, so its longest side, and with it the size of its voxels, is often that of the box
//! above. Such a node would repeat the voxels of the one above, so it has none and its children are drawn instead.
//!
//! A node whose triangles each cover many voxels has none either. The voxels would take more bytes than the triangles,
//! and would be drawn only where the triangles are large in the picture.

use super::split::Branch;

/// A node has voxels if they are at most this share of those of the next node above that has.
const STEP: f64 = 0.7;
/// Most voxels of a node for each of its triangles. So many take 180 bytes or more, a triangle 15 to 35.
const MOST_VOXELS: usize = 16;

/// Whether triangles touch too many voxels. Given all voxels of a grid, whether they could.
pub(super) fn is_dense(touched: usize, triangles: usize) -> bool {
    touched / MOST_VOXELS >= triangles
}

/// Of each node whether it is a leaf or has voxels. `coarser` is the number of nodes above the root of the hierarchy.
/// These and the root have voxels.
pub(super) fn with_voxels(branches: &[Branch], coarser: usize) -> Vec<bool> {
    let mut has_voxels = vec![true; branches.len()];
    // The longest side of the next box above that has voxels; parents come first.
    let mut above = vec![f64::INFINITY; branches.len()];
    for (number, branch) in branches.iter().enumerate() {
        let Some(children) = branch.children else {
            continue;
        };
        let side = (branch.high - branch.low).max_element();
        has_voxels[number] = number <= coarser || side <= STEP * above[number];
        let nearest = if has_voxels[number] {
            side
        } else {
            above[number]
        };
        // A second child of number 0 is none.
        for child in children.into_iter().filter(|&child| child > 0) {
            above[child] = nearest;
        }
    }
    has_voxels
}

/// Leaves out nodes below the root of which triangles touch too many voxels; of those that were counted.
pub(super) fn leave_out_dense(
    has_voxels: &mut [bool],
    branches: &[Branch],
    touched: &[Option<u32>],
    coarser: usize,
) {
    let counted = branches.iter().zip(touched).zip(has_voxels);
    for ((branch, touched), has_voxels) in counted.skip(coarser + 1) {
        *has_voxels &= touched.is_none_or(|n| !is_dense(n as usize, branch.count));
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn dense_nodes_have_sixteen_voxels_per_triangle_or_more() {
        assert!(is_dense(160, 10) && !is_dense(159, 10));
        // A grid of 64 voxels along a side holds no more.
        assert!(is_dense(64 * 64 * 64, 16_384) && !is_dense(64 * 64 * 64, 16_385));
    }

    #[test]
    fn a_box_halved_across_another_axis_has_no_voxels() {
        // A coarser node, the root, a chain of halves across x, y, z and x, and a leaf.
        let rows = [
            ([8.0, 8.0, 8.0], Some([1, 0]), true),
            ([8.0, 8.0, 8.0], Some([2, 6]), true),
            ([4.0, 8.0, 8.0], Some([3, 6]), false),
            ([4.0, 4.0, 8.0], Some([4, 6]), false),
            ([4.0, 4.0, 4.0], Some([5, 6]), true),
            ([2.0, 4.0, 4.0], Some([6, 6]), false),
            ([2.0, 2.0, 4.0], None, true),
        ];
        let branch = |level: usize| Branch {
            low: DVec3::ZERO,
            high: rows[level].0.into(),
            level: level as u32,
            first: 0,
            count: 1,
            children: rows[level].1,
        };
        let branches: Vec<Branch> = (0..7).map(branch).collect();
        assert_eq!(with_voxels(&branches, 1), rows.map(|row| row.2));
    }
}
