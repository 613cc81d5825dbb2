//! Normals of voxels that have none, from the surface around them.
//!
//! Around each voxel, its 5 x 5 x 5 neighbourhood is taken as a heap of mass
//! (weights 1 2 2 2 1 along each axis). Where the heap lies to one side of
//! the voxel, as at the face, edge or corner of a solid, the normal points
//! away from its centre of mass. Where it lies all around, as in a wall one
//! voxel thick, that direction is noise, and the normal is the direction in
//! which the heap is thinnest (the least axis of its covariance), turned away
//! from the heap or else from the middle of the object. A wall that thin has two sides,
//! and which one is *out* cannot be known from it: a viewer may turn such a
//! normal towards the eye.
//!
//! A voxel alone in its neighbourhood, or with all of it filled, has none.
//!
//! Speed comes from bricks of 4^3 voxels, 64 bits each: the node two levels
//! above the finest, its children's masks its bits. Its 26 neighbours come
//! down the tree with it: a child's neighbours are children of its parent's
//! neighbours. In a brick, a row of five voxels is an entry of a table.

use glam::DVec3;
use rayon::prelude::*;

use super::{PackedNormal, Progress, Topology};

/// `neighbours` where there is no node.
const ABSENT: u32 = u32::MAX;
/// Nodes of one level around and including a node: `(x * 3 + y) * 3 + z`.
type Neighbours = [u32; 27];
/// The node itself among its neighbours.
const SELF: usize = 13;
/// Most pieces that the work is split into.
const MAX_PIECES: usize = 4096;

/// Weight of a voxel by its distance along an axis, -2 to 2.
const WEIGHT: [i32; 5] = [1, 2, 2, 2, 1];
/// Mass of a full neighbourhood.
const FULL_MASS: i32 = 8 * 8 * 8;
/// Mass of a voxel alone.
const LONE_MASS: i32 = 2 * 2 * 2;
/// A centre of mass at least this far off, in voxels, tells the normal by
/// itself: 0.8 is a flat face, 0.45 a concave edge, 0.5 a wall of two.
const ONE_SIDED: f64 = 0.6;
/// How much the middle of the object has to say about which side is out,
/// against the offset of the centre of mass in voxels.
const OUTWARD_SHARE: f64 = 0.3;

/// What the estimate is made from: a tree stored level by level.
pub(super) struct Estimate<'t> {
    pub(super) topology: &'t [Topology],
    pub(super) level_start: &'t [u32],
    pub(super) depth: u32,
    /// Middle of the object, finest voxels.
    pub(super) centre: [f64; 3],
}

/// A subtree and the part of the finest level that it owns.
struct Piece {
    corner: [i32; 3],
    neighbours: Neighbours,
}

