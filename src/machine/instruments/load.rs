//! The host's work of loading a frame, counted.

use hwmodel::{Datapath, NoProbe, Overflow};

use crate::machine::constants::Constants;
use crate::project::FrameSetup;
use crate::project::host::Tally;

/// Counts what the host does to load a frame into the machine's words.
pub fn count_load(setup: &FrameSetup, tally: &Tally) {
    let mut dp = Datapath::new(setup.format, Overflow::default(), NoProbe);
    Constants::load_by(&mut dp, setup, tally);
}
