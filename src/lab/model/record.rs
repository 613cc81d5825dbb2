//! How many bits a record has on the machine's stack, field by field: what an
//! architect needs for the stack's width.
//!
//! Numbers have as many bits as their greatest value needs, coordinates those
//! of the frame's format. Poses share their bits: a record has one at a time,
//! and under the rules that draw outlines there is one pose alone.

use hwmodel::cycles::{Organisation, StackHolds};
use hwmodel::memory::RecordBits;

use crate::project::{CageKind, FrameSetup};

/// A field of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordField {
    /// Its name.
    pub name: &'static str,
    /// Its bits, all parts of it together.
    pub bits: u32,
    /// The poses in which a record has it.
    pub held: FieldPresence,
}

/// When a record has a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldPresence {
    /// Always.
    Always,
    /// In clip space.
    InClipSpace,
    /// In screen space.
    InScreenSpace,
    /// As a finest voxel, which has no children and hence no need of vertices.
    AsFinestVoxel,
}

/// Silhouette plane coefficients of a record: three planes of three, and
/// three constants.
const PLANE_WORDS: u32 = 12;

/// Bits of a number from 0 to `greatest`.
fn bits_to(greatest: u64) -> u32 {
    u64::BITS - greatest.leading_zeros()
}

/// The fields of a frame's records, as an organisation stores them. `nodes`: of the graph.
#[must_use]
pub fn record_fields(
    setup: &FrameSetup,
    nodes: usize,
    organisation: Organisation,
) -> Vec<RecordField> {
    let word = setup.format.bits();
    let wide = setup.format.wide().bits();
    let vertices = match setup.options.cage {
        CageKind::Corners => 8,
        CageKind::Frame => 4,
    };
    let exact = setup.options.coverage.draws_outlines();
    let position = bits_to(1 << setup.level_bound());
    let field = |name, bits, held| RecordField { name, bits, held };
    let mut fields = vec![
        field(
            "octree node",
            bits_to(nodes.saturating_sub(1) as u64),
            FieldPresence::Always,
        ),
        field(
            "octree level",
            bits_to(u64::from(setup.level_bound())),
            FieldPresence::Always,
        ),
        // A part of a solid is below its voxel's level; under the exact rule
        // solids have no parts.
        field(
            "level of the voxel",
            if exact {
                0
            } else {
                bits_to(u64::from(setup.depth))
            },
            FieldPresence::Always,
        ),
        match exact {
            true => field("solid, inside", 2, FieldPresence::Always),
            false => field("solid, inside, pose", 3, FieldPresence::Always),
        },
        field("lowest vertex", 3 * position, FieldPresence::Always),
        // It can be had from the lowest vertex and the level; the image-order paper keeps it.
        field("highest vertex", 3 * position, FieldPresence::Always),
        field(
            "quadtree level",
            bits_to(u64::from(setup.levels)),
            FieldPresence::Always,
        ),
        field("quadtree place", 2 * setup.levels, FieldPresence::Always),
        field(
            "clip X, Y, W",
            3 * vertices * word,
            FieldPresence::InClipSpace,
        ),
        field("least W", word, FieldPresence::InClipSpace),
    ];
    if organisation.stack == StackHolds::Parents {
        // Its node need not be read again: the place of its children stands where the node's would.
        let masks = if organisation.leaf_masks { 16 } else { 8 };
        fields.push(field("which children it has", masks, FieldPresence::Always));
        fields.push(field("children left", 8, FieldPresence::Always));
    }
    if exact {
        let planes = PLANE_WORDS * wide;
        fields.push(field("silhouette planes", planes, FieldPresence::Always));
        fields.push(field("least W above 0", 1, FieldPresence::AsFinestVoxel));
    } else {
        fields.push(field(
            "screen x, y",
            2 * vertices * word,
            FieldPresence::InScreenSpace,
        ));
        fields.push(field("box", 4 * word, FieldPresence::InScreenSpace));
    }
    fields
}

