//! What each setting of a hardware's organisation gives: alone, and on top of those before it.

use hwmodel::Overflow;
use hwmodel::cycles::{Hardware, NoObserver, Organisation, StackHolds};
use rayon::prelude::*;
use serde::Serialize;

use super::ModelError;
use super::cost::Prices;
use super::design::LightDesign;
use super::fill_bits;
use super::frame;
use super::range::Range;
use super::ray_caster;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Progress};
use shiftvox::project::FrameSetup;

/// A hardware with some of its settings.
#[derive(Debug, Clone, Serialize)]
pub struct StepRow {
    /// What was set last.
    pub step: &'static str,
    /// Whether all settings before it are set, too.
    pub with_those_before: bool,
    /// How it is organised.
    pub organisation: Organisation,
    /// Bits of an entry of the stack.
    pub stack_entry_bits: u32,
    /// Words of nodes that are read.
    pub node_reads: u64,
    /// Lines of nodes that are brought in.
    pub node_misses: u64,
    /// Bits of fill vectors on the chip.
    pub fill_bits: u64,
    /// Accesses to them.
    pub fill_accesses: u64,
    /// Energy, pJ.
    pub operations_pj: Range,
    /// See `operations_pj`.
    pub on_chip_pj: Range,
    /// See `operations_pj`.
    pub outer_pj: Range,
    /// See `operations_pj`.
    pub energy_pj: Range,
    /// Of the ray caster with the same nodes, in its best order.
    pub ray_caster_pj: Range,
    /// Area, NAND2 equivalents.
    pub area: Range,
    /// Cycles of the frame.
    pub cycles: u64,
}

/// The settings one by one, as they can be added.
type Setting = (&'static str, fn(&mut Organisation, &Organisation));

const SETTINGS: [Setting; 8] = [
    ("tiles as contexts", |to, from| {
        to.tile_levels = from.tile_levels;
    }),
    ("parents on the stack", |to, from| {
        if from.stack != StackHolds::Children {
            to.stack = StackHolds::Parents;
        }
    }),
    ("leaf masks", |to, from| to.leaf_masks = from.leaf_masks),
    ("what is hidden is not read", |to, from| {
        to.hidden_unread = from.hidden_unread;
    }),
    ("bricks", |to, from| {
        to.leaf_masks |= from.bricks;
        to.bricks = from.bricks;
    }),
    ("the path on the stack", |to, from| to.stack = from.stack),
    ("joined fill vectors", |to, from| {
        to.joined_fill = from.joined_fill;
    }),
    ("packed widths", |to, from| to.packed = from.packed),
];

/// The organisations: that of the image-order paper; each setting of `whole` alone; each on top of those before it.
fn organisations(whole: Organisation) -> Vec<(&'static str, bool, Organisation)> {
    let first = Organisation::default();
    let mut rows = vec![("as in the image-order paper", false, first)];
    for (name, set) in SETTINGS {
        let mut alone = first;
        set(&mut alone, &whole);
        if alone != first {
            rows.push((name, false, alone));
        }
    }
    let mut together = first;
    for (name, set) in SETTINGS {
        let before = together;
        set(&mut together, &whole);
        if together != before {
            rows.push((name, true, together));
        }
    }
    rows
}

/// The table. `exact`: the true picture.
///
/// # Errors
/// When the hardware cannot go on, or the cost tables lack a figure.
pub fn table(
    (graph, setup, exact): (&Graph, &FrameSetup, &Frame),
    overflow: Overflow,
    hardware: &Hardware,
    prices: &Prices,
    progress: &dyn Progress,
) -> Result<Vec<StepRow>, ModelError> {
    let rows = organisations(hardware.organisation);
    progress.begin("settings of the organisation", rows.len() as u64);
    let row = |(step, with_those_before, organisation): (&'static str, bool, Organisation)| {
        let hardware = Hardware {
            organisation,
            ..hardware.clone()
        };
        let counted = frame::count(graph, setup, &hardware, overflow)?;
        let (_, simulated) =
            frame::simulate(&graph.view(), setup, &hardware, overflow, &mut NoObserver)?;
        let cycles = &simulated.cycles;
        let LightDesign { cost, area, .. } =
            LightDesign::price(graph, setup, &counted, cycles, &hardware, prices)?;
        let rays = ray_caster::measure(graph, setup, &hardware, prices, None, exact)?;
        let accesses = counted.counter.accesses_by(|cell| cell.memory);
        let fill = accesses.get(&hwmodel::Memory::FillVector);
        let nodes = accesses.get(&hwmodel::Memory::Node);
        progress.advance(1);
        Ok(StepRow {
            step,
            with_those_before,
            organisation,
            stack_entry_bits: counted.record_bits(),
            node_reads: nodes.map_or(0, |of| of.reads),
            node_misses: cycles.node_cache.misses,
            fill_bits: fill_bits::fill_store_bits(setup, &hardware),
            fill_accesses: fill.map_or(0, |of| of.reads + of.writes),
            operations_pj: Range::from(&cost.operations),
            on_chip_pj: Range::from(&cost.on_chip),
            outer_pj: Range::from(&cost.outer),
            energy_pj: Range::new(cost.total()),
            ray_caster_pj: Range::new(rays.cost.total()),
            area: area.range(),
            cycles: cycles.cycles,
        })
    };
    let rows = rows.into_par_iter().map(row).collect();
    progress.end();
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_setting_alone_and_on_top_of_the_others() {
        let whole = Organisation {
            stack: StackHolds::Path,
            leaf_masks: true,
            bricks: true,
            tile_levels: 3,
            hidden_unread: true,
            joined_fill: true,
            packed: true,
        };
        let rows = organisations(whole);
        assert_eq!(rows.len(), 1 + 2 * SETTINGS.len());
        assert_eq!(rows.last().map(|row| row.2), Some(whole));
        assert!(rows[5].2.leaf_masks, "bricks need them");
        let few = Organisation {
            tile_levels: 1,
            ..Organisation::default()
        };
        assert_eq!(organisations(few).len(), 3);
    }
}
