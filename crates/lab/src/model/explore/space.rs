//! A space of hardware designs: descriptions to begin with, variants, and ranges of values that replace theirs.

use std::fmt;

use hwmodel::cycles::{Hardware, HardwareError};
use hwmodel::{MAX_BITS, MIN_BITS};
use serde::Deserialize;
use shiftvox::machine::check_hardware;
use shiftvox::project::{CageKind, Coverage, SetupOptions};
use toml::{Table, Value};

pub const MAX_POINTS: usize = 1 << 16;

pub const SPACES: [(&str, &str); 7] = [
    ("bundled", include_str!("spaces/bundled.toml")),
    ("lanes", include_str!("spaces/lanes.toml")),
    ("map", include_str!("spaces/map.toml")),
    ("rules", include_str!("spaces/rules.toml")),
    ("sizes", include_str!("spaces/sizes.toml")),
    ("steps", include_str!("spaces/steps.toml")),
    ("words", include_str!("spaces/words.toml")),
];

/// Keys of the ranges that say how the frame is drawn. All others are keys of the hardware.
const DRAWING: [&str; 5] = ["bits", "cage", "coverage", "size", "tolerance"];
const HARDWARE: &str = "hardware";
const VARIANT: &str = "variant";
/// Width of the words for which the shipped hardware is built, bits.
const BUILT_FOR_BITS: u32 = 32;

/// Why a space cannot be explored: the key or the point to blame, and the fault.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("space: {0}")]
pub struct SpaceError(String);

fn wrong(key: &str, why: impl fmt::Display) -> SpaceError {
    SpaceError(format!("{key}: {why}"))
}

fn unknown(key: &str, instead: impl fmt::Display) -> SpaceError {
    SpaceError(format!("there is no `{key}`; {instead}"))
}

#[derive(Debug, Clone, PartialEq)]
struct Axis {
    /// With dots: `node_cache.bytes`.
    key: String,
    values: Vec<Value>,
}

/// How the frame of a point is drawn, as far as the space says it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Drawing {
    /// Width of a word, bits.
    pub bits: Option<u32>,
    pub cage: Option<CageKind>,
    pub coverage: Option<Coverage>,
    /// Side of the picture, pixels.
    pub size: Option<u32>,
    /// Tolerance, pixels.
    pub tolerance: Option<f64>,
}

impl Drawing {
    pub fn options(&self, base: &SetupOptions) -> SetupOptions {
        SetupOptions {
            bits: self.bits.unwrap_or(base.bits),
            cage: self.cage.unwrap_or(base.cage),
            coverage: self.coverage.unwrap_or(base.coverage),
            tolerance_px: self.tolerance.unwrap_or(base.tolerance_px),
            ..*base
        }
    }
}

/// A space: the product of its axes. The last axis varies fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    bases: Vec<Hardware>,
    /// Settings of each variant, with dots in their keys.
    variants: Vec<Vec<Axis>>,
    /// Descriptions first, then variants, then keys in alphabetical order.
    axes: Vec<Axis>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub number: usize,
    pub values: Vec<(String, Value)>,
    pub drawing: Drawing,
    pub hardware: Hardware,
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&in_words(&self.values))
    }
}

fn in_words(values: &[(String, Value)]) -> String {
    let values = values.iter().map(|(key, value)| format!("{key} = {value}"));
    values.collect::<Vec<_>>().join(", ")
}

impl Space {
    /// Reads a space and checks every point. `open` finds a description by its name; `hardware` replaces the descriptions
    /// of the space.
    pub fn from_toml(
        text: &str,
        hardware: Option<&str>,
        open: impl Fn(&str) -> Result<Hardware, String>,
    ) -> Result<Self, SpaceError> {
        let mut file: Table =
            toml::from_str(text).map_err(|error| SpaceError(error.to_string()))?;
        let paper = || Value::Array(vec!["paper".into()]);
        let names = file.remove(HARDWARE).unwrap_or_else(paper);
        let names = match hardware {
            Some(name) => vec![name.into()],
            None => values_of(HARDWARE, &names)?,
        };
        let ranges = match file.remove("ranges") {
            Some(Value::Table(ranges)) => ranges,
            None => Table::new(),
            Some(_) => return Err(wrong("ranges", "it must be a table: [ranges]")),
        };
        let variants = file.remove("variants");
        if let Some(key) = file.keys().next() {
            return Err(unknown(
                key,
                "a space has `hardware`, [[variants]] and [ranges]",
            ));
        }
        let mut bases = Vec::new();
        for name in &names {
            let Value::String(name) = name else {
                return Err(wrong(HARDWARE, "it must be a list of names or files"));
            };
            let base = |why| wrong(&format!("hardware `{name}`"), why);
            bases.push(open(name).map_err(base)?);
        }
        let axis = |key: &str, values| Axis {
            key: key.to_owned(),
            values,
        };
        let mut axes = vec![axis(HARDWARE, names)];
        let (names, variants) = variants_of(variants)?;
        if !names.is_empty() {
            axes.push(axis(VARIANT, names));
        }
        collect("", &ranges, &mut axes)?;
        let space = Self {
            bases,
            variants,
            axes,
        };
        space.check()?;
        Ok(space)
    }

