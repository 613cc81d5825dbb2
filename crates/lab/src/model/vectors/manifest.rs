//! What stands in `manifest.json`.

use hwmodel::SignalKind;
use serde_json::{Value, json};

use super::description::absence;
use super::manifest_fields::fields;
use super::ports;
use super::recorder::Recording;
use super::rows::{EXPECTED, STIMULUS, file_name};
use super::turns::Turns;
use super::{Request, SCHEMA};
use shiftvox::machine::{Block, ProvenWidths, proven_widths};
use shiftvox::project::{FrameSetup, Stats};

/// The manifest of a folder of vectors; `nodes`: of the graph.
pub(super) fn document(
    setup: &FrameSetup,
    request: &Request<'_>,
    nodes: usize,
    stats: &Stats,
    (recordings, turns): (&[Recording], Option<&Turns>),
) -> Value {
    let records = stats.iter().find(|(name, _)| *name == "records");
    let overflows = stats.iter().find(|(name, _)| *name == "overflows");
    let options = &setup.options;
    let tolerance = if options.tolerance_px.is_finite() {
        json!(options.tolerance_px)
    } else {
        json!("inf")
    };
    let proven = proven_widths(setup, nodes);
    let blocks: Vec<Value> = Block::ALL
        .iter()
        .zip(recordings)
        .map(|(&block, recording)| entry(setup, block, recording, proven.as_ref()))
        .collect();
    json!({
        "kind": "shiftvox vectors",
        "schema": SCHEMA,
        "program": concat!("shiftvox ", env!("CARGO_PKG_VERSION")),
        "scene": request.scene,
        "width": setup.width,
        "height": setup.height,
        "records": request.records.min(records.map_or(0, |&(_, count)| count)),
        "word": {
            "bits": setup.format.bits(),
            "wide_bits": setup.format.wide().bits(),
            "screen_fraction_bits": setup.format.frac(),
            "clip_fraction_bits": setup.clip_frac + setup.sub_levels,
        },
        "overflow": request.overflow,
        // Of the whole frame: where there are any, functions hold modulo the policy.
        "overflows": overflows.map_or(0, |&(_, count)| count),
        "cage": options.cage,
        "coverage": options.coverage,
        "tolerance": tolerance,
        "constants": {
            "depth": setup.depth,
            "image_levels": setup.levels,
            "screen_fraction_bits": setup.format.frac(),
            "size_shifts": setup.size_limit.shifts(),
        },
        "blocks": blocks,
        "turns": turns.map_or_else(
            || json!({ "reason": "turns that blend are not written" }),
            Turns::entry,
        ),
        "stages_without_blocks": {
            "pop": "a record is read from the stack: no arithmetic",
            "push": "a record is written to the stack: no arithmetic",
        },
    })
}

fn entry(
    setup: &FrameSetup,
    block: Block,
    recording: &Recording,
    proven: Option<&ProvenWidths>,
) -> Value {
    let description = &recording.description;
    let stages: Vec<&str> = description.stages.iter().map(|s| s.name()).collect();
    let file = |end| (recording.rows > 0).then(|| file_name(description.name, end));
    let reason = (recording.rows == 0)
        .then(|| absence(block, setup).unwrap_or("none of these records came to it"));
    json!({
        "name": description.name,
        "stages": stages,
        "section": format!("SPEC.md, {}", description.section),
        "function": description.function,
        "rows": recording.rows,
        "frame_rows": recording.frame_rows,
        "reason": reason,
        "stimulus": fields(setup.format, &description.stimulus, file(STIMULUS), &|(at, _)| {
            known(recording, proven, 0, at)
        }),
        "expected": fields(setup.format, &description.expected, file(EXPECTED), &|(at, _)| {
            known(recording, proven, 1, at)
        }),
    })
}

/// What is known of a field of a block: when it changes, what values it took, and how many bits the
/// set-up proves to be enough for those.
fn known(recording: &Recording, proven: Option<&ProvenWidths>, side: usize, at: usize) -> Value {
    let description = &recording.description;
    let ports = [&description.stimulus, &description.expected][side];
    let field = &ports.fields()[at];
    // Within 64 bits: they are values of wires.
    let seen = recording.seen[side].get(at);
    let seen = seen.map(|span| [span.least as i64, span.greatest as i64]);
    let number = (side == 0).then(|| ports::number_of(&field.name)).flatten();
    let bits = proven.and_then(|proven| match (field.kind, number) {
        (SignalKind::Wide, _) => Some(proven.wide_bits),
        (_, number) => Some(proven.numbers.get(&number?)?.bits()),
    });
    json!({
        "changes": if ports::is_of_frame(&field.name) { "frame" } else { "row" },
        "seen": seen,
        "proven_bits": bits,
    })
}
