//! The blocks: ports, function and place in `SPEC.md`, and the frames that have them.

use hwmodel::Stage;

use shiftvox::machine::Block;
use shiftvox::project::FrameSetup;

/// A block as the manifest describes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Description {
    /// Its name, and that of its file.
    pub name: &'static str,
    /// The stages that contain it.
    pub stages: &'static [Stage],
    /// Its section of `SPEC.md`.
    pub section: &'static str,
    /// Its function.
    pub function: &'static str,
    /// Its inputs: see [`Ports::new`](super::Ports::new).
    pub inputs: &'static str,
    /// Its outputs.
    pub outputs: &'static str,
}

const SIZE: &[Stage] = &[Stage::OnePixel, Stage::Filled, Stage::ToScreen];
const FIT: &[Stage] = &[Stage::QuadtreeFit];
const DRAW: &[Stage] = &[Stage::Draw];
const BLEND: &[Stage] = &[Stage::Blend];

const fn of(
    name: &'static str,
    stages: &'static [Stage],
    section: &'static str,
    [inputs, outputs]: [&'static str; 2],
    function: &'static str,
) -> Description {
    Description {
        name,
        stages,
        section,
        function,
        inputs,
        outputs,
    }
}

/// Planes of three edges, and the planes across the axes by which they move.
macro_rules! planes {
    () => {
        "edge_x:3v edge_y:3v edge_z:3v axis_x:2v axis_y:2v axis_z:2v axis_x_c:v axis_y_c:v axis_z_c:v "
    };
}

/// Describes a block.
#[must_use]
#[expect(clippy::too_many_lines, reason = "one entry per block")]
pub const fn describe(block: Block) -> Description {
    match block {
        Block::Filled => of(
            "filled",
            &[Stage::Filled],
            "6",
            ["vector:u4", "full:u1"],
            "full = all four bits of the vector are set",
        ),
        Block::ChangeDepth => of(
            "change_depth",
            &[Stage::ToScreen],
            "5",
            ["w_min:w least:w", "deep:u1"],
            "deep = w_min >= least",
        ),
        Block::ChangeGuard => of(
            "change_guard",
            &[Stage::ToScreen],
            "5",
            ["x:c w:c places:s8", "enclosed:u1"],
            "enclosed = at all vertices x + (w >> places) >= 0 and (w - x) + (w >> places) >= 0, nothing rounded; \
             places < 0: w shifted left",
        ),
        Block::ToScreenDivide => of(
            "to_screen_divide",
            &[Stage::ToScreen],
            "5",
            ["x:w w:w fraction_bits:u6", "quotient:w"],
            "quotient = floor((x + 4 w) * 2^fraction_bits / w), for w > 0 and -4 w <= x < 12 w",
        ),
        Block::DetailDepth => of(
            "detail_depth",
            &[Stage::OnePixel],
            "7",
            ["w_min:w least:w", "solid:u1"],
            "solid = w_min >= least",
        ),
        Block::SizeLimit => of(
            "size_limit",
            SIZE,
            "7",
            ["w_min:w below:u6", "most:w"],
            "most = sum of w_min >> (s + below) over the shifts s of constant size_shifts; shifts below zero go left",
        ),
        Block::SizeClip => of(
            "size_clip",
            SIZE,
            "7",
            ["edge_x:3w edge_w:3w most:w", "fits:u1"],
            "fits = sum over k of max(|edge_x_k|, |edge_x_k - edge_w_k|) <= most",
        ),
        Block::SizeScreen => of(
            "size_screen",
            SIZE,
            "7",
            ["low:w high:w limit:w", "fits:u1"],
            "fits = high - low <= limit",
        ),
        Block::Centre => of(
            "centre",
            &[Stage::Centre],
            "2",
            ["min:3w max:3w", "centre:3w"],
            "centre = (min + max) >> 1, the sum with its carry",
        ),
        Block::OctantOrder => of(
            "octant_order",
            &[Stage::Order],
            "9",
            ["centre:3w eye_floor:3w", "octant:u3 child:8u3"],
            "octant bit k = eye_floor_k < centre_k, x highest; child_i = octant XOR {7,6,5,3,4,2,1,0}[i]",
        ),
        Block::VertexPool => of(
            "vertex_pool",
            &[Stage::VertexPool],
            "4",
            [
                "parent:c",
                "child_000:c child_001:c child_010:c child_011:c child_100:c child_101:c child_110:c child_111:c",
            ],
            "corners: midpoints (a + b) >> 1 along x, then y, then z; frame: edges (e + sign) >> 1, corners by seven adds",
        ),
        Block::ChildPlanes => of(
            "child_planes",
            &[Stage::VertexPool],
            "8",
            [
                concat!(planes!(), "half:u6 octant:u3"),
                "child_edge_x:3v child_edge_y:3v child_edge_z:3v",
            ],
            "for edge j, k = j+1, l = j+2 (mod 3): less axis_l << half where the octant has bit k, plus axis_k << half \
             where it has bit l",
        ),
        Block::ChildCorners => of(
            "child_corners",
            &[Stage::ChildBox],
            "1",
            [
                "min:3w max:3w centre:3w octant:u3",
                "child_min:3w child_max:3w",
            ],
            "along k: centre to max where the octant has bit k, else min to centre",
        ),
        Block::ChildSpan => of(
            "child_span",
            &[Stage::ChildBox],
            "4",
            ["child:c", "low:w high:w"],
            "low = the least of the eight vertices, high = the greatest",
        ),
        Block::MarginGrow => of(
            "margin_grow",
            FIT,
            "6",
            ["w:c places:s8", "margin:c"],
            "each number of the cage: (w >> places) + 1 for places > 0, else w << -places",
        ),
        Block::MarginGap => of(
            "margin_gap",
            FIT,
            "6",
            ["w:c below:u6", "margin:c"],
            "each number of the cage: -(w >> below)",
        ),
        Block::BorderClip => of(
            "border_clip",
            FIT,
            "6",
            ["x:c w:c margin:c wider:u1", "outside:u1 enclosed:u1"],
            "outside = x + margin < 0 at all vertices or x - w - margin > 0 at all; enclosed = not outside, x - margin >= 0 \
             and x - w + margin <= 0 at all (wider: > 0 and < 0)",
        ),
        Block::BisectorClip => of(
            "bisector_clip",
            FIT,
            "6",
            [
                "x:c w:c margin:c closed:u1 sample:u1",
                "relative:c low_half:u1 high_half:u1",
            ],
            "relative = 2 x - w; closed: low_half = min(relative - margin) <= 0, high_half = max(relative + margin) >= 0; \
             else low_half = min(relative) < 0, high_half = max(relative) > 0 or not low_half; sample: both, or neither",
        ),
        Block::NearNode => of(
            "near_node",
            FIT,
            "6",
            ["x:c w:c", "near:u1"],
            "near = x + w >= 0 and x - 2 w <= 0 at all vertices",
        ),
        Block::HalfClip => of(
            "half_clip",
            FIT,
            "4",
            ["x:c far:c right:u1", "inner:c"],
            "inner = far where right is set, else 2 x",
        ),
        Block::PlaneQuadrant => of(
            "plane_quadrant",
            &[Stage::QuadtreeFit, Stage::Draw],
            "8",
            ["plane:3v quadrant:u2", "inner_c:v"],
            "inner_c = 2 c + (quadrant bit 0 ? a : 0) + (quadrant bit 1 ? b : 0)",
        ),
        Block::BorderScreen => of(
            "border_screen",
            FIT,
            "6",
            ["low:w high:w node:u20 below:u6", "outside:u1 enclosed:u1"],
            "with left = node << (below + F), right = (node + 1) << (below + F): outside = high < left or low > right; \
             enclosed = not outside, low >= left and high <= right",
        ),
        Block::BisectorScreen => of(
            "bisector_screen",
            FIT,
            "6",
            ["low:w high:w node:u20 below:u6", "low_half:u1 high_half:u1"],
            "with c = (2 node + 1) << (below + F - 1), rounded down: low_half = low < c, high_half = high > c or not \
             low_half",
        ),
        Block::Quadrants => of(
            "quadrants",
            FIT,
            "6",
            [
                "low_half_x:u1 high_half_x:u1 low_half_y:u1 high_half_y:u1",
                "overlapped:u4",
            ],
            "bit y << 1 | x of overlapped = half x across (0 low, 1 high) and half y down are overlapped",
        ),
        Block::NodeChoice => of(
            "node_choice",
            FIT,
            "6",
            [
                "overlapped:u4 vector:u4",
                "rejected:u1 single:u1 quadrant:u2",
            ],
            "rejected = no overlapped quadrant is open; single = exactly one is overlapped; quadrant = its number, or 0",
        ),
        Block::CageCentre => of(
            "cage_centre",
            DRAW,
            "7",
            ["cage:c", "centre:w"],
            "corners: (vertex 0 + vertex 7) >> 1; frame: corner + ((edge_x + edge_y + edge_z) >> 1)",
        ),
        Block::CentreHalf => of(
            "centre_half",
            DRAW,
            "4",
            ["value:w w:w", "right:u1 inner:w"],
            "right = 2 value - w >= 0; inner = 2 value - w where right, else 2 value",
        ),
        Block::CentreSample => of(
            "centre_sample",
            DRAW,
            "7",
            ["centre:w node:u20 below:u6", "sample:w"],
            "sample = centre >> F, brought into node << below ... ((node + 1) << below) - 1",
        ),
        Block::CubePlanes => of(
            "cube_planes",
            DRAW,
            "8",
            [
                concat!(planes!(), "side:u6"),
                "plane_x0:3v plane_x1:3v plane_x2:3v plane_x3:3v plane_y0:3v plane_y1:3v plane_y2:3v plane_y3:3v \
                 plane_z0:3v plane_z1:3v plane_z2:3v plane_z3:3v",
            ],
            "for edge j, k = j+1, l = j+2 (mod 3): plane 0 = edge_j, 1 = 0 less axis_l << side, 2 = 0 plus axis_k << side, \
             3 = 1 plus axis_k << side",
        ),
        Block::CubeFront => of(
            "cube_front",
            DRAW,
            "8",
            [
                "min:3w max:3w eye_floor:3w eye_ceil:3w positive:u1",
                "found:u1 axis:u2 side:u2",
            ],
            "the first axis with eye_ceil <= min (upwards) or max <= eye_floor; side = 1 where upwards equals positive, \
             else 2; none: all zero",
        ),
        Block::PlaneSide => of(
            "plane_side",
            DRAW,
            "8",
            ["plane:3v sample:u1", "side:u2"],
            "low, high = c + the least, greatest of a x + b y over the node: a = b = c = 0 or low = high = 0: 3; low >= 0: \
             1; high <= 0: 2; sample: the first of 2c + a + b, a, b that is not zero: > 0: 1, < 0: 2; else 0",
        ),
        Block::PlaneCover => of(
            "plane_cover",
            DRAW,
            "8",
            [
                "side_x:4u2 side_y:4u2 side_z:4u2 front:u1 front_side:u2 wanted:u2",
                "cover_code:u2",
            ],
            "0: along some axis no plane is 0 and not both 1 and 2 are there, or front_side is neither 0 nor wanted; 2: \
             along all axes both 1 and 2, and front_side = wanted or no front; else 1. Front last",
        ),
        Block::FillUpdate => of(
            "fill_update",
            &[Stage::FillUpdate],
            "6",
            ["vector:u4 bits:u4", "after:u4 full:u1"],
            "after = vector OR bits; full = all four bits are set",
        ),
        Block::BlendWay => of(
            "blend_way",
            BLEND,
            "11",
            ["min:w max:w eye:w shift:u6", "way:w"],
            "way = |((min + max) >> 1 >> shift) - eye|, the first sum with its carry",
        ),
        Block::BlendShares => of(
            "blend_shares",
            BLEND,
            "11",
            ["way:3w", "share:3u5"],
            "with s = max(way_x + way_y + way_z, 1): share_x = (floor(32 way_x / s) + 1) >> 1, share_y the same of way_y but \
             at most 16 - share_x, share_z = 16 - share_x - share_y",
        ),
        Block::BlendCounts => of(
            "blend_counts",
            BLEND,
            "11",
            ["share:3u5", "count:3u5"],
            "with n = the square root of the sum of the squares, to the nearest: count = share^2 / n to the nearest, halves \
             up",
        ),
        Block::BlendWeight => of(
            "blend_weight",
            BLEND,
            "11",
            [
                "opacity_x:2u4 opacity_y:2u4 opacity_z:2u4 high:3u1 count:3u5",
                "weight:u9",
            ],
            "with a = the second number of the opacity where high is set, else the first: weight = 256 where an axis has a = \
             15, else the sum of (a + (a >> 3)) count",
        ),
        Block::BlendSample => of(
            "blend_sample",
            BLEND,
            "11",
            [
                "left:u9 weight:u9 light:3u16 sum:3u24",
                "rest:u9 after:3u24 first:u1 full:u1",
            ],
            "with m = (left weight + 128) >> 8: full = left - m <= 64, and then m = left; rest = left - m; after = sum + m \
             light; first = left is 256",
        ),
    }
}

/// The meaning of a port. Ports of several numbers have them in the order x, y, z; a, b, c; or of the vertices.
#[must_use]
pub(super) fn meaning(block: &str, port: &str) -> &'static str {
    match (block, port) {
        ("blend_weight", "high") => "the eye is on the high side of each axis",
        ("blend_way" | "blend_shares", "way") => "d of each axis",
        ("blend_sample", "full") => "opaque enough: the fill bit is to be set",
        ("blend_sample", "after") => "C of red, green, blue, written back",
        ("fill_update", "full") => "the parent's bit is to be set",
        ("plane_side" | "bisector_clip", "sample") => "the node is a sample",
        ("centre_sample", "centre") => "position of the centre",
        ("cage_centre", _) => "one coordinate of a cage, or of its centre",
        ("child_planes" | "cube_planes", name)
            if name.contains("edge") || name.starts_with("plane") =>
        {
            "a, b, c of an edge's plane a x + b y + c"
        }
        ("child_planes" | "cube_planes", "axis_x" | "axis_y" | "axis_z") => {
            "a, b of the plane perpendicular to the axis"
        }
        ("child_planes" | "cube_planes", name) if name.starts_with("axis") => {
            "c of the plane perpendicular to the axis"
        }
        ("cube_planes", "side") => "the cube's side in finest voxels, as a shift",
        ("vertex_pool", _) => "one coordinate of a cage: the record's or a child's",
        (_, "min" | "max" | "centre" | "child_min" | "child_max") => {
            "object coordinates, units of a finest voxel shifted by the levels below it"
        }
        (_, "eye_floor") => "the eye, rounded down",
        (_, "eye_ceil") => "the eye, rounded up",
        (_, "x" | "edge_x") => "X (or Y) relative to the quadtree node",
        (_, "w" | "edge_w") => "W",
        (_, "w_min") => "least W of the vertices",
        (_, "least") => "depth from which on the output is set",
        (_, "margin") => "the margin by which the box is widened; negative, it is narrowed",
        (_, "places") => "a part of the node's width, as a shift",
        (_, "below") => "levels from the quadtree node to the samples",
        (_, "fraction_bits") => "steps after the four integer steps",
        (_, "quotient") => "x / w + 4 with so many fraction bits, rounded down",
        (_, "most") => "extent of one sample at the least depth",
        (_, "low" | "high") => "least and greatest position, or vertex",
        (_, "limit") => "a size in the same units",
        (_, "node") => "the quadtree node's column (or row)",
        (_, "octant") => "a child or a direction, x highest",
        (_, "child") => "the children, nearest first; or one coordinate of a child's cage",
        (_, "vector") => "fill vector of the quadtree node",
        (_, "bits") => "quadrants that are full by now",
        (_, "overlapped") => "quadrants that the box overlaps",
        (_, "quadrant") => "y << 1 | x",
        (_, "outside") => "no part of the box is within the node",
        (_, "enclosed") => "all of the box is within the node, or leaves it by little enough",
        (_, "closed") => "boxes hold their borders",
        (_, "wider") => "the box is widened: it must lie strictly within",
        (_, "low_half" | "low_half_x" | "low_half_y") => "the left (upper) half is overlapped",
        (_, "high_half" | "high_half_x" | "high_half_y") => "the right (lower) half is overlapped",
        (_, "relative" | "far") => "coordinates relative to the right (lower) half",
        (_, "right") => "the right (lower) half",
        (_, "inner") => "coordinates relative to that half",
        (_, "plane") => "a, b, c of a x + b y + c",
        (_, "inner_c") => "c in the quadrant's coordinates",
        (_, "half") => "half the record's side in finest voxels, as a shift",
        (_, "positive") => "the sign of the determinant of the edges",
        (_, "found") => "the eye is outside the cube along some axis",
        (_, "axis") => "0 x, 1 y, 2 z",
        (_, "side" | "side_x" | "side_y" | "side_z" | "front_side") => {
            "0 not all on one side, 1 positive, 2 negative, 3 there is no plane"
        }
        (_, "front") => "the cube has a front plane",
        (_, "wanted") => "the side on which rays reach the cube",
        (_, "cover_code") => "0 no sample of the node is covered, 1 some may be, 2 all are",
        (_, "share") => "u of each axis, sixteenths",
        (_, "count") => "v of each axis: the weight of the side, sixteenths",
        (_, "opacity_x" | "opacity_y" | "opacity_z") => {
            "the voxel's opacity from the low and the high side"
        }
        (_, "weight") => "w: 256 lets nothing through",
        (_, "eye") => "the eye, shifted already",
        (_, "shift") => "k of the section",
        (_, "left" | "rest") => "T: the share of light that the sample still lets through",
        (_, "light") => "linear light of the voxel: red, green, blue",
        (_, "sum") => "C of red, green, blue: the light of the sample so far",
        (_, "first") => "the first voxel that the sample takes",
        (_, "after") => "written back",
        _ => "see the function",
    }
}