impl Estimate<'_> {
    /// Writes the normals of those finest voxels that have none.
    pub(super) fn fill(&self, normals: &mut [PackedNormal], progress: &dyn Progress) {
        if normals.iter().all(|normal| !normal.is_none()) {
            return;
        }
        progress.begin("estimate normals", normals.len() as u64);
        if let Some(brick_level) = self.depth.checked_sub(2) {
            self.fill_bricks(brick_level, normals, progress);
        } else {
            // One brick holds it all; a smaller object lies in its low corner.
            let mask = self.topology.first().map_or(1, |root| root.mask);
            let mut rows = [[0u8; 8]; 8];
            put(&mut rows, SELF, to_rows(u64::from(mask)));
            self.fill_brick(&rows, u64::from(mask), [0; 3], normals);
        }
        progress.end();
    }

    fn fill_bricks(&self, level: u32, normals: &mut [PackedNormal], progress: &dyn Progress) {
        let first_brick = self.level_start[level as usize];
        let bricks: Vec<u64> = (first_brick..self.level_start[level as usize + 1])
            .into_par_iter()
            .map(|node| self.brick(node))
            .collect();
        let (split_level, pieces) = self.pieces(level);

        // Pieces are in Morton order, so each owns the next part of the level.
        let mut rest = normals;
        let mut work = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let own = self.voxels_below(piece.neighbours[SELF], split_level);
            let (mine, others) = std::mem::take(&mut rest).split_at_mut(own);
            rest = others;
            work.push((piece, mine));
        }
        work.into_par_iter().for_each(|(piece, own)| {
            let mut walk = Walk {
                estimate: self,
                brick_level: level,
                first_brick,
                bricks: &bricks,
                next: 0,
                normals: own,
            };
            walk.descend(split_level, piece.corner, &piece.neighbours);
            progress.advance(walk.normals.len() as u64);
        });
    }

    /// The occupancy of a brick, bits in Morton order.
    fn brick(&self, node: u32) -> u64 {
        let Topology { first, mask, .. } = self.topology[node as usize];
        let mut word = 0u64;
        let mut child = first;
        for octant in (0..8).filter(|octant| mask >> octant & 1 == 1) {
            word |= u64::from(self.topology[child as usize].mask) << (8 * octant);
            child += 1;
        }
        word
    }

    /// Nodes of the deepest level, no deeper than the bricks, that has few
    /// enough of them; in Morton order.
    fn pieces(&self, brick_level: u32) -> (u32, Vec<Piece>) {
        let mut neighbours = [ABSENT; 27];
        neighbours[SELF] = 0;
        let mut pieces = vec![Piece {
            corner: [0; 3],
            neighbours,
        }];
        let mut level = 0;
        while level < brick_level {
            let below = level as usize + 1;
            if self.level_start[below + 1] - self.level_start[below] > MAX_PIECES as u32 {
                break;
            }
            let mut finer = Vec::new();
            for piece in &pieces {
                self.for_children(level, piece.corner, &piece.neighbours, |corner, n| {
                    finer.push(Piece {
                        corner,
                        neighbours: *n,
                    });
                });
            }
            pieces = finer;
            level += 1;
        }
        (level, pieces)
    }

    /// Finest voxels below a node.
    fn voxels_below(&self, node: u32, level: u32) -> usize {
        let first_voxel = |mut node: u32| {
            for below in level..self.depth {
                // Past the last node of a level comes the end of the next.
                node = if node == self.level_start[below as usize + 1] {
                    self.level_start[below as usize + 2]
                } else {
                    self.topology[node as usize].first
                };
            }
            node
        };
        (first_voxel(node + 1) - first_voxel(node)) as usize
    }

    /// Calls with the corner and the neighbours of each child of a node.
    #[inline]
    fn for_children(
        &self,
        level: u32,
        corner: [i32; 3],
        neighbours: &Neighbours,
        mut call: impl FnMut([i32; 3], &Neighbours),
    ) {
        let around = neighbours.map(|node| {
            if node == ABSENT {
                Topology::default()
            } else {
                self.topology[node as usize]
            }
        });
        let mask = around[SELF].mask;
        let side = 1i32 << (self.depth - level - 1);
        for octant in (0..8usize).filter(|octant| mask >> octant & 1 == 1) {
            let mut of_child = [ABSENT; 27];
            for (slot, (parent, child)) in of_child.iter_mut().zip(CHILD_NEIGHBOURS[octant]) {
                let Topology { first, mask, .. } = around[usize::from(parent)];
                if mask >> child & 1 == 1 {
                    *slot = first + (mask & ((1u8 << child) - 1)).count_ones();
                }
            }
            let along = |k: usize| corner[k] + side * (octant >> (2 - k) & 1) as i32;
            call([along(0), along(1), along(2)], &of_child);
        }
    }

    /// Writes the normals of a brick's voxels, given in Morton order.
    fn fill_brick(
        &self,
        rows: &[[u8; 8]; 8],
        word: u64,
        corner: [i32; 3],
        normals: &mut [PackedNormal],
    ) {
        let set_bits = (0..64usize).filter(|bit| word >> bit & 1 == 1);
        for (bit, normal) in set_bits.zip(normals) {
            if !normal.is_none() {
                continue;
            }
            let at = MORTON_TO_XYZ[bit];
            let moments = Moments::around(rows, at);
            let outward = [0, 1, 2]
                .map(|k| f64::from(corner[k]) + at[k] as f64 + 0.5 - self.centre[k]);
            *normal = moments.normal(DVec3::from_array(outward));
        }
    }
}

/// For each octant and each of its 27 neighbours: which neighbour of the
/// parent holds it, and as which octant.
const CHILD_NEIGHBOURS: [[(u8, u8); 27]; 8] = {
    let mut table = [[(0, 0); 27]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut neighbour = 0;
        while neighbour < 27 {
            // Positions in the parent's 6^3 grid of octants, 0 to 5.
            let x = 2 + (octant >> 2 & 1) + neighbour / 9 - 1;
            let y = 2 + (octant >> 1 & 1) + neighbour / 3 % 3 - 1;
            let z = 2 + (octant & 1) + neighbour % 3 - 1;
            let parent = (x / 2 * 3 + y / 2) * 3 + z / 2;
            let child = (x % 2) << 2 | (y % 2) << 1 | z % 2;
            table[octant][neighbour] = (parent as u8, child as u8);
            neighbour += 1;
        }
        octant += 1;
    }
    table
};

/// Place in the brick of each bit of its word.
const MORTON_TO_XYZ: [[usize; 3]; 64] = {
    let mut table = [[0; 3]; 64];
    let mut bit = 0;
    while bit < 64 {
        let mut axis = 0;
        while axis < 3 {
            table[bit][axis] = (bit >> (5 - axis) & 1) << 1 | (bit >> (2 - axis) & 1);
            axis += 1;
        }
        bit += 1;
    }
    table
};

