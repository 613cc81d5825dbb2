//! The ray caster's description, in TOML. `rival.toml` explains each setting.

use std::collections::BTreeMap;

use hwmodel::cycles::{
    Cache, Hardware, HardwareError, Independence, Organisation, Stack, StackHolds, StackOverflow,
    Unit,
};
use hwmodel::memory::RecordBits;
use hwmodel::{Format, OpClass, Stage};
use serde::{Deserialize, Serialize};

hwmodel::stages! {
    /// The stages of a ray, in the order of its work.
    pub enum RayStage {
        /// The step from a ray to the next.
        Next = "ray next",
        /// Whether and where a ray enters the object.
        Setup = "ray setup",
        /// A cell of a ray: into it, or on to the next one.
        Step = "ray step",
        /// The end of a ray at a voxel.
        Hit = "ray hit",
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rival {
    pub name: String,
    pub bits: u32,
    pub contexts: u32,
    #[serde(default)]
    pub wires: Vec<OpClass>,
    pub units: BTreeMap<OpClass, Unit>,
    #[serde(default)]
    pub stages: BTreeMap<String, BTreeMap<OpClass, Unit>>,
    pub stack: RivalStack,
    /// None: rays read nodes from the node cache.
    pub node_buffer: Option<Cache>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RivalStack {
    pub entries: u32,
    pub entry_bits: u32,
    pub ports: u32,
    pub latency: u32,
}

impl Rival {
    /// The text of the description that ships.
    pub const SHIPPED: &str = include_str!("rival.toml");

    pub fn shipped() -> Self {
        match Self::from_toml(Self::SHIPPED) {
            Ok(rival) => rival,
            Err(error) => unreachable!("the description ships with the program: {error}"),
        }
    }

    /// Reads and checks a description.
    pub fn from_toml(text: &str) -> Result<Self, HardwareError> {
        let rival: Self = toml::from_str(text).map_err(|error| HardwareError(error.to_string()))?;
        Format::new(rival.bits, 0).map_err(|error| HardwareError(format!("bits: {error}")))?;
        let stack = &rival.stack;
        if !(1..=32).contains(&stack.entries) || !(64..=4096).contains(&stack.entry_bits) {
            let why = "stack: a ray has 1 to 32 entries of 64 to 4096 bits";
            return Err(HardwareError(why.to_owned()));
        }
        // Beside a design that ships, its own numbers alone can be wrong.
        let hardware = rival.beside(&Hardware::preset("light")?);
        hardware.check()?;
        hardware.check_stages(&RayStage::ALL.map(Stage::from))?;
        Ok(rival)
    }

    /// The whole hardware beside a design, whose clock, lanes, memories and node format it shares.
    pub fn beside(&self, design: &Hardware) -> Hardware {
        Hardware {
            name: self.name.clone(),
            contexts: self.contexts,
            independence: Independence::Image,
            sequential: false,
            wires: self.wires.clone(),
            units: self.units.clone(),
            stages: self.stages.clone(),
            organisation: Organisation {
                stack: StackHolds::Parents,
                leaf_masks: design.organisation.leaf_masks,
                bricks: design.organisation.bricks,
                ..Organisation::default()
            },
            stack: Stack {
                // Rays that wait for a context; those in contexts have a stack of their own.
                entries: 2 * design.lanes * self.contexts + 2,
                ports: self.stack.ports,
                latency: self.stack.latency,
                overflow: StackOverflow::Error,
                spill_cycles: 0,
                record: RecordBits::default(),
            },
            node_buffer: self.node_buffer,
            built: None,
            ..design.clone()
        }
    }

    /// Bytes of a ray's stack.
    pub fn stack_bytes(&self) -> u64 {
        (u64::from(self.stack.entries) * u64::from(self.stack.entry_bits)).div_ceil(8)
    }
}
