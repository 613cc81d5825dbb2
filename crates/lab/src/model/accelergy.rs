//! Files of Accelergy (Wu, Emer and Sze, ICCAD 2019), version 0.3: its users price our counts, and we use their prices.
//!
//! - [`counts`] writes the components of both designs and how often each acts. `accelergy` reads it.
//! - [`energies`] writes an energy reference table (ERT) with our prices, in picojoules.
//! - [`EnergyTable`] reads an ERT, and is an [`Estimator`].
//!
//! A component is called `shiftvox.DESIGN.KIND_BITS`, a memory on the chip by its use: `shiftvox.light.node_64`. Its class
//! is the nearest of Accelergy's primitive classes, or else the operation's name. An access changes address and data.
//! Shifts by wires are no components. Leakage and the clock are neither written nor read.

mod yaml;

use std::collections::BTreeMap;
use std::fmt::Write;

use hwmodel::cost::{Attributes, Cost, CostError, Estimator, Fit, Quantity, Technology};
use serde::Deserialize;
use serde_json::Value;

use super::cost::FrameCost;

const VERSION: &str = "0.3";
const ROOT: &str = "shiftvox";
/// Arguments of an access.
const ACCESS: [&str; 2] = ["data_delta", "address_delta"];

/// Class and action of a kind of component that does something.
fn class_of<'a>(component: &'a str, action: &'a str) -> (&'a str, &'a str) {
    match component {
        "add" | "sub" | "midpoint" | "divide_step" => ("intadder", "add"),
        "less" | "min" | "minmax" => ("comparator", "compare"),
        "xor" | "and" | "invert" | "select" => ("bitwise", "process"),
        "multiply" => ("intmultiplier", "mult_random"),
        "float_add" => ("fpadder", "add"),
        "float_multiply" => ("fpmultiplier", "mult_random"),
        "sram" => ("SRAM", action),
        "dram" => ("DRAM", action),
        other => (other, action),
    }
}

#[derive(Debug)]
struct Component {
    class: String,
    of: Attributes,
    /// Times, and the energy of one.
    actions: BTreeMap<String, (u64, f64)>,
}

type Components = BTreeMap<String, Component>;

fn components(design: &str, cost: &FrameCost) -> Components {
    let mut found = Components::new();
    let parts = [&cost.operations, &cost.on_chip, &cost.outer];
    for line in parts.iter().flat_map(|part| &part.lines) {
        let Some((component, action, of)) = line.request(design) else {
            continue;
        };
        let (class, action) = class_of(component, action);
        let entry = found.entry(of.name.clone()).or_insert_with(|| Component {
            class: class.to_owned(),
            of,
            actions: BTreeMap::new(),
        });
        let counted = entry.actions.entry(action.to_owned()).or_default();
        *counted = (counted.0 + line.times, line.each.value);
    }
    found
}

/// Components and action counts of designs.
pub fn counts(designs: &[(&str, &FrameCost)], technology: Technology) -> String {
    let mut text = format!(
        "architecture:\n  version: {VERSION}\n  subtree:\n  - name: {ROOT}\n    attributes:\n      \
         technology: {}nm\n      voltage: {}\n    subtree:\n",
        technology.nm, technology.volts
    );
    let mut counted = format!("action_counts:\n  version: {VERSION}\n  local:\n");
    for (design, cost) in designs {
        text += &format!("    - name: {design}\n      local:\n");
        for (path, component) in components(design, cost) {
            let name = path.rsplit('.').next().unwrap_or(&path);
            let Attributes { width, bytes, .. } = component.of;
            let words = bytes.map(|bytes| (8 * bytes).div_ceil(u64::from(width.max(1))));
            let size = match words {
                Some(words) => format!("width: {width}\n          depth: {words}"),
                None if component.class == "DRAM" => format!("width: {width}"),
                None => format!("datawidth: {width}"),
            };
            let class = &component.class;
            text += &format!(
                "      - name: {name}\n        class: {class}\n        attributes:\n          {size}\n"
            );
            counted += &format!("  - name: {ROOT}.{path}\n    action_counts:\n");
            for (action, (times, _)) in &component.actions {
                counted += &format!("    - name: {action}\n");
                if class == "SRAM" {
                    counted += &arguments();
                }
                counted += &format!("      counts: {times}\n");
            }
        }
    }
    text + &counted
}

