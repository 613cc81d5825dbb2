//! The light hardware's figures for a frame that was counted and simulated.

use hwmodel::cycles::{CycleReport, Hardware};
use serde::Serialize;

use super::ModelError;
use super::area::{self, DesignArea};
use super::clock::{self, ClockCheck};
use super::cost::{self, FrameCost, Prices};
use super::frame::{self, Counted};
use shiftvox::graph::Graph;
use shiftvox::project::FrameSetup;

/// The design's name in files of other programs.
pub const LIGHT: &str = "light";

#[derive(Debug, Clone, Serialize)]
pub struct LightDesign {
    pub cost: FrameCost,
    pub area: DesignArea,
    pub clock: ClockCheck,
}

impl LightDesign {
    pub fn price(
        graph: &Graph,
        setup: &FrameSetup,
        counted: &Counted,
        cycles: &CycleReport,
        hardware: &Hardware,
        prices: &Prices,
    ) -> Result<Self, ModelError> {
        let widths = frame::widths(setup, graph, hardware);
        let area = area::light(counted, cycles, setup, hardware, prices)?;
        let cost = cost::frame_cost(counted, cycles, &widths, setup, hardware, prices)?;
        let used = counted.counter.sum_by(|cell| (cell.stage, cell.class));
        Ok(Self {
            cost: cost.whole(LIGHT, &area, (cycles.cycles, hardware.clock_mhz), prices)?,
            area,
            clock: clock::check(used.into_keys(), hardware, prices)?,
        })
    }
}