/// Bits of a stack's entry, which holds records of any kind.
#[must_use]
pub fn record_bits(fields: &[RecordField]) -> u32 {
    bits_held(fields, None).widest()
}

/// Bits of a context's registers: the record that it works on, and, where parents lie on the stack, the parent
/// with its children's vertices.
#[must_use]
pub fn context_bits(setup: &FrameSetup, record_bits: u32, organisation: Organisation) -> u64 {
    let record = u64::from(record_bits);
    if organisation.stack == StackHolds::Children {
        return record;
    }
    // Of each coordinate: 27 vertices, or eight corners and the edges that they share.
    let numbers = match setup.options.cage {
        CageKind::Corners => 27,
        CageKind::Frame => 8 + 3,
    };
    2 * record + 3 * numbers * u64::from(setup.format.bits())
}

/// Bits of a frame's records by their kind. Under the rules that draw outlines
/// a cube at the level of the finest voxels is drawn and has no parts: of its
/// vertices its turn needs one thing, whether all are before the eye.
#[must_use]
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
    use glam::DVec3;

    use super::*;
    use crate::graph::Placement;
    use crate::project::Coverage;
    use crate::project::{Camera, SetupOptions};

    fn setup(options: SetupOptions) -> FrameSetup {
        let camera = Camera {
            eye: DVec3::new(40.0, 30.0, 20.0),
            target: DVec3::splat(8.0),
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: 200,
            height: 100,
        };
        let setup = FrameSetup::new(&camera, &Placement::default(), 4, &options).unwrap();
        assert_eq!(setup.levels, 8);
        setup
    }

    fn bits(options: SetupOptions, nodes: usize) -> u32 {
        let setup = setup(options);
        record_bits(&record_fields(&setup, nodes, Organisation::default()))
    }

    #[test]
    fn contexts_of_parents_hold_two_records_and_the_children_s_vertices() {
        let frame = setup(SetupOptions::default());
        let parents = Organisation {
            stack: StackHolds::Parents,
            ..Organisation::default()
        };
        assert_eq!(context_bits(&frame, 1000, Organisation::default()), 1000);
        assert_eq!(context_bits(&frame, 1000, parents), 2000 + 3 * 11 * 64);
    }

    #[test]
    fn bits_by_hand() {
        let options = |coverage, cage| SetupOptions {
            bits: 32,
            frac: Some(8),
            cage,
            ..SetupOptions::of(coverage)
        };
        // Node 10, level 3, flags 2, two corners of three times 0..=16, quadtree
        // level 0..=8 and 8 bits each way.
        let always = 10 + 3 + 2 + 2 * 3 * 5 + 4 + 16;
        let exact = options(Coverage::Exact, CageKind::Frame);
        let clip = 3 * 4 * 32 + 32 + 12 * 64;
        assert_eq!(bits(exact, 1024), always + clip);
        assert_eq!(bits(exact, 1025), always + clip + 1);
        // A finest voxel: no vertices, and of the least W whether it is above 0.
        let by_kind = bits_by_kind(&setup(exact), 1024, Organisation::default());
        assert_eq!(by_kind.clip, always + clip);
        assert_eq!(by_kind.finest, always + 12 * 64 + 1);
        assert_eq!(by_kind.finest_level, Some(4));
        let any = options(Coverage::Any, CageKind::Corners);
        // A third of the fraction's bits lies below the finest voxels: levels
        // to 6, of voxels to 4, places to 64.
        let always = 10 + 3 + 3 + 3 + 2 * 3 * 7 + 4 + 16;
        assert_eq!(bits(any, 1024), always + 3 * 8 * 32 + 32);
        let by_kind = bits_by_kind(&setup(any), 1024, Organisation::default());
        assert_eq!(by_kind.screen, always + 2 * 8 * 32 + 4 * 32);
        assert_eq!(by_kind.finest_level, None);
    }
}
