//! Combinational blocks that a designer would build and test separately. [`Datapath::tap`](hwmodel::Datapath::tap)
//! reports their inputs and outputs, and `shiftvox model --vectors` writes them.

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
    /// A block without memory: its outputs follow from its inputs and the frame's constants.
    Block, 38:
    /// Is the quadtree node full?
    Filled,
    /// May a record's depth change to screen space?
    ChangeDepth,
    /// Does a record's box leave the picture by little enough to change?
    ChangeGuard,
    /// A quotient, bit by bit.
    ToScreenDivide,
    /// Is a node, by its depth, within the level of detail?
    DetailDepth,
    SizeLimit,
    /// Is a clip-space record no larger, along one axis?
    SizeClip,
    /// Is a screen-space box no larger, along one axis?
    SizeScreen,
    /// The centre of a voxel in object space.
    Centre,
    /// Octant bits, and the children in order.
    OctantOrder,
    /// The children's vertices, one coordinate.
    VertexPool,
    ChildPlanes,
    ChildCorners,
    /// The least and the greatest of a child's vertices, one coordinate.
    ChildSpan,
    /// The margin that widens boxes in clip space.
    MarginGrow,
    /// The margin that narrows boxes in clip space.
    MarginGap,
    /// A clip-space box and the edges of a node, along one axis.
    BorderClip,
    BisectorClip,
    /// Does a clip-space box leave a node by at most its width, along one axis?
    NearNode,
    /// One coordinate of a clip-space cage in the left or the right half.
    HalfClip,
    PlaneQuadrant,
    /// A screen-space box and the edges of a node, along one axis.
    BorderScreen,
    BisectorScreen,
    /// Two halves along each axis to quadrants.
    Quadrants,
    /// Overlapped quadrants and fill vector to: rejected, or which one.
    NodeChoice,
    /// The middle of a cage, one coordinate.
    CageCentre,
    CentreHalf,
    /// The sample that holds a screen-space centre, along one axis.
    CentreSample,
    CubePlanes,
    /// From which side rays reach a cube that is not before the eye.
    CubeFront,
    /// The side of a plane on which a node's samples are.
    PlaneSide,
    /// Sides of a cube's planes to: covered, outside, mixed.
    PlaneCover,
    /// Bits set in a fill vector.
    FillUpdate,
    /// The way from the eye to a voxel along one axis.
    BlendWay,
    /// A voxel's outline divided among the three visible sides.
    BlendShares,
    /// The weights of the three sides, from their shares.
    BlendCounts,
    /// A voxel's weight, of its opacities.
    BlendWeight,
    /// The light and the opacity that a voxel adds to a sample.
    BlendSample,
}

impl From<Block> for u32 {
    fn from(block: Block) -> Self {
        block as Self
    }
}

numbered! {
    /// A port to a memory. For a probe it is a block, numbered after all [`Block`]s: its input is the address, and its output
    /// the written or read data.
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
