//! The blocks: ports, function and place in `SPEC.md`, and the frames that have them.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

use shiftvox::machine::{Block, RecordStage};
use shiftvox::project::FrameSetup;

#[derive(Debug, Deserialize)]
pub(super) struct Descriptions {
    pub(super) record: String,
    meanings: BTreeMap<String, String>,
    block: Vec<Description>,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(super) struct Description {
    /// Its name, and that of its file.
    pub(super) name: String,
    pub(super) stages: Vec<RecordStage>,
    pub(super) section: String,
    pub(super) function: String,
    /// Its inputs: see [`super::ports::Ports::new`].
    #[serde(rename = "in")]
    pub(super) inputs: String,
    #[serde(rename = "out")]
    pub(super) outputs: String,
}

impl Descriptions {
    pub(super) fn shipped() -> &'static Self {
        static SHIPPED: OnceLock<Descriptions> = OnceLock::new();
        SHIPPED.get_or_init(|| match toml::from_str(include_str!("blocks.toml")) {
            Ok(descriptions) => descriptions,
            Err(error) => unreachable!("the descriptions ship with the program: {error}"),
        })
    }

    pub(super) fn meaning(&self, block: &str, port: &str) -> &str {
        let own = self.meanings.get(&format!("{block}.{port}"));
        own.or_else(|| self.meanings.get(port))
            .map_or("", String::as_str)
    }
}

pub(super) fn describe(block: Block) -> &'static Description {
    &Descriptions::shipped().block[block as usize]
}

/// The reason why a frame has no rows of a block, if its rules exclude it.
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
