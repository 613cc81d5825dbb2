//! The machine: the loop of the image-order paper (`REFERENCES.md`), sections 3.1 to 3.6, in words that cannot multiply.
//!
//! ```text
//! push the object's record
//! while there is a record:
//!     pop it; if its quadtree node is full by now, drop it
//!     change it to screen space, if the rule and its tolerance allow
//!     if it maps to a sample, or is a solid that can be drawn: draw it
//!     else: find its centre, the order of its children, their vertices;
//!           for each child, farthest first: find its box and the smallest
//!           unfilled quadtree node that holds it; push it if there is one
//! ```
//!
//! The scalar machine defines the bits: every faster engine must draw the same. Every arithmetic step is a call on a
//! [`Datapath`](hwmodel::Datapath), visible to a probe.
//!
//! Each file imports only files named before it:
//!
//! - data: `blocks`, `counters`, `options`, `cage`, `record`, `constants`;
//! - steps on words: `shifts`, `planes`, `quadrants`, `fill`, `smallest_node`, `to_screen`, `size`, `alpha`, `canvas`,
//!   `undrawn`, `path`;
//! - steps of the loop: `watch`, `state`, `verdict`, `decide`, `push`, `children`;
//! - the loop: `record_loop`, and `parents`, the loop with parents on its stack, and tiles;
//! - `records_by_sample`, and `engine`, the machine as an [`Engine`](crate::project::Engine);
//! - `instruments`, which observe the machine or drive it in another way.
//!
//! Every step takes the parts of the state (`state.rs`) that it works on: the datapath, the constant `Job`, the `Canvas`
//! with its fill vectors, and the `Traversal` with its counts.

mod alpha;
mod blocks;
mod cage;
mod canvas;
mod children;
mod constants;
mod counters;
mod decide;
mod engine;
mod fill;
mod instruments;
mod options;
mod parents;
mod path;
mod planes;
mod push;
mod quadrants;
mod record;
mod record_loop;
mod records_by_sample;
mod shifts;
mod size;
mod smallest_node;
mod state;
mod to_screen;
mod undrawn;
mod verdict;
mod watch;

pub use crate::project::OCCLUSION_ORDER;
pub use blocks::{Block, Port};
pub use constants::frame_registers;
pub use counters::{COUNTERS, CounterInfo};
pub use engine::Machine;
#[cfg(feature = "mutants")]
pub use instruments::mutants;
pub use instruments::{Cage, cages_along};
pub use instruments::{
    MOST_OPEN_TILES, NumberSpan, NumberSpans, Positions, ProvenWidths, RecordNumber, SimulateError,
    Simulated, Space, narrowed, proven_widths, visit_positions,
};
pub use options::MachineOptions;
