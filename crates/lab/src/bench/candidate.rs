//! What can be measured: engines by name, and engines with a part switched off.

use hwmodel::{Memory, Probe, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::graph::GraphView;
use shiftvox::machine::Machine;
use shiftvox::project::{Engine, EngineError, FrameSetup, SetupOptions};

/// Makes an engine for so many threads, 1 or more.
///
/// It draws inside a thread pool of that size, so an engine that uses the
/// pool it is called in need not look at the number.
pub type MakeEngine = fn(usize) -> Box<dyn Engine + Send>;

/// An engine by name.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// What tables call it.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// The counter among its `Stats` that measures its work.
    pub work: &'static str,
    /// Whether more threads make it faster; else it is measured on one.
    pub parallel: bool,
    /// Makes it.
    pub make: MakeEngine,
}

/// The nodes that a walk fetches, in its order, each as often as it does.
pub type FetchedNodes = fn(&GraphView<'_>, &FrameSetup) -> Result<Vec<u32>, EngineError>;

/// How a contender comes to a frame, where that is not by the engine alone.
#[derive(Debug, Clone, Copy, Default)]
pub enum Frames {
    /// Each is drawn.
    #[default]
    Drawn,
    /// Each is requested from a viewer, which draws it the first time.
    Kept,
    /// Each is drawn, and the attributes of all these nodes are read.
    WithAttributesOf(FetchedNodes),
}

/// An engine without one of its techniques.
#[derive(Debug, Clone, Copy)]
pub struct Variant {
    /// What tables call it.
    pub name: &'static str,
    /// What is off, and whether the picture may be another.
    pub about: &'static str,
    /// Changes the frame's settings, if it is they that switch the technique.
    pub adjust: fn(&mut SetupOptions),
    /// Makes the engine, if it is the engine that switches it.
    pub make: MakeEngine,
    /// How it comes to a frame, if it is that.
    pub frames: Frames,
}

/// An engine and what can be switched off in it.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// The engine with everything on.
    pub whole: Candidate,
    /// One technique off at a time.
    pub variants: &'static [Variant],
}

/// The nodes that the machine fetches for a frame: a [`FetchedNodes`].
///
/// # Errors
/// When the machine cannot finish the frame.
pub fn fetched_nodes(graph: &GraphView<'_>, setup: &FrameSetup) -> Result<Vec<u32>, EngineError> {
    /// Notes the nodes in the order in which they are read.
    struct Reads(Vec<u32>);
    impl Probe for Reads {
        fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
            if let (Memory::Node, Ok(node)) = (memory, u32::try_from(address)) {
                self.0.push(node);
            }
        }
    }
    let mut frame = Frame::nodes_only(setup.width, setup.height);
    let fetched = Reads(Vec::new());
    let (_, fetched) = Machine::default().render_probed(graph, setup, &mut frame, fetched)?;
    Ok(fetched.0)
}
