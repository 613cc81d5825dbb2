//! Contenders before they have a scene: engines by name, and their switches.

use hwmodel::{Memory, Probe, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::graph::GraphView;
use shiftvox::machine::Machine;
use shiftvox::project::{Engine, EngineError, FrameSetup, SetupOptions};

/// Makes an engine for a number of threads, 1 or more. The engine draws in a pool of that size.
pub type MakeEngine = fn(usize) -> Box<dyn Engine + Send>;

#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    pub name: &'static str,
    pub about: &'static str,
    /// The counter among its `Stats` that measures its work.
    pub work: &'static str,
    /// Whether it uses several threads; else it is measured on one.
    pub parallel: bool,
    pub make: MakeEngine,
}

/// The nodes that a traversal fetches, in its order, repeated as often as they are fetched.
pub(super) type FetchedNodes = fn(&GraphView<'_>, &FrameSetup) -> Result<Vec<u32>, EngineError>;

#[derive(Debug, Clone, Copy, Default)]
pub enum Frames {
    #[default]
    Drawn,
    Kept,
    /// The engine draws each frame, and the attributes of all these nodes are read.
    WithAttributesOf(FetchedNodes),
}

#[derive(Debug, Clone, Copy)]
pub struct Variant {
    pub name: &'static str,
    /// The technique that is off, and whether the picture may change.
    pub about: &'static str,
    /// Changes the frame's settings, for techniques that are settings.
    pub adjust: fn(&mut SetupOptions),
    /// Makes the engine, for techniques that the engine switches.
    pub make: MakeEngine,
    pub frames: Frames,
}

/// An engine and the variants that are measured beside it.
#[derive(Debug, Clone)]
pub struct Family {
    pub whole: Candidate,
    pub variants: Vec<Variant>,
}

pub fn fetched_nodes(graph: &GraphView<'_>, setup: &FrameSetup) -> Result<Vec<u32>, EngineError> {
    struct Reads(Vec<u32>);
    impl Probe for Reads {
        fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
            if let (Memory::Node, Ok(node)) = (memory, u32::try_from(address)) {
                self.0.push(node);
            }
        }
    }
    let mut frame = Frame::nodes_only(setup.width, setup.height);
    let reads = Reads(Vec::new());
    let (_, reads) = Machine::default().render_probed(graph, setup, &mut frame, reads)?;
    Ok(reads.0)
}
