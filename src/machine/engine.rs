//! The scalar engine: frames drawn by the record loop.

use hwmodel::count::Counter;
use hwmodel::cycles::Organisation;
use hwmodel::{NoProbe, Probe};

use super::cage::{CageCoordinate, with_cage};
use super::limit::Limit;
use super::state::{MachineOptions, State};
use super::watch::RecordsBySample;
use crate::frame::{FillVectors, Frame, QuadNode};
use crate::graph::GraphView;
use crate::project::{Engine, EngineError, FrameSetup, Rendered, Stats, Stop, most_records};

/// The scalar engine.
#[derive(Debug, Default)]
pub struct Machine {
    pub(super) options: MachineOptions,
    stop: Stop,
    /// Kept from frame to frame, with its level of the samples, samples across and down.
    fill: Option<((u32, u32, u32), FillVectors)>,
}

impl Machine {
    pub fn new(options: MachineOptions) -> Self {
        Self {
            options,
            stop: Stop::default(),
            fill: None,
        }
    }

    /// Lets `stop` end drawings.
    #[must_use]
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        self
    }

    /// Draws a frame with a probe; see [`Engine::render`]. Fails when a word overflows under the trap policy, or after
    /// [`most_records`].
    pub fn render_probed<P: Probe>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        probe: P,
    ) -> Result<(Stats, P), EngineError> {
        let most = most_records(setup);
        let drawn = with_cage!(setup, L => {
            self.run_as::<P, L>(graph, setup, frame, probe, most)
        })?;
        drawn.ok_or(EngineError::Records(most))
    }

    /// Draws a frame and counts its operations. Compiled once, for all crates.
    pub fn count(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<(Stats, Counter), EngineError> {
        self.render_probed(graph, setup, frame, Counter::new())
    }

    /// Draws a frame of at most `most_records` records; with more, returns `None`, and the frame has no meaning. For
    /// checks that every frame ends (`SPEC.md`, "Termination"). Fails when a word overflows under the trap policy.
    pub fn render_within(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        let drawn = with_cage!(setup, L => {
            self.run_as::<_, L>(graph, setup, frame, NoProbe, most_records)
        })?;
        Ok(drawn.map(|(stats, _)| stats))
    }

    /// Draws a frame in cages of type `L`, in at most `most` records.
    fn run_as<P: Probe, L: CageCoordinate>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        probe: P,
        most: u64,
    ) -> Result<Option<(Stats, P)>, EngineError> {
        let options = self.options;
        let mut limit = Limit::new(most, &self.stop);
        let wants_records = frame.records.is_some();
        let records = wants_records.then(|| RecordsBySample::new(setup.levels));
        let records = records.transpose()?;
        let canvas = (self.emptied(setup, frame)?, &mut *frame);
        let mut state = State::<P, L, _>::new(options, graph, setup, canvas, probe, records);
        let is_done = if options.organisation == Organisation::default() {
            state.draw_object(QuadNode::ROOT, &mut limit)?
        } else {
            state.draw_by_tiles(&mut limit)?
        };
        if !is_done {
            return Ok(None);
        }
        let (stats, probe, records) = state.finish();
        if let (Some(records), Some(shares)) = (records, &mut frame.records) {
            records.write_shares(frame.width, shares);
        }
        Ok(Some((stats, probe)))
    }

    /// Fits and clears a frame. Returns its fill vectors.
    pub(super) fn emptied(
        &mut self,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<&mut FillVectors, EngineError> {
        frame.fit(setup.width, setup.height, setup.options.coverage.blends())?;
        frame.clear();
        let size = (setup.levels, setup.width, setup.height);
        let kept = match self.fill.take().filter(|(kept, _)| *kept == size) {
            Some(kept) => kept,
            None => (size, FillVectors::new(size.0, size.1, size.2)?),
        };
        let (_, vectors) = self.fill.insert(kept);
        vectors.clear();
        Ok(vectors)
    }
}

impl Engine for Machine {
    fn render(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, frame: &mut Frame) -> Rendered {
        self.render_probed(graph, setup, frame, NoProbe)
            .map(|(stats, _)| stats)
    }
}
