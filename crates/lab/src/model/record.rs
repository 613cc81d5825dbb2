//! The bits of a record on the machine's stack, field by field.
//!
//! Numbers have the bits of their greatest value. Coordinates have those of the frame's format or, if packed, the width that
//! set-up proves sufficient. Clip and screen space share bits, because a record is in one of them.

use hwmodel::Overflow;
use hwmodel::cycles::{Organisation, StackHolds};
use hwmodel::memory::RecordBits;
use serde::Serialize;

use super::frame::machine;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{NumberSpan, RecordNumber, proven_widths};
use shiftvox::project::vector::cross;
use shiftvox::project::{CageKind, EngineError, FrameSetup};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct RecordField {
    #[serde(rename = "field")]
    pub name: &'static str,
    pub bits: u32,
    pub held: FieldPresence,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum FieldPresence {
    Always,
    InClipSpace,
    InScreenSpace,
    /// As a finest voxel, which has no children and needs no vertices.
    AsFinestVoxel,
}

/// Bits of a number from 0 to `greatest`.
fn bits_to(greatest: u64) -> u32 {
    u64::BITS - greatest.leading_zeros()
}

/// Numbers of corners and of edges that a cage keeps.
fn cage_parts(setup: &FrameSetup) -> (u32, u32) {
    match setup.options.cage {
        CageKind::Corners => (8, 0),
        CageKind::Frame => (1, 3),
    }
}

/// The fields of a frame's records, as an organisation stores them. `nodes`: of the graph.
pub fn record_fields(
    setup: &FrameSetup,
    nodes: usize,
    mut organisation: Organisation,
) -> Vec<RecordField> {
    use FieldPresence::{Always, AsFinestVoxel, InClipSpace, InScreenSpace};
    let word = setup.format.bits();
    let wide = setup.format.wide().bits();
    let (corners, edges) = cage_parts(setup);
    let exact = setup.options.coverage.draws_outlines();
    if !exact {
        organisation = organisation.without_outlines();
    }
    let proven = proven_widths(setup, nodes).filter(|_| organisation.packed);
    let bits_of = |number: RecordNumber, otherwise: u32| match &proven {
        Some(proven) => proven.numbers[&number].bits().min(otherwise),
        None => otherwise,
    };
    let position = bits_to(1 << setup.level_bound());
    let places = bits_to(nodes.saturating_sub(1) as u64);
    let mut fields = Vec::new();
    let mut put = |held, name, bits| fields.push(RecordField { name, bits, held });
    put(Always, "octree node", places);
    let level = bits_to(u64::from(setup.level_bound()));
    put(Always, "octree level", level);
    if organisation.stack != StackHolds::Children {
        // Its node need not be read again: the place of its children stands where the node's would.
        if organisation.bricks {
            put(Always, "voxels of a brick", 64);
            put(Always, "where they begin", places);
        }
        // Of a brick, which children it has follows from its voxels.
        let has_leaf_mask = organisation.leaf_masks && !organisation.bricks;
        let masks = if has_leaf_mask { 16 } else { 8 };
        put(Always, "which children it has", masks);
        put(Always, "children left", 8);
    }
    let quad_level = bits_to(u64::from(setup.levels));
    if organisation.stack == StackHolds::Path {
        put(Always, "inside", 1);
        put(Always, "quadtree level", quad_level);
        return fields;
    }
    // A part of a solid is below its voxel's level; under the exact rule solids have no parts.
    let voxel_level = bits_to(u64::from(setup.depth));
    put(
        Always,
        "level of the voxel",
        if exact { 0 } else { voxel_level },
    );
    match exact {
        true => put(Always, "solid, inside", 2),
        false => put(Always, "solid, inside, pose", 3),
    }
    let lowest = bits_of(RecordNumber::Lowest, position);
    put(Always, "lowest vertex", 3 * lowest);
    // It can be had from the lowest vertex and the level; the image-order paper keeps it.
    put(Always, "highest vertex", 3 * position);
    put(Always, "quadtree level", quad_level);
    put(Always, "quadtree place", 2 * setup.levels);
    let corner = 2 * bits_of(RecordNumber::ClipXy, word) + bits_of(RecordNumber::ClipW, word);
    let edge = 2 * bits_of(RecordNumber::EdgeXy, word) + bits_of(RecordNumber::EdgeW, word);
    put(InClipSpace, "clip X, Y, W", corners * corner + edges * edge);
    put(InClipSpace, "least W", bits_of(RecordNumber::LeastW, word));
    if exact {
        // Three planes of three coefficients, and three constants.
        let planes = 6 * bits_of(RecordNumber::PlaneAb, wide)
            + 3 * bits_of(RecordNumber::PlaneC, wide)
            + 3 * bits_of(RecordNumber::AxisC, wide);
        put(Always, "silhouette planes", planes);
        put(AsFinestVoxel, "least W above 0", 1);
    } else {
        put(InScreenSpace, "screen x, y", 2 * (corners + edges) * word);
        put(InScreenSpace, "box", 4 * word);
    }
    fields
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct NumberWidths {
    pub name: &'static str,
    pub count: u32,
    /// Bits that the frame's records took.
    pub seen: u32,
    /// Bits that the set-up proves to be enough.
    pub proven: u32,
    /// Bits that the hardware has.
    pub used: u32,
}

/// Constants that set-up writes to registers, six of each: name, range in this frame, possible range, and bits without
/// packing.
fn setup_constants(setup: &FrameSetup) -> [(&'static str, NumberSpan, NumberSpan, u32); 2] {
    let span_of = |values: &mut dyn Iterator<Item = i128>| {
        let spans = values.map(NumberSpan::of);
        spans.reduce(NumberSpan::with).unwrap_or_default()
    };
    // All eyes beyond the object have the same comparisons.
    let beyond = (1i128 << (setup.depth + setup.sub_levels)) + 1;
    let eye = setup.eye_floor.iter().chain(&setup.eye_ceil);
    let eye = span_of(&mut eye.map(|&c| i128::from(c).clamp(-1, beyond)));
    let anywhere = NumberSpan::of(-1).with(NumberSpan::of(beyond));
    let edges = setup.edge_clip.map(|edge| edge.map(i128::from));
    let normals = (0..3).map(|k| cross(edges[(k + 1) % 3], edges[(k + 2) % 3]));
    let axes = span_of(&mut normals.flat_map(|[a, b, _]| [a, b]));
    let format = setup.format;
    [
        ("eye, of set-up", eye, anywhere, format.bits()),
        (
            "axis plane's a, b, of set-up",
            axes,
            axes,
            format.wide().bits(),
        ),
    ]
}

/// The widths of a record's numbers in a frame, and of set-up's constants; none under the rules that do not draw outlines.
pub fn number_widths(
    graph: &Graph,
    setup: &FrameSetup,
    organisation: Organisation,
) -> Result<Vec<NumberWidths>, EngineError> {
    let Some(proven) = proven_widths(setup, graph.len()) else {
        return Ok(Vec::new());
    };
    let mut machine = machine(Overflow::default(), organisation);
    let mut frame = Frame::new(setup.width, setup.height, false);
    let seen = machine.seen_numbers(&graph.view(), setup, &mut frame)?;
    let word = setup.format.bits();
    let wide = setup.format.wide().bits();
    let (corners, edges) = cage_parts(setup);
    let position = bits_to(1 << setup.level_bound());
    let used = |proven: u32, plain: u32| match organisation.packed {
        true => proven.min(plain),
        false => plain,
    };
    let row = |number: RecordNumber| {
        let bits = proven.numbers[&number].bits();
        // How many there are, and their bits without packing; what is not a coordinate has its proven bits anyway.
        let (count, plain) = match number {
            RecordNumber::Node | RecordNumber::Level | RecordNumber::QuadLevel => (1, bits),
            RecordNumber::QuadPlace => (2, bits),
            RecordNumber::Lowest | RecordNumber::Highest => (3, position),
            RecordNumber::ClipXy => (2 * corners, word),
            RecordNumber::ClipW => (corners, word),
            RecordNumber::EdgeXy => (2 * edges, word),
            RecordNumber::EdgeW => (edges, word),
            RecordNumber::LeastW => (1, word),
            RecordNumber::PlaneAb => (6, wide),
            RecordNumber::PlaneC | RecordNumber::AxisC => (3, wide),
        };
        NumberWidths {
            name: number.name(),
            count,
            seen: seen.get(&number).map_or(0, |span| span.bits()),
            proven: bits,
            used: used(bits, plain),
        }
    };
    let rows = RecordNumber::ALL.into_iter().map(row);
    let constants = setup_constants(setup).map(|(name, span, bound, plain)| NumberWidths {
        name,
        count: 6,
        seen: span.bits(),
        proven: bound.bits(),
        used: used(bound.bits(), plain),
    });
    Ok(rows.filter(|row| row.count > 0).chain(constants).collect())
}

/// Bits of a stack's entry, which holds records of any kind.
pub fn record_bits(fields: &[RecordField]) -> u32 {
    bits_held(fields, None).widest()
}

/// Bits of a context's registers: the record that it works on, and, where parents lie on the stack, the parent
/// with its children's vertices.
pub fn context_bits(setup: &FrameSetup, record_bits: u32, organisation: Organisation) -> u64 {
    let record = u64::from(record_bits);
    let word = u64::from(setup.format.bits());
    match (organisation.stack, setup.options.cage) {
        (StackHolds::Children, _) => record,
        // Of each coordinate: 27 vertices, or what the children's corners and edges are made from.
        (StackHolds::Parents, CageKind::Corners) => 2 * record + 3 * 27 * word,
        (StackHolds::Parents, CageKind::Frame) => 2 * record + 3 * 4 * word,
        (StackHolds::Path, cage) => {
            // The stack's entry is not the record; a node's number takes 32 bits at most.
            let whole = Organisation {
                stack: StackHolds::Parents,
                ..organisation
            };
            let fields = record_fields(setup, u32::MAX as usize, whole);
            let records = 2 * u64::from(bits_held(&fields, None).widest());
            match cage {
                CageKind::Corners => records + 3 * 27 * word,
                // The parent's numbers are its lowest child's, the edges doubled: wires.
                CageKind::Frame => records,
            }
        }
    }
}

/// Bits of a frame's records by kind. Under the rules that draw outlines, a finest voxel has no parts. Its turn only needs
/// to know whether all vertices are before the eye.
pub fn bits_by_kind(setup: &FrameSetup, nodes: usize, organisation: Organisation) -> RecordBits {
    // A parent is never a finest voxel.
    let has_finest =
        setup.options.coverage.draws_outlines() && organisation.stack == StackHolds::Children;
    let fields = record_fields(setup, nodes, organisation);
    bits_held(&fields, has_finest.then_some(setup.depth))
}

fn bits_held(fields: &[RecordField], finest_level: Option<u32>) -> RecordBits {
    let sum = |held: FieldPresence| -> u32 {
        let of = fields.iter().filter(|field| field.held == held);
        of.map(|field| field.bits).sum()
    };
    let always = sum(FieldPresence::Always);
    RecordBits {
        clip: always + sum(FieldPresence::InClipSpace),
        screen: always + sum(FieldPresence::InScreenSpace),
        finest: always + sum(FieldPresence::AsFinestVoxel),
        finest_level,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use shiftvox::graph::Placement;
    use shiftvox::project::{Camera, Coverage, SetupOptions};

    fn setup(coverage: Coverage, cage: CageKind) -> FrameSetup {
        let (eye, target) = (DVec3::new(40.0, 30.0, 20.0), DVec3::splat(8.0));
        let camera = Camera::looking(eye, target, 60.0, (200, 100));
        let options = SetupOptions {
            bits: 32,
            frac: Some(8),
            cage,
            ..SetupOptions::of(coverage)
        };
        FrameSetup::new(&camera, &Placement::default(), 4, &options).unwrap()
    }

    #[test]
    fn bits_by_hand() {
        let plain = Organisation::default();
        let exact = setup(Coverage::Exact, CageKind::Frame);
        // Node 10, level 3, flags 2, two corners of three times 0..=16, quadtree
        // level 0..=8 and 8 bits each way.
        let always = 10 + 3 + 2 + 2 * 3 * 5 + 4 + 16;
        let clip = always + 3 * 4 * 32 + 32 + 12 * 64;
        let bits = |setup, nodes| record_bits(&record_fields(setup, nodes, plain));
        assert_eq!((bits(&exact, 1024), bits(&exact, 1025)), (clip, clip + 1));
        // A finest voxel: no vertices, and of the least W whether it is above 0.
        let by_kind = bits_by_kind(&exact, 1024, plain);
        let finest = always + 12 * 64 + 1;
        let found = (by_kind.clip, by_kind.finest, by_kind.finest_level);
        assert_eq!(found, (clip, finest, Some(4)));
        // A third of the fraction's bits lies below the finest voxels: levels
        // to 6, of voxels to 4, places to 64.
        let any = setup(Coverage::Any, CageKind::Corners);
        let always = 10 + 3 + 3 + 3 + 2 * 3 * 7 + 4 + 16;
        assert_eq!(bits(&any, 1024), always + 3 * 8 * 32 + 32);
        let by_kind = bits_by_kind(&any, 1024, plain);
        let screen = always + 2 * 8 * 32 + 4 * 32;
        assert_eq!((by_kind.screen, by_kind.finest_level), (screen, None));
        // Contexts of parents hold two records and the children's vertices.
        let parents = Organisation {
            stack: StackHolds::Parents,
            ..plain
        };
        let contexts = [plain, parents].map(|of| context_bits(&exact, 1000, of));
        assert_eq!(contexts, [1000, 2000 + 3 * 4 * 32]);
    }
}
