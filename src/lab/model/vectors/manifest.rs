//! What stands in `manifest.json`.

use hwmodel::Format;
use serde_json::{Value, json};

use super::blocks::absence;
use super::ports::{self, Ports};
use super::recorder::{EXPECTED, Recording, STIMULUS, file_name};
use super::{Request, SCHEMA};
use crate::machine::Block;
use crate::project::{FrameSetup, Stats};

/// The manifest of a folder of vectors.
pub(super) fn document(
    setup: &FrameSetup,
    request: &Request<'_>,
    stats: &Stats,
    recordings: &[Recording],
) -> Value {
    let records = stats.iter().find(|(name, _)| *name == "records");
    let overflows = stats.iter().find(|(name, _)| *name == "overflows");
    let options = &setup.options;
    let tolerance = if options.tolerance_px.is_finite() {
        json!(options.tolerance_px)
    } else {
        json!("inf")
    };
    let blocks: Vec<Value> = Block::ALL
        .iter()
        .zip(recordings)
        .map(|(&block, recording)| entry(setup, block, recording))
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
        "stages_without_blocks": {
            "pop": "a record is read from the stack: no arithmetic",
            "push": "a record is written to the stack: no arithmetic",
        },
    })
}

fn entry(setup: &FrameSetup, block: Block, recording: &Recording) -> Value {
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
        "stimulus": fields(setup.format, &description.stimulus, file(STIMULUS)),
        "expected": fields(setup.format, &description.expected, file(EXPECTED)),
    })
}

fn fields(format: Format, ports: &Ports, file: Option<String>) -> Value {
    let all: Vec<Value> = ports
        .placed(format)
        .map(|(field, lowest)| {
            json!({
                "name": field.name,
                "bits": field.kind.bits(format),
                "signed": field.kind.is_signed(),
                "lowest_bit": lowest,
                "changes": if ports::is_of_frame(&field.name) { "frame" } else { "row" },
                "meaning": field.meaning,
            })
        })
        .collect();
    json!({
        "file": file,
        "bits": ports.bits(format),
        "digits": ports.digits(format),
        "fields": all,
    })
}