fn arguments() -> String {
    let lines = ACCESS.map(|name| format!("        {name}: 1\n")).concat();
    format!("      arguments:\n{lines}")
}

/// An energy reference table of designs.
pub fn energies(designs: &[(&str, &FrameCost)]) -> String {
    let mut text = format!("ERT:\n  version: {VERSION}\n  tables:\n");
    for (design, cost) in designs {
        for (path, component) in components(design, cost) {
            let _ = writeln!(text, "  - name: {ROOT}.{path}\n    actions:");
            for (action, (_, energy)) in &component.actions {
                let _ = writeln!(text, "    - name: {action}");
                match component.class.as_str() {
                    "SRAM" => text += &arguments(),
                    _ => text += "      arguments: null\n",
                }
                let _ = writeln!(text, "      energy: {energy}");
            }
        }
    }
    text
}

#[derive(Debug, Deserialize)]
struct File {
    #[serde(rename = "ERT")]
    ert: Tables,
}

#[derive(Debug, Deserialize)]
struct Tables {
    tables: Vec<Table>,
}

#[derive(Debug, Deserialize)]
struct Table {
    name: String,
    actions: Vec<Action>,
}

#[derive(Debug, Deserialize)]
struct Action {
    name: String,
    arguments: Option<BTreeMap<String, Value>>,
    energy: f64,
}

impl Action {
    /// Whether it is an access that changes address and data, or has no such arguments.
    fn changes_all(&self) -> bool {
        let arguments = self.arguments.iter().flatten();
        let mut deltas = arguments.filter(|(name, _)| ACCESS.contains(&name.as_str()));
        deltas.all(|(_, value)| value.as_f64() == Some(1.0))
    }
}

/// An energy reference table of Accelergy. It has no areas.
#[derive(Debug)]
pub struct EnergyTable {
    file: String,
    tables: Vec<Table>,
}

impl EnergyTable {
    /// Reads a table; errors call it `file`.
    ///
    /// # Errors
    /// When the text is no ERT of version 0.3 or later, or an energy is not a number from 0.
    pub fn parse(file: &str, text: &str) -> Result<Self, CostError> {
        // A reason may repeat a long text.
        let wrong = |why: String| {
            let why: String = why.chars().take(200).collect();
            CostError::new(format!("{file} is no Accelergy ERT: {why}"))
        };
        let document = yaml::document(text).map_err(wrong)?;
        let parsed = serde_json::from_value(document);
        let parsed: File = parsed.map_err(|error| wrong(error.to_string()))?;
        for table in &parsed.ert.tables {
            for Action { name, energy, .. } in &table.actions {
                if *energy < 0.0 {
                    let key = format!("`{name}` of `{}`: energy is {energy}", table.name);
                    return Err(wrong(format!("{key}; it must be at least 0")));
                }
            }
        }
        Ok(Self {
            file: file.to_owned(),
            tables: parsed.ert.tables,
        })
    }

    fn table(&self, name: &str) -> Option<&Table> {
        self.tables.iter().find(|table| {
            // Numbers of copies, such as `[0..3]`, say nothing about energy.
            let pieces = table.name.split('[');
            let mut plain = String::new();
            for piece in pieces {
                plain += piece.split_once(']').map_or(piece, |(_, rest)| rest);
            }
            let rest = plain.strip_suffix(name);
            rest.is_some_and(|rest| rest.is_empty() || rest.ends_with('.'))
        })
    }
}

impl Estimator for EnergyTable {
    fn energy(&self, component: &str, action: &str, of: &Attributes) -> Result<Cost, CostError> {
        let (_, action) = class_of(component, action);
        let Self { file, .. } = self;
        let name = &of.name;
        let missing = |what: String| CostError::new(format!("{file}: ERT.tables has no {what}"));
        let table = self.table(name);
        let table = table.ok_or_else(|| missing(format!("`{ROOT}.{name}`")))?;
        let mut actions = table.actions.iter().filter(|of| of.name == action);
        let found = actions.find(|of| of.changes_all());
        let found = found.ok_or_else(|| missing(format!("action `{action}` of `{name}`")))?;
        Ok(Cost {
            quantity: Quantity::EnergyPj,
            value: found.energy,
            low: found.energy,
            high: found.energy,
            fit: Fit::Row,
            derived: false,
            rows: format!("`{action}` of `{}` ({file})", table.name),
            source: "an energy reference table of Accelergy".to_owned(),
        })
    }
}

#[cfg(test)]
mod tests;
