//! A lower bound on the cycles of the ray caster.
//!
//! Its hardware has lanes of pipelined units that rays in contexts share. The bound is the largest time that a kind of
//! unit, a port, a cache's misses, outer memory, or the latencies of dependent steps over the contexts need. A real frame
//! is slower, so the bound favours the ray caster.

use std::collections::BTreeMap;

use hwmodel::cycles::{Bound, Hardware, Unit};
use serde::{Deserialize, Serialize};

use super::cost::OuterTraffic;
use crate::float_rays::{FloatRayCounts, FloatStep};

/// Bits of an entry of the ray's stack: a node and where the ray leaves it.
pub const ASIDE_BITS: u32 = 64;
/// Entries of a ray's stack: one a level.
const ASIDE_ENTRIES: u64 = 24;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RayHardware {
    pub contexts: u32,
    /// Units by kind of step; minima and maxima are `float_compare`'s.
    pub units: BTreeMap<FloatStep, Unit>,
    pub stack: RayStack,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RayStack {
    pub ports: u32,
    pub latency: u32,
}

const SHIPPED: &str = include_str!("ray_hardware.toml");

impl RayHardware {
    pub fn shipped() -> Self {
        match toml::from_str(SHIPPED) {
            Ok(hardware) => hardware,
            Err(error) => unreachable!("the description ships with the program: {error}"),
        }
    }

    /// The unit that does a step; `None` for accesses.
    pub fn unit(&self, step: FloatStep) -> Option<&Unit> {
        self.units.get(&unit_of(step))
    }
}

pub fn unit_of(step: FloatStep) -> FloatStep {
    match step {
        FloatStep::FloatMinMax => FloatStep::FloatCompare,
        step => step,
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct RayCycles {
    pub cycles: u64,
    pub frames_per_second: f64,
    pub bounds: Vec<Bound>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RayMisses {
    pub node: u64,
    pub attribute: u64,
}

pub fn cycles(
    counts: &FloatRayCounts,
    misses: RayMisses,
    traffic: &OuterTraffic,
    rays: &RayHardware,
    hardware: &Hardware,
) -> RayCycles {
    let lanes = u64::from(hardware.lanes);
    let mut needs: Vec<(String, u64)> = Vec::new();
    let mut by_unit = BTreeMap::<FloatStep, u64>::new();
    for step in FloatStep::ALL {
        *by_unit.entry(unit_of(step)).or_default() += counts.of(step);
    }
    for (kind, unit) in &rays.units {
        let issues = by_unit.get(kind).copied().unwrap_or(0) * u64::from(unit.interval);
        let cycles = issues.div_ceil(u64::from(unit.count) * lanes);
        needs.push((format!("{} units", kind.name()), cycles));
    }
    let stack = counts.of(FloatStep::StackRead) + counts.of(FloatStep::StackWrite);
    let ports = u64::from(rays.stack.ports) * lanes;
    needs.push(("stack port".to_owned(), stack.div_ceil(ports)));
    let (nodes, attributes) = (&hardware.node_cache, &hardware.attribute_cache);
    for (name, cache, step, misses) in [
        ("node cache", nodes, FloatStep::NodeRead, misses.node),
        (
            "attribute cache",
            attributes,
            FloatStep::AttributeRead,
            misses.attribute,
        ),
    ] {
        let port = counts.of(step).div_ceil(u64::from(cache.ports));
        needs.push((format!("{name} port"), port));
        let each = u64::from(cache.hit_latency) + u64::from(cache.miss_latency);
        needs.push((
            format!("{name} misses"),
            misses * each / u64::from(cache.misses),
        ));
    }
    let moved = traffic.node_bits + traffic.attribute_bits + traffic.pixel_bits;
    needs.push((
        "outer memory port".to_owned(),
        hardware.outer_memory.cycles(moved),
    ));
    let drain = counts.of(FloatStep::PixelWrite) * u64::from(hardware.pixels.drain_interval);
    needs.push(("pixel drain".to_owned(), drain));
    let chain: u64 = FloatStep::ALL
        .iter()
        .map(|&step| counts.waits(step) * latency(step, rays, hardware))
        .sum();
    let waits = chain + misses.node * u64::from(nodes.miss_latency);
    let contexts = u64::from(rays.contexts) * lanes;
    needs.push(("contexts".to_owned(), waits.div_ceil(contexts)));
    needs.sort_by_key(|need| std::cmp::Reverse(need.1));
    let cycles = needs.first().map_or(0, |need| need.1);
    let bound = |(resource, needed): (String, u64)| Bound {
        resource,
        cycles: needed,
        share: needed as f64 / cycles.max(1) as f64,
    };
    RayCycles {
        cycles,
        frames_per_second: hardware.clock_mhz * 1e6 / cycles.max(1) as f64,
        bounds: needs.into_iter().map(bound).collect(),
    }
}

/// Cycles from a step's issue until what follows it can be issued.
fn latency(step: FloatStep, rays: &RayHardware, hardware: &Hardware) -> u64 {
    match step {
        FloatStep::NodeRead => u64::from(hardware.node_cache.hit_latency).max(1),
        FloatStep::AttributeRead => u64::from(hardware.attribute_cache.hit_latency).max(1),
        FloatStep::StackRead => u64::from(rays.stack.latency).max(1),
        FloatStep::StackWrite | FloatStep::PixelWrite => 1,
        step => rays
            .unit(step)
            .map_or(0, |unit| u64::from(unit.latency) + 1),
    }
}

/// The operation of the cost tables that a step is, and its width.
pub fn operation(step: FloatStep) -> Option<(&'static str, u32)> {
    match step {
        FloatStep::FloatAdd => Some(("float_add", 32)),
        FloatStep::FloatMultiply => Some(("float_multiply", 32)),
        FloatStep::FloatDivide => Some(("float_divide", 32)),
        // A minimum is a comparison; its multiplexer is not charged to the ray caster.
        FloatStep::FloatCompare | FloatStep::FloatMinMax => Some(("float_compare", 32)),
        FloatStep::IntegerAdd => Some(("add", 32)),
        FloatStep::Logic => Some(("xor", 32)),
        FloatStep::Shift => Some(("shift_var", 32)),
        FloatStep::NodeRead
        | FloatStep::AttributeRead
        | FloatStep::StackRead
        | FloatStep::StackWrite
        | FloatStep::PixelWrite => None,
    }
}

/// Bits of a lane's stacks: one for each context.
pub fn stack_bits(rays: &RayHardware) -> u64 {
    u64::from(rays.contexts) * ASIDE_ENTRIES * u64::from(ASIDE_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_by_hand() {
        let rays = RayHardware::shipped();
        let mut hardware = Hardware::preset("paper").unwrap();
        hardware.outer_memory.bytes_per_cycle = 8;
        // Of one ray, all in a chain.
        let mut counts = FloatRayCounts::default();
        for (step, times) in [
            (FloatStep::FloatAdd, 1000),
            (FloatStep::FloatMinMax, 500),
            (FloatStep::FloatCompare, 100),
            (FloatStep::FloatDivide, 9),
            (FloatStep::NodeRead, 70),
        ] {
            counts.add(step, times, times);
        }
        let (node, attribute) = (10, 0);
        let traffic = OuterTraffic {
            node_bits: 10 * 512,
            ..OuterTraffic::default()
        };
        // 1000 x 3 + 600 x 1 + 9 x 27 + 70 x 1, and 10 misses of 60 more, on 16 contexts.
        let chain = (3000 + 600 + 243 + 70 + 600u64).div_ceil(16);
        // Twice the lanes: the units' share halves, the caches' does not.
        for (resource, one_lane, two_lanes) in [
            ("float add units", 250, 125),
            ("float compare units", 100, 50),
            ("float divide units", 9 * 26 / 3, 9 * 26 / 6),
            ("node cache port", 70, 70),
            // 61 cycles each, four at once.
            ("node cache misses", 10 * 61 / 4, 10 * 61 / 4),
            ("outer memory port", 10 * 8, 10 * 8),
            ("contexts", chain, chain.div_ceil(2)),
        ] {
            for (lanes, expected) in [(1, one_lane), (2, two_lanes)] {
                hardware.lanes = lanes;
                let misses = RayMisses { node, attribute };
                let report = cycles(&counts, misses, &traffic, &rays, &hardware);
                let mut bounds = report.bounds.iter();
                let bound = bounds.find(|bound| bound.resource == resource).unwrap();
                assert_eq!(bound.cycles, expected, "{resource}, {lanes}");
                assert_eq!(report.cycles, [chain, 10 * 61 / 4][lanes as usize - 1]);
            }
        }
    }
}
