//! Subdivision: a record's children, in order, their vertices, and which of
//! them are pushed (image-order paper, 3.2 and 3.4).

use hwmodel::{Datapath, Probe, Short, Stage, Word};

use super::blocks::Block;
use super::cage::CageCoordinate;
use super::planes;
use super::record::{Clip, Cube, ImagePlace, Planes, Pose, Record};
use super::state::State;
use super::watch::Watch;
use crate::project::Coverage;

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Makes a record's children and pushes those that can be seen.
    pub(super) fn subdivide(&mut self, record: &Record<L>) {
        self.counts.subdivided += 1;
        let cube = &record.cube;
        let (centre, order) = self.centre_and_order(cube);

        self.dp.stage(Stage::VertexPool);
        let dp = &mut self.dp;
        let place = record.place;
        match &record.pose {
            Pose::Clip(clip, planes) => {
                let x = pool(dp, &clip.x);
                let y = pool(dp, &clip.y);
                let w = pool(dp, &clip.w);
                self.push_children(cube, order, &centre, |state, octant, child| {
                    let cage = [&x, &y, &w].map(|pool| L::child(pool, octant as usize));
                    state.push_clip_child(octant, cage, planes, child, place)
                });
            }
            Pose::Screen(screen) => {
                let x = pool(dp, &screen.x);
                let y = pool(dp, &screen.y);
                self.push_children(cube, order, &centre, |state, octant, child| {
                    let coordinates = || [&x, &y].map(|pool| L::child(pool, octant as usize));
                    state.push_screen_child(coordinates, child, place)
                });
            }
        }
    }

    /// The centre of a cube that is subdivided, and its octants, nearest first.
    #[inline(always)]
    pub(super) fn centre_and_order(&mut self, cube: &Cube) -> ([Word; 3], [u8; 8]) {
        self.dp.stage(Stage::Centre);
        let centre: [Word; 3] = std::array::from_fn(|k| self.dp.midpoint(cube.min[k], cube.max[k]));
        self.dp.tap(Block::Centre, &(cube.min, cube.max), &centre);

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
        (centre, order)
    }

    /// A cube's child in an octant, if there is one.
    #[inline(always)]
    pub(super) fn child_cube(
        &mut self,
        parent: &Cube,
        octant: u8,
        centre: &[Word; 3],
    ) -> Option<Cube> {
        let node = if parent.solid {
            Some(parent.node)
        } else {
            self.graph.child(parent.node, octant)
        };
        let Some(node) = node else {
            self.counts.absent_children += 1;
            return None;
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

    /// Pushes the children that exist, the farthest first. `push`, given the
    /// child's octant and cube, returns whether the child was pushed.
    #[inline(always)]
    fn push_children(
        &mut self,
        parent: &Cube,
        order: [u8; 8],
        centre: &[Word; 3],
        mut push: impl FnMut(&mut Self, u8, Cube) -> bool,
    ) {
        for (rank, octant) in (0..8u8).zip(order).rev() {
            let Some(child) = self.child_cube(parent, octant, centre) else {
                continue;
            };
            if push(self, octant, child) {
                self.watch.pushed(rank);
            }
        }
    }

    /// Pushes a child in clip space, if it can be seen. The planes are
    /// its parent's.
    pub(super) fn push_clip_child(
        &mut self,
        octant: u8,
        [x, y, w]: [L; 3],
        planes: &Planes,
        child: Cube,
        parent_place: ImagePlace,
    ) -> bool {
        let (w_min, w_max) = child_span(&mut self.dp, &w);
        let planes = if self.constants.coverage == Coverage::Exact {
            let (constants, parent_level) = (&self.constants, child.level - 1);
            self.dp.beside(Stage::VertexPool, |dp| {
                planes::of_child(dp, constants, planes, parent_level, octant)
            })
        } else {
            *planes
        };
        let clip = Clip { x, y, w, w_min };
        self.push_clip(child, parent_place, clip, planes, w_max)
    }

    /// Pushes a child in screen space, if it can be seen. `coordinates` gives its x and y.
    #[inline(always)]
    pub(super) fn push_screen_child(
        &mut self,
        coordinates: impl Fn() -> [L; 2],
        child: Cube,
        parent_place: ImagePlace,
    ) -> bool {
        let spans = coordinates().map(|coordinate| child_span(&mut self.dp, &coordinate));
        self.push_screen(child, parent_place, spans, coordinates)
    }
}

/// The least and the greatest of a child's vertices, one coordinate.
#[inline(always)]
pub(super) fn child_span<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    coordinate: &L,
) -> (Word, Word) {
    let span = coordinate.span(dp);
    dp.tap(Block::ChildSpan, coordinate, &span);
    span
}

/// One coordinate of the vertices of a record's children.
#[inline(always)]
pub(super) fn pool<P: Probe, L: CageCoordinate>(dp: &mut Datapath<P>, coordinate: &L) -> L::Pool {
    let pool = coordinate.pool(dp);
    if P::TAPS {
        dp.tap(Block::VertexPool, coordinate, &L::all(&pool));
    }
    pool
}
