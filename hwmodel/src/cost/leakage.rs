//! Energy that a design takes whether it works or not: leakage, and the clock of its registers.

use super::{Breakdown, CostError, CostTable};

/// A design's parts, as far as they leak or are clocked.
#[derive(Debug, Clone, Default)]
pub struct Standing {
    /// Of units, registers and control, NAND2 equivalents.
    pub logic_nand2: f64,
    /// Names and bits of memories.
    pub memories: Vec<(String, u64)>,
    /// Of all registers.
    pub register_bits: u64,
}

impl Standing {
    /// Leakage in so many cycles, in picojoules: a line for the logic, and one for each memory.
    ///
    /// ```
    /// use hwmodel::cost::{CostTable, Standing};
    ///
    /// let parts = Standing { logic_nand2: 1000.0, register_bits: 10, ..Standing::default() };
    /// let table = CostTable::load_shipped()?;
    /// // 10.6 to 17.4 fJ of a gate in a microsecond; 1400 cycles at 200 MHz are seven.
    /// assert!((parts.leakage(1400, 200.0, &table)?.total - 98.0).abs() < 1e-9);
    /// // 1.6 to 7.9 fJ of a bit in a cycle.
    /// assert!((parts.clock(1400, &table)?.total - 66.5).abs() < 1e-9);
    /// # Ok::<(), hwmodel::cost::CostError>(())
    /// ```
    pub fn leakage(
        &self,
        cycles: u64,
        clock_mhz: f64,
        table: &CostTable,
    ) -> Result<Breakdown, CostError> {
        let microseconds = cycles as f64 / clock_mhz;
        let mut sum = Breakdown::default();
        let mut push = |name: &str, operation: &str, times: u64| {
            let each = table.energy(operation, 1)?.times(microseconds);
            sum.push(name, operation, 1, times, each);
            Ok(())
        };
        push("logic", "logic_leakage", self.logic_nand2.round() as u64)?;
        for (name, bits) in &self.memories {
            push(name, "sram_leakage", *bits)?;
        }
        Ok(sum)
    }

    /// Energy of the clock in so many cycles, in picojoules.
    pub fn clock(&self, cycles: u64, table: &CostTable) -> Result<Breakdown, CostError> {
        let each = table.energy("clock", 1)?.times(cycles as f64);
        let mut sum = Breakdown::default();
        sum.push("registers", "clock", 1, self.register_bits, each);
        Ok(sum)
    }
}
