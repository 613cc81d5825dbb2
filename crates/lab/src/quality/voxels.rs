//! The image-order engines as methods.

use hwmodel::Memory;
use hwmodel::cycles::Organisation;

use super::method::{Examined, Method, Refused};
use crate::bench::MakeEngine;
use crate::model::record::{record_bits, record_fields};
use crate::report::Cell;
use shiftvox::drawing::{Buffers, GraphDrawing, GraphStyle, Shown};
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::picture::{Background, Buffer, Shading};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions, Stats, Up, stat};

/// Bytes per access: child mask and list of a node, its colour and normal, a fill vector (four bits,
/// a byte here), a pixel's node.
const NODE_BYTES: u64 = 5;
const ATTRIBUTE_BYTES: u64 = 5;
const FILL_VECTOR_BYTES: u64 = 1;
const PIXEL_BYTES: u64 = 4;
const ACCUMULATOR_BYTES: u64 = (hwmodel::memory::ACCUMULATOR_BITS as u64).div_ceil(8);

/// An engine with settings, on one thread. Times are the engine's. Counters are the machine's, which
/// draws the same bits, so that methods can be compared by hardware work.
pub fn voxel_method<'g>(
    graph: &'g Graph,
    (engine, make): (&'static str, MakeEngine),
    options: SetupOptions,
) -> Method<'g> {
    let drawn_as = GraphStyle {
        options,
        shading: Shading::default(),
        background: Background::default(),
        buffers: vec![Buffer::Voxel],
        is_hashed: false,
    };
    // Only fitted cameras use the up axis.
    let drawing = move || GraphDrawing::new(graph, Up::Z, drawn_as.clone(), move || make(1));
    let samples = 1 << options.aa_log2;
    Method {
        family: "voxels",
        name: name(engine, &options),
        settings: vec![
            ("coverage", options.coverage.name().into()),
            ("tolerance", tolerance_in_words(options.tolerance_px).into()),
            ("cage", options.cage.name().into()),
            ("bits", u64::from(options.bits).into()),
            ("lod", options.lod_px.to_string().into()),
            ("aa", Cell::Count(samples)),
            ("engine", engine.into()),
        ],
        kind: match samples {
            1 => options.coverage.name().to_owned(),
            _ => format!("{}, aa {samples}", options.coverage.name()),
        },
        graph: Some(graph),
        bytes: graph.bytes(),
        build_ms: None,
        drawing: Box::new(move || Box::new(drawing())),
        examine: Box::new(move |shown, camera| examine(graph, &options, shown, camera)),
    }
}

fn examine(
    graph: &Graph,
    options: &SetupOptions,
    shown: &Shown<'_>,
    camera: &Camera,
) -> Result<Examined, Refused> {
    let Buffers::Resolved(resolver) = &shown.buffers else {
        return Err(Refused::because("no engine of voxels"));
    };
    let frame = resolver.frame();
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, options);
    let setup = setup.map_err(Refused::because)?;
    let aa_log2 = options.aa_log2;
    let handed = |(name, _): &(&str, _)| *name == "handed_to_machine";
    Ok(Examined {
        shares: shares(frame, aa_log2),
        counters: counters(graph, &setup)?,
        samples: Some((aa_log2, frame.voxel.clone())),
        remark: remark(options, shown.counters.iter().any(handed)),
    })
}

/// `handed`: whether the fast engine passed the frame to the machine.
fn remark(o: &SetupOptions, handed: bool) -> Option<String> {
    let is_paper =
        (o.cage, o.coverage) == (CageKind::Corners, Coverage::Any) && o.tolerance_px.is_infinite();
    match (is_paper, handed) {
        (true, true) => Some("the paper's; drawn by the machine".to_owned()),
        (true, false) => Some("the paper's".to_owned()),
        (false, true) => Some("drawn by the machine".to_owned()),
        (false, false) => None,
    }
}

fn counters(graph: &Graph, setup: &FrameSetup) -> Result<Stats, Refused> {
    let mut frame = Frame::nodes_only(setup.width, setup.height);
    let drawn = Machine::default().count(&graph.view(), setup, &mut frame);
    let (stats, counter) = drawn.map_err(Refused::because)?;
    let record = u64::from(
        record_bits(&record_fields(setup, graph.len(), Organisation::default())).div_ceil(8),
    );
    let bytes = [
        (Memory::Stack, record),
        (Memory::Node, NODE_BYTES),
        (Memory::Attribute, ATTRIBUTE_BYTES),
        (Memory::FillVector, FILL_VECTOR_BYTES),
        (Memory::Pixel, PIXEL_BYTES),
        (Memory::Accumulator, ACCUMULATOR_BYTES),
    ];
    let touched = bytes
        .iter()
        .map(|&(memory, size)| size * (counter.reads(memory) + counter.writes(memory)));
    Ok(vec![
        ("operations", counter.ops()),
        ("records", stat(&stats, "records")),
        ("bytes_touched", touched.sum()),
    ])
}

fn tolerance_in_words(tolerance_px: f64) -> String {
    if tolerance_px.is_infinite() {
        return "inf".to_owned();
    }
    let inverse = 1.0 / tolerance_px;
    if tolerance_px < 1.0 && inverse.is_finite() && inverse == libm::round(inverse) {
        return format!("1/{inverse}");
    }
    tolerance_px.to_string()
}

fn name(engine: &str, o: &SetupOptions) -> String {
    let mut name = o.coverage.name().to_owned();
    if !o.coverage.draws_outlines() {
        name += &format!(" {}", tolerance_in_words(o.tolerance_px));
    }
    name += &format!(" {}", o.cage.name());
    if o.bits != 64 || o.frac.is_some() {
        name += &format!(" {} bits", o.bits);
    }
    if let Some(frac) = o.frac {
        name += &format!(" .{frac}");
    }
    if o.lod_px != o.coverage.default_lod() {
        name += &format!(" lod {}", o.lod_px);
    }
    if o.aa_log2 > 0 {
        name += &format!(" aa {}", 1 << o.aa_log2);
    }
    if engine != "fast" {
        name += &format!(", {}", engine);
    }
    name
}

fn shares(frame: &Frame, aa_log2: u32) -> Vec<f32> {
    let (side, across) = (1usize << aa_log2, frame.width as usize);
    let (width, height) = (across >> aa_log2, frame.height as usize >> aa_log2);
    let pixel = |x: usize, y: usize| {
        let rows = (0..side).map(|j| (y * side + j) * across + x * side);
        let samples = (side * side) as f32;
        if let Some(blend) = &frame.blend {
            let taken = rows.flat_map(|at| &blend[at..at + side]);
            return taken.map(|b| 1.0 - f32::from(b.left) / 256.0).sum::<f32>() / samples;
        }
        let seen = rows.flat_map(|at| &frame.node[at..at + side]);
        seen.filter(|&&node| node != NO_NODE).count() as f32 / samples
    };
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| pixel(x, y))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_and_shares() {
        let words = [0.0, 0.125, 1.0 / 64.0, 0.3, 2.0, f64::INFINITY].map(tolerance_in_words);
        assert_eq!(words, ["0", "1/8", "1/64", "0.3", "2", "inf"]);
        let mut frame = Frame::nodes_only(4, 2);
        for at in [0, 2, 3, 6, 7] {
            frame.node[at] = 0;
        }
        assert_eq!(shares(&frame, 1), [0.25, 1.0]);
        assert_eq!(shares(&frame, 0), [1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    }
}
