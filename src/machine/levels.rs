//! Arithmetic on octree and quadtree levels: counters beside the words, in control logic of their own. They are counted
//! like any operation, but no unit's issue waits for them.

use hwmodel::{Datapath, OpClass, Probe};

use super::blocks::{LEVEL_BITS, PLACES_BITS};
use crate::frame::QuadNode;

/// How far a level is above a deeper one.
#[inline(always)]
pub(super) fn above<P: Probe>(dp: &mut Datapath<P>, level: u32, deeper: u32) -> u32 {
    dp.control(OpClass::Sub, LEVEL_BITS);
    deeper - level
}

/// One level down.
#[inline(always)]
pub(super) fn next<P: Probe>(dp: &mut Datapath<P>, level: u32) -> u32 {
    dp.control(OpClass::Add, LEVEL_BITS);
    level + 1
}

/// A quadtree node's parent.
#[inline(always)]
pub(super) fn up<P: Probe>(dp: &mut Datapath<P>, quad: QuadNode) -> QuadNode {
    dp.control(OpClass::Sub, LEVEL_BITS);
    quad.ancestor(quad.level - 1)
}

/// Whether a level is as deep as another.
#[inline(always)]
pub(super) fn reaches<P: Probe>(dp: &mut Datapath<P>, level: u32, deeper: u32) -> bool {
    dp.control(OpClass::Compare, LEVEL_BITS);
    level >= deeper
}

/// The places of a shift that depends on a level, from a constant.
#[inline(always)]
pub(super) fn places<P: Probe>(dp: &mut Datapath<P>, constant: i32, levels: i32) -> i32 {
    dp.control(OpClass::Add, PLACES_BITS);
    constant + levels
}
