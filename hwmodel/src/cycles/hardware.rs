//! Descriptions of hardware designs, in TOML. `machines/light.toml` explains each setting.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::built::Built;
use super::outer::Dram;
use crate::memory::RecordBits;
use crate::{OpClass, Stage};

/// Most lanes of a design.
pub const MAX_LANES: u32 = 256;
/// Most contexts of a lane.
pub const MAX_CONTEXTS: u32 = 64;
const CLOCKS: std::ops::RangeInclusive<f64> = 1e-3..=1e6;
/// Of all other numbers, so that sums of a turn's times fit 64 bits.
const MAX_NUMBER: u32 = 1 << 24;
/// Of things that the simulation keeps one by one.
const MAX_KEPT: u32 = 1 << 16;
const MAX_ENTRY: u32 = 4096;
const MIN_LINE: u32 = 8;

/// A hardware design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Hardware {
    pub name: String,
    pub clock_mhz: f64,
    pub lanes: u32,
    pub contexts: u32,
    pub independence: Independence,
    pub steal_cycles: u32,
    /// Rule 12 of [the parent module](super).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sequential: bool,
    /// Classes of operation that take no unit and no time.
    #[serde(default)]
    pub wires: Vec<OpClass>,
    pub units: BTreeMap<OpClass, Unit>,
    /// Units of single stages where they differ, by [`Stage::key`].
    #[serde(default)]
    pub stages: BTreeMap<String, BTreeMap<OpClass, Unit>>,
    /// Replaces [`units`](Self::units) in the area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub built: Option<Built>,
    #[serde(default)]
    pub organisation: Organisation,
    pub stack: Stack,
    pub node_cache: Cache,
    /// A small cache of nodes before the node cache, one for each lane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node_buffer: Option<Cache>,
    pub attribute_cache: Cache,
    pub fill_vectors: Banks,
    pub pixels: Pixels,
    #[serde(default)]
    pub outer_memory: OuterMemory,
}

/// The port that cache misses, spilled records and pixels share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct OuterMemory {
    pub bytes_per_cycle: u32,
    /// Rule 15 of [the parent module](super).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dram: Option<Dram>,
}

impl OuterMemory {
    /// Cycles for which a transfer of so many bits takes the port.
    pub fn cycles(self, bits: u64) -> u64 {
        match self.bytes_per_cycle {
            0 => 0,
            bytes => bits.div_ceil(8 * u64::from(bytes)),
        }
    }
}

/// Organisation of the record loop's data. Exact pictures do not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Organisation {
    pub stack: StackHolds,
    pub leaf_masks: bool,
    pub tile_levels: u32,
    pub bricks: bool,
    pub hidden_unread: bool,
    pub joined_fill: bool,
    pub packed: bool,
}

impl Organisation {
    /// Under rules that do not draw outlines: without recomputed vertices and occlusion tests.
    #[must_use]
    pub fn without_outlines(self) -> Self {
        let stack = match self.stack {
            StackHolds::Path => StackHolds::Parents,
            stack => stack,
        };
        Self {
            stack,
            hidden_unread: false,
            ..self
        }
    }
}

/// Contents of a record loop's stack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StackHolds {
    /// All visible children, each with its vertices.
    #[default]
    Children,
    /// Subdivided records, with masks of the remaining children.
    Parents,
    /// Node and remaining children of each parent; the rest is computed back from a descendant.
    Path,
}

/// Most levels above the tiles of an image.
pub const MAX_TILE_LEVELS: u32 = 8;

/// Children of a record that may be in progress at once. Others wait for the subtrees of earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Independence {
    /// None.
    None,
    /// Those of one class of the occlusion order, as in the image-order paper: the nearest, the next three, the next
    /// three or the farthest. Under rules that are not exact, two may cover the same sample, and the first keeps it.
    Classes,
    /// Those with disjoint image nodes: all results are the serial ones.
    Image,
    /// Those of either rule.
    Both,
}

/// Units of one class of operation in one block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Unit {
    pub count: u32,
    pub latency: u32,
    pub interval: u32,
    pub width: u32,
}

