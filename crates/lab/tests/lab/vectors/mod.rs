//! Test vectors, replayed: every row of every block is computed again from the files alone, in plain integers, by `SPEC.md`
//! and the manifest. Nothing here uses the machine.

mod mutants;
mod replay;
mod rows;
mod turns;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;
use serde_json::Value;
use shiftvox::graph::{Graph, GraphView, Opacity};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};
use shiftvox_lab::model::vectors::{self, Recorded, Request};
use tempfile::TempDir;

use self::replay::replay;
use self::rows::{Row, constants_of, manifest_of, rows_of};
use super::common::{camera, octree, setup, sierpinski, solid, tolerance_of};

/// The first row that is not the output of its block, and the number of rows by block.
fn replay_folder(folder: &Path) -> (Option<String>, BTreeMap<String, usize>) {
    let manifest = manifest_of(folder);
    assert_eq!(manifest["schema"], 6);
    let constants = constants_of(&manifest);
    let mut files = BTreeSet::from(["manifest.json", "frame.constants.hex"].map(str::to_owned));
    // A graph that lists its children has no such file.
    let nodes = "frame.nodes.hex";
    if folder.join(nodes).exists() {
        files.insert(nodes.to_owned());
    }
    let mut wrong = None;
    let mut counts = BTreeMap::new();
    for block in manifest["blocks"].as_array().unwrap() {
        let name = block["name"].as_str().unwrap();
        let rows = block["rows"].as_u64().unwrap() as usize;
        counts.insert(name.to_owned(), rows);
        assert_eq!(block["file"].is_null(), rows == 0, "{name}");
        assert_eq!(block["reason"].is_null(), rows > 0, "{name}");
        if rows == 0 {
            assert!(!block["reason"].as_str().unwrap().is_empty(), "{name}");
            continue;
        }
        files.insert(block["file"].as_str().unwrap().to_owned());
        let found = rows_of(folder, block);
        assert_eq!(found.rows.len(), rows, "{name}");
        check_ranges(block, &found.rows);
        for (at, [into, out]) in found.rows.iter().enumerate() {
            let found = replay(name, into, &constants);
            if found != out.values && wrong.is_none() {
                let (values, out) = (&into.values, &out.values);
                wrong = Some(format!(
                    "{name}, row {at}: {values:?} -> {out:?}, not {found:?}"
                ));
            }
        }
    }
    files.extend(manifest["turns"]["file"].as_str().map(str::to_owned));
    let there: BTreeSet<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(there, files);
    (wrong, counts)
}

/// Numbers whose range was compared with a proof.
static PROVEN: AtomicUsize = AtomicUsize::new(0);

