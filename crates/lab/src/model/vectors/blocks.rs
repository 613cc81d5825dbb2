//! What each block is: its name, its wires, what it does, in words.

use hwmodel::{SignalKind, Stage};

use super::blending;
use super::description::{Description, OBJECT};
use super::ports::{BIT, LEVEL, Ports, WIDE, WORD};
use shiftvox::machine::Block;
use shiftvox::project::FrameSetup;

const TWO: SignalKind = SignalKind::Unsigned(2);
const THREE: SignalKind = SignalKind::Unsigned(3);
const FOUR: SignalKind = SignalKind::Unsigned(4);
const NODE: SignalKind = SignalKind::Unsigned(20);
const PLACES: SignalKind = SignalKind::Signed(8);

const X: &str = "X (or Y) of the vertices, relative to the quadtree node";
const W: &str = "W of the vertices";
const BELOW: &str = "levels from the quadtree node to the samples";
const SIDE: &str = "0 not all on one side, 1 positive, 2 negative, 3 the plane is none";
const COVER: &str = "0 no sample of the node is covered, 1 some may be, 2 all are";
const OUTSIDE: &str = "no part of the box is within the node";
const WITHIN: &str = "all of the box is";
const PLANE: &str = "a, b, c of the edge's plane a x + b y + c";
const NORMAL: &str = "a, b of the plane perpendicular to the axis";
const AXIS_C: &str = "c of the plane perpendicular to the axis";

const OCTANTS: [&str; 8] = ["000", "001", "010", "011", "100", "101", "110", "111"];

/// Planes of the three edges, and what moves them.
fn planes(ports: Ports) -> Ports {
    let ports = ["x", "y", "z"].iter().fold(ports, |ports, axis| {
        ports.each(&format!("edge_{axis}"), &["a", "b", "c"], WIDE, PLANE)
    });
    let ports = ["x", "y", "z"].iter().fold(ports, |ports, axis| {
        ports.each(&format!("axis_{axis}"), &["a", "b"], WIDE, NORMAL)
    });
    ports.each("axis", &["x_c", "y_c", "z_c"], WIDE, AXIS_C)
}