/// The bits of a brick by rows: bit `z * 16 + y * 4 + x`.
fn to_rows(word: u64) -> u64 {
    let mut rows = 0u64;
    let mut left = word;
    while left != 0 {
        let [x, y, z] = MORTON_TO_XYZ[left.trailing_zeros() as usize];
        rows |= 1 << (z * 16 + y * 4 + x);
        left &= left - 1;
    }
    rows
}

/// Puts a neighbouring brick into the 8^3 voxels around a brick, of which
/// its own are 2 to 5: `rows[z][y]`, bit x.
fn put(rows: &mut [[u8; 8]; 8], neighbour: usize, brick_rows: u64) {
    /// First place in the window, first place in the brick, how many.
    const SPAN: [(usize, usize, usize); 3] = [(0, 2, 2), (2, 0, 4), (6, 0, 2)];
    let (to_x, from_x, count_x) = SPAN[neighbour / 9];
    let (to_y, from_y, count_y) = SPAN[neighbour / 3 % 3];
    let (to_z, from_z, count_z) = SPAN[neighbour % 3];
    let keep = (1u8 << count_x) - 1;
    for k in 0..count_z {
        for j in 0..count_y {
            let row = brick_rows >> ((from_z + k) * 16 + (from_y + j) * 4 + from_x);
            rows[to_z + k][to_y + j] |= (row as u8 & keep) << to_x;
        }
    }
}

/// A walk over the bricks of a piece, in Morton order.
struct Walk<'w> {
    estimate: &'w Estimate<'w>,
    brick_level: u32,
    first_brick: u32,
    bricks: &'w [u64],
    /// The next voxel of the piece.
    next: usize,
    normals: &'w mut [PackedNormal],
}

impl Walk<'_> {
    fn descend(&mut self, level: u32, corner: [i32; 3], neighbours: &Neighbours) {
        if level < self.brick_level {
            let estimate = self.estimate;
            estimate.for_children(level, corner, neighbours, |corner, of_child| {
                self.descend(level + 1, corner, of_child);
            });
            return;
        }
        let word_of = |node: u32| self.bricks[(node - self.first_brick) as usize];
        let mut rows = [[0u8; 8]; 8];
        for (slot, &node) in neighbours.iter().enumerate() {
            if node != ABSENT {
                put(&mut rows, slot, to_rows(word_of(node)));
            }
        }
        let word = word_of(neighbours[SELF]);
        let end = self.next + word.count_ones() as usize;
        self.estimate
            .fill_brick(&rows, word, corner, &mut self.normals[self.next..end]);
        self.next = end;
    }
}

/// Mass, first and second moments of a row of five voxels, by its bits.
const ROW_MOMENTS: [[i32; 3]; 32] = {
    let mut table = [[0; 3]; 32];
    let mut bits = 0;
    while bits < 32 {
        let mut place = 0;
        while place < 5 {
            if bits >> place & 1 == 1 {
                let distance = place as i32 - 2;
                table[bits][0] += WEIGHT[place];
                table[bits][1] += WEIGHT[place] * distance;
                table[bits][2] += WEIGHT[place] * distance * distance;
            }
            place += 1;
        }
        bits += 1;
    }
    table
};

/// Moments of the filled part of a voxel's neighbourhood, about the voxel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Moments {
    mass: i32,
    first: [i32; 3],
    /// xx, yy, zz, xy, xz, yz.
    second: [i32; 6],
}

impl Moments {
    #[inline]
    fn around(rows: &[[u8; 8]; 8], [x, y, z]: [usize; 3]) -> Self {
        let mut sum = Self::default();
        for (k, weight_z) in WEIGHT.iter().enumerate() {
            let mut plane = [0i32; 6];
            for (j, weight_y) in WEIGHT.iter().enumerate() {
                let [mass, mx, mxx] = ROW_MOMENTS[usize::from(rows[z + k][y + j] >> x & 31)];
                let dy = j as i32 - 2;
                plane[0] += weight_y * mass;
                plane[1] += weight_y * mx;
                plane[2] += weight_y * dy * mass;
                plane[3] += weight_y * mxx;
                plane[4] += weight_y * dy * dy * mass;
                plane[5] += weight_y * dy * mx;
            }
            let [mass, mx, my, mxx, myy, mxy] = plane.map(|moment| moment * weight_z);
            let dz = k as i32 - 2;
            sum.mass += mass;
            sum.first[0] += mx;
            sum.first[1] += my;
            sum.first[2] += dz * mass;
            sum.second[0] += mxx;
            sum.second[1] += myy;
            sum.second[2] += dz * dz * mass;
            sum.second[3] += mxy;
            sum.second[4] += dz * mx;
            sum.second[5] += dz * my;
        }
        sum
    }

