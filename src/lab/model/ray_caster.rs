//! For comparison: a ray caster in floating point, drawing the same view, counted
//! and priced by the same tables.

use hwmodel::Memory;
use hwmodel::cost::{Breakdown, CostError, Store, Tally, energy_of_tallies};
use hwmodel::cycles::Hardware;
use hwmodel::memory::{Cache, CacheError};
use serde::Serialize;

use super::ModelError;
use super::cost::{FrameCost, OuterTraffic, Prices, outer_energy};
use super::frame;
use crate::frame::Frame;
use crate::graph::Graph;
use crate::lab::float_rays::{self, FloatRayCounts, FloatStep};
use crate::measure::CoverageError;
use crate::project::FrameSetup;

/// Bits of an entry of the ray's stack: a node and where the ray leaves it.
const ASIDE_BITS: u32 = 64;
/// Entries of the ray's stack: one a level.
const ASIDE_ENTRIES: u64 = 24;

/// What the ray caster took.
#[derive(Debug, Clone, Serialize)]
pub struct RayCasterReport {
    /// Steps by kind.
    pub counts: FloatRayCounts,
    /// Hits and misses of nodes in a cache like the hardware's.
    pub node_hits: u64,
    /// See `node_hits`.
    pub node_misses: u64,
    /// What the frame costs.
    pub cost: FrameCost,
    /// Coverage against exact rays.
    pub error: CoverageError,
}

/// The operation of the cost tables that a step is, and its width.
fn operation(step: FloatStep) -> Option<(&'static str, u32)> {
    match step {
        FloatStep::FloatAdd => Some(("float_add", 32)),
        FloatStep::FloatMultiply => Some(("float_multiply", 32)),
        FloatStep::FloatDivide => Some(("float_divide", 32)),
        // A minimum is a comparison; its multiplexer is left to the rival for nothing.
        FloatStep::FloatCompare | FloatStep::FloatMinMax => Some(("float_compare", 32)),
        FloatStep::IntegerAdd => Some(("add", 32)),
        FloatStep::Logic => Some(("xor", 32)),
        FloatStep::Shift => Some(("shift_var", 32)),
        FloatStep::NodeRead
        | FloatStep::StackRead
        | FloatStep::StackWrite
        | FloatStep::PixelWrite => None,
    }
}

fn tally(operation: &str, width: u32, times: u64) -> Tally {
    Tally {
        operation: operation.to_owned(),
        width,
        times,
    }
}

/// Casts a frame's rays. `exact`: the true picture.
///
/// # Errors
/// When the cost tables lack a figure.
pub fn measure(
    graph: &Graph,
    setup: &FrameSetup,
    hardware: &Hardware,
    prices: &Prices,
    exact: &Frame,
) -> Result<RayCasterReport, ModelError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut cache = cache_of(hardware).ok();
    let entry = u64::from(hardware.node_cache.entry_bytes);
    let counts = float_rays::count(&graph.view(), setup, &mut frame, &mut |node| {
        if let Some(cache) = &mut cache {
            cache.access(u64::from(node) * entry);
        }
    });
    let (node_hits, node_misses) = cache.map_or((0, 0), |c| (c.hits(), c.misses()));
    Ok(RayCasterReport {
        counts,
        node_hits,
        node_misses,
        cost: cost_of(&counts, node_misses, hardware, prices)?,
        error: frame::error(&frame, exact),
    })
}

fn cache_of(hardware: &Hardware) -> Result<Cache, CacheError> {
    let cache = &hardware.node_cache;
    Cache::new(u64::from(cache.bytes), cache.ways, cache.line_bytes)
}

fn cost_of(
    counts: &FloatRayCounts,
    node_misses: u64,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<FrameCost, CostError> {
    let table = &prices.table;
    let operations: Vec<Tally> = FloatStep::ALL
        .iter()
        .filter_map(|&step| {
            let (name, width) = operation(step)?;
            Some(tally(name, width, counts.of(step)))
        })
        .collect();
    let mut on_chip = Breakdown::default();
    let node_bits = 8 * hardware.node_cache.entry_bytes;
    let cache = Store::Sram {
        bytes: u64::from(hardware.node_cache.bytes),
    };
    let stack = Store::Sram {
        bytes: ASIDE_ENTRIES * u64::from(ASIDE_BITS) / 8,
    };
    let accesses = [
        (
            Memory::Node,
            "sram_read",
            cache,
            node_bits,
            FloatStep::NodeRead,
        ),
        (
            Memory::Stack,
            "sram_read",
            stack,
            ASIDE_BITS,
            FloatStep::StackRead,
        ),
        (
            Memory::Stack,
            "sram_write",
            stack,
            ASIDE_BITS,
            FloatStep::StackWrite,
        ),
    ];
    for (memory, operation, store, bits, step) in accesses {
        if let Store::Sram { bytes } = store {
            let each = table.memory_energy(operation, bytes, bits)?;
            on_chip.push(memory.name(), operation, bits, counts.of(step), each);
        }
    }
    let traffic = OuterTraffic {
        node_bits: 8 * node_misses * u64::from(hardware.node_cache.line_bytes),
        pixel_bits: counts.of(FloatStep::PixelWrite) * u64::from(frame::PIXEL_BITS),
        ..OuterTraffic::default()
    };
    Ok(FrameCost {
        operations: energy_of_tallies(&operations, table)?,
        on_chip,
        outer: outer_energy(&traffic, table)?,
    })
}
