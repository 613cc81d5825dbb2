//! The description of a hardware: how wide each part of it is.
//!
//! Read from TOML; four descriptions ship in `hwmodel/machines/`, each line
//! commented: `tiny`, `paper`, `light` and `wide`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::memory::RecordBits;
use crate::{OpClass, Stage};

/// Most lanes a hardware may have.
pub const MAX_LANES: u32 = 256;
/// Most contexts that a lane may have.
pub const MAX_CONTEXTS: u32 = 64;
/// Slowest and fastest clock, MHz: a kilohertz and a terahertz.
const CLOCKS: std::ops::RangeInclusive<f64> = 1e-3..=1e6;
/// Largest of all other numbers: no sum of a turn's times leaves 64 bits.
const MAX_NUMBER: u32 = 1 << 24;
/// Largest number of things that the simulation keeps one by one.
const MAX_KEPT: u32 = 1 << 16;
/// Largest entry of a cache, bytes: each access looks at all lines it spans.
const MAX_ENTRY: u32 = 4096;
/// Shortest line of a cache, bytes.
const MIN_LINE: u32 = 8;

/// A hardware.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hardware {
    /// Its name in reports; a line of text.
    pub name: String,
    /// Clock, MHz; 0.001 to 1,000,000.
    pub clock_mhz: f64,
    /// Copies of the record loop's blocks and stack, 1 to [`MAX_LANES`].
    pub lanes: u32,
    /// Records that a lane works on in turns, 1 to [`MAX_CONTEXTS`].
    pub contexts: u32,
    /// Which records may be worked on at once.
    pub independence: Independence,
    /// Further cycles to take a record from another lane's stack.
    pub steal_cycles: u32,
    /// Whether a turn's steps follow one another as the record loop makes them, with nothing at once:
    /// rule 12 of [this module's parent](super).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sequential: bool,
    /// Classes of operation that take no unit and no time.
    #[serde(default)]
    pub wires: Vec<OpClass>,
    /// Units of every stage's block, by class of operation.
    pub units: BTreeMap<OpClass, Unit>,
    /// Units of some stages' blocks where they differ.
    #[serde(default)]
    pub stages: BTreeMap<Stage, BTreeMap<OpClass, Unit>>,
    /// What the record loop keeps where. Without: as the image-order paper has it.
    #[serde(default)]
    pub organisation: Organisation,
    /// The record stack of a lane.
    pub stack: Stack,
    /// Graph nodes, for all lanes.
    pub node_cache: Cache,
    /// Colours and normals, for all lanes.
    pub attribute_cache: Cache,
    /// Fill vectors, for all lanes.
    pub fill_vectors: Banks,
    /// Pixels, for all lanes.
    pub pixels: Pixels,
    /// The port to outer memory, for all lanes.
    #[serde(default)]
    pub outer_memory: OuterMemory,
}

/// The port to outer memory, which cache misses, spilled records and pixels share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OuterMemory {
    /// Bytes it moves a cycle; 0, where nothing is said: as many as are wanted.
    pub bytes_per_cycle: u32,
}

impl OuterMemory {
    /// Cycles for which so many bits take the port.
    #[must_use]
    pub fn cycles(self, bits: u64) -> u64 {
        match self.bytes_per_cycle {
            0 => 0,
            bytes => bits.div_ceil(8 * u64::from(bytes)),
        }
    }
}

/// How the record loop's data is organised. The picture under rules of exact coverage is the same whatever this says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Organisation {
    /// What lies on the stack.
    pub stack: StackHolds,
    /// Whether a node says which of its children are leaves, so that leaves need not be read to be drawn.
    pub leaf_masks: bool,
    /// Levels of the image quadtree above its tiles, each of which is drawn by a walk of its own; 0: one
    /// walk for the picture.
    pub tile_levels: u32,
    /// Whether a node two levels above the finest voxels holds all voxels below it as a mask of 64 bits, so that the
    /// nodes between are not read. Of trees stored level by level; needs `leaf_masks`.
    pub bricks: bool,
    /// Whether a record is compared with the samples drawn before its node is read: what is hidden is not read.
    /// Only under the rules that draw outlines.
    pub hidden_unread: bool,
    /// Whether the lowest two levels of fill vectors are held as one word of 16 bits, one a sample.
    pub joined_fill: bool,
    /// Whether fields of a record and wide words have as many bits as the frame's set-up proves to be enough.
    pub packed: bool,
}