    fn normal(&self, outward: DVec3) -> PackedNormal {
        if self.mass == FULL_MASS || self.mass <= LONE_MASS {
            return PackedNormal::NONE;
        }
        let mass = f64::from(self.mass);
        let mean = DVec3::from_array(self.first.map(f64::from)) / mass;
        if mean.length_squared() >= ONE_SIDED * ONE_SIDED {
            return PackedNormal::encode(-mean);
        }
        let thin = thinnest(&self.second.map(|moment| f64::from(moment) / mass), mean);
        let hint = outward.normalize_or_zero() * OUTWARD_SHARE - mean;
        let turned = thin.map(|column| column.dot(hint));
        let direction = DVec3::from_array(turned);
        if direction.length() > 0.02 {
            return PackedNormal::encode(direction);
        }
        // The hint lies in the wall: either side is as good.
        let longest = thin
            .into_iter()
            .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let either = longest.unwrap_or(DVec3::ZERO);
        let up = either.z + 1e-3 * (either.y + 1e-3 * either.x);
        PackedNormal::encode(if up < 0.0 { -either } else { either })
    }
}

/// A projection to the directions of least variance, by columns (symmetric).
///
/// The adjugate of the covariance has the same axes, its largest value at
/// the covariance's least; squaring it five times leaves hardly anything
/// else. Where two variances are equally least, it projects to their plane.
fn thinnest(second: &[f64; 6], mean: DVec3) -> [DVec3; 3] {
    // Keeps the adjugate of a straight row of voxels from vanishing.
    const FLOOR: f64 = 1e-3;
    let xx = second[0] - mean.x * mean.x + FLOOR;
    let yy = second[1] - mean.y * mean.y + FLOOR;
    let zz = second[2] - mean.z * mean.z + FLOOR;
    let xy = second[3] - mean.x * mean.y;
    let xz = second[4] - mean.x * mean.z;
    let yz = second[5] - mean.y * mean.z;
    let a = DVec3::new(xx, xy, xz);
    let b = DVec3::new(xy, yy, yz);
    let c = DVec3::new(xz, yz, zz);
    let mut columns = [b.cross(c), c.cross(a), a.cross(b)];
    for squaring in 0..6 {
        let trace = columns[0].x + columns[1].y + columns[2].z;
        // Variances are above the floor, so the trace is above zero.
        columns = columns.map(|column| column / trace);
        if squaring < 5 {
            let [u, v, w] = columns;
            columns = columns.map(|column| u * column.x + v * column.y + w * column.z);
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_window_are_where_they_should_be() {
        // One voxel in each neighbour, seen at its place in the window.
        for neighbour in 0..27 {
            for bit in 0..64 {
                let mut rows = [[0u8; 8]; 8];
                put(&mut rows, neighbour, to_rows(1 << bit));
                let offset = [neighbour / 9, neighbour / 3 % 3, neighbour % 3];
                let at = [0, 1, 2].map(|k| {
                    let place = MORTON_TO_XYZ[bit][k] + 4 * offset[k];
                    place.checked_sub(2).filter(|&p| p < 8)
                });
                let mut expected = [[0u8; 8]; 8];
                if let [Some(x), Some(y), Some(z)] = at {
                    expected[z][y] = 1 << x;
                }
                assert_eq!(rows, expected, "neighbour {neighbour} bit {bit}");
            }
        }
    }

    #[test]
    fn moments_match_a_plain_sum() {
        let mut state = 1u64;
        let mut rows = [[0u8; 8]; 8];
        for row in rows.iter_mut().flatten() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            *row = (state >> 56) as u8;
        }
        for at in MORTON_TO_XYZ {
            let mut plain = Moments::default();
            for (dx, dy, dz) in (0..125).map(|i| (i / 25 - 2, i / 5 % 5 - 2, i % 5 - 2)) {
                let place = |k: usize, d: i32| (at[k] as i32 + d + 2) as usize;
                if rows[place(2, dz)][place(1, dy)] >> place(0, dx) & 1 == 0 {
                    continue;
                }
                let weight = [dx, dy, dz]
                    .map(|d| WEIGHT[(d + 2) as usize])
                    .iter()
                    .product::<i32>();
                plain.mass += weight;
                for (sum, d) in plain.first.iter_mut().zip([dx, dy, dz]) {
                    *sum += weight * d;
                }
                let products = [dx * dx, dy * dy, dz * dz, dx * dy, dx * dz, dy * dz];
                for (sum, product) in plain.second.iter_mut().zip(products) {
                    *sum += weight * product;
                }
            }
            assert_eq!(Moments::around(&rows, at), plain);
        }
    }
}
