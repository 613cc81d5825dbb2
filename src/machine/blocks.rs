//! Combinational blocks that are built and tested separately. [`Datapath::tap`](hwmodel::Datapath::tap) reports their
//! inputs and outputs; `shiftvox model --vectors` writes them.

use hwmodel::{Datapath, Probe, Short, Wires};

/// An enumeration and the list of its values.
macro_rules! numbered {
    ($(#[$enum_doc:meta])* $enum:ident, $count:literal: $($(#[$doc:meta])* $name:ident,)*) => {
        $(#[$enum_doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum $enum {
            $($(#[$doc])* $name,)*
        }

        impl $enum {
            pub const ALL: [Self; $count] = [$(Self::$name,)*];
        }
    };
}

numbered! {
    /// A block without memory; `crates/lab/src/model/vectors/blocks.toml` describes each.
    Block, 38:
    Filled,
    ChangeDepth,
    ChangeGuard,
    ToScreenDivide,
    DetailDepth,
    SizeLimit,
    SizeClip,
    SizeScreen,
    Centre,
    OctantOrder,
    VertexPool,
    ChildPlanes,
    ChildCorners,
    ChildSpan,
    MarginGrow,
    MarginGap,
    BorderClip,
    BisectorClip,
    NearNode,
    HalfClip,
    PlaneQuadrant,
    BorderScreen,
    BisectorScreen,
    Quadrants,
    NodeChoice,
    CageCentre,
    CentreHalf,
    CentreSample,
    CubePlanes,
    CubeFront,
    PlaneSide,
    PlaneCover,
    FillUpdate,
    BlendWay,
    BlendShares,
    BlendCounts,
    BlendWeight,
    BlendSample,
}

impl From<Block> for u32 {
    fn from(block: Block) -> Self {
        block as Self
    }
}

numbered! {
    /// A port to a memory: for a probe a block, numbered after all [`Block`]s, whose input is the address and whose output
    /// is the data.
    Port, 8:
    /// A record is taken from the stack.
    Pop,
    Push,
    FillRead,
    FillWrite,
    NodeRead,
    /// The record loop does not use the attributes.
    AttributeRead,
    /// The node that a pixel shows.
    PixelWrite,
    /// With parents on the stack: a record is in registers, new (0) or restored (1).
    Made,
}

impl Port {
    #[inline(always)]
    pub(super) fn tap<P: Probe>(self, dp: &mut Datapath<P>, address: u64, data: &impl Wires) {
        let number = Block::ALL.len() as u32 + self as u32;
        dp.tap(number, &Short::unsigned(address as u32, ADDRESS_BITS), data);
    }
}

pub(super) const ADDRESS_BITS: u32 = 32;
/// Wires of an octree or quadtree level, or of a shift by levels.
pub(super) const LEVEL_BITS: u32 = 6;
/// Wires of a signed number of places to shift by.
pub(super) const PLACES_BITS: u32 = 8;
/// Wires of a quadtree node's row or column.
pub(super) const NODE_BITS: u32 = 20;

/// A quadtree node's column or row, and its level above the samples.
#[inline(always)]
pub(super) fn node_wires(column: u32, below: u32) -> (Short, Short) {
    (
        Short::unsigned(column, NODE_BITS),
        Short::unsigned(below, LEVEL_BITS),
    )
}
