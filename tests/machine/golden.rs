//! Golden pictures: what is drawn today is what was drawn when
//! `tests/golden/hashes.txt` was written, in every build profile and on any
//! number of threads. After a change that is meant to show:
//!
//! ```text
//! SHIFTVOX_BLESS=1 cargo test --release --test machine golden
//! ```
//!
//! and say in the commit why which lines changed.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::scenes::*;
use glam::DVec3;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions as Options,
};
use shiftvox::rays::Rays;
use xxhash_rust::xxh3::Xxh3;

/// One golden picture.
struct Case {
    name: &'static str,
    /// A `gen:` spec, or a file of `tests/data`.
    scene: &'static str,
    /// Eye and target as parts of the object's cube.
    eye: [f64; 3],
    target: [f64; 3],
    fov_degrees: f64,
    size: (u32, u32),
    options: Options,
    oracle: bool,
}

/// The image-order paper's machine.
fn paper() -> Options {
    Options {
        cage: CageKind::Corners,
        tolerance_px: f64::INFINITY,
        ..Options::of(Coverage::Any)
    }
}

/// Down to the leaves.
fn exact() -> Options {
    Options {
        lod_px: 0.0,
        ..Options::default()
    }
}

const OUTSIDE: [f64; 3] = [1.6, -0.7, 1.25];
const MIDDLE: [f64; 3] = [0.5, 0.5, 0.4];

fn case(name: &'static str, scene: &'static str, options: Options) -> Case {
    Case {
        name,
        scene,
        eye: OUTSIDE,
        target: MIDDLE,
        fov_degrees: 60.0,
        size: (96, 96),
        options,
        oracle: false,
    }
}

fn cases() -> Vec<Case> {
    let default = Options::default;
    vec![
        case("terrain-default", "gen:terrain,depth=6", default()),
        case("terrain-paper", "gen:terrain,depth=6", paper()),
        // So few fraction bits that the rounding of midpoints shows.
        case(
            "terrain-paper-coarse-words",
            "gen:terrain,depth=6",
            Options {
                bits: 32,
                frac: Some(6),
                ..paper()
            },
        ),
        // Rays along lattice planes and through corners.
        Case {
            eye: [0.5, -0.5, 0.5],
            target: [0.5; 3],
            fov_degrees: 90.0,
            ..case("menger-ties-exact", "gen:menger,depth=3", exact())
        },
        Case {
            size: (101, 43),
            ..case(
                "terrain-wide-corners",
                "gen:terrain,depth=6",
                Options {
                    cage: CageKind::Corners,
                    ..default()
                },
            )
        },
        case("menger-exact", "gen:menger,depth=3", exact()),
        Case {
            oracle: true,
            ..case("menger-oracle", "gen:menger,depth=3", exact())
        },
        Case {
            eye: [0.35, -0.6, 0.4],
            ..case(
                "menger-center-antialiased-2",
                "gen:menger,depth=3",
                Options {
                    aa_log2: 1,
                    ..Options::of(Coverage::Center)
                },
            )
        },
        Case {
            eye: [0.21, 0.27, 0.83],
            fov_degrees: 110.0,
            ..case(
                "maze-inside-center",
                "gen:maze,depth=6",
                Options::of(Coverage::Center),
            )
        },
        Case {
            eye: [0.5, 0.48, 0.52],
            target: [0.9, 0.7, 0.6],
            fov_degrees: 100.0,
            ..case("shell-inside-exact", "gen:shell,depth=6", exact())
        },
        Case {
            eye: [-0.7, -0.9, 0.6],
            target: [0.3; 3],
            ..case("sierpinski-exact", "gen:sierpinski,depth=9", exact())
        },
        Case {
            eye: [-0.7, -0.9, 0.6],
            target: [0.3; 3],
            ..case(
                "sierpinski-8-any-exact-cage",
                "gen:sierpinski,depth=8",
                Options {
                    tolerance_px: 0.0,
                    ..paper()
                },
            )
        },
        Case {
            size: (40, 40),
            ..case(
                "truss-antialiased-4",
                "gen:truss,depth=6",
                Options {
                    aa_log2: 2,
                    ..default()
                },
            )
        },
        Case {
            size: (57, 120),
            ..case(
                "wires-tall-coarse",
                "gen:wires,depth=6",
                Options {
                    lod_px: 4.0,
                    ..default()
                },
            )
        },
        Case {
            eye: [0.58, -0.05, 0.09],
            target: [0.5, 0.03, 0.04],
            ..case("axes-file-default", "axes.vox", default())
        },
        Case {
            eye: [0.5, -0.6, 0.5],
            ..case("extended-file-paper", "extended.vox", paper())
        },
        Case {
            eye: [-0.9, 1.3, 0.9],
            ..case(
                "sphere-file-32-bits",
                "sphere.vox",
                Options {
                    bits: 32,
                    ..default()
                },
            )
        },
    ]
}

