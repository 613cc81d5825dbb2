//! Children, in the order of R9 (`SPEC.md`; image-order paper, 3.2), and their vertices (3.4). Those before the eye whose
//! box has an unfilled quadtree node are pushed (3.5).

use crate::machine::stages::RecordStage;
use hwmodel::cycles::StackHolds;
use hwmodel::{Datapath, Memory, Probe, Short, Word};

use super::blocks::{Block, Port};
use super::cage::CageCoordinate;
use super::canvas::Canvas;
use super::constants::Constants;
use super::counters::Counts;
use super::levels;
use super::planes;
use super::record::{Child, Clip, Cube, ImagePlace, Planes, Pose, Record, Screen};
use super::smallest_node;
use super::state::{Job, State, Traversal};
use super::watch::{Event, Watch};
use crate::frame::QuadNode;
use crate::project::options::OutlineRule;

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Begins a tile, or the picture: pushes the record of the whole object.
    pub(super) fn push_object(&mut self, tile: QuadNode) {
        let (dp, job, canvas) = (&mut self.dp, &self.job, &mut self.canvas);
        // A tile begins at level 0, also after another tile.
        dp.resume(0);
        canvas.fill.begin_tile(dp, tile);
        dp.stage(RecordStage::Push);
        let c = &job.constants;
        let [x, y, w] = [0, 1, 2].map(|k| L::from_frame(dp, c.origin[k], c.edges[k]));
        let (w_min, w_max) = w.span(dp);
        let side = dp.load(1i64 << (c.depth + c.sub_levels));
        let object = Child {
            cube: Cube {
                min: [Word::ZERO; 3],
                max: [side; 3],
                node: job.graph.root,
                level: 0,
                voxel_level: 0,
                solid: false,
            },
            from: ImagePlace::ROOT,
        };
        let planes = Planes {
            edge: c.edge_planes,
            axis_c: c.axis_c,
        };
        let clip = Clip { x, y, w, w_min };
        if !is_behind(dp, c, &mut canvas.counts, w_max) {
            self.traversal
                .push_clip(dp, job, canvas, object, clip, planes);
        }
    }
}