impl Organisation {
    /// What of it there is under a rule that does not draw outlines: vertices can be worked back,
    /// and what is hidden told, only where both are exact.
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

/// What lies on the stack of a record loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StackHolds {
    /// Children: a record that is subdivided pushes all that can be seen, each with its vertices.
    #[default]
    Children,
    /// Parents: a record that is subdivided stays, with a mask of the children that are left. Children are
    /// made one by one when their turn comes, and only what is subdivided is ever stored.
    Parents,
    /// The way to a record: of each parent its node and the children that are left. Its vertices, planes and place in
    /// the picture are worked back from those of the descendant that the walk comes from.
    Path,
}

/// Most levels above the tiles of an image.
pub const MAX_TILE_LEVELS: u32 = 8;

/// Which children of a record may be worked on at once. What is not
/// independent waits for the whole subtree of the earlier one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Independence {
    /// None: one after the other, depth first.
    None,
    /// Those of one class of the occlusion order, as the image-order paper has it: the
    /// nearest; the next three; the next three; the farthest. They never
    /// occlude one another, but where samples are not claimed by exact rays
    /// two may claim the same one; then the first to come has it.
    Classes,
    /// Those whose image nodes are disjoint. What meets in the picture keeps
    /// the serial order, so that everything comes out as it does serially.
    Image,
    /// Those that either rule lets through.
    Both,
}

/// Units of one class of operation in one block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unit {
    /// How many; at least 1.
    pub count: u32,
    /// Cycles from the last operation's last issue cycle to its result.
    pub latency: u32,
    /// Cycles after which a unit takes its next operation; at least 1.
    pub interval: u32,
    /// Bits; a wider operation takes `ceil(bits / width)` passes.
    pub width: u32,
}

/// A lane's record stack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stack {
    /// Records it holds.
    pub entries: u32,
    /// Accesses it takes a cycle.
    pub ports: u32,
    /// Cycles of a read.
    pub latency: u32,
    /// What becomes of a record beyond the last entry.
    pub overflow: StackOverflow,
    /// Further cycles to take a record that was spilled, until its first bits are there.
    pub spill_cycles: u32,
    /// Bits of the frame's records: what a spilled one moves to outer memory
    /// and back. Whoever simulates a frame says it; a description need not.
    #[serde(default)]
    pub record: RecordBits,
}

/// What becomes of a record for which a stack has no entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StackOverflow {
    /// It is written to outer memory in the background, and read back when
    /// its turn comes.
    Spill,
    /// The frame ends with an error.
    Error,
}

/// A set-associative cache with least-recently-used replacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cache {
    /// Size; a multiple of `ways * line_bytes`.
    pub bytes: u32,
    /// Lines of a set.
    pub ways: u32,
    /// Bytes of a line; a power of two.
    pub line_bytes: u32,
    /// Bytes of one entry (a node, an attribute).
    pub entry_bytes: u32,
    /// Accesses it takes a cycle.
    pub ports: u32,
    /// Cycles of a hit.
    pub hit_latency: u32,
    /// Further cycles of a miss.
    pub miss_latency: u32,
    /// Misses that may be under way at once.
    pub misses: u32,
}

/// A memory of banks; an address lies in bank `address mod banks`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Banks {
    /// Banks.
    pub banks: u32,
    /// Reads that a bank takes a cycle.
    pub read_ports: u32,
    /// Writes that a bank takes a cycle.
    pub write_ports: u32,
    /// Cycles of a read; a write takes one.
    pub latency: u32,
}

/// The way out for pixels: ports into a buffer that drains at a fixed rate at most, by the port to outer memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pixels {
    /// Writes a cycle into the buffer.
    pub write_ports: u32,
    /// Pixels that the buffer holds.
    pub buffer: u32,
    /// Cycles from one pixel's leaving to the next one's.
    pub drain_interval: u32,
    /// Whether pixels leave by a port of their own, and not by that to outer memory.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub own_port: bool,
}

