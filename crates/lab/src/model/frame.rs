//! One frame of the machine, with everything counted.

use std::borrow::Cow;

use hwmodel::Overflow;
use hwmodel::count::Counter;
use hwmodel::cycles::{Hardware, Observer, Organisation};
use hwmodel::memory::{PIXEL_BITS, RecordProbe, Widths};
use hwmodel::shifts::ShiftProbe;

use super::record::{RecordField, bits_by_kind, record_bits, record_fields};
use super::{ModelError, fill_bits};
use crate::measure::count_differing;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::{Machine, MachineOptions, Simulated, narrowed};
use shiftvox::picture::{Shading, lights};
use shiftvox::project::{Camera, Engine, EngineError, FrameSetup, SetupError, SetupOptions, Stats};
use shiftvox::rays::Rays;

#[derive(Debug)]
pub struct Counted {
    pub frame: Frame,
    pub counter: Counter,
    pub shifts: ShiftProbe,
    pub records: RecordProbe,
    pub stats: Stats,
    pub fields: Vec<RecordField>,
}

impl Counted {
    pub fn record_bits(&self) -> u32 {
        record_bits(&self.fields)
    }

    pub fn differing(&self, other: &Frame) -> u64 {
        count_differing(&self.frame.voxel, &other.voxel)
    }

    pub fn operations_per_record(&self) -> f64 {
        self.counter.ops() as f64 / self.counter.records().max(1) as f64
    }
}

/// Bits that an access of each memory moves.
pub fn widths(setup: &FrameSetup, graph: &Graph, hardware: &Hardware) -> Widths {
    Widths {
        stack_bits: record_bits(&record_fields(setup, graph.len(), hardware.organisation)),
        node_bits: 8 * hardware.node_cache.entry_bytes,
        attribute_bits: 8 * hardware.attribute_cache.entry_bytes,
        fill_vector_bits: fill_bits::fill_access_bits(setup, hardware.organisation),
        pixel_bits: PIXEL_BITS,
    }
}

pub(super) fn machine(overflow: Overflow, organisation: Organisation) -> Machine {
    Machine::new(MachineOptions {
        overflow,
        organisation,
        ..MachineOptions::default()
    })
}

/// The set-up in the words that an organisation has.
pub(super) fn in_words(setup: &FrameSetup, organisation: Organisation) -> Cow<'_, FrameSetup> {
    match organisation.packed {
        true => Cow::Owned(narrowed(setup)),
        false => Cow::Borrowed(setup),
    }
}

/// Draws a frame and counts.
pub fn count(
    graph: &Graph,
    setup: &FrameSetup,
    organisation: Organisation,
    overflow: Overflow,
) -> Result<Counted, EngineError> {
    let setup = &*in_words(setup, organisation);
    let mut frame = Frame::new(setup.width, setup.height, false);
    let light = lights(graph, setup, Shading::Lambert)?;
    let view = graph.lit(&light);
    let records = RecordProbe::new(bits_by_kind(setup, graph.len(), organisation));
    let probes = ((Counter::new(), ShiftProbe::new()), records);
    let mut machine = machine(overflow, organisation);
    let (stats, ((counter, shifts), records)) =
        machine.render_probed(&view, setup, &mut frame, probes)?;
    Ok(Counted {
        frame,
        counter,
        shifts,
        records,
        stats,
        fields: record_fields(setup, graph.len(), organisation),
    })
}

/// Simulates a frame on hardware, cycle by cycle.
pub fn simulate(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    hardware: &Hardware,
    overflow: Overflow,
    observer: &mut dyn Observer,
) -> Result<(Frame, Simulated), ModelError> {
    let setup = &*in_words(setup, hardware.organisation);
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut hardware = hardware.clone();
    hardware.stack.record = bits_by_kind(setup, graph.mask.len(), hardware.organisation);
    let mut machine = machine(overflow, hardware.organisation);
    let simulated = machine.simulate(graph, setup, &mut frame, &hardware, observer)?;
    Ok((frame, simulated))
}

/// The set-up of the exact picture, which errors are measured against: 64 bits, whatever the measured format.
/// [`reference()`] leaves out its level of detail.
pub fn exact_setup(graph: &Graph, camera: &Camera, aa_log2: u32) -> Result<FrameSetup, SetupError> {
    let options = SetupOptions {
        aa_log2,
        ..SetupOptions::default()
    };
    FrameSetup::new(camera, &graph.placement, graph.depth, &options)
}

/// The exact picture of a frame's view, down to the finest voxels.
pub fn reference(graph: &GraphView<'_>, setup: &FrameSetup) -> Result<Frame, EngineError> {
    exact(graph, &setup.without_detail())
}

/// The exact picture of a frame's view.
pub fn exact(graph: &GraphView<'_>, setup: &FrameSetup) -> Result<Frame, EngineError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    Rays::default().render(graph, setup, &mut frame)?;
    Ok(frame)
}
