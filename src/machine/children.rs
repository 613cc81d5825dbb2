//! A record's children: their order, their vertices, and which of them are
//! pushed (paper, 3.2 and 3.4).

use hwmodel::{Datapath, Probe, Short, Stage, Word};

use super::fit;
use super::lattice::Lattice;
use super::planes;
use super::record::{Clip, Planes, Pose, Record, Screen};
use super::taps::Block;
use super::walk::Walk;
use crate::project::Coverage;

impl<P: Probe, L: Lattice> Walk<'_, P, L> {
    /// Makes a record's children and pushes those that are seen.
    pub(super) fn subdivide(&mut self, record: &Record<L>) {
        self.counts.subdivided += 1;
        self.dp.stage(Stage::Centre);
        let centre: [Word; 3] =
            std::array::from_fn(|k| self.dp.midpoint(record.min[k], record.max[k]));

        self.dp
            .tap(Block::Centre, &(record.min, record.max), &centre);

        self.dp.stage(Stage::Order);
        let octant = (0..3).fold(0u8, |bits, k| {
            // The centre is on the positive side where the eye is below it.
            bits << 1 | u8::from(self.dp.lt(self.constants.eye_floor[k], centre[k]))
        });
        let order = self
            .options
            .order
            .map(|nearest| self.dp.xor_bits(3, octant, nearest));
        self.dp.tap(
            Block::OctantOrder,
            &(centre, self.constants.eye_floor),
            &(
                Short::unsigned(octant, 3),
                order.map(|child| Short::unsigned(child, 3)),
            ),
        );

        self.dp.stage(Stage::VertexPool);
        let dp = &mut self.dp;
        match &record.pose {
            Pose::Clip(clip, planes) => {
                let x = pool(dp, &clip.x);
                let y = pool(dp, &clip.y);
                let w = pool(dp, &clip.w);
                self.push_children(record, order, &centre, |walk, octant, child| {
                    walk.push_in_clip_space(octant, (&x, &y, &w), planes, &child);
                });
            }
            Pose::Screen(screen) => {
                let x = pool(dp, &screen.x);
                let y = pool(dp, &screen.y);
                self.push_children(record, order, &centre, |walk, octant, child| {
                    walk.push_in_screen_space(octant, &x, &y, &child);
                });
            }
        }
    }

    /// Has `push` push the children that there are, the farthest first. It is
    /// told the octant, and what makes a record of the child's vertices.
    #[inline(always)]
    fn push_children<'r>(
        &mut self,
        parent: &'r Record<L>,
        order: [u8; 8],
        centre: &'r [Word; 3],
        mut push: impl FnMut(&mut Self, u8, Child<'r, L>),
    ) {
        for &octant in order.iter().rev() {
            let node = if parent.solid {
                Some(parent.node)
            } else {
                self.graph.child(parent.node, octant)
            };
            let Some(node) = node else {
                self.counts.absent_children += 1;
                continue;
            };
            self.dp.stage(Stage::ChildBox);
            let upper: [bool; 3] = std::array::from_fn(|k| octant >> (2 - k) & 1 != 0);
            let min = std::array::from_fn(|k| self.dp.select(upper[k], centre[k], parent.min[k]));
            let max = std::array::from_fn(|k| self.dp.select(upper[k], parent.max[k], centre[k]));
            self.dp.tap(
                Block::ChildCorners,
                &(parent.min, parent.max, centre, Short::unsigned(octant, 3)),
                &(min, max),
            );
            let child = Child {
                parent,
                node,
                min,
                max,
            };
            push(self, octant, child);
        }
    }

    /// Pushes a child whose vertices are in clip space, if it is seen. The
    /// pools are those of its parent.
    fn push_in_clip_space(
        &mut self,
        octant: u8,
        (x, y, w): (&L::Pool, &L::Pool, &L::Pool),
        planes: &Planes,
        child: &Child<'_, L>,
    ) {
        let of_child = |pool| L::child(pool, octant as usize);
        let (x, y, w) = (of_child(x), of_child(y), of_child(w));
        let (w_min, w_max) = w.span(&mut self.dp);
        self.dp.tap(Block::ChildSpan, &w, &(w_min, w_max));
        let planes = if self.constants.coverage == Coverage::Exact {
            self.dp.stage(Stage::VertexPool);
            let level = child.parent.level;
            planes::of_child(&mut self.dp, &self.constants, planes, level, octant)
        } else {
            *planes
        };
        let clip = Clip { x, y, w, w_min };
        self.push_if_seen(child.record(Pose::Clip(clip, planes)), w_max);
    }

    /// The same in screen space.
    #[inline(always)]
    fn push_in_screen_space(&mut self, octant: u8, x: &L::Pool, y: &L::Pool, child: &Child<'_, L>) {
        // Wires, so taken from the pool again below: most children are
        // rejected, and need not be kept until then.
        let of_child = |pool| L::child(pool, octant as usize);
        let mut span = |lattice: L| {
            let span = lattice.span(&mut self.dp);
            self.dp.tap(Block::ChildSpan, &lattice, &span);
            span
        };
        let spans = [span(of_child(x)), span(of_child(y))];
        let fill = self.canvas.seen_by_fit(self.options.reject_filled);
        let place = child.parent.place();
        let found = fit::screen(&mut self.dp, &self.constants, &fill, &place, &spans);
        let screen = Screen {
            x: of_child(x),
            y: of_child(y),
            spans,
        };
        self.push_at(child.record(Pose::Screen(screen)), found);
    }
}

/// One coordinate of the vertices of a record's children.
#[inline(always)]
fn pool<P: Probe, L: Lattice>(dp: &mut Datapath<P>, lattice: &L) -> L::Pool {
    let pool = lattice.pool(dp);
    if P::TAPS {
        dp.tap(Block::VertexPool, lattice, &L::all(&pool));
    }
    pool
}

/// A child, but for its vertices.
struct Child<'p, L> {
    parent: &'p Record<L>,
    node: u32,
    min: [Word; 3],
    max: [Word; 3],
}

impl<L> Child<'_, L> {
    /// Its record, at the quadtree node of its parent.
    #[inline(always)]
    fn record(&self, pose: Pose<L>) -> Record<L> {
        let parent = self.parent;
        let level = parent.level + 1;
        Record {
            min: self.min,
            max: self.max,
            node: self.node,
            level,
            voxel_level: if parent.solid {
                parent.voxel_level
            } else {
                level
            },
            solid: parent.solid,
            quad: parent.quad,
            inside: parent.inside,
            pose,
        }
    }
}
