//! A space of hardware: descriptions to begin with, and ranges of what is changed in them.

use std::fmt;

use hwmodel::cycles::{Hardware, HardwareError};
use hwmodel::{MAX_BITS, MIN_BITS};
use toml::{Table, Value};

use crate::model::sweep::with_width;

/// Most points of a space.
pub const MAX_POINTS: usize = 1 << 16;

/// Names and texts of the spaces that ship.
pub const SPACES: [(&str, &str); 1] = [("bundled", include_str!("bundled.toml"))];

/// The key of the word's width, which is no part of a hardware's description.
const BITS: &str = "bits";
/// The key of the description that a point begins with.
const HARDWARE: &str = "hardware";

/// Why a space cannot be explored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpaceError {
    /// Not TOML.
    #[error("space: {0}")]
    Syntax(String),
    /// A key that nothing has.
    #[error("space: there is no `{key}`; {instead}")]
    Unknown {
        /// The key, as in the file.
        key: String,
        /// What there is.
        instead: String,
    },
    /// A range that is none.
    #[error("space: {key}: {why}")]
    Range {
        /// The key, as in the file.
        key: String,
        /// What is wrong.
        why: String,
    },
    /// A description to begin with that cannot be had.
    #[error("space: hardware `{name}`: {why}")]
    Base {
        /// Its name.
        name: String,
        /// Why.
        why: String,
    },
    /// A point that is no hardware.
    #[error("space: point {point}, {values}: {source}")]
    Impossible {
        /// Its number.
        point: usize,
        /// What it is made of.
        values: String,
        /// What is wrong with that.
        source: HardwareError,
    },
    /// More points than [`MAX_POINTS`].
    #[error("space: it has more than {MAX_POINTS} points; take values out of its ranges")]
    TooLarge,
}

/// A key and the values that it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The key, with dots: `node_cache.bytes`.
    pub key: String,
    /// The values, in the order of the file.
    pub values: Vec<Value>,
}

/// A space: the product of its axes. The last axis varies fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    bases: Vec<Hardware>,
    /// The descriptions' names first, then keys by alphabet.
    axes: Vec<Axis>,
}

/// A point of a space.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its number, from 0.
    pub number: usize,
    /// What it is made of, axis by axis.
    pub values: Vec<(String, Value)>,
    /// Width of a word, if the space says it.
    pub bits: Option<u32>,
    /// The hardware.
    pub hardware: Hardware,
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let values = self.values.iter();
        let values: Vec<String> = values
            .map(|(key, value)| format!("{key} = {value}"))
            .collect();
        f.write_str(&values.join(", "))
    }
}

impl Space {
    /// Reads a space and checks every point of it. `open` finds a description by the name
    /// that the space has for it.
    ///
    /// # Errors
    /// With the key or the point to blame.
    pub fn from_toml(
        text: &str,
        open: impl Fn(&str) -> Result<Hardware, String>,
    ) -> Result<Self, SpaceError> {
        let mut file: Table =
            toml::from_str(text).map_err(|error| SpaceError::Syntax(error.to_string()))?;
        let names = file
            .remove(HARDWARE)
            .unwrap_or_else(|| Value::Array(vec!["paper".into()]));
        let names = values_of(HARDWARE, &names)?;
        let ranges = match file.remove("ranges") {
            Some(Value::Table(ranges)) => ranges,
            None => Table::new(),
            Some(_) => return Err(wrong("ranges", "it must be a table: [ranges]")),
        };
        if let Some(key) = file.keys().next() {
            return Err(SpaceError::Unknown {
                key: key.clone(),
                instead: "a space has `hardware` and [ranges]".to_owned(),
            });
        }
        let mut bases = Vec::new();
        for name in &names {
            let Value::String(name) = name else {
                return Err(wrong(HARDWARE, "it must be a list of names or files"));
            };
            let base = |why| SpaceError::Base {
                name: name.clone(),
                why,
            };
            bases.push(open(name).map_err(base)?);
        }
        let mut axes = vec![Axis {
            key: HARDWARE.to_owned(),
            values: names,
        }];
        collect("", &ranges, &mut axes)?;
        let space = Self { bases, axes };
        space.check()?;
        Ok(space)
    }