/// Describes a block of a frame.
#[must_use]
#[expect(clippy::too_many_lines, reason = "one entry for each block")]
pub fn describe(block: Block, setup: &FrameSetup) -> Description {
    let ports = || Ports::new(setup.options.cage);
    let made = Description::new;
    let bit = |name: &str, meaning| ports().one(name, BIT, meaning);
    let border = || {
        ports()
            .one("outside", BIT, OUTSIDE)
            .one("enclosed", BIT, WITHIN)
    };
    let halves = |ports: Ports| {
        ports
            .one("low_half", BIT, "the left (upper) half is overlapped")
            .one("high_half", BIT, "the right (lower) half is")
    };
    let clip = |ports: Ports| ports.cage("x", X).cage("w", W);
    let screen_box = || {
        ports()
            .one(
                "low",
                WORD,
                "least position of the box, samples with the format's fraction",
            )
            .one("high", WORD, "greatest position")
            .one("node", NODE, "the quadtree node's column (or row)")
            .one("below", LEVEL, BELOW)
    };
    let corners = |ports: Ports| ports.axes("min", WORD, OBJECT).axes("max", WORD, OBJECT);
    match block {
        Block::Filled => made(
            "filled",
            &[Stage::Filled],
            "6",
            "full = all four bits of the vector are set",
            ports().one("vector", FOUR, "fill vector of the record's quadtree node"),
            bit("full", "the record is done"),
        ),
        Block::ChangeDepth => made(
            "change_depth",
            &[Stage::ToScreen],
            "5",
            "deep = w_min >= least",
            ports().one("w_min", WORD, "least W of the vertices").one(
                "least",
                WORD,
                "T of the record's octree level",
            ),
            bit("deep", "far enough to change to screen space"),
        ),
        Block::ChangeGuard => made(
            "change_guard",
            &[Stage::ToScreen],
            "5",
            "enclosed = at all vertices x + (w >> places) >= 0 and (w - x) + (w >> places) >= 0, nothing rounded; places < 0: w shifted left",
            clip(ports()).one(
                "places",
                PLACES,
                "part of the width by which the box may leave the node, as a shift",
            ),
            bit(
                "enclosed",
                "the box leaves the picture by little enough, along this axis",
            ),
        ),
        Block::ToScreenDivide => made(
            "to_screen_divide",
            &[Stage::ToScreen],
            "5",
            "quotient = floor((x + 4 w) * 2^fraction_bits / w), for w > 0 and -4 w <= x < 12 w",
            ports()
                .one("x", WORD, "X (or Y) of a vertex")
                .one("w", WORD, "W of the vertex, positive")
                .one("fraction_bits", LEVEL, "steps after the four integer steps"),
            ports().one(
                "quotient",
                WORD,
                "x / w + 4 with so many fraction bits, rounded down",
            ),
        ),
        Block::DetailDepth => made(
            "detail_depth",
            &[Stage::OnePixel],
            "7",
            "solid = w_min >= least",
            ports().one("w_min", WORD, "least W of the vertices").one(
                "least",
                WORD,
                "depth from which on no node of the level is larger than the level of detail",
            ),
            bit("solid", "the node is drawn as a solid"),
        ),
        Block::SizeLimit => made(
            "size_limit",
            &[Stage::OnePixel, Stage::Filled, Stage::ToScreen],
            "7",
            "most = sum of w_min >> (s + below) over the shifts s of constant size_shifts; shifts below zero go left",
            ports()
                .one("w_min", WORD, "least W of the vertices")
                .one("below", LEVEL, BELOW),
            ports().one("most", WORD, "extent of one sample at the least depth"),
        ),
        Block::SizeClip => made(
            "size_clip",
            &[Stage::OnePixel, Stage::Filled, Stage::ToScreen],
            "7",
            "fits = sum over k of max(|edge_x_k|, |edge_x_k - edge_w_k|) <= most",
            ports()
                .axes("edge_x", WORD, "X (or Y) of the edge")
                .axes("edge_w", WORD, "W of the edge")
                .one("most", WORD, "from size_limit"),
            bit("fits", "no larger than a sample along this axis"),
        ),
        Block::SizeScreen => made(
            "size_screen",
            &[Stage::OnePixel, Stage::Filled, Stage::ToScreen],
            "7",
            "fits = high - low <= limit",
            ports()
                .one("low", WORD, "least position of the box")
                .one("high", WORD, "greatest position")
                .one("limit", WORD, "a size in the same units"),
            bit("fits", "no larger along this axis"),
        ),
        Block::Centre => made(
            "centre",
            &[Stage::Centre],
            "2",
            "centre = (min + max) >> 1, the sum with its carry",
            corners(ports()),
            ports().axes("centre", WORD, OBJECT),
        ),
        Block::OctantOrder => made(
            "octant_order",
            &[Stage::Order],
            "9",
            "octant bit k = eye_floor_k < centre_k, x highest; child_i = octant XOR {7,6,5,3,4,2,1,0}[i]",
            ports()
                .axes("centre", WORD, OBJECT)
                .axes("eye_floor", WORD, "the eye, rounded down"),
            ports()
                .one("octant", THREE, "where the centre is above the eye")
                .list("child", 8, THREE, "the i-th nearest child"),
        ),
        Block::VertexPool => made(
            "vertex_pool",
            &[Stage::VertexPool],
            "4",
            "corners: midpoints (a + b) >> 1 along x, then y, then z; frame: edges (e + sign) >> 1, corners by seven adds",
            ports().cage("parent", "one coordinate of the record's cage"),
            OCTANTS.iter().fold(ports(), |ports, octant| {
                ports.cage(
                    &format!("child_{octant}"),
                    "the same coordinate of a child's cage",
                )
            }),
        ),
        Block::ChildPlanes => made(
            "child_planes",
            &[Stage::VertexPool],
            "8",
            "for edge j, k = j+1, l = j+2 (mod 3): less axis_l << half where the octant has bit k, plus axis_k << half where it has bit l",
            planes(ports())
                .one(
                    "half",
                    LEVEL,
                    "half the record's side in finest voxels, as a shift",
                )
                .one("octant", THREE, "which child, x highest"),
            ["x", "y", "z"].iter().fold(ports(), |ports, axis| {
                ports.each(&format!("child_edge_{axis}"), &["a", "b", "c"], WIDE, PLANE)
            }),
        ),
        Block::ChildCorners => made(
            "child_corners",
            &[Stage::ChildBox],
            "1",
            "along k: centre to max where the octant has bit k, else min to centre",
            corners(ports()).axes("centre", WORD, OBJECT).one(
                "octant",
                THREE,
                "which child, x highest",
            ),
            ports()
                .axes("child_min", WORD, OBJECT)
                .axes("child_max", WORD, OBJECT),
        ),
        Block::ChildSpan => made(
            "child_span",
            &[Stage::ChildBox],
            "4",
            "low = the least of the eight vertices, high = the greatest",
            ports().cage("child", "one coordinate of a child's cage"),
            ports()
                .one("low", WORD, "least vertex")
                .one("high", WORD, "greatest vertex"),
        ),
        Block::MarginGrow => made(
            "margin_grow",
            &[Stage::QuadtreeFit],
            "6",
            "each number of the cage: (w >> places) + 1 for places > 0, else w << -places",
            ports().cage("w", W).one(
                "places",
                PLACES,
                "tolerance as a part of the node's width, as a shift",
            ),
            ports().cage("margin", "what the box is widened by"),
        ),
        Block::MarginGap => made(
            "margin_gap",
            &[Stage::QuadtreeFit],
            "6",
            "each number of the cage: -(w >> below)",
            ports().cage("w", W).one("below", LEVEL, BELOW),
            ports().cage(
                "margin",
                "what the box is widened by: negative, it is narrowed",
            ),
        ),
        Block::BorderClip => made(
            "border_clip",
            &[Stage::QuadtreeFit],
            "6",
            "outside = x + margin < 0 at all vertices or x - w - margin > 0 at all; enclosed = not outside, x - margin >= 0 and x - w + margin <= 0 at all (wider: > 0 and < 0)",
            clip(ports())
                .cage("margin", "what the box is widened by")
                .one(
                    "wider",
                    BIT,
                    "the box is widened: it must lie strictly within",
                ),
            border(),
        ),
        Block::BisectorClip => made(
            "bisector_clip",
            &[Stage::QuadtreeFit],
            "6",
            "relative = 2 x - w; closed: low_half = min(relative - margin) <= 0, high_half = max(relative + margin) >= 0; else low_half = min(relative) < 0, high_half = max(relative) > 0 or not low_half; sample: both, or neither",
            clip(ports())
                .cage("margin", "what the box is widened by")
                .one("closed", BIT, "boxes hold their borders")
                .one("sample", BIT, "a sample's centre is tested, not a bisector"),
            halves(ports().cage("relative", "coordinates relative to the right half")),
        ),
        Block::NearNode => made(
            "near_node",
            &[Stage::QuadtreeFit],
            "6",
            "near = x + w >= 0 and x - 2 w <= 0 at all vertices",
            clip(ports()),
            bit(
                "near",
                "the box leaves the node by at most its width, along this axis",
            ),
        ),
        Block::HalfClip => made(
            "half_clip",
            &[Stage::QuadtreeFit],
            "4",
            "inner = far where right is set, else 2 x",
            ports()
                .cage("x", X)
                .cage("far", "2 x - w, from bisector_clip")
                .one("right", BIT, "the right (lower) half is next"),
            ports().cage("inner", "coordinates relative to that half"),
        ),
        Block::PlaneQuadrant => made(
            "plane_quadrant",
            &[Stage::QuadtreeFit, Stage::Draw],
            "8",
            "inner_c = 2 c + (quadrant bit 0 ? a : 0) + (quadrant bit 1 ? b : 0)",
            ports()
                .each("plane", &["a", "b", "c"], WIDE, "of a x + b y + c")
                .one("quadrant", TWO, "y << 1 | x"),
            ports().one("inner_c", WIDE, "c in the quadrant's coordinates"),
        ),
        Block::BorderScreen => made(
            "border_screen",
            &[Stage::QuadtreeFit],
            "6",
            "with left = node << (below + F), right = (node + 1) << (below + F): outside = high < left or low > right; enclosed = not outside, low >= left and high <= right",
            screen_box(),
            border(),
        ),
        Block::BisectorScreen => made(
            "bisector_screen",
            &[Stage::QuadtreeFit],
            "6",
            "with c = (2 node + 1) << (below + F - 1), rounded down: low_half = low < c, high_half = high > c or not low_half",
            screen_box(),
            halves(ports()),
        ),
        Block::Quadrants => made(
            "quadrants",
            &[Stage::QuadtreeFit],
            "6",
            "bit y << 1 | x of overlapped = half x across (0 low, 1 high) and half y down are overlapped",
            ports()
                .one("low_half_x", BIT, "the left half is overlapped")
                .one("high_half_x", BIT, "the right half is")
                .one("low_half_y", BIT, "the upper half is")
                .one("high_half_y", BIT, "the lower half is"),
            ports().one("overlapped", FOUR, "quadrants that the box overlaps"),
        ),
        Block::NodeChoice => made(
            "node_choice",
            &[Stage::QuadtreeFit],
            "6",
            "rejected = no overlapped quadrant is open; single = exactly one is overlapped; quadrant = its number, or 0",
            ports()
                .one("overlapped", FOUR, "quadrants that the box overlaps")
                .one("vector", FOUR, "the node's fill vector"),
            ports()
                .one("rejected", BIT, "the record is hidden")
                .one("single", BIT, "the box goes to one quadrant")
                .one("quadrant", TWO, "which one"),
        ),
        Block::CageCentre => made(
            "cage_centre",
            &[Stage::Draw],
            "7",
            "corners: (vertex 0 + vertex 7) >> 1; frame: corner + ((edge_x + edge_y + edge_z) >> 1)",
            ports().cage("cage", "one coordinate of a cage"),
            ports().one("centre", WORD, "the same of the centre"),
        ),
        Block::CentreHalf => made(
            "centre_half",
            &[Stage::Draw],
            "4",
            "right = 2 value - w >= 0; inner = 2 value - w where right, else 2 value",
            ports()
                .one("value", WORD, "X (or Y) of the centre, relative to a node")
                .one("w", WORD, "W of the centre"),
            ports()
                .one("right", BIT, "the centre is in the right (lower) half")
                .one("inner", WORD, "relative to that half"),
        ),
        Block::CentreSample => made(
            "centre_sample",
            &[Stage::Draw],
            "7",
            "sample = centre >> F, brought into node << below ... ((node + 1) << below) - 1",
            ports()
                .one("centre", WORD, "position of the centre")
                .one("node", NODE, "the quadtree node's column (or row)")
                .one("below", LEVEL, BELOW),
            ports().one("sample", WORD, "column (or row) of the sample drawn"),
        ),
        Block::CubePlanes => made(
            "cube_planes",
            &[Stage::Draw],
            "8",
            "for edge j, k = j+1, l = j+2 (mod 3): plane 0 = edge_j, 1 = 0 less axis_l << side, 2 = 0 plus axis_k << side, 3 = 1 plus axis_k << side",
            planes(ports()).one(
                "side",
                LEVEL,
                "the cube's side in finest voxels, as a shift",
            ),
            ["x", "y", "z"].iter().fold(ports(), |ports, axis| {
                (0..4).fold(ports, |ports, i| {
                    ports.each(&format!("plane_{axis}{i}"), &["a", "b", "c"], WIDE, PLANE)
                })
            }),
        ),
        Block::CubeFront => made(
            "cube_front",
            &[Stage::Draw],
            "8",
            "the first axis with eye_ceil <= min (upwards) or max <= eye_floor; side = 1 where upwards equals positive, else 2; none: all zero",
            corners(ports())
                .axes("eye_floor", WORD, "the eye, rounded down")
                .axes("eye_ceil", WORD, "the eye, rounded up")
                .one("positive", BIT, "the sign of the determinant of the edges"),
            ports()
                .one("found", BIT, "the eye is outside the cube along some axis")
                .one("axis", TWO, "0 x, 1 y, 2 z")
                .one("side", TWO, SIDE),
        ),
        Block::PlaneSide => made(
            "plane_side",
            &[Stage::Draw],
            "8",
            "low, high = c + the least, greatest of a x + b y over the node: a = b = c = 0 or low = high = 0: 3; low >= 0: 1; high <= 0: 2; sample: the first of 2c + a + b, a, b that is not zero: > 0: 1, < 0: 2; else 0",
            ports()
                .each("plane", &["a", "b", "c"], WIDE, "of a x + b y + c")
                .one("sample", BIT, "the node is a sample"),
            ports().one("side", TWO, SIDE),
        ),
        Block::PlaneCover => made(
            "plane_cover",
            &[Stage::Draw],
            "8",
            "0: along some axis no plane is 0 and not both 1 and 2 are there, or front_side is neither 0 nor wanted; 2: along all axes both 1 and 2, and front_side = wanted or no front; else 1. Front last",
            ["x", "y", "z"]
                .iter()
                .fold(ports(), |ports, axis| {
                    ports.list(&format!("side_{axis}"), 4, TWO, SIDE)
                })
                .one("front", BIT, "the cube has a front plane")
                .one("front_side", TWO, SIDE)
                .one("wanted", TWO, "the side on which rays reach the cube"),
            ports().one("cover_code", TWO, COVER),
        ),
        Block::FillUpdate => made(
            "fill_update",
            &[Stage::FillUpdate],
            "6",
            "after = vector OR bits; full = all four bits are set",
            ports().one("vector", FOUR, "the node's fill vector").one(
                "bits",
                FOUR,
                "quadrants that are full by now",
            ),
            ports().one("after", FOUR, "written back").one(
                "full",
                BIT,
                "the parent's bit is to be set",
            ),
        ),
        Block::BlendWay => blending::way(),
        Block::BlendShares => blending::shares(),
        Block::BlendCounts => blending::counts(),
        Block::BlendWeight => blending::weight(),
        Block::BlendSample => blending::sample(),
    }
}
