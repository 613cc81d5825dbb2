//! Test vectors, replayed: every row of every block is computed again from the files alone, in plain integers, by `SPEC.md`
//! and the manifest. Nothing here uses the machine.

mod mutants;
mod replay;
mod rows;
mod turns;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;
use serde_json::Value;
use shiftvox::graph::{Graph, GraphView, Opacity};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};
use shiftvox_lab::model::vectors::{self, Recorded, Request};
use tempfile::TempDir;

use self::replay::replay;
use self::rows::{BlockRows, Row, constants_of, manifest_of, rows_of};
use super::common::{camera, octree, setup, sierpinski, solid, tolerance_of};

/// Replays all rows, and returns their number by block, and that of numbers with a proven range.
fn replay_folder(folder: &Path) -> (BTreeMap<String, usize>, usize) {
    let manifest = manifest_of(folder);
    assert_eq!(manifest["schema"], 6);
    let constants = constants_of(&manifest);
    let mut files = BTreeSet::from(["manifest.json", "frame.constants.hex"].map(str::to_owned));
    // A graph that lists its children has no file of nodes.
    let nodes = ["frame.nodes.hex"].into_iter();
    files.extend(
        nodes
            .filter(|name| folder.join(name).exists())
            .map(str::to_owned),
    );
    let mut counts = BTreeMap::new();
    let mut proven = 0;
    for block in manifest["blocks"].as_array().unwrap() {
        let name = block["name"].as_str().unwrap();
        let rows = block["rows"].as_u64().unwrap() as usize;
        counts.insert(name.to_owned(), rows);
        assert_eq!(block["file"].is_null(), rows == 0, "{name}");
        if rows == 0 {
            assert!(!block["reason"].as_str().unwrap().is_empty(), "{name}");
            continue;
        }
        assert!(block["reason"].is_null(), "{name}");
        files.insert(block["file"].as_str().unwrap().to_owned());
        let BlockRows { rows: found, .. } = rows_of(folder, block);
        assert_eq!(found.len(), rows, "{name}");
        proven += check_ranges(block, &found);
        for (at, [into, out]) in found.iter().enumerate() {
            let replayed = replay(name, into, &constants);
            assert_eq!(replayed, out.values, "{name}, row {at}: {:?}", into.values);
        }
    }
    files.extend(manifest["turns"]["file"].as_str().map(str::to_owned));
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
        let mut first = 0;
        for port in block[key]["ports"].as_array().unwrap() {
            let count = port["count"].as_u64().unwrap() as usize;
            for at in 0..count {
                let values = || rows.iter().map(|row| row[side].values[first + at]);
                let (Some(least), Some(greatest)) = (values().min(), values().max()) else {
                    continue;
                };
                let name = format!("{}, {}", block["name"], port["name"]);
                let seen = [0, 1].map(|end| i128::from(port["seen"][at][end].as_i64().unwrap()));
                assert_eq!(seen, [least, greatest], "{name}");
                if let Some(bits) = port["proven_bits"][at].as_u64() {
                    let most = 1i128 << if least < 0 { bits - 1 } else { bits };
                    let is_within = -most <= least && greatest < most;
                    assert!(is_within, "{name}: {least} to {greatest}, {bits} bits");
                    proven += 1;
                }
            }
            first += count;
        }
    }
    proven
}

/// From outside, from near, and from within; some cells of a voxel are solid, others let light through.
fn scenes() -> Vec<(&'static str, Graph, Camera)> {
    let blob = octree(4, &|[x, y, z]| {
        (x * 7 + y * 5 + z * 3) % 4 < 2 && x + y > z / 2
    });
    let holed = octree(3, &|[x, y, z]| x != 3 && (y + z) % 5 != 2);
    let scenes = [
        (
            "blob",
            blob,
            camera([30.0, 24.0, 20.0], [8.0, 8.0, 6.0], 48),
        ),
        (
            "tetrahedra",
            sierpinski(5),
            camera([40.0, -9.0, 20.0], [16.0; 3], 37),
        ),
        (
            "inside",
            holed,
            camera([3.4, 3.7, 3.5], [8.0, 5.0, 4.0], 40),
        ),
        ("cube", solid(3), camera([11.0, 10.0, 14.0], [4.0; 3], 33)),
    ];
    let with_opacities = |(name, mut graph, camera): (_, Graph, _)| {
        let opacity = (0..graph.len()).map(|i| {
            let side = |k: usize| (i * 37 + k * 101) as u8;
            Opacity([0, 1, 2].map(|k| if i % 4 == k { 255 } else { side(k) }))
        });
        graph.opacity = opacity.collect::<Vec<_>>().into();
        (name, graph, camera)
    };
    scenes.map(with_opacities).into()
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
        records,
        overflow: Overflow::Trap,
        organisation: Organisation::default(),
        folder: &folder,
        overwrite: false,
    };
    let recorded = vectors::write(graph, setup, &request).unwrap();
    (shelter, folder, recorded)
}

