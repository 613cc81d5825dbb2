//! The bits of a record's numbers under the rules that draw outlines, proven from a set-up and measured.
//!
//! Clip vectors lie in the hull of the object's corners, which bounds `W`, and `X` and `Y` relative to the whole
//! picture. A box enters a quadrant only if it leaves that by at most half a sample, or by the quadrant's width
//! (`near_node`). So relative to any other node `-W <= X <= 2W`, and no vertex lies behind the eye. Edges are
//! differences of two such numbers. Of a plane `a X + b Y + c W = 0` through an edge, `a` and `b` are greatest at a
//! corner of the object, and equal for all nodes. The edge's end is on it, so `|c| <= 2 (|a| + |b|)`. A plane across an
//! axis is the difference of two of these, so its `c` is at most twice theirs.

use std::collections::BTreeMap;

use hwmodel::{NoProbe, Wires};

use crate::frame::Frame;
use crate::graph::GraphView;
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::machine::engine::Machine;
use crate::machine::limit::Limit;
use crate::machine::record::{Pose, Record};
use crate::machine::state::State;
use crate::machine::watch::{Event, Watch};
use crate::project::vector::cross;
use crate::project::{CageKind, EngineError, FrameSetup, Stop, most_records};

hwmodel::named! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum RecordNumber {
        Node = "octree node",
        Level = "octree level",
        Lowest = "lowest vertex",
        Highest = "highest vertex",
        QuadLevel = "quadtree level",
        /// Column or row of the quadtree node.
        QuadPlace = "quadtree place",
        ClipXy = "X, Y",
        ClipW = "W",
        EdgeXy = "edge's X, Y",
        EdgeW = "edge's W",
        LeastW = "least W",
        PlaneAb = "plane's a, b",
        PlaneC = "plane's c",
        AxisC = "axis plane's c",
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NumberSpan {
    pub least: i128,
    pub greatest: i128,
}

impl NumberSpan {
    pub fn of(value: i128) -> Self {
        Self {
            least: value,
            greatest: value,
        }
    }

    fn around(most: i128) -> Self {
        Self {
            least: -most,
            greatest: most,
        }
    }

    fn to(greatest: i128) -> Self {
        Self { least: 0, greatest }
    }

    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
        }
    }

    /// Bits that hold the span: two's complement if it contains negative values.
    pub fn bits(self) -> u32 {
        let of = |value: i128| i128::BITS - value.leading_zeros();
        match self.least < 0 {
            true => 1 + of(self.greatest.max(0)).max(of(!self.least)),
            false => of(self.greatest),
        }
    }

    pub fn holds(self, other: Self) -> bool {
        self.with(other) == self
    }
}

pub type NumberSpans = BTreeMap<RecordNumber, NumberSpan>;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvenWidths {
    pub numbers: NumberSpans,
    /// Bits of a wide word that holds every sum of the steps on planes.
    pub wide_bits: u32,
}

/// `None` under the rules that do not draw outlines. `nodes`: of the graph.
pub fn proven_widths(setup: &FrameSetup, nodes: usize) -> Option<ProvenWidths> {
    if !setup.options.coverage.draws_outlines() {
        return None;
    }
    let origin = setup.origin_clip.map(i128::from);
    let edges = setup.edge_clip.map(|edge| edge.map(i128::from));
    let corners: Vec<[i128; 3]> = (0..8u32)
        .map(|corner| {
            let mut at = origin;
            for (k, edge) in edges.iter().enumerate() {
                if corner >> (2 - k) & 1 != 0 {
                    for c in 0..3 {
                        at[c] += edge[c] << setup.depth;
                    }
                }
            }
            at
        })
        .collect();
    let span_of = |values: &mut dyn Iterator<Item = i128>| {
        values
            .map(NumberSpan::of)
            .reduce(NumberSpan::with)
            .unwrap_or_default()
    };
    let scaled = |span: NumberSpan| NumberSpan {
        least: span.least << setup.sub_levels,
        greatest: span.greatest << setup.sub_levels,
    };
    let w = scaled(span_of(&mut corners.iter().map(|at| at[2])));
    let far = w.greatest.max(0);
    let xy = scaled(span_of(&mut corners.iter().flat_map(|at| [at[0], at[1]])));
    let in_node = NumberSpan {
        least: -far,
        greatest: 2 * far,
    };
    let along = |c: usize| {
        let most = edges.iter().map(|edge| edge[c].abs() << setup.depth).max();
        most.unwrap_or(0) << setup.sub_levels
    };
    let edge_xy = along(0).max(along(1)).max(3 * far);
    // Planes through an edge at a corner of the object, in the whole picture.
    let through = corners
        .iter()
        .flat_map(|&at| edges.iter().map(move |&edge| cross(at, edge)));
    let (mut plane_ab, mut plane_c, mut sums) = (0, 0, 0);
    for [a, b, c] in through {
        plane_ab = plane_ab.max(a.abs()).max(b.abs());
        sums = sums.max(a.abs() + b.abs());
        plane_c = plane_c.max(c.abs());
    }
    let plane_c = plane_c.max(2 * sums);
    let axis_ab = (0..3)
        .map(|k| {
            let [a, b, _] = cross(edges[(k + 1) % 3], edges[(k + 2) % 3]);
            a.abs() + b.abs()
        })
        .max()
        .unwrap_or(0);
    let position = setup.depth + setup.sub_levels;
    let (to, around) = (NumberSpan::to, NumberSpan::around);
    let numbers = [
        (RecordNumber::Node, to(nodes.saturating_sub(1) as i128)),
        (RecordNumber::Level, to(i128::from(setup.depth))),
        (RecordNumber::Lowest, to((1 << position) - 1)),
        (RecordNumber::Highest, to(1 << position)),
        (RecordNumber::QuadLevel, to(i128::from(setup.levels))),
        (RecordNumber::QuadPlace, to((1 << setup.levels) - 1)),
        (RecordNumber::ClipXy, xy.with(in_node)),
        (RecordNumber::ClipW, w),
        (RecordNumber::EdgeXy, around(edge_xy)),
        (RecordNumber::EdgeW, around(along(2))),
        (RecordNumber::LeastW, w),
        (RecordNumber::PlaneAb, around(plane_ab)),
        (RecordNumber::PlaneC, around(plane_c)),
        (RecordNumber::AxisC, around(2 * plane_c)),
    ];
    // The largest sums: four times an axis plane's constant, or twice that of a plane across a node, which is at most
    // `|a| + |b|`, with their coefficients.
    let most = (4 * plane_c + axis_ab).max(2 * plane_c + 4 * sums);
    Some(ProvenWidths {
        numbers: numbers.into_iter().collect(),
        wide_bits: around(most).bits(),
    })
}