    pub fn points(&self) -> usize {
        let sizes = self.axes.iter().map(|axis| axis.values.len());
        sizes.fold(1, usize::saturating_mul)
    }

    pub fn point(&self, number: usize) -> Result<Point, SpaceError> {
        let mut rest = number;
        let mut values = Vec::new();
        let (mut base, mut drawing, mut changes) = (0, Table::new(), Vec::new());
        for axis in self.axes.iter().rev() {
            let at = rest % axis.values.len();
            rest /= axis.values.len();
            let value = &axis.values[at];
            values.push((axis.key.clone(), value.clone()));
            match axis.key.as_str() {
                HARDWARE => base = at,
                VARIANT => {
                    let settings = self.variants[at].iter();
                    changes.extend(settings.map(|of| (of.key.as_str(), &of.values[0])));
                }
                // Variants replace what ranges set.
                key => changes.insert(0, (key, value)),
            }
        }
        values.reverse();
        changes.retain(|(key, value)| {
            let is_drawing = DRAWING.contains(key);
            if is_drawing {
                drawing.insert((*key).to_owned(), (*value).clone());
            }
            !is_drawing
        });
        let impossible =
            |error: HardwareError| wrong(&format!("point {number}, {}", in_words(&values)), error);
        let syntax = |error: toml::de::Error| HardwareError(error.message().to_owned());
        let drawing: Drawing = drawing
            .try_into()
            .map_err(|error| impossible(syntax(error)))?;
        let hardware = match drawing.bits {
            Some(bits) => with_width(&self.bases[base], bits),
            None => self.bases[base].clone(),
        };
        let mut description = table_of(&hardware);
        for (key, value) in changes {
            if let Some(place) = slot(&mut description, key) {
                *place = value.clone();
            }
        }
        let hardware = description.try_into::<Hardware>().map_err(syntax);
        let checked = hardware.and_then(|hardware| check_hardware(&hardware).map(|()| hardware));
        let hardware = checked.map_err(impossible)?;
        Ok(Point {
            number,
            values,
            drawing,
            hardware,
        })
    }

    fn check(&self) -> Result<(), SpaceError> {
        let named = self.axes.iter().filter(|axis| axis.key == VARIANT);
        let names = named.flat_map(|axis| &axis.values);
        let variants = names.zip(&self.variants).flat_map(|(name, settings)| {
            let within = format!("variants.{}", name.as_str().unwrap_or_default());
            settings.iter().map(move |axis| (within.clone(), axis))
        });
        let ranges = self.axes.iter().map(|axis| ("ranges".to_owned(), axis));
        let is_own = |key: &str| [HARDWARE, VARIANT].contains(&key);
        for (within, axis) in ranges
            .chain(variants)
            .filter(|(_, axis)| !is_own(&axis.key))
        {
            let key = format!("{within}.{}", axis.key);
            if DRAWING.contains(&axis.key.as_str()) {
                axis.values
                    .iter()
                    .try_for_each(|value| check_drawing(&key, &axis.key, value))?;
                continue;
            }
            for base in &self.bases {
                let mut description = table_of(base);
                if slot(&mut description, &axis.key).is_none() {
                    let there = neighbours(description, &axis.key);
                    let instead = format!("hardware `{}` has {there}", base.name);
                    return Err(unknown(&key, instead));
                }
            }
        }
        if self.points() > MAX_POINTS {
            return Err(SpaceError(format!(
                "it has more than {MAX_POINTS} points; take values out of its ranges"
            )));
        }
        (0..self.points()).try_for_each(|number| self.point(number).map(|_| ()))
    }
}

