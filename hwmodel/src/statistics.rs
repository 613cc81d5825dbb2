//! A list of named numbers, for other programs.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

/// Version of the serialised form, raised by incompatible changes.
pub const SCHEMA: u32 = 1;

/// A number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A count.
    Count(u64),
    /// A measure: a mean, a rate, an energy.
    Measure(f64),
}

impl From<u64> for Value {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Value {
    fn from(measure: f64) -> Self {
        Self::Measure(measure)
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Count(count) => f.pad(&count.to_string()),
            // As gem5 writes it.
            Self::Measure(measure) if measure.is_nan() => f.pad("nan"),
            Self::Measure(measure) => f.pad(&format!("{measure:.6}")),
        }
    }
}

/// One line of a report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// Dotted name, such as `machine.ops.add.w32.vertex_pool`.
    pub name: String,
    /// Value.
    pub value: Value,
    /// Unit, such as `Count`, `Cycle`, `Byte` or `pJ`.
    pub unit: String,
    /// Meaning.
    pub description: String,
}

/// Statistics in the order in which they were added.
///
/// ```
/// use hwmodel::statistics::Statistics;
///
/// let mut statistics = Statistics::new();
/// statistics.add("machine.records", 12u64, "Count", "records that had their turn");
/// statistics.add("machine.energy", 3.5, "pJ", "energy of all operations");
/// assert!(statistics.to_stats_txt().contains("machine.records"));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    schema: u32,
    statistics: Vec<Statistic>,
}

impl Default for Statistics {
    fn default() -> Self {
        Self {
            schema: SCHEMA,
            statistics: Vec::new(),
        }
    }
}

impl Statistics {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a number. White space in the name becomes `_`.
    pub fn add(&mut self, name: &str, value: impl Into<Value>, unit: &str, description: &str) {
        self.statistics.push(Statistic {
            name: one_word(name),
            value: value.into(),
            unit: unit.to_owned(),
            description: description.to_owned(),
        });
    }

    /// All statistics, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Statistic> {
        self.statistics.iter()
    }

    /// The first statistic of a name.
    pub fn get(&self, name: &str) -> Option<&Statistic> {
        self.iter().find(|statistic| statistic.name == name)
    }

    /// Text in the format of gem5: name, value, `#` description and `(unit)`, between lines of dashes.
    pub fn to_stats_txt(&self) -> String {
        let mut text = String::from("\n---------- Begin Simulation Statistics ----------\n");
        for statistic in self.iter() {
            let Statistic { name, value, .. } = statistic;
            let (description, unit) = (one_line(&statistic.description), one_line(&statistic.unit));
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:<48} {value:>16} # {description} ({unit})");
        }
        text.push_str("\n---------- End Simulation Statistics   ----------\n");
        text
    }
}

fn one_word(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join("_")
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
