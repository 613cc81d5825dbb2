//! A bounding volume hierarchy of triangles with four children per node, for rays.
//!
//! It is built from the top by the surface area heuristic. The triangles of a node are sorted into 16 bins along each
//! axis, and cut where the cost of the two sides is least. Two such cuts make four children, whose boxes are tested
//! together.

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;

/// Most triangles of a leaf.
const LEAF: usize = 4;
/// Bins along an axis.
const BINS: usize = 16;
/// The margin of a triangle's box, as a share of its extent and of its distance from the origin. It exceeds the
/// rounding of the boxes and of the triangle test.
const WIDER: [f32; 2] = [4e-5, 1e-6];
/// Levels below which triangles are cut in equal halves, so that hierarchies are not deep: 2^32 triangles in equal
/// quarters have 16 more.
const UNEQUAL_LEVELS: u32 = 32;
/// Most nodes that wait on the way down: three on each level.
const STACK: usize = 3 * (UNEQUAL_LEVELS as usize + 16) + 1;

/// Four children: their boxes by axis, and their kinds.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Node {
    low: [[f32; 4]; 3],
    high: [[f32; 4]; 3],
    /// A node's number, or the place of a leaf's first triangle.
    first: [u32; 4],
    /// The number of a leaf's triangles, 0 for a node, or [`NONE`] for no child.
    count: [u32; 4],
}

const NONE: u32 = u32::MAX;

/// A ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Vec3A,
    /// Unit vector.
    pub(super) direction: Vec3A,
}

/// A box around some triangles.
#[derive(Debug, Clone, Copy)]
struct Extent {
    low: Vec3A,
    high: Vec3A,
}

impl Extent {
    const EMPTY: Self = Self {
        low: Vec3A::splat(f32::INFINITY),
        high: Vec3A::splat(f32::NEG_INFINITY),
    };

