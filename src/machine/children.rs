//! Subdivision: a record's children, in the order of R9 (`SPEC.md`), and their vertices (image-order paper, 3.2 and
//! 3.4).

use hwmodel::{Datapath, Probe, Short, Stage, Word};

use super::blocks::Block;
use super::cage::CageCoordinate;
use super::counters::Counts;
use super::fill::FillStore;
use super::planes;
use super::push::{child_span, is_behind};
use super::record::{Child, Clip, Cube, Planes, Pose, Record};
use super::state::{Job, Traversal};
use super::watch::{Event, Watch};

impl<L: CageCoordinate, W: Watch> Traversal<L, W> {
    pub(super) fn subdivide<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        fill: &FillStore<'_>,
        record: &Record<L>,
    ) {
        self.counts.subdivided += 1;
        let (centre, order) = centre_and_order(dp, job, &record.cube);

        dp.stage(Stage::VertexPool);
        match &record.pose {
            Pose::Clip(clip, planes) => {
                let x = pool(dp, &clip.x);
                let y = pool(dp, &clip.y);
                let w = pool(dp, &clip.w);
                self.push_children(dp, job, record, (centre, order), |to, dp, octant, child| {
                    let cage = [&x, &y, &w].map(|pool| L::child(pool, octant as usize));
                    to.push_clip_child(dp, job, fill, child, cage, (planes, octant))
                });
            }
            Pose::Screen(screen) => {
                let x = pool(dp, &screen.x);
                let y = pool(dp, &screen.y);
                self.push_children(dp, job, record, (centre, order), |to, dp, octant, child| {
                    let coordinates = || [&x, &y].map(|pool| L::child(pool, octant as usize));
                    to.push_screen(dp, job, fill, child, coordinates)
                });
            }
        }
    }

    /// Pushes the existing children, the farthest first. `push` returns whether it pushed the child.
    #[inline(always)]
    fn push_children<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        parent: &Record<L>,
        (centre, order): ([Word; 3], [u8; 8]),
        mut push: impl FnMut(&mut Self, &mut Datapath<P>, u8, Child) -> bool,
    ) {
        for (rank, octant) in (0..8u8).zip(order).rev() {
            let counts = &mut self.counts;
            let Some(cube) = child_cube(dp, job, counts, &parent.cube, octant, &centre) else {
                continue;
            };
            let from = parent.place;
            if push(self, dp, octant, Child { cube, from }) {
                self.watch.see(Event::<L>::Pushed(rank));
            }
        }
    }

    /// Pushes a child in clip space, if it is visible. `planes` are its parent's.
    pub(super) fn push_clip_child<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        fill: &FillStore<'_>,
        child: Child,
        [x, y, w]: [L; 3],
        (planes, octant): (&Planes, u8),
    ) -> bool {
        let c = &job.constants;
        let (w_min, w_max) = child_span(dp, &w);
        let planes = if c.outline.has_planes() {
            let parent_level = child.cube.level - 1;
            dp.beside(Stage::VertexPool, |dp| {
                planes::of_child(dp, c, planes, parent_level, octant)
            })
        } else {
            *planes
        };
        let clip = Clip { x, y, w, w_min };
        !is_behind(dp, c, &mut self.counts, w_max)
            && self.push_clip(dp, job, fill, child, clip, planes)
    }
}

#[inline(always)]
pub(super) fn centre_and_order<P: Probe>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    cube: &Cube,
) -> ([Word; 3], [u8; 8]) {
    dp.stage(Stage::Centre);
    let centre: [Word; 3] = std::array::from_fn(|k| dp.midpoint(cube.min[k], cube.max[k]));
    dp.tap(Block::Centre, &(cube.min, cube.max), &centre);

    dp.stage(Stage::Order);
    let eye = job.constants.eye_floor;
    let octant = (0..3).fold(0u8, |bits, k| {
        // The centre is on the positive side where the eye is below it.
        bits << 1 | u8::from(dp.lt(eye[k], centre[k]))
    });
    let order = job.order.map(|nearest| dp.xor_bits(3, octant, nearest));
    dp.tap(
        Block::OctantOrder,
        &(centre, eye),
        &(
            Short::unsigned(octant, 3),
            order.map(|child| Short::unsigned(child, 3)),
        ),
    );
    (centre, order)
}

/// A cube's child in an octant, if there is one.
#[inline(always)]
pub(super) fn child_cube<P: Probe>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    counts: &mut Counts,
    parent: &Cube,
    octant: u8,
    centre: &[Word; 3],
) -> Option<Cube> {
    let node = if parent.solid {
        Some(parent.node)
    } else {
        job.graph.child(parent.node, octant)
    };
    let Some(node) = node else {
        counts.absent_children += 1;
        return None;
    };
    dp.stage(Stage::ChildBox);
    let upper: [bool; 3] = std::array::from_fn(|k| octant >> (2 - k) & 1 != 0);
    let min = std::array::from_fn(|k| dp.select(upper[k], centre[k], parent.min[k]));
    let max = std::array::from_fn(|k| dp.select(upper[k], parent.max[k], centre[k]));
    dp.tap(
        Block::ChildCorners,
        &(parent.min, parent.max, centre, Short::unsigned(octant, 3)),
        &(min, max),
    );
    let level = parent.level + 1;
    Some(Cube {
        min,
        max,
        node,
        level,
        voxel_level: if parent.solid {
            parent.voxel_level
        } else {
            level
        },
        solid: parent.solid,
    })
}

#[inline(always)]
pub(super) fn pool<P: Probe, L: CageCoordinate>(dp: &mut Datapath<P>, coordinate: &L) -> L::Pool {
    let pool = coordinate.pool(dp);
    if P::TAPS {
        dp.tap(Block::VertexPool, coordinate, &L::all(&pool));
    }
    pool
}
