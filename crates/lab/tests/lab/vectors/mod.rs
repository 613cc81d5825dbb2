//! Test vectors, replayed: every row of every block computed again from the
//! files alone, in plain integers, by `SPEC.md` and the manifest.
//! Nothing here uses the machine.

mod mutants;
mod replay;
mod rows;
mod testbench;
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
use self::rows::{Row, constants_of, read};
use super::common::{camera, octree, setup, sierpinski, solid, tolerance_of};

/// Rows that are not what their block gives, and the first of them; and rows by block.
fn replay_folder(folder: &Path) -> (Option<String>, BTreeMap<String, usize>) {
    let text = fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(manifest["schema"], 5);
    let constants = constants_of(&manifest);
    let mut files = [
        "manifest.json",
        "README.txt",
        "parameters.vh",
        "frame.constants.hex",
    ]
    .map(str::to_owned)
    .into_iter()
    .collect::<BTreeSet<_>>();
    // Not of a graph that lists its children.
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
        if rows == 0 {
            assert!(!block["reason"].as_str().unwrap().is_empty(), "{name}");
            assert!(block["stimulus"]["file"].is_null() && block["expected"]["file"].is_null());
            continue;
        }
        assert!(block["reason"].is_null());
        for ports in ["stimulus", "expected"] {
            files.insert(block[ports]["file"].as_str().unwrap().to_owned());
        }
        files.insert(format!("{name}_tb.v"));
        let stimulus = read(folder, &block["stimulus"]);
        let expected = read(folder, &block["expected"]);
        let frame_rows = block["frame_rows"].as_u64().unwrap() as usize;
        check_ranges(&block["stimulus"], &stimulus[..frame_rows], name);
        check_ranges(&block["expected"], &expected[..frame_rows], name);
        assert_eq!((stimulus.len(), expected.len()), (rows, rows), "{name}");
        for (at, (into, out)) in stimulus.iter().zip(&expected).enumerate() {
            let found = replay(name, into, &constants);
            if found != out.values && wrong.is_none() {
                let (values, out) = (&into.values, &out.values);
                wrong = Some(format!(
                    "{name}, row {at}: {values:?} -> {out:?}, not {found:?}"
                ));
            }
        }
    }
    let turns = &manifest["turns"];
    if turns["reason"].is_null() {
        for ports in ["events", "records"] {
            files.insert(turns[ports]["file"].as_str().unwrap().to_owned());
        }
    }
    let there: BTreeSet<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(there, files);
    (wrong, counts)
}

/// Fields whose range was compared with a proof.
static PROVEN: AtomicUsize = AtomicUsize::new(0);

/// The manifest's ranges are those of the frame's rows, and within what is proven of them.
fn check_ranges(ports: &Value, rows: &[Row], block: &str) {
    for (at, field) in ports["fields"].as_array().unwrap().iter().enumerate() {
        let values = || rows.iter().map(|row| row.values[at]);
        let (least, greatest) = (values().min(), values().max());
        let name = format!("{block}, {}", field["name"]);
        let seen = |end: usize| field["seen"][end].as_i64().map(i128::from);
        if rows.is_empty() {
            continue;
        }
        assert_eq!((seen(0), seen(1)), (least, greatest), "{name}");
        let (Some(bits), Some(least), Some(greatest)) =
            (field["proven_bits"].as_u64(), least, greatest)
        else {
            continue;
        };
        let most = match least < 0 {
            true => 1i128 << (bits - 1),
            false => 1i128 << bits,
        };
        assert!(
            -most <= least && greatest < most,
            "{name}: {least} to {greatest}, {bits} bits"
        );
        PROVEN.fetch_add(1, Ordering::Relaxed);
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
    let always = [
        "filled",
        "centre",
        "octant_order",
        "vertex_pool",
        "child_corners",
        "child_span",
        "border_clip",
        "bisector_clip",
        "near_node",
        "half_clip",
        "quadrants",
        "node_choice",
        "fill_update",
        "detail_depth",
        "size_limit",
        "size_clip",
    ];
    let of_change = ["change_depth", "to_screen_divide", "margin_grow"];
    let of_exact = [
        "child_planes",
        "plane_quadrant",
        "margin_gap",
        "cube_planes",
        "cube_front",
        "plane_side",
        "plane_cover",
    ];
    let of_blending = [
        "blend_way",
        "blend_shares",
        "blend_counts",
        "blend_weight",
        "blend_sample",
    ];
    let of_samples = ["size_screen", "border_screen", "bisector_screen"];
    let of_centres = |changes| match changes {
        true => ["cage_centre", "centre_sample"],
        false => ["cage_centre", "centre_half"],
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
            has(&of_samples, changes);
            has(&of_exact, exact);
            if coverage != Coverage::Any {
                has(&of_centres(changes), !exact);
            }
        }
    }
}

/// A file with one bit changed is found out.
#[test]
fn a_wrong_bit_is_found() {
    let files = ["vertex_pool.out", "centre.in", "node_choice.out"];
    changed_bits_are_found(
        &options(Coverage::Exact, CageKind::Corners, 0.0, 24),
        &files,
    );
}

/// Of the blocks that blend too.
#[test]
fn a_wrong_bit_of_blending_is_found() {
    let files = [
        "blend_way.out",
        "blend_shares.out",
        "blend_counts.out",
        "blend_weight.out",
        "blend_sample.out",
    ];
    changed_bits_are_found(&options(Coverage::Alpha, CageKind::Frame, 0.0, 24), &files);
}

/// Changes the second lowest bit of the last row of each file, one after the other.
fn changed_bits_are_found(options: &SetupOptions, files: &[&str]) {
    let (_, graph, camera) = scenes().swap_remove(0);
    let setup = setup(&graph, &camera, options);
    let (_shelter, folder, _) = written(&graph.view(), &setup, 20);
    assert_eq!(replay_folder(&folder).0, None);
    for file in files {
        let path = folder.join(format!("{file}.hex"));
        let text = fs::read_to_string(&path).unwrap();
        let last = text
            .trim_end()
            .chars()
            .last()
            .unwrap()
            .to_digit(16)
            .unwrap();
        let digit = char::from_digit(last ^ 2, 16).unwrap();
        let mut broken = text.trim_end().to_owned();
        broken.pop();
        broken.push(digit);
        fs::write(&path, broken + "\n").unwrap();
        let (wrong, _) = replay_folder(&folder);
        let block = file.split('.').next().unwrap();
        assert!(wrong.is_some_and(|w| w.starts_with(block)), "{file}");
        fs::write(&path, text).unwrap();
    }
}
