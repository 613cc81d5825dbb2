//! Contenders before they have a scene: engines by name, and their switches.

use shiftvox::project::{Engine, SetupOptions};

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

#[derive(Debug, Clone, Copy)]
pub struct Variant {
    pub name: &'static str,
    /// The technique that is off, and whether the picture may change.
    pub about: &'static str,
    /// Changes the frame's settings, for techniques that are settings.
    pub adjust: fn(&mut SetupOptions),
    /// Makes the engine, for techniques that the engine switches. None: the family's own.
    pub make: Option<MakeEngine>,
}

/// An engine and the variants that are measured beside it.
#[derive(Debug, Clone)]
pub struct Family {
    pub whole: Candidate,
    pub variants: Vec<Variant>,
}