    /// What varies.
    #[must_use]
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Points.
    #[must_use]
    pub fn len(&self) -> usize {
        let sizes = self.axes.iter().map(|axis| axis.values.len());
        sizes.fold(1, usize::saturating_mul)
    }

    /// Never: every axis has a value.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A point.
    ///
    /// # Errors
    /// When it is no hardware; [`Self::from_toml`] lets no such space through.
    pub fn point(&self, number: usize) -> Result<Point, SpaceError> {
        let mut rest = number;
        let mut values = Vec::new();
        let mut base = 0;
        for axis in self.axes.iter().rev() {
            let at = rest % axis.values.len();
            rest /= axis.values.len();
            values.push((axis.key.clone(), axis.values[at].clone()));
            base = at; // at last of the first axis
        }
        values.reverse();
        let bits = values.iter().find(|(key, _)| key == BITS);
        let bits = bits.and_then(|(_, value)| u32::try_from(value.as_integer()?).ok());
        let mut point = Point {
            number,
            values,
            bits,
            hardware: self.bases[base].clone(),
        };
        if let Some(bits) = bits {
            point.hardware = with_width(&point.hardware, bits);
        }
        match changed(&point) {
            Ok(hardware) => Ok(Point { hardware, ..point }),
            Err(source) => Err(SpaceError::Impossible {
                point: number,
                values: point.to_string(),
                source,
            }),
        }
    }

    fn check(&self) -> Result<(), SpaceError> {
        let range = i64::from(MIN_BITS)..=i64::from(MAX_BITS);
        for axis in &self.axes[1..] {
            if axis.key == BITS {
                let is_no_width = |value: &&Value| {
                    let bits = value.as_integer();
                    !bits.is_some_and(|bits| range.contains(&bits))
                };
                if let Some(value) = axis.values.iter().find(is_no_width) {
                    let why = format!("{value}: a word has {MIN_BITS} to {MAX_BITS} bits");
                    return Err(wrong("ranges.bits", &why));
                }
                continue;
            }
            for base in &self.bases {
                let mut description = table_of(base);
                if slot(&mut description, &axis.key).is_none() {
                    return Err(SpaceError::Unknown {
                        key: format!("ranges.{}", axis.key),
                        instead: format!(
                            "hardware `{}` has {}",
                            base.name,
                            neighbours(description, &axis.key)
                        ),
                    });
                }
            }
        }
        if self.len() > MAX_POINTS {
            return Err(SpaceError::TooLarge);
        }
        (0..self.len()).try_for_each(|number| self.point(number).map(|_| ()))
    }
}

fn wrong(key: &str, why: &str) -> SpaceError {
    SpaceError::Range {
        key: key.to_owned(),
        why: why.to_owned(),
    }
}

/// A point's hardware: its description with the point's values in their places.
fn changed(point: &Point) -> Result<Hardware, HardwareError> {
    let mut description = table_of(&point.hardware);
    for (key, value) in &point.values[1..] {
        if let Some(place) = slot(&mut description, key) {
            *place = value.clone();
        }
    }
    let hardware: Hardware = description
        .try_into()
        .map_err(|error: toml::de::Error| HardwareError::Syntax(error.message().to_owned()))?;
    hardware.check()?;
    Ok(hardware)
}

fn table_of(hardware: &Hardware) -> Table {
    match Table::try_from(hardware) {
        Ok(table) => table,
        Err(error) => unreachable!("a description is written as it is read: {error}"),
    }
}

/// Where a description has a key with dots.
fn slot<'a>(description: &'a mut Table, key: &str) -> Option<&'a mut Value> {
    match key.split_once('.') {
        None => description.get_mut(key),
        Some((first, rest)) => slot(description.get_mut(first)?.as_table_mut()?, rest),
    }
}

