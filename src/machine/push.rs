//! Pushing records: those that are before the eye, and whose box has an
//! unfilled quadtree node (image-order paper, 3.5).

use hwmodel::cycles::StackHolds;
use hwmodel::{Memory, Probe, Stage, Word};

use super::blocks::Port;
use super::cage::CageCoordinate;
use super::record::{Clip, Cube, ImagePlace, Planes, Pose, Record, Screen};
use super::smallest_node::{self, Fill};
use super::state::State;
use super::watch::Watch;
use crate::frame::QuadNode;
use crate::project::Coverage;

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Begins a tile of the picture, or all of it: makes the record of the whole object and pushes it.
    pub(super) fn push_object(&mut self, tile: QuadNode) {
        // Where a frame begins, also where a tile does after another's last record.
        self.dp.resume(0);
        self.canvas.fill.begin_tile(&mut self.dp, tile);
        self.dp.stage(Stage::Push);
        let c = &self.constants;
        let dp = &mut self.dp;
        let mut coordinate =
            |coordinate: usize| L::from_frame(dp, c.origin[coordinate], c.edges[coordinate]);
        let (x, y, w) = (coordinate(0), coordinate(1), coordinate(2));
        let (w_min, w_max) = w.span(dp);
        let side = dp.load(1i64 << (c.depth + c.sub_levels));
        let cube = Cube {
            min: [Word::ZERO; 3],
            max: [side; 3],
            node: self.graph.root,
            level: 0,
            voxel_level: 0,
            solid: false,
        };
        let planes = Planes {
            edge: c.edge_planes,
            axis_c: c.axis_c,
        };
        self.push_clip(
            cube,
            ImagePlace::ROOT,
            Clip { x, y, w, w_min },
            planes,
            w_max,
        );
    }

    /// Pushes a record in clip space, if it is before the eye and the fit,
    /// from the quadtree node `from` on, does not reject it. `w_max`: the
    /// greatest depth of its vertices. Returns whether it was pushed.
    pub(super) fn push_clip(
        &mut self,
        cube: Cube,
        from: ImagePlace,
        mut clip: Clip<L>,
        mut planes: Planes,
        w_max: Word,
    ) -> bool {
        self.dp.stage(Stage::ChildBox);
        if self.is_behind(w_max) {
            self.counts.behind_eye += 1;
            return false;
        }
        let fill = Fill {
            vectors: &self.canvas.fill,
            reject: self.options.reject_filled,
        };
        let (dp, constants) = (&mut self.dp, &self.constants);
        let found = smallest_node::clip(dp, constants, &fill, from, &mut clip, &mut planes);
        self.push_at(found, cube, || Pose::Clip(clip, planes))
    }

    /// The same in screen space, where all is before the eye. `coordinates` gives
    /// the vertices' x and y: selected once more, which costs nothing in
    /// hardware, since most children are rejected and need not be kept till then.
    #[inline(always)]
    pub(super) fn push_screen(
        &mut self,
        cube: Cube,
        from: ImagePlace,
        spans: [(Word, Word); 2],
        coordinates: impl FnOnce() -> [L; 2],
    ) -> bool {
        let fill = Fill {
            vectors: &self.canvas.fill,
            reject: self.options.reject_filled,
        };
        let found = smallest_node::screen(&mut self.dp, &self.constants, &fill, from, &spans);
        self.push_at(found, cube, || {
            let [x, y] = coordinates();
            Pose::Screen(Screen { x, y, spans })
        })
    }

    /// Pushes a record at the place that the fit found.
    #[inline(always)]
    fn push_at(
        &mut self,
        found: Option<ImagePlace>,
        cube: Cube,
        pose: impl FnOnce() -> Pose<L>,
    ) -> bool {
        let Some(place) = found else {
            self.counts.rejected += 1;
            return false;
        };
        self.dp.stage(Stage::Push);
        let record = Record {
            cube,
            place,
            pose: pose(),
        };
        // Where parents lie on the stack, what was just made is in registers.
        if self.options.organisation.stack == StackHolds::Children {
            let address = self.stack.len() as u64;
            self.dp.write(Memory::Stack, address);
            Port::Push.tap(&mut self.dp, address, &record);
        }
        self.watch.made(&record);
        self.stack.push(record);
        if self.options.organisation.stack == StackHolds::Children {
            self.counts.deepest_stack = self.counts.deepest_stack.max(self.stack.len() as u64);
        }
        true
    }

    /// Whether a box whose greatest depth is `w_max` lies behind the eye, or,
    /// under the rules that have one, before the near plane.
    fn is_behind(&mut self, w_max: Word) -> bool {
        if self.constants.coverage == Coverage::Exact {
            !self.dp.is_positive(w_max)
        } else {
            self.dp.lt(w_max, self.constants.near)
        }
    }
}