/// A hardware whose units are wider or narrower by as much as words of `bits` bits are than those that it was built for.
/// Wide units are for sums of products of two words, which have two more bits for each bit of a word.
fn with_width(hardware: &Hardware, bits: u32) -> Hardware {
    let mut hardware = hardware.clone();
    let stages = hardware.stages.values_mut();
    for units in stages.chain([&mut hardware.units]) {
        for unit in units.values_mut().filter(|unit| unit.width > 8) {
            let words = if unit.width > 40 { 2 } else { 1 };
            let wider = words * (i64::from(bits) - i64::from(BUILT_FOR_BITS));
            unit.width = (i64::from(unit.width) + wider).max(1) as u32;
        }
    }
    hardware
}

fn check_drawing(key: &str, setting: &str, value: &Value) -> Result<(), SpaceError> {
    let one = Table::from_iter([(setting.to_owned(), value.clone())]);
    let drawing: Drawing = one
        .try_into()
        .map_err(|error: toml::de::Error| wrong(key, error.message()))?;
    let bits = drawing.bits.unwrap_or(MIN_BITS);
    if !(MIN_BITS..=MAX_BITS).contains(&bits) {
        let why = format!("{value}: a word has {MIN_BITS} to {MAX_BITS} bits");
        return Err(wrong(key, why));
    }
    if drawing.size == Some(0) || drawing.tolerance.is_some_and(|px| px.is_nan() || px < 0.0) {
        return Err(wrong(key, format!("{value} is too small")));
    }
    Ok(())
}

fn table_of(hardware: &Hardware) -> Table {
    match Table::try_from(hardware) {
        Ok(table) => table,
        Err(error) => unreachable!("a description is written as it is read: {error}"),
    }
}

fn slot<'a>(description: &'a mut Table, key: &str) -> Option<&'a mut Value> {
    match key.split_once('.') {
        None => description.get_mut(key),
        Some((first, rest)) => slot(description.get_mut(first)?.as_table_mut()?, rest),
    }
}

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

fn variants_of(list: Option<Value>) -> Result<(Vec<Value>, Vec<Vec<Axis>>), SpaceError> {
    let must = "it must be a list: [[variants]], each with a `name` and the keys that it sets";
    let list = match list {
        None => return Ok((Vec::new(), Vec::new())),
        Some(Value::Array(list)) => list,
        Some(_) => return Err(wrong("variants", must)),
    };
    let (mut names, mut all) = (Vec::new(), Vec::new());
    for variant in list {
        let Value::Table(mut variant) = variant else {
            return Err(wrong("variants", must));
        };
        let Some(name @ Value::String(_)) = variant.remove("name") else {
            return Err(wrong("variants", must));
        };
        let mut settings = Vec::new();
        collect("", &variant, &mut settings)?;
        if settings.iter().any(|axis| axis.values.len() > 1) {
            return Err(wrong("variants", "a variant sets one value for each key"));
        }
        names.push(name);
        all.push(settings);
    }
    let names = values_of("variants", &Value::Array(names))?;
    Ok((names, all))
}

/// Adds the axes of a table of ranges. Tables without `from` are parts of descriptions.
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
            return Err(wrong(key, format!("it has {value} twice")));
        }
    }
    Ok(values)
}

/// A range of whole numbers, by steps or factors.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Steps {
    from: u32,
    to: u32,
    step: Option<u32>,
    times: Option<u32>,
}

fn stepped(key: &str, range: &Table) -> Result<Vec<Value>, SpaceError> {
    let steps = Value::Table(range.clone()).try_into();
    let of: Steps = steps.map_err(|error: toml::de::Error| wrong(key, error.message()))?;
    let next: Box<dyn Fn(u32) -> Option<u32>> = match (of.step, of.times) {
        (Some(step), None) if step > 0 => Box::new(move |value| value.checked_add(step)),
        (None, Some(times)) if times > 1 && of.from > 0 => {
            Box::new(move |value| value.checked_mul(times))
        }
        _ => {
            let why = "it needs one of `step`, 1 or more, and `times`, 2 or more from 1 or more";
            return Err(wrong(key, why));
        }
    };
    if of.from > of.to {
        let why = format!("it is empty, from {} to {}", of.from, of.to);
        return Err(wrong(key, why));
    }
    let is_within = |next: &u32| *next <= of.to;
    let values = std::iter::successors(Some(of.from), |&value| next(value).filter(is_within));
    // One more than allowed, so that the excess is noticed.
    let values = values.take(MAX_POINTS + 1).map(i64::from);
    Ok(values.map(Value::Integer).collect())
}
