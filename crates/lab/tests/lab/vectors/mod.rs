//! Folders of test vectors, read by their manifests alone. Rows are computed again in plain integers, by `SPEC.md`, or have
//! a block in Verilog, which `crates/cli/tests/rtl` runs over rows; it also follows whole turns.

mod mutants;
mod replay;
mod rows;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;
use serde_json::Value;
use shiftvox::graph::{Graph, GraphView};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};
use shiftvox_lab::model::vectors::{self, Recorded, Request};
use tempfile::TempDir;

use self::mutants::Missed;
use self::replay::Rules;
use self::rows::{Row, manifest_of, rows_of};
use super::common::{
    camera, lights, octree, setup, sierpinski, solid, tolerance_of, with_opacities,
};

/// Replays all rows, and returns their number by block, and that of numbers with a proven range. Faults that rows detect
/// are no longer missed.
fn replay_folder(folder: &Path, missed: &mut Vec<Missed>) -> (BTreeMap<String, usize>, usize) {
    let manifest = manifest_of(folder);
    assert_eq!(manifest["schema"], 6);
    let rules = Rules::new(&manifest);
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let mut files = BTreeSet::from(
        [
            "manifest.json",
            "frame.constants.hex",
            "frame.attributes.hex",
        ]
        .map(str::to_owned),
    );
    files.extend(text(&manifest["turns"]["file"]));
    // A graph that lists its children has no file of nodes.
    let nodes = "frame.nodes.hex".to_owned();
    files.extend(folder.join(&nodes).exists().then_some(nodes));
    let mut counts = BTreeMap::new();
    let mut proven = 0;
    for block in manifest["blocks"].as_array().unwrap() {
        let name = block["name"].as_str().unwrap();
        let rows = block["rows"].as_u64().unwrap() as usize;
        counts.insert(name.to_owned(), rows);
        let has_reason = text(&block["reason"]).is_some_and(|reason| !reason.is_empty());
        let has_rows = block["file"].is_string();
        assert_eq!((has_rows, has_reason), (rows > 0, rows == 0), "{name}");
        if !has_rows {
            continue;
        }
        files.extend(text(&block["file"]));
        let found = rows_of(folder, block);
        assert_eq!(found.len(), rows, "{name}");
        proven += check_ranges(block, &found);
        let rtl = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../rtl"));
        let mut modules = ["blocks", "blocks_exact"]
            .map(|of| rtl.join(of))
            .into_iter();
        let has_module = modules.any(|of| of.join(format!("{name}.v")).exists());
        for (at, [into, out]) in found.iter().enumerate() {
            match rules.replay(name, into) {
                Some(replayed) => {
                    assert_eq!(replayed, out.values, "{name}, row {at}: {:?}", into.values);
                }
                None => assert!(has_module, "no rule for block {name}"),
            }
        }
        // Sums of wider words would show all carries.
        let is_tested = manifest["word"]["bits"] == mutants::BITS;
        missed.retain(|&(block, _, spoil)| {
            let mut wrong = Rules::new(&manifest);
            spoil(&mut wrong);
            let tells = |[row, right]: &[Row; 2]| wrong.replay(name, row).unwrap() != right.values;
            !(is_tested && block == name && found.iter().any(tells))
        });
    }
    let there = fs::read_dir(folder).unwrap();
    let there = there.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(there.collect::<BTreeSet<_>>(), files);
    (counts, proven)
}

/// The manifest's ranges are those of the frame's rows, and within the proven widths. Returns how many are proven.
fn check_ranges(block: &Value, rows: &[[Row; 2]]) -> usize {
    let rows = &rows[..block["frame_rows"].as_u64().unwrap() as usize];
    let mut proven = 0;
    for (side, key) in ["in", "out"].into_iter().enumerate() {
        let ports = block[key]["ports"].as_array().unwrap().iter();
        let places = ports.flat_map(|port| {
            (0..port["count"].as_u64().unwrap()).map(move |at| (port, at as usize))
        });
        for (number, (port, at)) in places.enumerate() {
            assert_ne!(port["meaning"], "", "{}", port["name"]);
            let values = || rows.iter().map(|row| row[side].values[number]);
            let (Some(least), Some(greatest)) = (values().min(), values().max()) else {
                continue;
            };
            let name = format!("{}, {}: {least} to {greatest}", block["name"], port["name"]);
            let seen = [0, 1].map(|end| i128::from(port["seen"][at][end].as_i64().unwrap()));
            assert_eq!(seen, [least, greatest], "{name}");
            if let Some(bits) = port["proven_bits"][at].as_u64() {
                let most = 1i128 << if least < 0 { bits - 1 } else { bits };
                assert!(-most <= least && greatest < most, "{name}, {bits} bits");
                proven += 1;
            }
        }
    }
    proven
}

