//! Time coherency, the outlook of the image-order paper: "directly rendering voxels which were rendered in the last
//! frame". Each frame of a film is drawn in two ways, and both must show the same picture.
//!
//! - *In order*, the machine as it is.
//! - *List first*, in two passes over a picture or over each of its tiles. The first pass descends from the root to the
//!   listed nodes alone, since without a multiplier only its parent gives a node its vertices. The second one is the
//!   whole traversal. A listed voxel is drawn early only if it is to be drawn in this frame, too. A sample holds its
//!   voxel's place in the order, its key, and a pyramid of the largest keys decides what is occluded
//!   (`src/machine/keys.rs`), like the pyramid of a hierarchical Z-buffer.
//!
//! The figures favour the list. Making, storing and reading it is free, and its nodes are not read from memory. All caches
//! are empty when a frame begins, in both ways.

use hwmodel::Memory;
use hwmodel::Overflow;
use hwmodel::count::Counter;
use hwmodel::cycles::{CycleReport, Hardware, StackHolds};
use hwmodel::memory::RecordProbe;
use hwmodel::shifts::ShiftProbe;
use serde::Serialize;

use super::ModelError;
use super::area;
use super::cost::{self, Prices};
use super::design::LIGHT;
use super::fill_bits;
use super::frame::{self, Counted};
use super::record::{FieldPresence, RecordField, record_fields};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Listed;
use shiftvox::project::{Coverage, FrameSetup};

/// Sums over the frames of a film.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Sums {
    pub records: u64,
    pub node_reads: u64,
    pub node_misses: u64,
    pub cycles: u64,
    pub energy_uj: f64,
    /// Of the hardware that can draw every frame, NAND2.
    pub area: f64,
    /// Samples with another node or voxel than in order.
    pub differing_samples: u64,
}

pub const WAYS: [&str; 2] = ["in order", "list first"];

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Film {
    /// Measured ones: the first frame only gives its list.
    pub frames: usize,
    /// Nodes on the lists, and those above.
    pub listed: u64,
    /// By [`WAYS`].
    pub sums: [Sums; 2],
}

/// Draws a film. Fails under other rules than `exact`, on sequential hardware, and if a key has too many bits.
pub fn film(
    graph: &Graph,
    setups: &[FrameSetup],
    hardware: &Hardware,
    overflow: Overflow,
    prices: &Prices,
) -> Result<Film, ModelError> {
    let mut film = Film {
        frames: setups.len().saturating_sub(1),
        listed: 0,
        sums: Default::default(),
    };
    let mut last: Option<Listed> = None;
    for setup in setups {
        check(setup, hardware)?;
        let run = |listed| Run::new(graph, setup, hardware, overflow, listed);
        let in_order = run(None)?;
        let shown = Listed::of(&in_order.counted.frame, setup.depth);
        if let Some(list) = last.replace(shown) {
            film.listed += list.len() as u64;
            let [normal, first] = &mut film.sums;
            in_order.add_to(normal, &in_order, graph, setup, prices)?;
            run(Some(&list))?.add_to(first, &in_order, graph, setup, prices)?;
        }
    }
    Ok(film)
}

fn check(setup: &FrameSetup, hardware: &Hardware) -> Result<(), ModelError> {
    let needs = if setup.options.coverage != Coverage::Exact {
        "--coverage exact"
    } else if hardware.sequential {
        "hardware that is not sequential"
    } else if 3 * setup.depth + 2 > setup.format.bits() {
        "words (--bits) of three bits per level of the scene, and two"
    } else {
        return Ok(());
    };
    Err(ModelError::Coherency(needs))
}

/// A frame in one way.
struct Run {
    counted: Counted,
    cycles: CycleReport,
    hardware: Hardware,
    fill_access_bits: u32,
}

