//! The machine: the loop of the image-order paper (`REFERENCES.md`), sections 3.1 to 3.6, in words that cannot
//! multiply.
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
//! The machine defines the bits: every faster engine must draw the same. Every arithmetic step is a call on a
//! [`Datapath`](hwmodel::Datapath), visible to a probe. Each file imports only files named before it:
//!
//! - data: `blocks`, `counters`, `cage`, `record`, `constants`;
//! - steps on words and levels: `levels`, `shifts`, `planes`, `quadrants`, `fill`, `smallest_node`, `to_screen`, `size`,
//!   `alpha`, `canvas`, `undrawn`, `path`;
//! - steps of the loop: `watch`, `state`, `decide`, `children`;
//! - the loop: `record_loop`, and `parents`, the loop with parents on its stack, and tiles;
//! - `engine`, the machine as an [`Engine`](crate::project::Engine);
//! - `instruments`, which observe the machine or drive it in another way.

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
mod levels;
mod limit;
mod parents;
mod path;
mod planes;
mod quadrants;
mod record;
mod record_loop;
mod shifts;
mod size;
mod smallest_node;
mod stages;
mod state;
mod to_screen;
mod undrawn;
mod watch;

pub use crate::project::OCCLUSION_ORDER;
pub use blocks::{Block, Port};
pub use constants::frame_registers;
pub use engine::Machine;
pub use instruments::{
    Cage, Coordinates, NumberSpan, NumberSpans, ProvenWidths, RecordNumber, SimulateError,
    Simulated, cages_along, narrowed, proven_widths,
};
pub use stages::{RecordStage, check_hardware};
pub use state::MachineOptions;