impl<L: CageCoordinate, W: Watch> Traversal<L, W> {
    pub(super) fn subdivide<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        canvas: &mut Canvas<'_>,
        record: &Record<L>,
    ) {
        canvas.counts.subdivided += 1;
        let (centre, order) = centre_and_order(dp, job, &record.cube);

        dp.stage(RecordStage::VertexPool);
        let (x, y, depth) = match &record.pose {
            Pose::Clip(clip, planes) => (&clip.x, &clip.y, Some((&clip.w, planes))),
            Pose::Screen(screen) => (&screen.x, &screen.y, None),
        };
        let [x, y] = [x, y].map(|coordinate| pool(dp, coordinate));
        let depth = depth.map(|(w, planes)| (pool(dp, w), planes));
        // The farthest first.
        for (rank, octant) in (0..8u8).zip(order).rev() {
            let counts = &mut canvas.counts;
            let Some(cube) = child_cube(dp, job, counts, &record.cube, octant, &centre) else {
                continue;
            };
            let from = record.place;
            let (child, of_child) = (Child { cube, from }, |pool| L::child(pool, octant as usize));
            let is_pushed = match &depth {
                Some((w, planes)) => {
                    let cage = [&x, &y, w].map(of_child);
                    self.push_clip_child(dp, job, canvas, child, cage, (planes, octant))
                }
                None => self.push_screen(dp, job, canvas, child, || [&x, &y].map(of_child)),
            };
            if is_pushed {
                self.watch.see(Event::<L>::Pushed(rank));
            }
        }
    }

    /// Pushes a child in clip space, if it is visible. `planes` are its parent's.
    pub(super) fn push_clip_child<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        canvas: &mut Canvas<'_>,
        child: Child,
        [x, y, w]: [L; 3],
        (planes, octant): (&Planes, u8),
    ) -> bool {
        let c = &job.constants;
        let (w_min, w_max) = child_span(dp, &w);
        let planes = if c.outline.has_planes() {
            let parent_level = child.cube.level - 1;
            dp.beside(RecordStage::VertexPool, |dp| {
                planes::of_child(dp, c, planes, parent_level, octant)
            })
        } else {
            *planes
        };
        let clip = Clip { x, y, w, w_min };
        !is_behind(dp, c, &mut canvas.counts, w_max)
            && self.push_clip(dp, job, canvas, child, clip, planes)
    }

    /// Pushes a record in clip space, unless it is rejected. Returns whether it was pushed.
    pub(super) fn push_clip<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        canvas: &mut Canvas<'_>,
        child: Child,
        mut clip: Clip<L>,
        mut planes: Planes,
    ) -> bool {
        let c = &job.constants;
        let found = smallest_node::clip(dp, c, &canvas.fill, child.from, &mut clip, &mut planes);
        self.push_at(dp, job, &mut canvas.counts, found, child.cube, || {
            Pose::Clip(clip, planes)
        })
    }

    /// Pushes a record in screen space. `coordinates` selects x and y, twice: most children are rejected.
    #[inline(always)]
    pub(super) fn push_screen<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        canvas: &mut Canvas<'_>,
        child: Child,
        coordinates: impl Fn() -> [L; 2],
    ) -> bool {
        let spans = coordinates().map(|coordinate| child_span(dp, &coordinate));
        let found = smallest_node::screen(dp, &job.constants, &canvas.fill, child.from, &spans);
        self.push_at(dp, job, &mut canvas.counts, found, child.cube, || {
            let [x, y] = coordinates();
            Pose::Screen(Screen { x, y, spans })
        })
    }

    #[inline(always)]
    fn push_at<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        counts: &mut Counts,
        found: Option<ImagePlace>,
        cube: Cube,
        pose: impl FnOnce() -> Pose<L>,
    ) -> bool {
        let Some(place) = found else {
            counts.rejected_by_quadtree += 1;
            return false;
        };
        dp.stage(RecordStage::Push);
        let record = Record {
            cube,
            place,
            pose: pose(),
        };
        self.watch.see(Event::Made(&record));
        // With parents on the stack, a new record is in registers.
        if job.organisation.stack == StackHolds::Children {
            let address = self.stack.len() as u64;
            dp.write(Memory::Stack, address);
            Port::Push.tap(dp, address, &record);
            counts.deepest_stack = counts.deepest_stack.max(address + 1);
        }
        self.stack.push(record);
        true
    }
}

#[inline(always)]
pub(super) fn centre_and_order<P: Probe>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    cube: &Cube,
) -> ([Word; 3], [u8; 8]) {
    dp.stage(RecordStage::Centre);
    let centre: [Word; 3] = std::array::from_fn(|k| dp.midpoint(cube.min[k], cube.max[k]));
    dp.tap(Block::Centre, &(cube.min, cube.max), &centre);

    dp.stage(RecordStage::Order);
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
    dp.stage(RecordStage::ChildBox);
    let upper: [bool; 3] = std::array::from_fn(|k| octant >> (2 - k) & 1 != 0);
    let min = std::array::from_fn(|k| dp.select(upper[k], centre[k], parent.min[k]));
    let max = std::array::from_fn(|k| dp.select(upper[k], parent.max[k], centre[k]));
    dp.tap(
        Block::ChildCorners,
        &(parent.min, parent.max, centre, Short::unsigned(octant, 3)),
        &(min, max),
    );
    let level = levels::next(dp, parent.level);
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

/// Whether a box is behind the plane of the eye (`SPEC.md`, R8.2) or before the near plane, if there is one (R7.2).
pub(super) fn is_behind<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    counts: &mut Counts,
    w_max: Word,
) -> bool {
    dp.stage(RecordStage::ChildBox);
    let is_behind = match constants.outline {
        OutlineRule::Silhouette => !dp.is_positive(w_max),
        OutlineRule::Box | OutlineRule::Centre => dp.lt(w_max, constants.near),
    };
    counts.behind_eye += u64::from(is_behind);
    is_behind
}

#[inline(always)]
pub(super) fn child_span<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    coordinate: &L,
) -> (Word, Word) {
    let span = coordinate.span(dp);
    dp.tap(Block::ChildSpan, coordinate, &span);
    span
}
