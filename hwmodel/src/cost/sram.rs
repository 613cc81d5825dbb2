//! Area of a memory by its shape.

use super::rows::{CostError, Goal, Quantity};
use super::table::{Cost, CostTable, Fit, cost};

/// A memory that is read and written by words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct MemoryShape {
    pub words: u64,
    /// Bits of a word.
    pub width: u32,
    /// Accesses per cycle.
    pub ports: u32,
}

/// Rows of the table for memories with one port and with two: for each bit, word, column and memory.
const ROWS: [[&str; 4]; 2] = [
    ["sram_bit", "sram_word", "sram_column", "sram_fixed"],
    ["sram2_bit", "sram2_word", "sram2_column", "sram2_fixed"],
];

impl CostTable {
    /// Area of a memory for each of its bits, in NAND2 equivalents, and the operation that has this price: `sram` or,
    /// where they are smaller, `register`s.
    ///
    /// An SRAM is a rectangle. Its height is proportional to the words, plus that of the sense amplifiers. Its width is
    /// proportional to the bits of a row, plus that of the decoder. The four rows are the products of these terms. A row has
    /// one word, or 2, 4, ... if the memory is smaller then. Memories with more than two ports are copies with two. Registers
    /// have a selector before them and one for each port.
    ///
    /// ```
    /// use hwmodel::cost::{CostTable, Goal, MemoryShape};
    ///
    /// let table = CostTable::load_shipped()?;
    /// let [one, two] = [1, 2].map(|ports| MemoryShape { words: 512, width: 64, ports });
    /// let area = |shape| table.memory_area(shape, Goal::Area).map(|(_, each)| 32768.0 * each.value);
    /// assert!((20_000.0..21_000.0).contains(&area(one)?));
    /// assert!((1.8..2.0).contains(&(area(two)? / area(one)?)));
    /// # Ok::<(), hwmodel::cost::CostError>(())
    /// ```
    pub fn memory_area(
        &self,
        shape: MemoryShape,
        goal: Goal,
    ) -> Result<(&'static str, Cost), CostError> {
        let copies = f64::from(shape.ports.div_ceil(2));
        let [bit, word, column, fixed] = ROWS[usize::from(shape.ports > 1)];
        let of_rows = |rows: f64, columns: f64| {
            let mut weights = Vec::new();
            for (operation, times) in [
                (bit, rows * columns),
                (word, rows),
                (column, columns),
                (fixed, 1.0),
            ] {
                let (of, _) = self.rows_of(Quantity::Nand2, operation, 1, Some(goal))?;
                let bits = shape.words as f64 * f64::from(shape.width);
                weights.extend(of.iter().map(|row| (row, copies * times / bits)));
            }
            Ok(cost(
                Quantity::Nand2,
                "sram_*",
                None,
                &weights,
                Fit::Interpolated,
            ))
        };
        let mut sram = of_rows(shape.words as f64, f64::from(shape.width))?;
        let mut fold = 2;
        while fold <= shape.words {
            let rows = shape.words.div_ceil(fold);
            let folded = of_rows(rows as f64, (fold * u64::from(shape.width)) as f64)?;
            if folded.value < sram.value {
                sram = folded;
            }
            fold *= 2;
        }
        let each = |operation| self.area(operation, 8, goal).map(|of| of.value / 8.0);
        let in_registers = each("register")? + f64::from(1 + shape.ports) * each("select")?;
        if in_registers < sram.value {
            let register = self.area("register", 8, goal)?;
            let [value, low, high] = [in_registers; 3];
            return Ok((
                "register",
                Cost {
                    value,
                    low,
                    high,
                    ..register
                },
            ));
        }
        Ok(("sram", sram))
    }
}