/// The reason why a frame has no rows of a block, if its rules exclude it.
#[must_use]
pub(super) fn absence(block: Block, setup: &FrameSetup) -> Option<&'static str> {
    const NOT_EXACT: &str = "only coverages exact and alpha have it";
    const IS_EXACT: &str = "coverages exact and alpha do not have it";
    let exact = setup.options.coverage.draws_outlines();
    let changes = setup.screen_depth.iter().any(|&w| w != i64::MAX);
    match block {
        Block::ChangeDepth
        | Block::ChangeGuard
        | Block::ToScreenDivide
        | Block::SizeScreen
        | Block::BorderScreen
        | Block::BisectorScreen
        | Block::CentreSample => match (exact, changes) {
            (true, _) => Some(IS_EXACT),
            (_, false) => Some("at this tolerance no record changes to screen space"),
            _ => None,
        },
        Block::ChildPlanes
        | Block::PlaneQuadrant
        | Block::MarginGap
        | Block::CubePlanes
        | Block::CubeFront
        | Block::PlaneSide
        | Block::PlaneCover => (!exact).then_some(NOT_EXACT),
        Block::CageCentre | Block::CentreHalf => exact.then_some(IS_EXACT),
        Block::BlendWay
        | Block::BlendShares
        | Block::BlendCounts
        | Block::BlendWeight
        | Block::BlendSample => {
            (!setup.options.coverage.blends()).then_some("only coverage alpha has it")
        }
        Block::DetailDepth => {
            (setup.lod_limit.is_none()).then_some("level of detail 0 takes no node for a solid")
        }
        Block::MarginGrow if exact => Some(IS_EXACT),
        Block::MarginGrow => {
            (setup.grow_shift.is_none()).then_some("at this tolerance boxes are not widened")
        }
        _ => None,
    }
}