/// Records a frame with a colour for each node, and replays it.
fn round_trip(
    graph: &Graph,
    camera: &Camera,
    options: &SetupOptions,
) -> (BTreeMap<String, usize>, usize) {
    let light: Vec<[u16; 3]> = (0..graph.len() as u16)
        .map(|i| [0, 1, 2].map(|c| i.wrapping_mul(40_503).rotate_left(5 * c) ^ 0x9e37))
        .collect();
    let lit = GraphView {
        light: &light,
        ..graph.view()
    };
    let (_shelter, folder, recorded) = written(&lit, &setup(graph, camera, options), 150);
    let (counts, proven) = replay_folder(&folder);
    assert_eq!(counts.values().sum::<usize>() as u64, recorded.rows);
    let with_rows = counts.values().filter(|&&rows| rows > 0);
    assert_eq!(with_rows.count(), recorded.blocks);
    (counts, proven)
}

const COVERAGES: [Coverage; 4] = [
    Coverage::Any,
    Coverage::Center,
    Coverage::Exact,
    Coverage::Alpha,
];

/// Of a rule, and whether records change space.
type IsPresent = fn(Coverage, bool) -> bool;

/// Blocks, and whether frames have rows of them: under exact rules or not, where records change space or not.
const PRESENCE: [(&str, IsPresent); 6] = [
    (
        "filled centre octant_order vertex_pool child_corners child_span border_clip bisector_clip near_node half_clip \
         quadrants node_choice fill_update detail_depth size_limit size_clip",
        |_, _| true,
    ),
    (
        "change_depth to_screen_divide margin_grow size_screen border_screen bisector_screen",
        |_, changes| changes,
    ),
    (
        "child_planes plane_quadrant margin_gap cube_planes cube_front plane_side plane_cover",
        |coverage, _| coverage.draws_outlines(),
    ),
    (
        "blend_way blend_shares blend_counts blend_weight blend_sample",
        |coverage, _| coverage == Coverage::Alpha,
    ),
    ("centre_sample", |_, changes| changes),
    ("cage_centre centre_half", |coverage, _| {
        !coverage.draws_outlines()
    }),
];

#[test]
fn rows_are_what_the_blocks_give_and_are_there_where_they_should() {
    let (mut frames, mut all_proven) = (0, 0);
    let mut sums: BTreeMap<(usize, bool, String), usize> = BTreeMap::new();
    for (name, graph, camera) in scenes() {
        frames += 1;
        for (rule, coverage) in COVERAGES.into_iter().enumerate() {
            for cage in [CageKind::Corners, CageKind::Frame] {
                for tolerance in [0.0, 0.125, f64::INFINITY] {
                    if tolerance != tolerance_of(coverage, tolerance) {
                        continue;
                    }
                    // Each of the two words in turn.
                    frames += 1;
                    let bits = [24, 32][frames % 2];
                    println!("{name}, {coverage:?}, {cage:?}, {tolerance}, {bits}");
                    let options = options(coverage, cage, tolerance, bits);
                    let (counts, proven) = round_trip(&graph, &camera, &options);
                    all_proven += proven;
                    let changes = !coverage.draws_outlines() && tolerance > 0.0;
                    for (block, rows) in counts {
                        *sums.entry((rule, changes, block)).or_default() += rows;
                    }
                }
            }
        }
    }
    assert!(all_proven > 1000);
    for (blocks, is_there) in PRESENCE {
        for ((rule, changes, block), &rows) in &sums {
            if blocks.split(' ').any(|of| of == block) {
                let expected = is_there(COVERAGES[*rule], *changes);
                assert_eq!(rows > 0, expected, "{block}, {rule}, {changes}");
            }
        }
    }
    for (.., block) in sums.keys() {
        let has_rows = |((.., of), rows): (&(_, _, String), &usize)| of == block && *rows > 0;
        assert!(sums.iter().any(has_rows), "{block} has no rows anywhere");
    }
}

#[test]
fn rows_of_wide_words_and_coarse_frames() {
    let (_, graph, camera) = scenes().swap_remove(0);
    for coverage in COVERAGES {
        for lod_px in [0.0, 3.0] {
            let options = SetupOptions {
                lod_px,
                aa_log2: 1,
                ..options(coverage, CageKind::Frame, 1.0 / 64.0, 64)
            };
            println!("{coverage:?}, {lod_px}");
            round_trip(&graph, &camera, &options);
        }
    }
}