/// Why a description is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HardwareError {
    /// Not TOML, or not of these fields.
    #[error("hardware description: {0}")]
    Syntax(String),
    /// A number out of its range.
    #[error("hardware description: {field} is {value}; it must be {range}")]
    Range {
        /// Where, as in the file.
        field: String,
        /// What is there.
        value: String,
        /// What may be there.
        range: String,
    },
    /// A class of operation that nothing does.
    #[error(
        "hardware description: nothing does `{class}`; give it a [units.{class}] \
         or put it into `wires`"
    )]
    NoUnit {
        /// The class, as in the file.
        class: String,
    },
    /// A class of operation that is listed both with units and without.
    #[error(
        "hardware description: `{class}` is among `wires`, which take no units, \
         and has a [units.{class}]; take out one"
    )]
    WiresAndUnits {
        /// The class, as in the file.
        class: String,
    },
    /// No description of this name ships.
    #[error("no hardware of the name `{0}` ships; there are tiny, paper, light and wide")]
    NoPreset(String),
}

/// Names and texts of the descriptions that ship.
pub const PRESETS: [(&str, &str); 4] = [
    ("tiny", include_str!("../../machines/tiny.toml")),
    ("paper", include_str!("../../machines/paper.toml")),
    ("light", include_str!("../../machines/light.toml")),
    ("wide", include_str!("../../machines/wide.toml")),
];

impl Hardware {
    /// Reads and checks a description.
    ///
    /// # Errors
    /// With the line where the text is no description, or with the field, its
    /// value and its range.
    pub fn from_toml(text: &str) -> Result<Self, HardwareError> {
        let hardware: Self =
            toml::from_str(text).map_err(|error| HardwareError::Syntax(error.to_string()))?;
        hardware.check()?;
        Ok(hardware)
    }

    /// One of those that ship: `tiny`, `paper`, `light`, `wide`.
    ///
    /// # Errors
    /// Where there is none of that name.
    pub fn preset(name: &str) -> Result<Self, HardwareError> {
        let (_, text) = PRESETS
            .iter()
            .find(|(of, _)| *of == name)
            .ok_or_else(|| HardwareError::NoPreset(name.to_owned()))?;
        Self::from_toml(text)
    }

    /// The units of a class in a stage's block; `None`: wires.
    #[must_use]
    pub fn unit(&self, stage: Stage, class: OpClass) -> Option<Unit> {
        if let Some(unit) = self.stages.get(&stage).and_then(|units| units.get(&class)) {
            return Some(*unit);
        }
        if self.wires.contains(&class) {
            return None;
        }
        self.units.get(&class).copied()
    }

    /// Whether lanes are given tiles, each of which they draw alone: rule 13 of [this module's parent](super).
    #[must_use]
    pub fn hands_out_tiles(&self) -> bool {
        self.sequential && self.organisation.tile_levels > 0
    }

    /// Walks with a stack of their own: lanes or, where tiles are [handed out](Self::hands_out_tiles), contexts.
    #[must_use]
    pub fn stacks(&self) -> u32 {
        match self.hands_out_tiles() {
            true => self.lanes * self.contexts,
            false => self.lanes,
        }
    }

    /// Contexts of all lanes.
    #[must_use]
    pub fn all_contexts(&self) -> u64 {
        u64::from(self.lanes) * u64::from(self.contexts)
    }