/// A lane's record stack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Stack {
    pub entries: u32,
    pub ports: u32,
    pub latency: u32,
    pub overflow: StackOverflow,
    pub spill_cycles: u32,
    /// Bits of the frame's records, for spilling.
    #[serde(default)]
    pub record: RecordBits,
}

/// Treatment of a record for which a stack has no entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StackOverflow {
    /// Written to outer memory, and read back for its turn.
    Spill,
    /// An error.
    Error,
}

/// A set-associative cache with least-recently-used replacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Cache {
    pub bytes: u32,
    pub ways: u32,
    pub line_bytes: u32,
    pub entry_bytes: u32,
    pub ports: u32,
    pub hit_latency: u32,
    pub miss_latency: u32,
    pub misses: u32,
}

/// A banked memory; an address lies in bank `address mod banks`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Banks {
    pub banks: u32,
    pub read_ports: u32,
    pub write_ports: u32,
    pub latency: u32,
}

/// The output of pixels: a buffer that drains by the port to outer memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "`machines/light.toml` explains each setting")]
pub struct Pixels {
    pub write_ports: u32,
    pub buffer: u32,
    pub drain_interval: u32,
    /// Whether pixels leave by their own port.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub own_port: bool,
}

/// An invalid field, its value and the allowed ones.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("hardware description: {0}")]
pub struct HardwareError(pub String);

/// Names and texts of the shipped descriptions.
pub const PRESETS: [(&str, &str); 4] = [
    ("tiny", include_str!("../../machines/tiny.toml")),
    ("paper", include_str!("../../machines/paper.toml")),
    ("light", include_str!("../../machines/light.toml")),
    ("wide", include_str!("../../machines/wide.toml")),
];

impl Hardware {
    /// Reads and checks a description.
    pub fn from_toml(text: &str) -> Result<Self, HardwareError> {
        let hardware: Self =
            toml::from_str(text).map_err(|error| HardwareError(error.to_string()))?;
        hardware.check()?;
        Ok(hardware)
    }

    /// A shipped description, by its name in [`PRESETS`].
    pub fn preset(name: &str) -> Result<Self, HardwareError> {
        let preset = PRESETS.iter().find(|(of, _)| *of == name);
        let unknown = || HardwareError(format!("`{name}` is none of tiny, paper, light and wide"));
        Self::from_toml(preset.ok_or_else(unknown)?.1)
    }

    /// The units of a class in a stage's block, if it is not wires.
    pub fn unit(&self, stage: impl Into<Stage>, class: OpClass) -> Option<Unit> {
        let units = self.stages.get(&stage.into().key());
        if let Some(unit) = units.and_then(|units| units.get(&class)) {
            return Some(*unit);
        }
        if self.wires.contains(&class) {
            return None;
        }
        self.units.get(&class).copied()
    }

    /// Reports the first stage that a program does not have.
    pub fn check_stages(&self, known: &[Stage]) -> Result<(), HardwareError> {
        let known: Vec<String> = known.iter().map(|stage| stage.key()).collect();
        let built = self.built.iter().flat_map(|built| built.units.keys());
        let mut named = self.stages.keys().chain(built);
        let unknown = named.find(|key| !known.contains(key));
        unknown.map_or(Ok(()), |key| {
            let known = known.join(", ");
            Err(HardwareError(format!("[stages.{key}] is none of {known}")))
        })
    }

    /// Rule 13 of [the parent module](super).
    pub fn hands_out_tiles(&self) -> bool {
        self.sequential && self.organisation.tile_levels > 0
    }

    /// Number of stacks: lanes or, with [tiles](Self::hands_out_tiles), contexts.
    pub fn stacks(&self) -> u32 {
        match self.hands_out_tiles() {
            true => self.lanes * self.contexts,
            false => self.lanes,
        }
    }

    /// Contexts of all lanes.
    pub fn all_contexts(&self) -> u64 {
        u64::from(self.lanes) * u64::from(self.contexts)
    }

