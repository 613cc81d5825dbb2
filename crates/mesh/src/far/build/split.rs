//! The hierarchy, by the surface area heuristic. A node's triangles are a range.

use std::ops::Range;

use glam::DVec3;

use crate::geometry::bounds;

const SLICES: usize = 32;
pub(super) const MOST_LEVELS: u32 = 64;
const PARALLEL: usize = 4096;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Branch {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    pub(super) level: u32,
    pub(super) first: usize,
    pub(super) count: usize,
    /// The places of the children in the list, or `None` for a leaf.
    pub(super) children: Option<[usize; 2]>,
}

impl Branch {
    pub(super) fn triangles(&self) -> Range<usize> {
        self.first..self.first + self.count
    }
}

struct Tree {
    low: DVec3,
    high: DVec3,
    count: usize,
    halves: Option<Box<[Tree; 2]>>,
}

/// Splits until a node has fewer triangles than `leaf_triangles` (or one). Returns the nodes, parents first, and the
/// triangles' numbers in their order.
pub(super) fn split(
    count: usize,
    corners: impl Fn(usize) -> [DVec3; 3] + Sync,
    leaf_triangles: usize,
) -> (Vec<Branch>, Vec<u32>) {
    let box_of = |number: u32| {
        let [a, b, c] = corners(number as usize);
        Slice {
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            count: 1,
        }
    };
    let mut numbers: Vec<u32> = (0..count as u32).collect();
    let tree = tree(&mut numbers, &box_of, leaf_triangles, 0);
    let mut branches = Vec::new();
    flatten(&tree, 0, 0, &mut branches);
    (branches, numbers)
}

fn flatten(tree: &Tree, level: u32, first: usize, branches: &mut Vec<Branch>) -> usize {
    let place = branches.len();
    branches.push(Branch {
        low: tree.low,
        high: tree.high,
        level,
        first,
        count: tree.count,
        children: None,
    });
    if let Some(halves) = &tree.halves {
        let near = flatten(&halves[0], level + 1, first, branches);
        let far = flatten(&halves[1], level + 1, first + halves[0].count, branches);
        branches[place].children = Some([near, far]);
    }
    place
}

type BoxOf<'f> = dyn Fn(u32) -> Slice + Sync + 'f;

fn tree(numbers: &mut [u32], box_of: &BoxOf<'_>, leaf_triangles: usize, level: u32) -> Tree {
    let boxes = numbers.iter().map(|&number| box_of(number));
    let Slice { low, high, count } = boxes.fold(Slice::NONE, Slice::with);
    let halves = (count >= leaf_triangles && count > 1).then(|| {
        let middle = match level < MOST_LEVELS {
            true => partition(numbers, box_of),
            false => count / 2,
        };
        let (near, far) = numbers.split_at_mut(middle);
        let below = |numbers| tree(numbers, box_of, leaf_triangles, level + 1);
        let (near, far) = if count >= PARALLEL {
            rayon::join(|| below(near), || below(far))
        } else {
            (below(near), below(far))
        };
        Box::new([near, far])
    });
    Tree {
        low,
        high,
        count,
        halves,
    }
}

#[derive(Clone, Copy)]
struct Slice {
    low: DVec3,
    high: DVec3,
    count: usize,
}

impl Slice {
    const NONE: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        count: 0,
    };

    fn middle(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            count: self.count + other.count,
        }
    }

    /// Half of the area of the box, times the number of triangles.
    fn cost(&self) -> f64 {
        let side = (self.high - self.low).max(DVec3::ZERO);
        (side.x * side.y + side.y * side.z + side.z * side.x) * self.count as f64
    }
}

fn partition(numbers: &mut [u32], box_of: &BoxOf<'_>) -> usize {
    let boxes = || numbers.iter().map(|&number| box_of(number));
    let (low, high) = bounds(boxes().map(|of| of.middle()));
    let mut all = [[Slice::NONE; SLICES]; 3];
    for of in boxes() {
        for (axis, slices) in all.iter_mut().enumerate() {
            let slice = &mut slices[slice_of(axis, low, high, &of)];
            *slice = slice.with(of);
        }
    }
    let mut best: Option<(f64, usize, usize)> = None;
    for (axis, slices) in all.iter().enumerate() {
        if high[axis] <= low[axis] {
            continue;
        }
        let mut behind = [Slice::NONE; SLICES];
        let mut sum = Slice::NONE;
        for i in (1..SLICES).rev() {
            sum = sum.with(slices[i]);
            behind[i] = sum;
        }
        let mut before = Slice::NONE;
        for plane in 1..SLICES {
            before = before.with(slices[plane - 1]);
            if before.count == 0 || behind[plane].count == 0 {
                continue;
            }
            let cost = before.cost() + behind[plane].cost();
            if best.is_none_or(|(least, _, _)| cost < least) {
                best = Some((cost, axis, plane));
            }
        }
    }
    let Some((_, axis, plane)) = best else {
        return numbers.len() / 2;
    };
    // Stable, so that the order does not depend on how it is done.
    let is_near = |&&number: &&u32| slice_of(axis, low, high, &box_of(number)) < plane;
    let (near, far): (Vec<u32>, Vec<u32>) = numbers.iter().partition(is_near);
    numbers[..near.len()].copy_from_slice(&near);
    numbers[near.len()..].copy_from_slice(&far);
    near.len()
}

fn slice_of(axis: usize, low: DVec3, high: DVec3, of: &Slice) -> usize {
    let scale = SLICES as f64 / (high[axis] - low[axis]);
    let slice = ((of.middle()[axis] - low[axis]) * scale) as usize;
    slice.min(SLICES - 1)
}