fn graph_of(scene: &str) -> Graph {
    if scene.starts_with("gen:") {
        return graph_of_spec(scene);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(scene);
    graph_of_file(&path).expect(scene)
}

fn set_up(case: &Case, graph: &Graph) -> FrameSetup {
    let (low, side) = cube(graph);
    let camera = Camera {
        eye: low + DVec3::from_array(case.eye) * side,
        target: low + DVec3::from_array(case.target) * side,
        up: DVec3::Z,
        fov_degrees: case.fov_degrees,
        width: case.size.0,
        height: case.size.1,
    };
    FrameSetup::new(&camera, &graph.placement, graph.depth, &case.options)
        .unwrap_or_else(|error| panic!("{}: {error}", case.name))
}

fn draw(case: &Case, graph: &Graph) -> Frame {
    let setup = set_up(case, graph);
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = if case.oracle {
        Rays.render(&graph.view(), &setup, &mut frame)
    } else {
        Machine::default().render(&graph.view(), &setup, &mut frame)
    };
    drawn.unwrap_or_else(|error| panic!("{}: {error}", case.name));
    frame
}

/// XXH3-128 of all voxels, then all nodes, little-endian.
fn hash(frame: &Frame) -> u128 {
    let mut hash = Xxh3::new();
    for number in frame.voxel.iter().flatten() {
        hash.update(&number.to_le_bytes());
    }
    for node in &frame.node {
        hash.update(&node.to_le_bytes());
    }
    hash.digest128()
}

/// All pictures; in a build without optimisation every third, which is enough
/// for what has been seen in full in a release build.
fn some_cases() -> Vec<Case> {
    let step = if cfg!(debug_assertions) { 3 } else { 1 };
    cases().into_iter().step_by(step).collect()
}

/// Draws pictures; one line each: name, hash, samples drawn of all.
fn draw_all(cases: Vec<Case>) -> String {
    let mut graphs = HashMap::new();
    let mut lines = String::new();
    for case in cases {
        let graph = graphs
            .entry(case.scene)
            .or_insert_with(|| graph_of(case.scene));
        let frame = draw(&case, graph);
        let (drawn, all) = (frame.drawn(), frame.node.len());
        assert!(drawn * 30 > all, "{}: {drawn} of {all} drawn", case.name);
        writeln!(lines, "{} {:032x} {drawn}/{all}", case.name, hash(&frame))
            .expect("a string takes all");
    }
    lines
}

fn hashes_file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/hashes.txt")
}

#[test]
fn pictures_are_the_golden_ones() {
    let drawn = draw_all(cases());
    if std::env::var_os("SHIFTVOX_BLESS").is_some() {
        std::fs::write(hashes_file(), &drawn).expect("a file that can be written");
        eprintln!("wrote {}", hashes_file().display());
        return;
    }
    let golden = std::fs::read_to_string(hashes_file())
        .expect("tests/golden/hashes.txt")
        .replace("\r\n", "\n");
    let changed: Vec<String> = drawn
        .lines()
        .filter(|line| !golden.lines().any(|golden| golden == *line))
        .map(|line| format!("now     {line}"))
        .chain(
            golden
                .lines()
                .filter(|line| !drawn.lines().any(|drawn| drawn == *line))
                .map(|line| format!("golden  {line}")),
        )
        .collect();
    assert!(
        changed.is_empty(),
        "these pictures changed; if that is meant, run \
         SHIFTVOX_BLESS=1 cargo test --release --test machine golden\n{}",
        changed.join("\n")
    );
}

