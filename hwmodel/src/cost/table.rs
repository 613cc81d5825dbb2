//! The table: shipped rows, a user's rows over them, and interpolation.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::rows::{
    AREA_FILE, CostError, CostRow, ENERGY_FILE, Goal, Quantity, Rows, Spread, parse,
};
use super::technology::Technology;

/// Origin of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fit {
    /// A row contains it.
    Row,
    /// It lies between two rows, or is scaled to an access of other bits.
    Interpolated,
    /// It lies below the narrowest row or above the widest.
    Extrapolated,
}

/// A figure and its origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Cost {
    pub quantity: Quantity,
    /// The middle of its range, in the quantity's unit.
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub fit: Fit,
    /// Whether a row derives its figure from another source's, as the row's source states.
    pub derived: bool,
    /// The rows in words, with their file.
    pub rows: String,
    /// The source of these rows.
    pub source: String,
}

impl Cost {
    /// The cost of several.
    #[must_use]
    pub fn times(mut self, factor: f64) -> Self {
        for figure in [&mut self.value, &mut self.low, &mut self.high] {
            *figure *= factor;
        }
        self
    }
}

/// Rows of several tables, a user's over the shipped ones. A request without a row is an error.
///
/// ```
/// use hwmodel::cost::{CostTable, Fit, Goal};
///
/// let table = CostTable::load_shipped()?;
/// let adder = table.area("add", 32, Goal::Area)?;
/// assert_eq!((adder.value, adder.fit), (232.9, Fit::Row));
/// assert_eq!(table.area("add", 40, Goal::Area)?.fit, Fit::Interpolated);
/// let mine = r#"row = [{ operation = "add", width = 32, nand2 = 200, source = "my synthesis" }]"#;
/// let table = table.with_overrides("mine.toml", mine)?;
/// assert_eq!(table.area("add", 32, Goal::Area)?.value, 200.0);
/// # Ok::<(), hwmodel::cost::CostError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CostTable {
    rows: Rows,
    quadratic: BTreeSet<String>,
    follows: BTreeMap<String, String>,
    spread: Spread,
    technology: Technology,
}

const FARTHEST: f64 = 4.0;

impl CostTable {
    /// The tables that ship with the crate.
    pub fn load_shipped() -> Result<Self, CostError> {
        Self::default()
            .with_overrides(AREA_FILE, include_str!("../../tables/area.toml"))?
            .with_overrides(ENERGY_FILE, include_str!("../../tables/energy.toml"))
    }

    /// The same table with rows of another over it; errors and reports call it `file`.
    /// They replace all rows of the same operation, quantity and goal; rows without goal replace those of both goals.
    /// Energies of the other rows move to the text's `[technology]`.
    ///
    /// # Errors
    /// When the text is not a cost table, or a row is invalid or occurs twice.
    pub fn with_overrides(mut self, file: &str, text: &str) -> Result<Self, CostError> {
        let (parsed, rows) = parse(file, text)?;
        if let Some(technology) = parsed.technology {
            self.move_to(technology);
        }
        self.rows.retain(|(quantity, operation, goal), _| {
            let is_replaced = |goal| rows.contains_key(&(*quantity, operation.clone(), goal));
            !is_replaced(*goal) && !is_replaced(None)
        });
        // A user's row follows no other.
        for (_, operation, _) in rows.keys() {
            self.follows.remove(operation);
        }
        self.rows.extend(rows);
        self.quadratic.extend(parsed.quadratic);
        self.follows.extend(parsed.follows);
        self.spread = parsed.spread.unwrap_or(self.spread);
        Ok(self)
    }

    /// Multiplies energies by the technology's factors.
    fn move_to(&mut self, technology: Technology) {
        for ((quantity, operation, _), rows) in &mut self.rows {
            let factor = technology.factor(operation) / self.technology.factor(operation);
            if *quantity != Quantity::EnergyPj || factor == 1.0 {
                continue;
            }
            for row in rows {
                row.low *= factor;
                row.high *= factor;
                row.derived = true;
                let Technology { nm, volts } = technology;
                let moved = format!("; times {factor:.3} for {nm} nm and {volts} V");
                row.source.push_str(&moved);
            }
        }
        self.technology = technology;
    }