    /// Reports the first number out of its range.
    pub fn check(&self) -> Result<(), HardwareError> {
        let organisation = &self.organisation;
        if self.name.trim().is_empty() || self.name.contains(char::is_control) {
            let name = format!("{:?}", self.name);
            return Err(out_of_range("name", name, "a line of text"));
        }
        if !CLOCKS.contains(&self.clock_mhz) {
            let clock = format!("{:?}", self.clock_mhz);
            return Err(out_of_range("clock_mhz", clock, "0.001 to 1000000"));
        }
        if organisation.bricks && !organisation.leaf_masks {
            let range = "false where leaf_masks is";
            return Err(out_of_range("organisation.bricks", true, range));
        }
        if self.sequential && self.contexts > 1 && organisation.tile_levels == 0 {
            let range = "1 where lanes are sequential and draw no tiles";
            return Err(out_of_range("contexts", self.contexts, range));
        }
        let table = toml::Table::try_from(self);
        check_numbers(
            "",
            &table.map_err(|error| HardwareError(error.to_string()))?,
        )?;
        for class in OpClass::ALL {
            let problem = match (self.units.contains_key(&class), self.wires.contains(&class)) {
                (false, false) => "has neither a [units] nor a place among `wires`",
                (true, true) => "is among `wires`, which take no units, and has a [units]",
                _ => continue,
            };
            let key = toml::Value::try_from(class).ok();
            let key = key.as_ref().and_then(toml::Value::as_str);
            let key = key.unwrap_or(class.name());
            return Err(HardwareError(format!("`{key}` {problem}")));
        }
        let buffer = self.node_buffer.as_ref();
        if let Some(buffer) = buffer {
            let cache = &self.node_cache;
            if buffer.entry_bytes != cache.entry_bytes {
                let range = format!("{}, as in the node cache", cache.entry_bytes);
                return Err(out_of_range(
                    "node_buffer.entry_bytes",
                    buffer.entry_bytes,
                    &range,
                ));
            }
            if buffer.line_bytes > cache.line_bytes {
                let range = format!("at most {}, as in the node cache", cache.line_bytes);
                return Err(out_of_range(
                    "node_buffer.line_bytes",
                    buffer.line_bytes,
                    &range,
                ));
            }
        }
        let caches = [
            ("node_cache", &self.node_cache),
            ("attribute_cache", &self.attribute_cache),
        ];
        for (name, cache) in caches
            .into_iter()
            .chain(buffer.map(|of| ("node_buffer", of)))
        {
            let Cache {
                line_bytes,
                ways,
                bytes,
                ..
            } = *cache;
            if !line_bytes.is_power_of_two() {
                let field = format!("{name}.line_bytes");
                return Err(out_of_range(&field, line_bytes, "a power of two"));
            }
            let set = u64::from(ways) * u64::from(line_bytes);
            if !u64::from(bytes).is_multiple_of(set) {
                let range = format!("a multiple of ways * line_bytes, {set}");
                return Err(out_of_range(&format!("{name}.bytes"), bytes, &range));
            }
        }
        Ok(())
    }
}

impl Cache {
    /// Sets.
    pub fn sets(&self) -> u32 {
        self.bytes / (self.ways * self.line_bytes)
    }
}

fn limits(field: &str) -> (u32, u32) {
    match field {
        "lanes" => (1, MAX_LANES),
        "contexts" => (1, MAX_CONTEXTS),
        "tile_levels" => (0, MAX_TILE_LEVELS),
        "banks" | "buffer" | "misses" => (1, MAX_KEPT),
        "entry_bytes" => (1, MAX_ENTRY),
        "line_bytes" | "row_bytes" => (MIN_LINE, MAX_NUMBER),
        "count" | "interval" | "width" | "entries" | "bytes" | "ways" => (1, MAX_NUMBER),
        "ports" | "read_ports" | "write_ports" => (1, MAX_NUMBER),
        _ => (0, MAX_NUMBER),
    }
}

fn check_numbers(path: &str, table: &toml::Table) -> Result<(), HardwareError> {
    for (field, value) in table {
        match value {
            toml::Value::Table(table) => check_numbers(&format!("{path}{field}."), table)?,
            toml::Value::Integer(number) => {
                let (least, most) = limits(field);
                if !(i64::from(least)..=i64::from(most)).contains(number) {
                    let range = format!("{least} to {most}");
                    return Err(out_of_range(&format!("{path}{field}"), number, &range));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn out_of_range(field: &str, value: impl ToString, range: &str) -> HardwareError {
    let value = value.to_string();
    HardwareError(format!("{field} is {value}; it must be {range}"))
}