    fn of(corners: &[Vec3A; 3]) -> Self {
        let [a, b, c] = *corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let farthest = low.abs().max(high.abs()).max_element();
        let wider = WIDER[0] * (high - low).max_element() + WIDER[1] * farthest;
        Self {
            low: low - wider,
            high: high + wider,
        }
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn middle(self) -> Vec3A {
        (self.low + self.high) * 0.5
    }

    /// Half the surface.
    fn area(self) -> f32 {
        let size = (self.high - self.low).max(Vec3A::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// Builds the nodes of a hierarchy, the root first, and the order in which they have the triangles.
pub(super) fn build(triangles: &[[Vec3A; 3]]) -> (Vec<Node>, Vec<u32>) {
    let mut build = Build {
        boxes: triangles.iter().map(Extent::of).collect(),
        order: (0..triangles.len() as u32).collect(),
        nodes: Vec::new(),
    };
    if !triangles.is_empty() {
        build.node(0, triangles.len(), 0);
    }
    (build.nodes, build.order)
}

struct Build {
    boxes: Vec<Extent>,
    order: Vec<u32>,
    nodes: Vec<Node>,
}

impl Build {
    /// Makes the node of some triangles, by their places in the order; returns its number.
    fn node(&mut self, from: usize, to: usize, level: u32) -> u32 {
        let number = self.nodes.len();
        let mut node = Node::zeroed();
        node.count = [NONE; 4];
        self.nodes.push(node);
        let is_equal = level >= UNEQUAL_LEVELS;
        let middle = self.cut(from, to, is_equal);
        let halves = [(from, middle), (middle, to)];
        let quarters = halves.map(|(from, to)| match to - from > LEAF {
            true => {
                let middle = self.cut(from, to, is_equal);
                [(from, middle), (middle, to)]
            }
            false => [(from, to), (to, to)],
        });
        for (child, &(from, to)) in quarters.as_flattened().iter().enumerate() {
            if from == to {
                continue;
            }
            let (first, count) = match to - from > LEAF {
                true => (self.node(from, to, level + 1), 0),
                false => (from as u32, (to - from) as u32),
            };
            let extent = self.extent(from, to);
            let node = &mut self.nodes[number];
            (node.first[child], node.count[child]) = (first, count);
            for axis in 0..3 {
                node.low[axis][child] = extent.low[axis];
                node.high[axis][child] = extent.high[axis];
            }
        }
        number as u32
    }

    fn extent(&self, from: usize, to: usize) -> Extent {
        let boxes = self.order[from..to].iter();
        boxes.fold(Extent::EMPTY, |all, &triangle| {
            all.with(self.boxes[triangle as usize])
        })
    }

    /// Sorts some triangles to both sides of the best cut, or of one into halves; returns the place of the first
    /// behind it.
    fn cut(&mut self, from: usize, to: usize, is_equal: bool) -> usize {
        let half = from + (to - from).div_ceil(2);
        let (mut low, mut high) = (Extent::EMPTY.low, Extent::EMPTY.high);
        for &triangle in &self.order[from..to] {
            let middle = self.boxes[triangle as usize].middle();
            (low, high) = (low.min(middle), high.max(middle));
        }
        let size = high - low;
        let mut best = (f32::INFINITY, 0, 0);
        for axis in 0..3 {
            let scale = BINS as f32 / size[axis];
            if !scale.is_finite() {
                continue;
            }
            let mut bins = [(Extent::EMPTY, 0u32); BINS];
            for &triangle in &self.order[from..to] {
                let extent = self.boxes[triangle as usize];
                let bin = &mut bins[bin_of(extent, axis, low, scale)];
                *bin = (bin.0.with(extent), bin.1 + 1);
            }
            // The bounds and counts behind each cut, from the last one on.
            let mut behind = [0.0; BINS];
            let mut all = (Extent::EMPTY, 0);
            for cut in (1..BINS).rev() {
                all = (all.0.with(bins[cut].0), all.1 + bins[cut].1);
                behind[cut] = all.0.area() * all.1 as f32;
            }
            let mut before = (Extent::EMPTY, 0);
            for cut in 1..BINS {
                before = (before.0.with(bins[cut - 1].0), before.1 + bins[cut - 1].1);
                let cost = before.0.area() * before.1 as f32 + behind[cut];
                if before.1 > 0 && (before.1 as usize) < to - from && cost < best.0 {
                    best = (cost, axis, cut);
                }
            }
        }
        let (cost, axis, cut) = best;
        if is_equal || !cost.is_finite() {
            // Without a best cut all are in one place: any halves do.
            return half;
        }
        let scale = BINS as f32 / size[axis];
        let (mut left, mut right) = (from, to);
        while left < right {
            let extent = self.boxes[self.order[left] as usize];
            if bin_of(extent, axis, low, scale) < cut {
                left += 1;
            } else {
                right -= 1;
                self.order.swap(left, right);
            }
        }
        left
    }
}

fn bin_of(extent: Extent, axis: usize, low: Vec3A, scale: f32) -> usize {
    (((extent.middle() - low)[axis] * scale) as usize).min(BINS - 1)
}

/// Calls `meet` with the place of each triangle that a ray may meet before `most`, near boxes first. `meet` returns the
/// distance before which the ray is followed on.
pub(super) fn traverse(
    nodes: &[Node],
    ray: &Ray,
    mut most: f32,
    mut meet: impl FnMut(usize) -> f32,
) {
    if nodes.is_empty() {
        return;
    }
    let per_unit = ray.direction.recip().to_array();
    let origin = ray.origin.to_array();
    let mut stack = [(0.0f32, 0u32); STACK];
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let (enters, number) = stack[height];
        if enters > most {
            continue;
        }
        let node = &nodes[number as usize];
        // A ray within a plane of a box gives what is not a number there: it compares as false, and counts as within.
        let (mut enter, mut leave) = ([0.0f32; 4], [most; 4]);
        for axis in 0..3 {
            let (near, far) = match per_unit[axis].is_sign_negative() {
                false => (&node.low[axis], &node.high[axis]),
                true => (&node.high[axis], &node.low[axis]),
            };
            for child in 0..4 {
                let enters = (near[child] - origin[axis]) * per_unit[axis];
                let leaves = (far[child] - origin[axis]) * per_unit[axis];
                enter[child] = if enters > enter[child] {
                    enters
                } else {
                    enter[child]
                };
                leave[child] = if leaves < leave[child] {
                    leaves
                } else {
                    leave[child]
                };
            }
        }
        let first_new = height;
        for child in 0..4 {
            let count = node.count[child];
            // Rounding: a few units of the last place.
            if count == NONE || enter[child] > leave[child] * (1.0 + 1e-6) {
                continue;
            }
            if count > 0 {
                let first = node.first[child] as usize;
                for place in first..first + count as usize {
                    most = most.min(meet(place));
                }
                continue;
            }
            // The farthest lowest on the stack.
            let mut place = height;
            while place > first_new && stack[place - 1].0 < enter[child] {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = (enter[child], node.first[child]);
            height += 1;
        }
    }
}