    /// The technology of the energies.
    pub fn technology(&self) -> Technology {
        self.technology
    }

    /// The operation from whose price another operation's price is derived, if from one.
    pub fn follows(&self, operation: &str) -> Option<&str> {
        self.follows.get(operation).map(String::as_str)
    }

    /// How uncertain figures are.
    pub fn spread(&self) -> Spread {
        self.spread
    }

    /// Area of a unit, in NAND2 equivalents.
    pub fn area(&self, operation: &str, width: u32, goal: Goal) -> Result<Cost, CostError> {
        self.cost(Quantity::Nand2, operation, width, Some(goal))
    }

    /// Delay of a unit, in picoseconds.
    pub fn delay(&self, operation: &str, width: u32, goal: Goal) -> Result<Cost, CostError> {
        self.cost(Quantity::DelayPs, operation, width, Some(goal))
    }

    /// Energy of an operation, in picojoules.
    pub fn energy(&self, operation: &str, width: u32) -> Result<Cost, CostError> {
        self.cost(Quantity::EnergyPj, operation, width, None)
    }

    /// Linear between rows, in the width or in its square (areas and energies of quadratic operations). Proportional below
    /// the first row. Extrapolated from two rows above the last, up to four times the widest.
    fn cost(
        &self,
        quantity: Quantity,
        operation: &str,
        width: u32,
        goal: Option<Goal>,
    ) -> Result<Cost, CostError> {
        let (rows, goal) = self.rows_of(quantity, operation, width, goal)?;
        if let [row] = rows
            && row.width.is_none()
        {
            return Ok(cost(quantity, operation, goal, &[(row, 1.0)], Fit::Row));
        }
        let square = self.quadratic.contains(operation) && quantity != Quantity::DelayPs;
        let measure = |width: u32| f64::from(width).powi(if square { 2 } else { 1 });
        let rows: Vec<(f64, &CostRow)> = rows
            .iter()
            .filter_map(|row| row.width.map(|width| (measure(width), row)))
            .collect();
        let widest = rows.iter().filter_map(|row| row.1.width).max().unwrap_or(0);
        if f64::from(width) > FARTHEST * f64::from(widest) {
            let (size, why) = (
                format!("near {width} bits"),
                too_far(widest.into(), FARTHEST),
            );
            return Err(no_figure(quantity, operation, &size, goal, &why));
        }
        let (weights, fit) = weigh(&rows, measure(width));
        Ok(cost(quantity, operation, goal, &weights, fit))
    }

    /// Energy of an access (`sram_read` or `sram_write`) of `bits` bits to a memory of `bytes` bytes, in picojoules.
    /// Proportional to the bits, and linear in the square root of the size, as the length of wires.
    /// An error for a memory more than four times as long and wide as that of the largest row.
    pub fn memory_energy(&self, operation: &str, bytes: u64, bits: u32) -> Result<Cost, CostError> {
        let quantity = Quantity::EnergyPj;
        let (rows, _) = self.rows_of(quantity, operation, bits, None)?;
        let rows: Vec<(f64, &CostRow)> = rows
            .iter()
            .filter_map(|row| row.bytes.map(|bytes| ((bytes as f64).sqrt(), row)))
            .collect();
        let Some(largest) = rows.iter().filter_map(|row| row.1.bytes).max() else {
            let size = format!("at {bits} bits");
            return Err(no_figure(quantity, operation, &size, None, ""));
        };
        // In either direction.
        let times = FARTHEST * FARTHEST;
        if bytes as f64 > times * largest as f64 {
            let (size, why) = (format!("near {bytes} bytes"), too_far(largest, times));
            return Err(no_figure(quantity, operation, &size, None, &why));
        }
        let (mut weights, mut fit) = weigh(&rows, (bytes as f64).sqrt());
        for (row, weight) in &mut weights {
            let scale = f64::from(bits) / f64::from(row.width.unwrap_or(bits).max(1));
            *weight *= scale;
            if scale != 1.0 && fit == Fit::Row {
                fit = Fit::Interpolated;
            }
        }
        Ok(cost(quantity, operation, None, &weights, fit))
    }

