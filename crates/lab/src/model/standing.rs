//! Leakage and the clock of a whole design, by its area and cycles.

use hwmodel::cost::{CostError, Standing};

use super::area::DesignArea;
use super::cost::{FrameCost, Prices};

/// The parts of a design that leak or are clocked. A small memory is registers.
pub fn standing(area: &DesignArea) -> Standing {
    let memories = area.memories.lines.iter();
    let (small, memories): (Vec<_>, Vec<_>) = memories.partition(|of| of.operation == "register");
    let small_nand2: f64 = small.iter().map(|of| of.total).sum();
    let small_bits: u64 = small.iter().map(|of| of.times).sum();
    let registers = area.registers.lines.iter();
    let bits: u64 = registers.map(|of| u64::from(of.width) * of.times).sum();
    Standing {
        logic_nand2: area.units.total + area.registers.total + area.control.total + small_nand2,
        memories: memories
            .iter()
            .map(|of| (of.name.clone(), of.times))
            .collect(),
        register_bits: bits + small_bits,
    }
}

impl FrameCost {
    /// The whole cost of a frame: with leakage and clock, and at the prices of a user's estimator, if there is one. It
    /// prices actions alone.
    pub fn whole(
        mut self,
        design: &str,
        area: &DesignArea,
        (cycles, clock_mhz): (u64, f64),
        prices: &Prices,
    ) -> Result<Self, CostError> {
        if let Some(by) = &prices.estimator {
            for part in [&mut self.operations, &mut self.on_chip, &mut self.outer] {
                *part = part.priced_by(design, by.as_ref())?;
            }
        }
        let parts = standing(area);
        let table = &prices.table;
        self.leakage = parts.leakage(cycles, clock_mhz, table)?;
        self.clock = parts.clock(cycles, table)?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwmodel::cost::{CostTable, Goal};

    /// Two adders of 232.9 NAND2, 32 bits of registers of 128, 1000 bits of memory, and 20 % of 593.8 for control.
    #[test]
    fn parts_by_hand() {
        let table = CostTable::load_shipped().unwrap();
        let goal = Goal::Area;
        let each = |operation, width| table.area(operation, width, goal).unwrap();
        let mut area = DesignArea::default();
        area.units.push("centre", "add", 32, 2, each("add", 32));
        area.registers
            .push("pipeline", "register", 8, 4, each("register", 8));
        area.memories
            .push("stack", "sram", 64, 1000, each("add", 32));
        area.memories
            .push("small", "register", 8, 5, each("invert", 1));
        area.control
            .push("control", "control", 1, 594, each("control", 1));
        let parts = standing(&area);
        let small = 5.0 * each("invert", 1).value;
        assert!((parts.logic_nand2 - (465.8 + 128.0 + 118.8 + small)).abs() < 1e-9);
        assert_eq!(parts.memories, [("stack".to_owned(), 1000)]);
        assert_eq!(parts.register_bits, 32 + 5);
        // Seven microseconds: 14 fJ of a gate, 8.15 fJ of a bit.
        let gates = parts.logic_nand2.round();
        let leakage = parts.leakage(1400, 200.0, &table).unwrap();
        assert!((leakage.total - 7.0 * (0.014 * gates + 0.00815 * 1000.0)).abs() < 1e-9);
        assert_eq!(leakage.lines.len(), 2);
    }
}
