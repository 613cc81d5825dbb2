//! Coarser nodes above the root of the hierarchy, each with one child: for pictures smaller than the
//! root's grid.

use super::split::Branch;

/// The fewest voxels along a node above another one. Thin tubes would lose area in larger voxels.
const LEAST: [u32; 2] = [32, 16];

/// Puts nodes of half the voxels along a side, and so on, above the root, unless that is a leaf.
/// Gives how many.
pub(super) fn put_above(branches: &mut Vec<Branch>, grid: u32, hybrid: bool) -> usize {
    let Some(root) = branches.first().filter(|root| root.children.is_some()) else {
        return 0;
    };
    let count = (grid / LEAST[usize::from(hybrid)]).max(1).ilog2();
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

/// Voxels along a node's longest side, of a hierarchy with so many coarser ones.
pub(super) fn grid_of(number: usize, coarser: usize, grid: u32) -> u32 {
    grid >> coarser.saturating_sub(number)
}
