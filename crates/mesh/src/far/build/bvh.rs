//! A bounding volume hierarchy of triangles with four children per node, for rays: every other level of a binary one.

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;

use super::split::{Branch, MOST_LEVELS, split};

const LEAF: usize = 4;
/// The margin of a box, as a share of its extent and of its distance from the origin. It exceeds the rounding of the
/// boxes and of the triangle test.
const WIDER: [f64; 2] = [4e-5, 1e-6];
/// Three nodes wait for every other level. Below [`MOST_LEVELS`] triangles are halved.
const STACK: usize = 3 * (MOST_LEVELS as usize + 32) / 2 + 1;

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

#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Vec3A,
    pub(super) direction: Vec3A,
}

pub(super) fn build(triangles: &[[Vec3A; 3]]) -> (Vec<Node>, Vec<u32>) {
    if triangles.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let corners = |number: usize| triangles[number].map(Vec3A::as_dvec3);
    let (branches, order) = split(triangles.len(), corners, LEAF + 1);
    let mut nodes = Vec::new();
    add_node(&branches, 0, &mut nodes);
    (nodes, order)
}

/// The children are the branch's grandchildren.
fn add_node(branches: &[Branch], place: usize, nodes: &mut Vec<Node>) -> u32 {
    let number = nodes.len();
    let mut node = Node::zeroed();
    node.count = [NONE; 4];
    nodes.push(node);
    let below = |place: usize| match branches[place].children {
        Some([near, far]) => [Some(near), Some(far)],
        None => [Some(place), None],
    };
    let quarters = below(place).map(|half| half.map_or([None; 2], below));
    let quarters = quarters.as_flattened().iter().flatten();
    for (child, &quarter) in quarters.enumerate() {
        let branch = &branches[quarter];
        let (first, count) = match branch.children {
            Some(_) => (add_node(branches, quarter, nodes), 0),
            None => (branch.first as u32, branch.count as u32),
        };
        let farthest = branch.low.abs().max(branch.high.abs()).max_element();
        let wider = WIDER[0] * (branch.high - branch.low).max_element() + WIDER[1] * farthest;
        let node = &mut nodes[number];
        (node.first[child], node.count[child]) = (first, count);
        for axis in 0..3 {
            node.low[axis][child] = (branch.low[axis] - wider) as f32;
            node.high[axis][child] = (branch.high[axis] + wider) as f32;
        }
    }
    number as u32
}

/// Calls `meet` with triangles that a ray may meet before `most`, near boxes first. It returns the distance before
/// which the ray is followed on.
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