    /// Checks every number.
    ///
    /// # Errors
    /// With the first field that is out of its range.
    pub fn check(&self) -> Result<(), HardwareError> {
        if self.name.trim().is_empty() || self.name.contains(char::is_control) {
            let name = format!("{:?}", self.name);
            return Err(out_of_range("name", name, "a line of text"));
        }
        if !CLOCKS.contains(&self.clock_mhz) {
            let clock = format!("{:?}", self.clock_mhz);
            return Err(out_of_range("clock_mhz", clock, "0.001 to 1000000"));
        }
        within("lanes", self.lanes, 1, MAX_LANES)?;
        let tile_levels = self.organisation.tile_levels;
        within("organisation.tile_levels", tile_levels, 0, MAX_TILE_LEVELS)?;
        let Organisation {
            bricks, leaf_masks, ..
        } = self.organisation;
        if bricks && !leaf_masks {
            let range = "false where leaf_masks is";
            return Err(out_of_range("organisation.bricks", bricks, range));
        }
        within("contexts", self.contexts, 1, MAX_CONTEXTS)?;
        if self.sequential && self.contexts > 1 && tile_levels == 0 {
            let range = "1 where lanes are sequential and draw no tiles";
            return Err(out_of_range("contexts", self.contexts, range));
        }
        within("steal_cycles", self.steal_cycles, 0, MAX_NUMBER)?;
        for class in OpClass::ALL {
            match (self.units.contains_key(&class), self.wires.contains(&class)) {
                (false, false) => return Err(HardwareError::NoUnit { class: key(&class) }),
                (true, true) => {
                    return Err(HardwareError::WiresAndUnits { class: key(&class) });
                }
                _ => {}
            }
        }
        for (class, unit) in &self.units {
            unit.check(&format!("units.{}", key(class)))?;
        }
        for (stage, units) in &self.stages {
            for (class, unit) in units {
                unit.check(&format!("stages.{}.{}", key(stage), key(class)))?;
            }
        }
        let stack = &self.stack;
        within("fill_vectors.banks", self.fill_vectors.banks, 1, MAX_KEPT)?;
        within("pixels.buffer", self.pixels.buffer, 1, MAX_KEPT)?;
        for (field, value, least) in [
            (
                "outer_memory.bytes_per_cycle",
                self.outer_memory.bytes_per_cycle,
                0,
            ),
            ("stack.record.clip", stack.record.clip, 0),
            ("stack.record.screen", stack.record.screen, 0),
            ("stack.record.finest", stack.record.finest, 0),
            ("stack.entries", stack.entries, 1),
            ("stack.ports", stack.ports, 1),
            ("stack.latency", stack.latency, 0),
            ("stack.spill_cycles", stack.spill_cycles, 0),
            ("fill_vectors.read_ports", self.fill_vectors.read_ports, 1),
            ("fill_vectors.write_ports", self.fill_vectors.write_ports, 1),
            ("fill_vectors.latency", self.fill_vectors.latency, 0),
            ("pixels.write_ports", self.pixels.write_ports, 1),
            ("pixels.drain_interval", self.pixels.drain_interval, 0),
        ] {
            within(field, value, least, MAX_NUMBER)?;
        }
        self.node_cache.check("node_cache")?;
        self.attribute_cache.check("attribute_cache")
    }
}

impl Unit {
    fn check(&self, at: &str) -> Result<(), HardwareError> {
        within(&format!("{at}.count"), self.count, 1, MAX_NUMBER)?;
        within(&format!("{at}.latency"), self.latency, 0, MAX_NUMBER)?;
        within(&format!("{at}.interval"), self.interval, 1, MAX_NUMBER)?;
        within(&format!("{at}.width"), self.width, 1, MAX_NUMBER)
    }
}

impl Cache {
    /// Sets.
    #[must_use]
    pub fn sets(&self) -> u32 {
        self.bytes / (self.ways * self.line_bytes)
    }

    fn check(&self, at: &str) -> Result<(), HardwareError> {
        for (field, value, least) in [
            ("bytes", self.bytes, 1),
            ("ways", self.ways, 1),
            ("line_bytes", self.line_bytes, MIN_LINE),
            ("ports", self.ports, 1),
            ("hit_latency", self.hit_latency, 0),
            ("miss_latency", self.miss_latency, 0),
        ] {
            within(&format!("{at}.{field}"), value, least, MAX_NUMBER)?;
        }
        within(&format!("{at}.entry_bytes"), self.entry_bytes, 1, MAX_ENTRY)?;
        within(&format!("{at}.misses"), self.misses, 1, MAX_KEPT)?;
        if !self.line_bytes.is_power_of_two() {
            let field = format!("{at}.line_bytes");
            return Err(out_of_range(&field, self.line_bytes, "a power of two"));
        }
        let set = u64::from(self.ways) * u64::from(self.line_bytes);
        if !u64::from(self.bytes).is_multiple_of(set) {
            let range = format!("a multiple of ways * line_bytes, {set}");
            return Err(out_of_range(&format!("{at}.bytes"), self.bytes, &range));
        }
        Ok(())
    }
}

/// A name as the file has it.
fn key(of: &impl std::fmt::Debug) -> String {
    // `MinMax` is `min_max` in the file.
    let mut name = String::new();
    for letter in format!("{of:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

fn within(field: &str, value: u32, least: u32, most: u32) -> Result<(), HardwareError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(out_of_range(field, value, &format!("{least} to {most}")))
    }
}

fn out_of_range(field: &str, value: impl ToString, range: &str) -> HardwareError {
    HardwareError::Range {
        field: field.to_owned(),
        value: value.to_string(),
        range: range.to_owned(),
    }
}