#[test]
fn a_machine_draws_alike_whatever_it_drew_before() {
    let mut machine = Machine::default();
    for case in some_cases().iter().filter(|case| !case.oracle) {
        let graph = graph_of(case.scene);
        let fresh = draw(case, &graph);
        let setup = set_up(case, &graph);
        let mut frame = Frame::new(setup.width, setup.height, false);
        // Twice: over an empty frame, and over its own picture.
        for _ in 0..2 {
            machine
                .render(&graph.view(), &setup, &mut frame)
                .expect(case.name);
            assert!(frame == fresh, "{}", case.name);
        }
    }
}

/// Frames that [`RECORDED_SAMPLES`] is of.
const RECORDED_FRAMES: u32 = 400;
/// XXH3-128 of what the image-order paper's rules draw of them, or how they end.
const RECORDED_SAMPLES: u128 = 0x18d0_8acf_1d8c_47b5_7535_f004_11f5_07de;

/// The rules `any` and `center`, at all tolerances, in words of many widths.
/// The counters that were recorded; later ones are not part of the hash.
const RECORDED_COUNTERS: [&str; 14] = [
    "records",
    "subdivided",
    "already_full",
    "hidden_across_bisectors",
    "absent_children",
    "behind_eye",
    "rejected_by_quadtree",
    "changed_to_screen",
    "at_level_bound",
    "solids_drawn",
    "samples_drawn",
    "samples_already_drawn",
    "deepest_stack",
    "overflows",
];

#[test]
fn pictures_by_box_and_centre_are_those_recorded() {
    const SPECS: [&str; 6] = [
        "gen:terrain,depth=6,seed=3",
        "gen:menger,depth=3",
        "gen:sierpinski,depth=7",
        "gen:shell,depth=5",
        "gen:truss,depth=5",
        "gen:wires,depth=5",
    ];
    let graphs = SPECS.map(graph_of);
    let mut dice = Dice::new(5);
    let mut hash = Xxh3::new();
    let mut drawn = 0;
    for _ in 0..RECORDED_FRAMES {
        let graph = &graphs[dice.below(6) as usize];
        let place = PLACES[dice.below(6) as usize];
        let camera = camera_at(place, graph, (40, 31), &mut dice);
        let infinite = f64::INFINITY;
        let options = Options {
            bits: [20, 24, 32, 48, 64, 64][dice.below(6) as usize],
            frac: [None, None, Some(6), Some(12)][dice.below(4) as usize],
            cage: [CageKind::Corners, CageKind::Frame][dice.below(2) as usize],
            tolerance_px: [0.0, 1.0 / 64.0, 0.125, 1.5, infinite][dice.below(5) as usize],
            coverage: [Coverage::Any, Coverage::Center][dice.below(2) as usize],
            lod_px: [0.0, 1.0, 2.5][dice.below(3) as usize],
            aa_log2: dice.below(2),
        };
        let made = FrameSetup::new(&camera, &graph.placement, graph.depth, &options);
        let Ok(setup) = made else {
            hash.update(b"no frame");
            continue;
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let mut machine = Machine::default();
        match machine.render_within(&graph.view(), &setup, &mut frame, 200_000) {
            Ok(Some(mut stats)) => {
                drawn += 1;
                stats.retain(|(name, _)| RECORDED_COUNTERS.contains(name));
                hash.update(&self::hash(&frame).to_le_bytes());
                hash.update(format!("{stats:?}").as_bytes());
            }
            Ok(None) => hash.update(b"too many records"),
            Err(EngineError::Memory(short)) => panic!("{short}"),
            Err(EngineError::Trap(trap)) => {
                // As the message was when this was recorded.
                let advice = "use more bits, fewer fraction bits, or --overflow wrap|saturate";
                hash.update(format!("{trap}; {advice}").as_bytes());
            }
        }
    }
    assert!(drawn * 2 > RECORDED_FRAMES, "{drawn}");
    assert_eq!(
        hash.digest128(),
        RECORDED_SAMPLES,
        "{:#x}",
        hash.digest128()
    );
}