/// The set-up with wide words of the proven bits. Blending keeps its own.
pub fn narrowed(setup: &FrameSetup) -> FrameSetup {
    let mut narrow = setup.clone();
    if !setup.options.coverage.blends()
        && let Some(proven) = proven_widths(setup, 0)
    {
        narrow.format = setup.format.with_wide_bits(proven.wide_bits);
    }
    narrow
}

struct Seen {
    cage: CageKind,
    spans: NumberSpans,
}

impl Seen {
    fn note(&mut self, number: RecordNumber, values: impl IntoIterator<Item = i128>) {
        for span in values.into_iter().map(NumberSpan::of) {
            let seen = self.spans.entry(number).or_insert(span);
            *seen = seen.with(span);
        }
    }

    /// Notes the first numbers of `of`, and then the others, as one number each.
    fn note_both(&mut self, [first, rest]: [RecordNumber; 2], of: &impl Wires, at: usize) {
        let mut shown = Vec::new();
        of.show(&mut shown);
        let mut values = shown.iter().map(|signal| i128::from(signal.value));
        self.note(first, values.by_ref().take(at));
        self.note(rest, values);
    }
}

impl Watch for Seen {
    fn see<L: CageCoordinate>(&mut self, event: Event<'_, L>) {
        use RecordNumber::*;
        let Event::Made(Record { cube, place, pose }) = event else {
            return;
        };
        let quad = place.quad;
        self.note(Node, [i128::from(cube.node)]);
        self.note(Level, [i128::from(cube.level)]);
        self.note(QuadLevel, [i128::from(quad.level)]);
        self.note(QuadPlace, [quad.x, quad.y].map(i128::from));
        self.note_both([Lowest, Highest], &(cube.min, cube.max), 3);
        if let Pose::Clip(clip, planes) = pose {
            let corners = match self.cage {
                CageKind::Corners => 8,
                CageKind::Frame => 1,
            };
            self.note_both([ClipXy, EdgeXy], &clip.x, corners);
            self.note_both([ClipXy, EdgeXy], &clip.y, corners);
            self.note_both([ClipW, EdgeW], &clip.w, corners);
            self.note_both([LeastW, LeastW], &clip.w_min, 1);
            for plane in &planes.edge {
                self.note_both([PlaneAb, PlaneC], plane, 2);
            }
            self.note_both([AxisC, AxisC], &planes.axis_c, 3);
        }
    }
}

impl Machine {
    /// Draws a frame and returns the spans of its records' numbers. Fails when a word overflows under the trap policy.
    pub fn seen_numbers(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<NumberSpans, EngineError> {
        let watch = Seen {
            cage: setup.options.cage,
            spans: NumberSpans::new(),
        };
        let options = self.options;
        let canvas = (self.emptied(setup, frame)?, &mut *frame);
        with_cage!(setup, L => {
            let mut state = State::<_, L, _>::new(options, graph, setup, canvas, NoProbe, watch);
            let most = most_records(setup);
            if !state.draw_by_tiles(&mut Limit::new(most, &Stop::default()))? {
                return Err(EngineError::Records(most));
            }
            Ok(state.finish().2.spans)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_by_hand() {
        let spans = [
            (0, 0),
            (0, 255),
            (0, 256),
            (-1, 0),
            (-128, 127),
            (-129, 0),
            (-1, 128),
        ];
        let bits = spans.map(|(least, greatest)| NumberSpan { least, greatest }.bits());
        assert_eq!(bits, [0, 8, 9, 1, 8, 9, 9]);
    }
}
