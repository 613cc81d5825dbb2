//! Rows of a cost table, and their parser.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::technology::Technology;

/// The quantity of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Area in two-input NAND gates of the same library.
    Nand2,
    /// Delay in the source's process, in picoseconds.
    DelayPs,
    /// Energy of one operation or access, in picojoules.
    EnergyPj,
}

impl Quantity {
    /// The quantity in words, its key in a table, and the shipped file that has it.
    pub(super) const fn words(self) -> [&'static str; 3] {
        match self {
            Self::Nand2 => ["area in NAND2 equivalents", "nand2", AREA_FILE],
            Self::DelayPs => ["delay", "delay_ps", AREA_FILE],
            Self::EnergyPj => ["energy", "energy_pj", ENERGY_FILE],
        }
    }
}

pub(super) const AREA_FILE: &str = "hwmodel/tables/area.toml";
pub(super) const ENERGY_FILE: &str = "hwmodel/tables/energy.toml";

/// The goal of a synthesis.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Goal {
    /// Small area.
    #[default]
    Area,
    /// Short delay.
    Delay,
}

impl Goal {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Area => "for small area",
            Self::Delay => "for short delay",
        }
    }
}

/// The problem of a table or of a request.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct CostError(pub(super) String);

impl CostError {
    /// Of an estimator.
    pub fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Figure {
    Number(f64),
    Range([f64; 2]),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileRow {
    operation: String,
    width: Option<u32>,
    goal: Option<Goal>,
    bytes: Option<u64>,
    source: String,
    #[serde(default)]
    derived: bool,
    nand2: Option<Figure>,
    delay_ps: Option<Figure>,
    energy_pj: Option<Figure>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    #[serde(default)]
    pub(super) quadratic: Vec<String>,
    #[serde(default)]
    pub(super) follows: BTreeMap<String, String>,
    pub(super) spread: Option<Spread>,
    pub(super) technology: Option<Technology>,
    #[serde(default)]
    sources: BTreeMap<String, String>,
    #[serde(default)]
    row: Vec<FileRow>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct CostRow {
    pub(super) width: Option<u32>,
    pub(super) bytes: Option<u64>,
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) source: String,
    pub(super) derived: bool,
    pub(super) file: String,
}

/// How uncertain figures are: for each origin the factor of one standard deviation of the figure's logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Of a row that its source states.
    pub stated: f64,
    /// Of a row that is derived from another one's source, beside that row's own.
    pub derived: f64,
    /// Of a figure below the first or above the last row, beside the rows' own.
    pub extrapolated: f64,
}

impl Default for Spread {
    fn default() -> Self {
        Self {
            stated: 1.0,
            derived: 1.0,
            extrapolated: 1.0,
        }
    }
}

pub(super) type Key = (Quantity, String, Option<Goal>);

pub(super) type Rows = BTreeMap<Key, Vec<CostRow>>;

const MAX_FIGURE: f64 = 1e12;
const MAX_WIDTH: u32 = 1 << 16;
const MAX_BYTES: u64 = 1 << 50;

impl FileRow {
    fn problem(&self) -> Option<&'static str> {
        let is_sound =
            |(_, low, high): (_, f64, f64)| low >= 0.0 && low <= high && high <= MAX_FIGURE;
        Some(if self.operation.trim().is_empty() {
            "the operation has no name"
        } else if self.source.trim().is_empty() {
            "the source is empty; every row must name one"
        } else if self.width == Some(0) {
            "a width is at least 1 bit; leave it out for any"
        } else if self.width.is_some_and(|width| width > MAX_WIDTH) {
            "a width is at most 65536 bits"
        } else if self.bytes.is_some_and(|bytes| bytes > MAX_BYTES) {
            "a memory has at most 2^50 bytes"
        } else if self.bytes == Some(0) || self.bytes.is_some() && self.width.is_none() {
            "a memory has at least 1 byte, and a width: the bits of an access"
        } else if self.figures().next().is_none() {
            "there is no figure: nand2, delay_ps or energy_pj"
        } else if !self.figures().all(is_sound) {
            "a figure is a number from 0 to 1e12, or a range [low, high] of two"
        } else {
            return None;
        })
    }

    fn figures(&self) -> impl Iterator<Item = (Quantity, f64, f64)> {
        let figures = [
            (Quantity::Nand2, self.nand2),
            (Quantity::DelayPs, self.delay_ps),
            (Quantity::EnergyPj, self.energy_pj),
        ];
        figures.into_iter().filter_map(|(quantity, figure)| {
            let [low, high] = match figure? {
                Figure::Number(number) => [number; 2],
                Figure::Range(range) => range,
            };
            Some((quantity, low, high))
        })
    }
}

pub(super) fn parse(file: &str, text: &str) -> Result<(File, Rows), CostError> {
    let parsed: File = toml::from_str(text)
        .map_err(|error| CostError(format!("{file} is no cost table: {error}")))?;
    let mut rows = Rows::new();
    for row in &parsed.row {
        let wrong = |problem: &str| {
            let width = row.width.map(|width| format!(" of {width} bits"));
            let width = width.unwrap_or_default();
            let operation = &row.operation;
            Err(CostError(format!(
                "{file}, row `{operation}`{width}: {problem}"
            )))
        };
        if let Some(problem) = row.problem() {
            return wrong(problem);
        }
        for (quantity, low, high) in row.figures() {
            let key = (quantity, row.operation.clone(), row.goal);
            let others = rows.entry(key).or_default();
            let place = (row.width, row.bytes);
            for other in others.iter() {
                if (other.width, other.bytes) == place {
                    return wrong("there are two such rows");
                }
                if other.width.is_none() != row.width.is_none() {
                    return wrong("one row is for any width and another for one: which counts?");
                }
            }
            let source = parsed.sources.get(&row.source).unwrap_or(&row.source);
            others.push(CostRow {
                width: row.width,
                bytes: row.bytes,
                low,
                high,
                source: source.clone(),
                derived: row.derived,
                file: file.to_owned(),
            });
        }
    }
    for together in rows.values_mut() {
        together.sort_by_key(|row| (row.width, row.bytes));
    }
    if let Some(Spread {
        stated,
        derived,
        extrapolated,
    }) = parsed.spread
        && ![stated, derived, extrapolated]
            .iter()
            .all(|factor| (1.0..=100.0).contains(factor))
    {
        return Err(CostError(format!(
            "{file}: factors of [spread] are 1 to 100"
        )));
    }
    if let Some(technology) = parsed.technology {
        technology.check(file)?;
    }
    Ok((parsed, rows))
}