/// The keys that stand where `key`, which does not, would.
fn neighbours(description: Table, key: &str) -> String {
    let mut here = description;
    for part in key.split('.') {
        match here.get(part) {
            Some(Value::Table(below)) => here = below.clone(),
            _ => break,
        }
    }
    let keys: Vec<&str> = here.keys().map(String::as_str).collect();
    keys.join(", ")
}

/// Adds the axes of a table of ranges, in which tables without `from` are parts of descriptions.
fn collect(above: &str, ranges: &Table, axes: &mut Vec<Axis>) -> Result<(), SpaceError> {
    for (name, range) in ranges {
        let key = match above {
            "" => name.clone(),
            above => format!("{above}.{name}"),
        };
        match range {
            Value::Table(below) if !below.contains_key("from") => {
                if below.is_empty() {
                    return Err(wrong(&format!("ranges.{key}"), "it has no values"));
                }
                collect(&key, below, axes)?;
            }
            range => {
                let values = values_of(&format!("ranges.{key}"), range)?;
                axes.push(Axis { key, values });
            }
        }
    }
    Ok(())
}

/// The values of a range: a list, one value, or `{ from, to, step }` or `{ from, to, times }`.
fn values_of(key: &str, range: &Value) -> Result<Vec<Value>, SpaceError> {
    let values = match range {
        Value::Array(values) => values.clone(),
        Value::Table(steps) => stepped(key, steps)?,
        one => vec![one.clone()],
    };
    if values.is_empty() {
        return Err(wrong(key, "it has no values"));
    }
    for (at, value) in values.iter().enumerate() {
        if matches!(
            value,
            Value::Array(_) | Value::Table(_) | Value::Datetime(_)
        ) {
            return Err(wrong(key, "its values must be numbers, words or booleans"));
        }
        if values[..at].contains(value) {
            return Err(wrong(key, &format!("it has {value} twice")));
        }
    }
    Ok(values)
}

fn stepped(key: &str, range: &Table) -> Result<Vec<Value>, SpaceError> {
    const KEYS: [&str; 4] = ["from", "to", "step", "times"];
    if let Some(stranger) = range.keys().find(|name| !KEYS.contains(&name.as_str())) {
        return Err(SpaceError::Unknown {
            key: format!("{key}.{stranger}"),
            instead: "a range has `from`, `to` and one of `step` and `times`".to_owned(),
        });
    }
    let number = |name: &str| match range.get(name) {
        None => Ok(None),
        Some(value) => match value.as_integer().map(u32::try_from) {
            Some(Ok(number)) => Ok(Some(number)),
            _ => Err(wrong(
                key,
                &format!("`{name}` must be a whole number, 0 or more"),
            )),
        },
    };
    let (from, to) = (number("from")?, number("to")?);
    let (Some(from), Some(to)) = (from, to) else {
        return Err(wrong(key, "`from` and `to` are missing, or one of them"));
    };
    let next: Box<dyn Fn(u32) -> Option<u32>> = match (number("step")?, number("times")?) {
        (Some(step), None) if step > 0 => Box::new(move |value| value.checked_add(step)),
        (None, Some(times)) if times > 1 && from > 0 => {
            Box::new(move |value| value.checked_mul(times))
        }
        _ => {
            let why = "it needs one of `step`, 1 or more, and `times`, 2 or more from 1 or more";
            return Err(wrong(key, why));
        }
    };
    if from > to {
        return Err(wrong(key, &format!("it is empty, from {from} to {to}")));
    }
    let values = std::iter::successors(Some(from), |&value| next(value).filter(|&next| next <= to));
    // One more than may be, so that it is seen.
    let values = values.take(MAX_POINTS + 1);
    Ok(values
        .map(|value| Value::Integer(i64::from(value)))
        .collect())
}