impl Run {
    fn new(
        graph: &Graph,
        setup: &FrameSetup,
        hardware: &Hardware,
        overflow: Overflow,
        listed: Option<&Listed>,
    ) -> Result<Self, ModelError> {
        let view = graph.view();
        let setup = &*frame::in_words(setup, hardware.organisation);
        let mut hardware = frame::with_records(&view, setup, hardware);
        let mut fields = record_fields(setup, graph.len(), hardware.organisation);
        let mut fill_access_bits = fill_bits::fill_access_bits(setup, hardware.organisation);
        let mut fill_bits = fill_bits::fill_store_bits(setup, &hardware);
        if listed.is_some() {
            fill_access_bits = fill_bits::key_word_bits(setup);
            fill_bits = fill_bits::key_store_bits(setup, &hardware);
            // A parent's key is the beginning of its descendant's: an entry of a path needs none.
            if hardware.organisation.stack != StackHolds::Path {
                let bits = 3 * setup.depth + 1;
                fields.push(RecordField {
                    name: "place in the order, pass",
                    bits,
                    held: FieldPresence::Always,
                });
                let record = &mut hardware.stack.record;
                for of in [&mut record.clip, &mut record.screen, &mut record.finest] {
                    *of += bits;
                }
            }
        }
        let mut picture = Frame::new(setup.width, setup.height, false);
        let records = RecordProbe::new(hardware.stack.record);
        let probes = ((Counter::new(), ShiftProbe::new()), records);
        let (simulated, ((counter, shifts), records)) = frame::machine(
            overflow,
            hardware.organisation,
        )
        .simulate_listed((&view, setup, listed), &mut picture, &hardware, probes)?;
        Ok(Self {
            counted: Counted {
                frame: picture,
                counter,
                shifts,
                records,
                stats: simulated.counts,
                fields,
                keyed_fill_bits: Some(fill_bits),
            },
            cycles: simulated.cycles,
            hardware,
            fill_access_bits,
        })
    }

