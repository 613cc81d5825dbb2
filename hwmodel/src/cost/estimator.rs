//! The interface of estimators: the shipped tables are one, and a user's program or file may be another.

use std::fmt::Debug;

use super::{Breakdown, Cost, CostError, CostTable, Line};

/// Name and size of a component.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Attributes {
    /// The component's name: its design and its own, such as `light.add_32`.
    pub name: String,
    /// In bits: of a unit's words, or of an access.
    pub width: u32,
    /// Of a memory on the chip.
    pub bytes: Option<u64>,
}

/// Prices components by their kind: an operation of the cost tables such as `add`, `sram` or `dram`.
///
/// ```
/// use hwmodel::cost::{Attributes, CostTable, Estimator};
///
/// let by: &dyn Estimator = &CostTable::load_shipped()?;
/// let of = Attributes { width: 64, bytes: Some(8192), ..Attributes::default() };
/// assert_eq!(by.energy("sram", "read", &of)?.value, 10.0);
/// # Ok::<(), hwmodel::cost::CostError>(())
/// ```
pub trait Estimator: Debug + Send + Sync {
    /// Energy of one action, in picojoules: `read` and `write` of memories, `compute` of units.
    fn energy(&self, component: &str, action: &str, of: &Attributes) -> Result<Cost, CostError>;
}

impl Estimator for CostTable {
    fn energy(&self, component: &str, action: &str, of: &Attributes) -> Result<Cost, CostError> {
        match (component, of.bytes) {
            ("sram", Some(bytes)) => self.memory_energy(&format!("sram_{action}"), bytes, of.width),
            ("sram" | "dram", _) => self.energy(&format!("{component}_{action}"), of.width),
            _ => self.energy(component, of.width),
        }
    }
}

impl Line {
    /// The kind of the line's component, its action, its name and size. Wires are no component.
    pub fn request(&self, design: &str) -> Option<(&str, &'static str, Attributes)> {
        let width = self.width;
        let (component, action, name) = match self.operation.as_str() {
            "shift_wires" => return None,
            "sram_read" => ("sram", "read", slug(&self.name)),
            "sram_write" => ("sram", "write", slug(&self.name)),
            // One chip, whatever it keeps.
            "dram_read" => ("dram", "read", "dram".to_owned()),
            "dram_write" => ("dram", "write", "dram".to_owned()),
            unit => (unit, "compute", unit.to_owned()),
        };
        let attributes = Attributes {
            name: format!("{design}.{name}_{width}"),
            width,
            bytes: self.bytes,
        };
        Some((component, action, attributes))
    }
}

impl Breakdown {
    /// The same counts at an estimator's prices.
    pub fn priced_by(&self, design: &str, by: &dyn Estimator) -> Result<Self, CostError> {
        let mut sum = Self::default();
        for line in &self.lines {
            let each = match line.request(design) {
                Some((component, action, of)) => by.energy(component, action, &of)?,
                None => line.each.clone(),
            };
            sum.push(&line.name, &line.operation, line.width, line.times, each);
            sum.of_bytes(line.bytes);
        }
        Ok(sum)
    }
}

/// A name of letters, digits and underscores.
fn slug(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { ' ' };
    let spaced: String = name.chars().map(letter).collect();
    spaced.split_whitespace().collect::<Vec<_>>().join("_")
}
