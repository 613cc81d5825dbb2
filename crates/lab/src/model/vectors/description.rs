//! A block in words, and why a frame may have none of it.

use hwmodel::Stage;

use super::ports::Ports;
use shiftvox::machine::Block;
use shiftvox::project::FrameSetup;

/// What a coordinate of object space is.
pub(super) const OBJECT: &str =
    "object coordinate, units of a finest voxel shifted by the levels below it";

/// A block as the manifest describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// Its name, and that of its files.
    pub name: &'static str,
    /// Stages that have it.
    pub stages: &'static [Stage],
    /// Section of `SPEC.md`.
    pub section: &'static str,
    /// What it does.
    pub function: &'static str,
    /// Its inputs.
    pub stimulus: Ports,
    /// Its outputs.
    pub expected: Ports,
}

impl Description {
    /// Of these parts.
    pub(super) fn new(
        name: &'static str,
        stages: &'static [Stage],
        section: &'static str,
        function: &'static str,
        stimulus: Ports,
        expected: Ports,
    ) -> Self {
        Self {
            name,
            stages,
            section,
            function,
            stimulus,
            expected,
        }
    }
}

/// Why a frame with these integers has no rows of a block, if that is so.
#[must_use]
pub fn absence(block: Block, setup: &FrameSetup) -> Option<&'static str> {
    let exact = setup.options.coverage.draws_outlines();
    let changes = setup.screen_depth.iter().any(|&w| w != i64::MAX);
    const NOT_EXACT: &str = "only coverages exact and alpha have it";
    const IS_EXACT: &str = "coverages exact and alpha do not have it";
    const NOT_ALPHA: &str = "only coverage alpha has it";
    const NO_CHANGE: &str = "at this tolerance no record changes to screen space";
    let of_screen = || match (exact, changes) {
        (true, _) => Some(IS_EXACT),
        (_, false) => Some(NO_CHANGE),
        _ => None,
    };
    match block {
        Block::ChangeDepth
        | Block::ChangeGuard
        | Block::ToScreenDivide
        | Block::SizeScreen
        | Block::BorderScreen
        | Block::BisectorScreen
        | Block::CentreSample => of_screen(),
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
        | Block::BlendSample => (!setup.options.coverage.blends()).then_some(NOT_ALPHA),
        Block::DetailDepth => {
            (setup.lod_limit.is_none()).then_some("level of detail 0 takes no node for a solid")
        }
        Block::MarginGrow => {
            if exact {
                return Some(IS_EXACT);
            }
            (setup.grow_shift.is_none()).then_some("at this tolerance boxes are not widened")
        }
        _ => None,
    }
}
