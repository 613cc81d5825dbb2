//! A picture that is kept, and drawn again only when the set-up changes: a [`Viewer`] owns the engine and the frame,
//! lends the frame only for reading, and borrows the graph.

use super::{Engine, EngineError, FrameSetup, Stats};
use crate::frame::Frame;
use crate::graph::GraphView;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Contents {
    Nodes,
    #[default]
    Voxels,
    Records,
}

/// Name of the counter that is 1 where a frame was kept.
pub const FRAMES_UNCHANGED: &str = "frames_unchanged";

/// An engine and a frame, to be reused for another graph.
pub struct Canvas {
    engine: Box<dyn Engine + Send>,
    frame: Frame,
}

impl Canvas {
    pub fn new(engine: Box<dyn Engine + Send>) -> Self {
        Self {
            engine,
            frame: Frame::nodes_only(0, 0),
        }
    }
}

/// An engine, its input, and its last frame, equal to that of a new engine with the same set-up.
pub struct Viewer<'g> {
    graph: GraphView<'g>,
    canvas: Canvas,
    contents: Contents,
    shown: Option<(FrameSetup, Stats)>,
}

impl<'g> Viewer<'g> {
    /// A viewer of a graph that shows nothing. The engine's result must depend only on graph and set-up.
    pub fn new(graph: GraphView<'g>, canvas: Canvas, contents: Contents) -> Self {
        Self {
            graph,
            canvas,
            contents,
            shown: None,
        }
    }

    pub fn into_canvas(self) -> Canvas {
        self.canvas
    }

    pub fn contents(&self) -> Contents {
        self.contents
    }

    /// Changes the contents of samples from the next frame on, and shows nothing until then.
    pub fn store(&mut self, contents: Contents) {
        self.contents = contents;
        self.forget();
    }

    /// Makes the frame that of a set-up, and returns the counters: [`FRAMES_UNCHANGED`] is last. If the frame was kept,
    /// it is 1 and all others are 0. `light` of the nodes is for rules that blend: the same for the same set-up. After
    /// an error nothing is shown.
    pub fn render(&mut self, setup: &FrameSetup, light: &[[u16; 3]]) -> Result<Stats, EngineError> {
        if let Some((_, last)) = self.shown.as_ref().filter(|(shown, _)| shown == setup) {
            let mut stats: Stats = last.iter().map(|&(name, _)| (name, 0)).collect();
            stats.push((FRAMES_UNCHANGED, 1));
            return Ok(stats);
        }
        self.make_room();
        let graph = GraphView {
            light,
            ..self.graph
        };
        let Canvas { engine, frame } = &mut self.canvas;
        let mut stats = engine.render(&graph, setup, frame)?;
        self.shown = Some((setup.clone(), stats.clone()));
        stats.push((FRAMES_UNCHANGED, 0));
        Ok(stats)
    }

    pub fn frame(&self) -> Option<&Frame> {
        self.shown.as_ref().map(|_| &self.canvas.frame)
    }

    pub fn frame_bytes(&self) -> u64 {
        let Frame {
            node,
            voxel,
            records,
            blend,
            ..
        } = &self.canvas.frame;
        let records = records.as_deref().map_or(0, size_of_val);
        let blend = blend.as_deref().map_or(0, size_of_val);
        (size_of_val(&node[..]) + size_of_val(&voxel[..]) + records + blend) as u64
    }

    pub fn shows(&self, setup: &FrameSetup) -> bool {
        self.shown.as_ref().is_some_and(|(shown, _)| shown == setup)
    }

    pub fn forget(&mut self) {
        self.shown = None;
    }

    /// Shows nothing. The engine then draws into the last frame's memory, if that has the same contents.
    fn make_room(&mut self) {
        self.forget();
        let frame = &mut self.canvas.frame;
        let has = match (&frame.records, frame.voxel.is_empty()) {
            (Some(_), _) => Contents::Records,
            (None, false) => Contents::Voxels,
            (None, true) => Contents::Nodes,
        };
        if has != self.contents {
            *frame = match self.contents {
                Contents::Nodes => Frame::nodes_only(0, 0),
                contents => Frame::new(1, 1, contents == Contents::Records),
            };
        }
    }
}
