//! The host's set-up of a frame: counted while it is done, apart from the
//! machine's operations, and priced by the same tables.

use std::collections::BTreeMap;

use hwmodel::Memory;
use hwmodel::cost::{Breakdown, CostError, Tally, energy_of_tallies};
use serde::Serialize;

use super::ModelError;
use super::cost::Prices;
use super::frame::Counted;
use crate::graph::Placement;
use crate::machine::count_load;
use crate::project::host::{self, HostCell, Kind, Step};
use crate::project::{Camera, FrameSetup, SetupOptions};

/// What the host did before the first record.
#[derive(Debug, Clone, Serialize)]
pub struct HostWork {
    /// Steps by what they were for, what was done, and to what.
    pub cells: Vec<HostCell>,
    /// All steps.
    pub steps: u64,
    /// Multiplies, of floats and integers.
    pub multiplies: u64,
    /// Divides, of floats and integers.
    pub divides: u64,
    /// Steps for each record of the frame.
    pub steps_per_record: f64,
    /// Steps for each pixel that is written.
    pub steps_per_pixel: f64,
    /// Energy of the steps that the tables have rows for, pJ.
    pub energy: Breakdown,
    /// Steps that the tables have no row for; their energy is left out.
    pub unpriced: u64,
}

/// The operation of the cost tables that a step is.
#[must_use]
pub const fn operation(step: Step, kind: Kind) -> Option<&'static str> {
    let float = matches!(kind, Kind::Float);
    match step {
        Step::Add if float => Some("float_add"),
        Step::Add => Some("add"),
        Step::Multiply if float => Some("float_multiply"),
        Step::Multiply => Some("multiply"),
        Step::Divide if float => Some("float_divide"),
        // A minimum is a comparison; its multiplexer is left out.
        Step::Compare | Step::MinMax if float => Some("float_compare"),
        Step::Compare => Some("less"),
        Step::MinMax => Some("min"),
        Step::Sign if !float => Some("sub"),
        Step::Shift => Some("shift_var"),
        Step::Logic => Some("xor"),
        Step::Divide
        | Step::SquareRoot
        | Step::Logarithm
        | Step::Tangent
        | Step::Sign
        | Step::Scale
        | Step::Round
        | Step::Convert => None,
    }
}

impl HostWork {
    /// Sets the frame up once more and counts. `counted`: what the machine made of it.
    ///
    /// # Errors
    /// When the frame cannot be set up, or the cost tables lack a figure.
    pub fn measure(
        camera: &Camera,
        placement: &Placement,
        depth: u32,
        options: &SetupOptions,
        counted: &Counted,
        prices: &Prices,
    ) -> Result<Self, ModelError> {
        let tally = host::Tally::default();
        let setup = FrameSetup::counted(camera, placement, depth, options, &tally)?;
        count_load(&setup, &tally);
        let cells: Vec<HostCell> = tally.cells().collect();
        let of = |is_wanted: &dyn Fn(&HostCell) -> bool| -> u64 {
            let wanted = cells.iter().filter(|cell| is_wanted(cell));
            wanted.map(|cell| cell.times).sum()
        };
        let steps = of(&|_| true);
        let (records, pixels) = (
            counted.counter.records(),
            counted.counter.writes(Memory::Pixel),
        );
        Ok(Self {
            steps,
            multiplies: of(&|cell| cell.step == Step::Multiply),
            divides: of(&|cell| cell.step == Step::Divide),
            steps_per_record: steps as f64 / records.max(1) as f64,
            steps_per_pixel: steps as f64 / pixels.max(1) as f64,
            energy: energy(&cells, prices)?,
            unpriced: of(&|cell| operation(cell.step, cell.kind).is_none()),
            cells,
        })
    }

    /// Steps by what was done and to what, whatever for.
    #[must_use]
    pub fn by_step(&self) -> BTreeMap<(Step, Kind), u64> {
        sums(&self.cells)
    }
}

fn sums(cells: &[HostCell]) -> BTreeMap<(Step, Kind), u64> {
    let mut sums = BTreeMap::new();
    for cell in cells {
        *sums.entry((cell.step, cell.kind)).or_default() += cell.times;
    }
    sums
}

fn energy(cells: &[HostCell], prices: &Prices) -> Result<Breakdown, CostError> {
    let priced = sums(cells).into_iter().filter_map(|((step, kind), times)| {
        Some(Tally {
            operation: operation(step, kind)?.to_owned(),
            width: kind.bits(),
            times,
        })
    });
    energy_of_tallies(&priced.collect::<Vec<_>>(), &prices.table)
}