/// From outside, from near, and from within; some cells of a voxel are solid, others let light through.
fn scenes() -> Vec<(Graph, Camera)> {
    let blob = |[x, y, z]: [i32; 3]| (x * 7 + y * 5 + z * 3) % 4 < 2 && x + y > z / 2;
    let holed = |[x, y, z]: [i32; 3]| x != 3 && (y + z) % 5 != 2;
    let scenes = [
        (
            octree(4, &blob),
            camera([30.0, 24.0, 20.0], [8.0, 8.0, 6.0], 48),
        ),
        (sierpinski(5), camera([40.0, -9.0, 20.0], [16.0; 3], 37)),
        (
            octree(3, &holed),
            camera([3.4, 3.7, 3.5], [8.0, 5.0, 4.0], 40),
        ),
        (solid(3), camera([11.0, 10.0, 14.0], [4.0; 3], 33)),
    ];
    let opacity = |i: usize| {
        let side = |k: usize| (i * 37 + k * 101) as u8;
        [0, 1, 2].map(|k| if i % 4 == k { 255 } else { side(k) })
    };
    let opacities: Vec<[u8; 3]> = (0..256).map(opacity).collect();
    scenes
        .map(|(graph, camera)| (with_opacities(&graph, &opacities), camera))
        .into()
}

fn options(coverage: Coverage, cage: CageKind, tolerance_px: f64, bits: u32) -> SetupOptions {
    SetupOptions {
        bits,
        cage,
        tolerance_px: tolerance_of(coverage, tolerance_px),
        ..SetupOptions::of(coverage)
    }
}

/// A folder that holds `vectors`: at most so many records of a frame, as they are written.
fn written(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    records: u64,
) -> (TempDir, PathBuf, Recorded) {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path().join("vectors");
    let request = Request {
        scene: "a test",
        color: &[],
        normal: &[],
        overwrite: false,
        records,
        overflow: Overflow::Trap,
        organisation: Organisation::default(),
        folder: &folder,
    };
    let recorded = vectors::write(graph, setup, &request).unwrap();
    (shelter, folder, recorded)
}

const COVERAGES: [Coverage; 4] = [
    Coverage::Any,
    Coverage::Center,
    Coverage::Exact,
    Coverage::Alpha,
];

/// Frames under all rules, by scene; then of wide words, with and without level of detail.
fn frames() -> Vec<(usize, SetupOptions)> {
    let mut frames = Vec::new();
    for (scene, coverage) in (0..16).map(|at| (at / 4, COVERAGES[at % 4])) {
        let tolerances = [0.0, 0.125, f64::INFINITY].into_iter();
        for tolerance in tolerances.filter(|&of| of == tolerance_of(coverage, of)) {
            for cage in [CageKind::Corners, CageKind::Frame] {
                // Each of the two words in turn.
                let bits = [24, 32][(frames.len() / 3 + scene) % 2];
                frames.push((scene, options(coverage, cage, tolerance, bits)));
            }
        }
    }
    for (coverage, lod_px) in COVERAGES.map(|of| [(of, 0.0), (of, 3.0)]).concat() {
        let mut wide = options(coverage, CageKind::Frame, 1.0 / 64.0, 64);
        (wide.lod_px, wide.aa_log2) = (lod_px, 1);
        frames.push((0, wide));
    }
    frames
}

#[test]
fn rows_are_what_the_blocks_give_and_are_there_where_they_should() {
    let scenes = scenes();
    let mut missed: Vec<Missed> = mutants::all().collect();
    let mut all_proven = 0;
    let mut with_rows: BTreeMap<_, BTreeSet<String>> = BTreeMap::new();
    let mut all = BTreeSet::new();
    for (scene, options) in frames() {
        println!("scene {scene}, {options:?}");
        let (graph, camera) = &scenes[scene];
        let light = lights(graph);
        let lit = graph.lit(&light);
        let (_shelter, folder, recorded) = written(&lit, &setup(graph, camera, &options), 150);
        let (counts, proven) = replay_folder(&folder, &mut missed);
        assert_eq!(counts.values().sum::<usize>() as u64, recorded.rows);
        all_proven += proven;
        all.extend(counts.keys().cloned());
        let present = counts.into_iter().filter(|(_, rows)| *rows > 0);
        let present: BTreeSet<String> = present.map(|(block, _)| block).collect();
        assert_eq!(present.len(), recorded.blocks);
        let changes = options.tolerance_px > 0.0;
        let key = (format!("{:?}", options.coverage), changes);
        with_rows.entry(key).or_default().extend(present);
    }
    let missed: Vec<_> = missed.iter().map(|of| (of.0, of.1)).collect();
    assert_eq!(missed, [], "faults of rules that no row detects");
    assert!(all_proven > 1000);
    let counts = with_rows
        .iter()
        .map(|((rule, changes), blocks)| (rule.as_str(), *changes, blocks.len()));
    let expected = [
        ("Alpha", false, 28),
        ("Any", false, 18),
        ("Any", true, 26),
        ("Center", false, 18),
        ("Center", true, 26),
        ("Exact", false, 23),
    ];
    assert_eq!(counts.collect::<Vec<_>>(), expected);
    let found: BTreeSet<String> = with_rows.into_values().flatten().collect();
    assert_eq!(found, all, "blocks that have rows nowhere");
}