    fn add_to(
        &self,
        sums: &mut Sums,
        in_order: &Self,
        graph: &Graph,
        setup: &FrameSetup,
        prices: &Prices,
    ) -> Result<(), ModelError> {
        let (counted, cycles, hardware) = (&self.counted, &self.cycles, &self.hardware);
        let setup = &*frame::in_words(setup, hardware.organisation);
        let mut widths = frame::widths(setup, graph, hardware);
        widths.stack_bits = counted.record_bits();
        widths.fill_vector_bits = self.fill_access_bits;
        let cost = cost::frame_cost(counted, cycles, &widths, setup, hardware, prices)?;
        let area = area::light(counted, cycles, setup, hardware, prices)?;
        let time = (cycles.cycles, hardware.clock_mhz);
        let cost = cost.whole(LIGHT, &area, time, prices)?;
        sums.records += counted.counter.records();
        sums.node_reads += counted.counter.reads(Memory::Node);
        sums.node_misses += cycles.node_cache.misses;
        sums.cycles += cycles.cycles;
        // From pJ.
        sums.energy_uj += cost.total() * 1e-6;
        sums.area = sums.area.max(area.total);
        let (ours, theirs) = (&counted.frame, &in_order.counted.frame);
        let samples = ours.node.iter().zip(&ours.voxel);
        let differ = samples.zip(theirs.node.iter().zip(&theirs.voxel));
        sums.differing_samples += differ.filter(|(a, b)| a != b).count() as u64;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::Motion;
    use glam::DVec3;
    use shiftvox::frame::NO_NODE;
    use shiftvox::graph::Silent;
    use shiftvox::machine::Machine;
    use shiftvox::project::{Camera, Engine, SetupOptions, stat};
    use shiftvox::split_mix::SplitMix;
    use shiftvox_mesh::open::{OpenOptions, open};

    fn scene(spec: &str) -> Graph {
        let opened = open(&format!("gen:{spec}"), &OpenOptions::default(), &Silent);
        opened.unwrap().graph
    }

    /// Eye and target in sides of the object's cube.
    fn setups(graph: &Graph, [eye, target]: [[f64; 3]; 2], motion: Motion) -> Vec<FrameSetup> {
        let low = DVec3::from_array(graph.placement.origin_index.map(|c| c as f64));
        let at = |of: [f64; 3]| low + DVec3::from_array(of) * f64::from(1u32 << graph.depth);
        let camera = Camera::looking(at(eye), at(target), 60.0, (80, 56));
        let setup = |frame| {
            let camera = motion.after(&camera, frame).unwrap();
            let options = SetupOptions {
                bits: 40,
                ..SetupOptions::default()
            };
            FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap()
        };
        (0..3).map(setup).collect()
    }

    /// Voxels from anywhere in a graph, most of them hidden.
    fn random_voxels(graph: &Graph, count: usize) -> Vec<[i32; 4]> {
        let (view, mut dice) = (graph.view(), SplitMix::new(5));
        let mut voxel = || {
            let (mut node, mut at, mut level) = (view.root, [0; 3], 0);
            while level < graph.depth && view.mask(node) != 0 {
                let octant = dice.below(8) as u8;
                let Some(child) = view.child(node, octant) else {
                    continue;
                };
                (node, level) = (child, level + 1);
                for k in 0..3 {
                    at[k] |= i32::from(octant >> (2 - k) & 1) << (graph.depth - level);
                }
            }
            [at[0], at[1], at[2], level as i32]
        };
        (0..count).map(|_| voxel()).collect()
    }

    /// Also with wrong lists: empty, of hidden voxels, of another scene.
    #[test]
    fn every_list_gives_the_machines_picture() {
        let outside = [[1.6, -0.7, 1.25], [0.5, 0.5, 0.3]];
        let inside = [[0.26, 0.74, 0.41], [0.9, 0.3, 0.3]];
        let stranger = Listed::new(random_voxels(&scene("sphere,depth=6"), 500), 6);
        let mut taken_over = 0;
        for (spec, view, motion) in [
            ("terrain,depth=6", outside, Motion::Turntable(40.0)),
            ("terrain,depth=6", inside, Motion::Dolly(0.1)),
            ("menger,depth=3", outside, Motion::Turntable(5.0)),
            ("menger,depth=3", inside, Motion::Dolly(0.1)),
        ] {
            let graph = scene(spec);
            let hidden = Listed::new(random_voxels(&graph, 500), graph.depth);
            let mut last = Listed::default();
            for setup in setups(&graph, view, motion) {
                let mut serial = Frame::new(setup.width, setup.height, false);
                let mut machine = Machine::default();
                machine.render(&graph.view(), &setup, &mut serial).unwrap();
                let empty = Listed::default();
                for (name, listed) in [
                    ("in order", None),
                    ("last", Some(&last)),
                    ("empty", Some(&empty)),
                    ("hidden", Some(&hidden)),
                    ("stranger", Some(&stranger)),
                ] {
                    for design in ["light", "paper"] {
                        let hardware = Hardware::preset(design).unwrap();
                        let run = Run::new(&graph, &setup, &hardware, Overflow::Trap, listed);
                        let counted = run.unwrap().counted;
                        let differing = counted.differing(&serial);
                        assert_eq!(differing, 0, "{spec}, {motion:?}, {name}, {design}");
                        assert_eq!(counted.frame.node, serial.node);
                        let covered = serial.node.iter().filter(|&&node| node != NO_NODE);
                        let drawn = stat(&counted.stats, "samples_drawn");
                        taken_over += drawn - covered.count() as u64;
                    }
                }
                last = Listed::of(&serial, graph.depth);
            }
        }
        assert!(taken_over > 10_000, "no list was wrong: {taken_over}");
    }

    /// The same list for the same frame: every visible voxel is drawn by the first pass, and nothing is taken over.
    #[test]
    fn a_perfect_list_draws_every_sample_once() {
        let graph = scene("terrain,depth=6");
        let view = [[1.6, -0.7, 1.25], [0.5, 0.5, 0.3]];
        let setups = setups(&graph, view, Motion::Pan(0.0));
        let hardware = Hardware::preset("light").unwrap();
        let prices = Prices::shipped().unwrap();
        let film = film(&graph, &setups[..2], &hardware, Overflow::Trap, &prices).unwrap();
        let [normal, first] = film.sums;
        assert_eq!(film.frames, 1);
        assert!(first.node_reads <= normal.node_reads);
        assert!(first.records > normal.records);
        assert_eq!(first.differing_samples, 0);
    }
}
