//! Pushes records before the eye whose box has an unfilled quadtree node (image-order paper, 3.5).

use hwmodel::cycles::StackHolds;
use hwmodel::{Datapath, Memory, Probe, Stage, Word};

use super::blocks::{Block, Port};
use super::cage::CageCoordinate;
use super::constants::Constants;
use super::counters::Counts;
use super::fill::FillStore;
use super::record::{Child, Clip, Cube, ImagePlace, Planes, Pose, Record, Screen};
use super::smallest_node;
use super::state::{Job, State, Traversal};
use super::watch::{Event, Watch};
use crate::frame::QuadNode;
use crate::project::options::OutlineRule;

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Begins a tile, or the picture: pushes the record of the whole object.
    pub(super) fn push_object(&mut self, tile: QuadNode) {
        let (dp, job, fill) = (&mut self.dp, &self.job, &self.canvas.fill);
        // A tile begins at level 0, also after another tile.
        dp.resume(0);
        fill.begin_tile(dp, tile);
        dp.stage(Stage::Push);
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
        let traversal = &mut self.traversal;
        if !is_behind(dp, c, &mut traversal.counts, w_max) {
            traversal.push_clip(dp, job, fill, object, clip, planes);
        }
    }
}

impl<L: CageCoordinate, W: Watch> Traversal<L, W> {
    /// Pushes a record in clip space, unless it is rejected. Returns whether it was pushed.
    pub(super) fn push_clip<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        fill: &FillStore<'_>,
        child: Child,
        mut clip: Clip<L>,
        mut planes: Planes,
    ) -> bool {
        let c = &job.constants;
        let found = smallest_node::clip(dp, c, fill, child.from, &mut clip, &mut planes);
        self.push_at(dp, job, found, child.cube, || Pose::Clip(clip, planes))
    }

    /// Pushes a record in screen space. `coordinates` selects x and y: twice, because most children are rejected.
    #[inline(always)]
    pub(super) fn push_screen<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        fill: &FillStore<'_>,
        child: Child,
        coordinates: impl Fn() -> [L; 2],
    ) -> bool {
        let spans = coordinates().map(|coordinate| child_span(dp, &coordinate));
        let found = smallest_node::screen(dp, &job.constants, fill, child.from, &spans);
        self.push_at(dp, job, found, child.cube, || {
            let [x, y] = coordinates();
            Pose::Screen(Screen { x, y, spans })
        })
    }

    #[inline(always)]
    fn push_at<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        job: &Job<'_>,
        found: Option<ImagePlace>,
        cube: Cube,
        pose: impl FnOnce() -> Pose<L>,
    ) -> bool {
        let Some(place) = found else {
            self.counts.rejected_by_quadtree += 1;
            return false;
        };
        dp.stage(Stage::Push);
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
            self.counts.deepest_stack = self.counts.deepest_stack.max(address + 1);
        }
        self.stack.push(record);
        true
    }
}

/// Whether a box is behind the plane of the eye (`SPEC.md`, R8.2) or, under the rules that have one, before the near plane
/// (R7.2).
pub(super) fn is_behind<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    counts: &mut Counts,
    w_max: Word,
) -> bool {
    dp.stage(Stage::ChildBox);
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
