//! Rows of a cost table, and their parser.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The quantity of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Area in two-input NAND gates of the same library.
    Nand2,
    /// Area in the source's process, in square micrometres.
    Um2,
    /// Area at 45 nm, in square micrometres.
    Um2At45Nm,
    /// Delay in the source's process, in picoseconds.
    DelayPs,
    /// Energy of one operation or access, in picojoules.
    EnergyPj,
}

impl Quantity {
    /// The quantity in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nand2 => "area in NAND2 equivalents",
            Self::Um2 => "area",
            Self::Um2At45Nm => "area at 45 nm",
            Self::DelayPs => "delay",
            Self::EnergyPj => "energy",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Nand2 => "NAND2",
            Self::Um2 | Self::Um2At45Nm => "um2",
            Self::DelayPs => "ps",
            Self::EnergyPj => "pJ",
        }
    }

    /// The key of its figures in a table.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Nand2 => "nand2",
            Self::Um2 => "um2",
            Self::Um2At45Nm => "um2_45nm",
            Self::DelayPs => "delay_ps",
            Self::EnergyPj => "energy_pj",
        }
    }

    /// The shipped file that holds such figures.
    pub const fn file(self) -> &'static str {
        match self {
            Self::EnergyPj => "hwmodel/tables/energy.toml",
            _ => "hwmodel/tables/area.toml",
        }
    }
}

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
    /// The goal in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Area => "for small area",
            Self::Delay => "for short delay",
        }
    }
}

/// Why a table cannot be read, or has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CostError {
    /// A file is not TOML, or not a cost table.
    #[error("{file} is no cost table: {message}")]
    Syntax {
        /// File name.
        file: String,
        /// Problem and place.
        message: String,
    },
    /// A row makes no sense.
    #[error("{file}, row `{operation}`{}: {problem}", of_bits(*width))]
    Row {
        /// File name.
        file: String,
        /// The row's operation.
        operation: String,
        /// The row's width, in bits.
        width: Option<u32>,
        /// Problem.
        problem: &'static str,
    },
    /// No row.
    #[error(
        "no {} of `{operation}`, asked for at {width} bits{}: add a row with `{}` to a cost table of your own, or to {}",
        quantity.name(), in_brackets(*goal), quantity.key(), quantity.file()
    )]
    Missing {
        /// Requested quantity.
        quantity: Quantity,
        /// Requested operation.
        operation: String,
        /// Requested width, in bits.
        width: u32,
        /// Requested goal, if it matters.
        goal: Option<Goal>,
    },
    /// No row is near enough.
    #[error(
        "no {} of `{operation}` near {width} {unit}{}: the largest row has {widest}, and nothing is extrapolated beyond {times} times that; add a row with `{}` to a cost table of your own, or to {}",
        quantity.name(), in_brackets(*goal), quantity.key(), quantity.file()
    )]
    TooWide {
        /// Requested quantity.
        quantity: Quantity,
        /// Requested operation.
        operation: String,
        /// Requested width or size, in bits or bytes.
        width: u64,
        /// Width or size of the widest row.
        widest: u64,
        /// `bits` or `bytes`.
        unit: &'static str,
        /// Largest accepted multiple of the widest.
        times: u64,
        /// Requested goal, if it matters.
        goal: Option<Goal>,
    },
    /// Operations cannot be priced in the requested way. Operations cannot be costed in the requested way.
    #[error(
        "{times} min/max operations of {width} bits in stage {stage} are not spans of eight values (7 min and 7 max each): pairs are for the corner cage"
    )]
    NoSpans {
        /// Number of operations.
        times: u64,
        /// Their width, in bits.
        width: u32,
        /// The stage in words.
        stage: &'static str,
    },
}

fn of_bits(width: Option<u32>) -> String {
    width.map_or_else(String::new, |width| format!(" of {width} bits"))
}

fn in_brackets(goal: Option<Goal>) -> String {
    goal.map_or_else(String::new, |goal| format!(" ({})", goal.name()))
}

/// A number, or a range.
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
    um2: Option<Figure>,
    um2_45nm: Option<Figure>,
    delay_ps: Option<Figure>,
    energy_pj: Option<Figure>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    quadratic: Vec<String>,
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

/// Key of the rows between which figures are interpolated.
pub(super) type Key = (Quantity, String, Option<Goal>);

/// Contents of a file.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub(super) quadratic: Vec<String>,
    pub(super) rows: BTreeMap<Key, Vec<CostRow>>,
}

/// Largest figure, so that sums over a frame stay finite.
const MAX_FIGURE: f64 = 1e12;
/// Widest row, bits.
const MAX_WIDTH: u32 = 1 << 16;
/// Largest memory, bytes.
const MAX_BYTES: u64 = 1 << 50;

pub(super) fn parse(file: &str, text: &str) -> Result<Parsed, CostError> {
    let parsed: File = toml::from_str(text).map_err(|error| CostError::Syntax {
        file: file.to_owned(),
        message: error.to_string(),
    })?;
    let mut rows = BTreeMap::<Key, Vec<CostRow>>::new();
    for row in &parsed.row {
        let wrong = |problem| CostError::Row {
            file: file.to_owned(),
            operation: row.operation.clone(),
            width: row.width,
            problem,
        };
        if row.operation.trim().is_empty() {
            return Err(wrong("the operation has no name"));
        }
        if row.source.trim().is_empty() {
            return Err(wrong("the source is empty; every row must name one"));
        }
        if row.width == Some(0) {
            return Err(wrong("a width is at least 1 bit; leave it out for any"));
        }
        if row.width.is_some_and(|width| width > MAX_WIDTH) {
            return Err(wrong("a width is at most 65536 bits"));
        }
        if row.bytes.is_some_and(|bytes| bytes > MAX_BYTES) {
            return Err(wrong("a memory has at most 2^50 bytes"));
        }
        if row.bytes.is_some() && (row.bytes == Some(0) || row.width.is_none()) {
            return Err(wrong(
                "a memory has at least 1 byte, and a width: the bits of an access",
            ));
        }
        let figures = [
            (Quantity::Nand2, row.nand2),
            (Quantity::Um2, row.um2),
            (Quantity::Um2At45Nm, row.um2_45nm),
            (Quantity::DelayPs, row.delay_ps),
            (Quantity::EnergyPj, row.energy_pj),
        ];
        if figures.iter().all(|(_, figure)| figure.is_none()) {
            return Err(wrong(
                "there is no figure: nand2, um2, um2_45nm, delay_ps or energy_pj",
            ));
        }
        for (quantity, figure) in figures {
            let (low, high) = match figure {
                None => continue,
                Some(Figure::Number(number)) => (number, number),
                Some(Figure::Range([low, high])) => (low, high),
            };
            if !(low >= 0.0 && low <= high && high <= MAX_FIGURE) {
                return Err(wrong(
                    "a figure is a number from 0 to 1e12, or a range [low, high] of two",
                ));
            }
            let key = (quantity, row.operation.clone(), row.goal);
            let together = rows.entry(key).or_default();
            if together
                .iter()
                .any(|other| (other.width, other.bytes) == (row.width, row.bytes))
            {
                return Err(wrong("there are two such rows"));
            }
            if together
                .iter()
                .any(|other| other.width.is_none() != row.width.is_none())
            {
                return Err(wrong(
                    "one row is for any width and another for one: which counts?",
                ));
            }
            let source = parsed.sources.get(&row.source).unwrap_or(&row.source);
            together.push(CostRow {
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
    Ok(Parsed {
        quadratic: parsed.quadratic,
        rows,
    })
}
