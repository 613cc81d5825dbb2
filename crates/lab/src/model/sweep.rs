//! The same frame in words of many widths: the narrowest that keeps a scene
//! within a given error is what an architect looks for.

use hwmodel::cycles::Hardware;
use rayon::prelude::*;
use serde::Serialize;

use super::ModelError;
use super::cost::Prices;
use super::frame;
use super::rules::{self, Outcome};
use super::safe::{self, Safe, rounding_px};
use shiftvox::graph::{Graph, Progress};
use shiftvox::project::{Camera, FrameSetup, SetupOptions};

/// A word format and what it comes to.
#[derive(Debug, Clone, Serialize)]
pub struct FormatRow {
    /// Width of a word, bits.
    pub bits: u32,
    /// Fraction bits of clip vectors, and of screen positions; none if the
    /// frame cannot be set up.
    pub fraction_bits: Option<(u32, u32)>,
    /// Whether no word of the frame can overflow, by its bounds.
    pub has_headroom: bool,
    /// How far the view's shape may be off by rounding, pixels, for what is
    /// seen from its own size away.
    pub rounding_px: f64,
    /// Bits of a record on the stack.
    pub record_bits: u32,
    /// What is safe with this format.
    pub safe: Safe,
    /// What became of the frame.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// The frame in words of so many bits each. Units are as wide as the words.
///
/// # Errors
/// When the camera sees nothing, or the cost tables lack a figure.
pub fn table(
    graph: &Graph,
    camera: &Camera,
    base: &SetupOptions,
    widths: &[u32],
    hardware: &Hardware,
    prices: &Prices,
    progress: &dyn Progress,
) -> Result<Vec<FormatRow>, ModelError> {
    let exact = frame::reference(&graph.view(), &rules::true_setup(graph, camera, base)?)?;
    progress.begin("word formats", widths.len() as u64);
    let row = |&bits: &u32| {
        let options = SetupOptions {
            bits,
            frac: None,
            ..*base
        };
        let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options);
        let known = setup.as_ref().ok();
        let (fraction_bits, has_headroom, rounding_px) =
            known.map_or((None, false, f64::INFINITY), |setup| {
                let fraction = (setup.clip_frac, setup.format.frac());
                (Some(fraction), setup.has_headroom, rounding_px(setup))
            });
        let hardware = with_width(hardware, bits);
        let (record_bits, outcome) = rules::measure(graph, setup, &hardware, prices, &exact)?;
        progress.advance(1);
        Ok(FormatRow {
            bits,
            fraction_bits,
            has_headroom,
            rounding_px,
            record_bits,
            safe: safe::of(graph, camera, &options),
            outcome,
        })
    };
    let rows = widths.par_iter().map(row).collect();
    progress.end();
    rows
}

/// Words for which the shipped hardware is built.
const BUILT_FOR_BITS: u32 = 32;

/// A hardware whose units for words are as much wider or narrower as words of
/// `bits` bits are than those that it is built for.
pub(super) fn with_width(hardware: &Hardware, bits: u32) -> Hardware {
    let mut hardware = hardware.clone();
    let stages = hardware.stages.values_mut();
    for units in stages.chain([&mut hardware.units]) {
        for unit in units.values_mut().filter(|unit| unit.width > 8) {
            unit.width = (unit.width + bits).saturating_sub(BUILT_FOR_BITS).max(1);
        }
    }
    hardware
}