/// The manifest's ranges are those of the frame's rows, and within the proven widths.
fn check_ranges(block: &Value, rows: &[[Row; 2]]) {
    let rows = &rows[..block["frame_rows"].as_u64().unwrap() as usize];
    for (side, key) in ["in", "out"]
        .into_iter()
        .enumerate()
        .filter(|_| !rows.is_empty())
    {
        let ports = block[key]["ports"].as_array().unwrap().iter();
        let numbers = ports.flat_map(|port| {
            let count = port["count"].as_u64().unwrap() as usize;
            (0..count).map(move |at| (port, at))
        });
        for (at, (port, of_port)) in numbers.enumerate() {
            let values = || rows.iter().map(|row| row[side].values[at]);
            let (least, greatest) = (values().min().unwrap(), values().max().unwrap());
            let name = format!("{}, {}", block["name"], port["name"]);
            let seen = [0, 1].map(|end| i128::from(port["seen"][of_port][end].as_i64().unwrap()));
            assert_eq!(seen, [least, greatest], "{name}");
            if let Some(bits) = port["proven_bits"][of_port].as_u64() {
                let most = 1i128 << if least < 0 { bits - 1 } else { bits };
                let is_within = -most <= least && greatest < most;
                assert!(is_within, "{name}: {least} to {greatest}, {bits} bits");
                PROVEN.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

/// With opacities: sides of all kinds, and every fourth voxel with solid ones.
fn with_opacities(mut graph: Graph) -> Graph {
    let opacity = (0..graph.len()).map(|i| {
        let side = |k: usize| (i * 37 + k * 101) as u8;
        Opacity([0, 1, 2].map(|k| if i % 4 == k { 255 } else { side(k) }))
    });
    graph.opacity = opacity.collect::<Vec<_>>().into();
    graph
}

/// Scenes and cameras: a sponge-like thing from outside, a fractal from near,
/// a dense cube with the eye within, near its middle.
fn scenes() -> Vec<(&'static str, Graph, Camera)> {
    let blob = octree(4, &|[x, y, z]| {
        (x * 7 + y * 5 + z * 3) % 4 < 2 && x + y > z / 2
    });
    let scenes = vec![
        (
            "blob",
            blob,
            camera([30.0, 24.0, 20.0], [8.0, 8.0, 6.0], 48),
        ),
        (
            "tetrahedra",
            sierpinski(5),
            camera([40.0, -9.0, 20.0], [16.0, 16.0, 16.0], 37),
        ),
        (
            "inside",
            octree(3, &|[x, y, z]| x != 3 && (y + z) % 5 != 2),
            camera([3.4, 3.7, 3.5], [8.0, 5.0, 4.0], 40),
        ),
        (
            "cube",
            solid(3),
            camera([11.0, 10.0, 14.0], [4.0, 4.0, 4.0], 33),
        ),
    ];
    let with_opacities = |(name, graph, camera)| (name, with_opacities(graph), camera);
    scenes.into_iter().map(with_opacities).collect()
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

/// Records a frame and replays it.
fn round_trip(
    graph: &Graph,
    camera: &Camera,
    options: &SetupOptions,
    records: u64,
) -> (Option<String>, BTreeMap<String, usize>) {
    // A colour for each node.
    let light: Vec<[u16; 3]> = (0..graph.len() as u16)
        .map(|i| [0, 1, 2].map(|c| i.wrapping_mul(40_503).rotate_left(5 * c) ^ 0x9e37))
        .collect();
    let lit = GraphView {
        light: &light,
        ..graph.view()
    };
    let (_shelter, folder, recorded) = written(&lit, &setup(graph, camera, options), records);
    let (wrong, counts) = replay_folder(&folder);
    let rows: usize = counts.values().sum();
    assert_eq!(rows as u64, recorded.rows);
    assert_eq!(
        counts.values().filter(|&&rows| rows > 0).count(),
        recorded.blocks
    );
    (wrong, counts)
}

const COVERAGES: [Coverage; 4] = [
    Coverage::Any,
    Coverage::Center,
    Coverage::Exact,
    Coverage::Alpha,
];
const CAGES: [CageKind; 2] = [CageKind::Corners, CageKind::Frame];
const TOLERANCES: [f64; 3] = [0.0, 0.125, f64::INFINITY];

/// Every row of every block, for every scene, rule, cage and tolerance, in words of 24 and of 32
/// bits.
#[test]
fn rows_are_what_the_blocks_give() {
    let mut sums: BTreeMap<String, usize> = BTreeMap::new();
    let mut frames = 0;
    for (name, graph, camera) in scenes() {
        frames += 1;
        for coverage in COVERAGES {
            for cage in CAGES {
                for tolerance in TOLERANCES {
                    if tolerance != tolerance_of(coverage, tolerance) {
                        continue;
                    }
                    // Each of the two words in turn.
                    frames += 1;
                    let bits = [24, 32][frames % 2];
                    let options = options(coverage, cage, tolerance, bits);
                    let (wrong, counts) = round_trip(&graph, &camera, &options, 150);
                    let at = format!("{name}, {coverage:?}, {cage:?}, {tolerance}, {bits}");
                    assert_eq!(wrong, None, "{at}");
                    for (block, rows) in counts {
                        *sums.entry(block).or_default() += rows;
                    }
                }
            }
        }
    }
    assert!(PROVEN.load(Ordering::Relaxed) > 1000);
    // None is there that nothing came to.
    for (block, rows) in sums {
        assert!(rows > 0, "{block} has no rows anywhere");
    }
}

/// Wide words too, and a level of detail.
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
            let (wrong, _) = round_trip(&graph, &camera, &options, 100);
            assert_eq!(wrong, None, "{coverage:?}, {lod_px}");
        }
    }
}

/// Rows by block of all scenes.
fn rows_of_all_scenes(options: &SetupOptions) -> BTreeMap<String, usize> {
    let mut sums: BTreeMap<String, usize> = BTreeMap::new();
    for (name, graph, camera) in scenes() {
        let (wrong, counts) = round_trip(&graph, &camera, options, 400);
        assert_eq!(wrong, None, "{name}");
        for (block, rows) in counts {
            *sums.entry(block).or_default() += rows;
        }
    }
    sums
}

/// Blocks that frames must come to have rows; what a rule does not have has none.
#[test]
fn blocks_have_rows_where_they_should() {
    let words = |text: &'static str| text.split(' ').collect::<Vec<_>>();
    let always = words(
        "filled centre octant_order vertex_pool child_corners child_span border_clip bisector_clip near_node half_clip \
         quadrants node_choice fill_update detail_depth size_limit size_clip",
    );
    let of_change = words(
        "change_depth to_screen_divide margin_grow size_screen border_screen bisector_screen",
    );
    let of_exact = words(
        "child_planes plane_quadrant margin_gap cube_planes cube_front plane_side plane_cover",
    );
    let of_blending = words("blend_way blend_shares blend_counts blend_weight blend_sample");
    let of_centres = |changes| match changes {
        true => words("cage_centre centre_sample"),
        false => words("cage_centre centre_half"),
    };
    for coverage in COVERAGES {
        for (cage, tolerance) in CAGES.into_iter().zip([0.125, 0.0]) {
            let counts = rows_of_all_scenes(&options(coverage, cage, tolerance, 32));
            let has = |blocks: &[&str], expected: bool| {
                for block in blocks {
                    let rows = counts[*block];
                    assert_eq!(rows > 0, expected, "{coverage:?} {tolerance} {block}");
                }
            };
            let exact = coverage.draws_outlines();
            let changes = !exact && tolerance > 0.0;
            has(&of_blending, coverage == Coverage::Alpha);
            has(&always, true);
            has(&of_change, changes);
            has(&of_exact, exact);
            if coverage != Coverage::Any {
                has(&of_centres(changes), !exact);
            }
        }
    }
}

/// One wrong bit in the last row of a file is detected.
#[test]
fn a_wrong_bit_is_found() {
    let exact = options(Coverage::Exact, CageKind::Corners, 0.0, 24);
    let alpha = options(Coverage::Alpha, CageKind::Frame, 0.0, 24);
    for (options, block, side) in [
        (&exact, "vertex_pool", "out"),
        (&exact, "centre", "in"),
        (&exact, "node_choice", "out"),
        (&alpha, "blend_way", "out"),
        (&alpha, "blend_shares", "out"),
        (&alpha, "blend_counts", "out"),
        (&alpha, "blend_weight", "out"),
        (&alpha, "blend_sample", "out"),
    ] {
        let (_, graph, camera) = scenes().swap_remove(0);
        let setup = setup(&graph, &camera, options);
        let (_shelter, folder, _) = written(&graph.view(), &setup, 20);
        assert_eq!(replay_folder(&folder).0, None);
        let path = folder.join(format!("{block}.jsonl"));
        let text = fs::read_to_string(&path).unwrap();
        let (first, last) = text.trim_end().rsplit_once('\n').unwrap();
        let mut row: Value = serde_json::from_str(last).unwrap();
        let mut digits = row[side].as_str().unwrap().to_owned();
        let digit = digits.pop().unwrap().to_digit(16).unwrap();
        digits.push(char::from_digit(digit ^ 2, 16).unwrap());
        row[side] = digits.into();
        fs::write(&path, format!("{first}\n{row}\n")).unwrap();
        let (wrong, _) = replay_folder(&folder);
        assert!(wrong.is_some_and(|w| w.starts_with(block)), "{block}");
    }
}
