//! `manifest.json`: the word format, the constants, and a description of every file.

use serde_json::{Value, json};

use super::blocks::{Descriptions, absence};
use super::recorder::{Recording, TURNS, Turns, file_name};
use super::{Request, SCHEMA};
use shiftvox::machine::{ProvenWidths, proven_widths};
use shiftvox::project::{FrameSetup, Stats, stat};

/// The manifest of a folder of vectors. `nodes` is the size of the graph.
pub(super) fn document(
    setup: &FrameSetup,
    request: &Request<'_>,
    nodes: usize,
    stats: &Stats,
    (recordings, turns): (&[Recording], Option<&Turns>),
) -> Value {
    let options = &setup.options;
    let tolerance = match options.tolerance_px.is_finite() {
        true => json!(options.tolerance_px),
        false => json!("inf"),
    };
    let proven = proven_widths(setup, nodes);
    let blocks = recordings
        .iter()
        .map(|of| entry(setup, of, proven.as_ref()));
    json!({
        "kind": "shiftvox vectors",
        "schema": SCHEMA,
        "program": concat!("shiftvox ", env!("CARGO_PKG_VERSION")),
        "scene": request.scene,
        "width": setup.width,
        "height": setup.height,
        "records": request.records.min(stat(stats, "records")),
        "word": {
            "bits": setup.format.bits(),
            "wide_bits": setup.format.wide().bits(),
            "screen_fraction_bits": setup.format.frac(),
            "clip_fraction_bits": setup.clip_frac + setup.sub_levels,
        },
        "overflow": request.overflow,
        // Of the whole frame. If there are any, functions hold modulo the policy.
        "overflows": stat(stats, "overflows"),
        "cage": options.cage,
        "coverage": options.coverage,
        "tolerance": tolerance,
        "constants": {
            "depth": setup.depth,
            "image_levels": setup.levels,
            "screen_fraction_bits": setup.format.frac(),
            "size_shifts": setup.size_limit.shifts(),
        },
        "blocks": blocks.collect::<Vec<_>>(),
        "turns": turns.map_or_else(
            || json!({ "reason": "turns that blend are not written" }),
            |of| json!({
                "file": TURNS,
                "turns": of.turns,
                "events": of.events,
                "record": of.record.describe(setup.format, |name| meaning("record", name), &[], None),
            }),
        ),
    })
}

fn meaning(block: &str, port: &str) -> String {
    Descriptions::shipped().meaning(block, port).to_owned()
}

fn entry(setup: &FrameSetup, recording: &Recording, proven: Option<&ProvenWidths>) -> Value {
    let of = recording.description;
    let stages: Vec<&str> = of.stages.iter().map(|stage| stage.name()).collect();
    let absent = || absence(recording.block, setup).unwrap_or("none of these records came to it");
    let ports = |side: usize, proven| {
        let seen = &recording.seen[side];
        recording.ports[side].describe(setup.format, |name| meaning(&of.name, name), seen, proven)
    };
    json!({
        "name": of.name,
        "stages": stages,
        "section": format!("SPEC.md, {}", of.section),
        "function": of.function,
        "file": (recording.rows > 0).then(|| file_name(&of.name)),
        "rows": recording.rows,
        "frame_rows": recording.frame_rows,
        "reason": (recording.rows == 0).then(absent),
        "in": ports(0, proven),
        // Outputs have proven widths only where they are wide words.
        "out": ports(1, proven.filter(|_| has_wide_outputs(recording))),
    })
}

fn has_wide_outputs(recording: &Recording) -> bool {
    let mut ports = recording.ports[1].0.iter();
    ports.any(|port| port.kind == hwmodel::SignalKind::Wide)
}