    /// Rows of a goal or, if there are none, without goal.
    pub(super) fn rows_of(
        &self,
        quantity: Quantity,
        operation: &str,
        width: u32,
        goal: Option<Goal>,
    ) -> Result<(&[CostRow], Option<Goal>), CostError> {
        for goal in [goal, None] {
            if let Some(rows) = self.rows.get(&(quantity, operation.to_owned(), goal)) {
                return Ok((rows, goal));
            }
        }
        let size = format!("at {width} bits");
        Err(no_figure(quantity, operation, &size, goal, ""))
    }

    /// All operations with rows or listed as quadratic, in order.
    pub fn operations(&self) -> Vec<&str> {
        let of_rows = self.rows.keys().map(|key| key.1.as_str());
        let listed = self.quadratic.iter().map(String::as_str);
        let names: BTreeSet<&str> = of_rows.chain(listed).collect();
        names.into_iter().collect()
    }
}

fn no_figure(
    quantity: Quantity,
    operation: &str,
    size: &str,
    goal: Option<Goal>,
    why: &str,
) -> CostError {
    let [name, key, file] = quantity.words();
    let goal = goal.map_or_else(String::new, |goal| format!(" ({})", goal.name()));
    CostError(format!(
        "no {name} of `{operation}` {size}{goal}{why}; add a row with `{key}` to a cost table of your own, or to {file}"
    ))
}

fn too_far(largest: u64, times: f64) -> String {
    format!(
        ": the largest row has {largest}, and nothing is extrapolated beyond {times} times that"
    )
}

/// The rows next to a place, with weights. Rows are in order of place.
fn weigh<'a>(rows: &[(f64, &'a CostRow)], at: f64) -> (Vec<(&'a CostRow, f64)>, Fit) {
    if let Some(&(_, row)) = rows.iter().find(|row| row.0 == at) {
        return (vec![(row, 1.0)], Fit::Row);
    }
    let after = rows.iter().take_while(|row| row.0 < at).count();
    let (pair, fit) = match (after, rows) {
        (_, []) => return (Vec::new(), Fit::Extrapolated),
        (0, [first, ..]) | (_, [first]) => {
            return (vec![(first.1, at / first.0)], Fit::Extrapolated);
        }
        (after, rows) if after == rows.len() => (&rows[after - 2..], Fit::Extrapolated),
        (after, rows) => (&rows[after - 1..=after], Fit::Interpolated),
    };
    let [(left, low), (right, high)] = [pair[0], pair[1]];
    let part = (at - left) / (right - left);
    (vec![(low, 1.0 - part), (high, part)], fit)
}

pub(super) fn cost(
    quantity: Quantity,
    operation: &str,
    goal: Option<Goal>,
    weights: &[(&CostRow, f64)],
    fit: Fit,
) -> Cost {
    let sum = |figure: fn(&CostRow) -> f64| -> f64 {
        let parts = weights.iter().map(|&(row, weight)| weight * figure(row));
        parts.sum::<f64>().max(0.0)
    };
    let (low, high) = (sum(|row| row.low), sum(|row| row.high));
    let is_memory = weights.iter().any(|(row, _)| row.bytes.is_some());
    let size = |row: &CostRow| row.bytes.or(row.width.map(u64::from));
    let mut sizes: Vec<String> = weights
        .iter()
        .filter_map(|(row, _)| size(row).map(|size| size.to_string()))
        .collect();
    sizes.dedup();
    let sizes = match sizes.as_slice() {
        [] => "any width".to_owned(),
        sizes => format!(
            "{} {}",
            sizes.join(" and "),
            if is_memory { "bytes" } else { "bits" }
        ),
    };
    let goal = goal.map_or_else(String::new, |goal| format!(", {}", goal.name()));
    let file = weights.first().map_or("", |(row, _)| row.file.as_str());
    let mut sources: Vec<&str> = weights.iter().map(|(row, _)| row.source.as_str()).collect();
    sources.dedup();
    Cost {
        quantity,
        value: (low + high) / 2.0,
        low: low.min(high),
        high: high.max(low),
        fit,
        derived: weights.iter().any(|(row, _)| row.derived),
        rows: format!("`{operation}` of {sizes}{goal} ({file})"),
        source: sources.join("; "),
    }
}
