//! Whole frames in Verilog against the machine: every event with all its bits, in order; the picture; the cycles.

use std::collections::BTreeMap;
use std::fs;

use shiftvox::graph::{LinkedGraph, vxg};

use super::machines::{Expected, Machine, STAGE_A, STAGE_B, STAGE_C, agree, agree_linked};
use super::tools::{is_there, rtl, run, text};

pub(crate) const TREE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/tree.vox");
/// In the middle of the sponge's hollow, looking at a corner of it.
const INSIDE: [&str; 7] = [
    "gen:menger,depth=3",
    "--size",
    "64",
    "--eye",
    "13.4,12.7,13.5",
    "--target",
    "20,16,11",
];

#[test]
fn the_bundled_tree_has_the_machines_events_picture_and_cycles() {
    if !is_there("verilator") {
        return;
    }
    for (machine, events) in [
        (&STAGE_A, 1_000_000),
        (&STAGE_B, 250_000),
        (&STAGE_C, 100_000),
    ] {
        let agreement = agree(machine, &[TREE, "--size", "64"]);
        assert!(agreement.events > events && agreement.samples > 1000);
    }
}

#[test]
fn an_eye_inside_too() {
    if !is_there("verilator") {
        return;
    }
    agree(&STAGE_A, &INSIDE);
    agree(&STAGE_B, &INSIDE);
    agree(&STAGE_C, &INSIDE);
}

/// File, text, what somebody might have written.
type Fault = (&'static str, &'static str, &'static str);

/// Faults in what connects the blocks.
const FAULTS_A: [Fault; 9] = [
    ("machine", "r_node : first + count", "r_node : first"),
    ("machine", "marked <= after", "marked <= vector"),
    (
        "children",
        "for (place = 7; place >= 0; place = place - 1)",
        "for (place = 0; place < 8; place = place + 1)",
    ),
    ("cache", "valid[{set, way}] <= 1", "valid[{set, way}] <= 0"),
    ("memory", "<= data_in", "<= ~data_in"),
    ("verdict", "one & ~before_near", "~before_near"),
    ("image_step", ".low_half_x(half[0])", ".low_half_x(half[2])"),
    ("to_screen", "(column - 4)", "(column - 3)"),
    ("frame_constants", "vector[3 + i]", "vector[4 + i]"),
];
/// And in what stage B has of its own: small voxels, cubes about the eye, an eye on a corner of some.
const FAULTS_B: [&[Fault]; 3] = [
    &[
        ("machine", "c_more <= inner_more", "c_more <= c_more"),
        ("plane_constants", "low[3*i + 2]}", "low[3*i + 1]}"),
        ("image_step", "sample ? no_margin : gap", "gap"),
        ("verdict", "leaf | has_lod_depth & deep", "leaf"),
    ],
    &[
        ("silhouettes", "depth - r_level - 1'b1", "depth - r_level"),
        ("silhouettes", "whole & next_in >= whole_level", "whole"),
        ("silhouettes", ".positive(positive)", ".positive(1'b0)"),
        ("silhouette_steps", "divided - 1'b1 == back_level", "1'b1"),
        ("silhouette", "known ? of_divided : inner", "inner"),
        ("silhouette", "sides <= sides_above", "sides <= sides"),
        (
            "silhouette",
            "wanted <= front_side",
            "wanted <= ~front_side",
        ),
    ],
    &[
        (
            "silhouettes",
            ".before_eye(t_w_min > 0)",
            ".before_eye(1'b1)",
        ),
        ("plane_side", "none ? 2'd3", "none ? 2'd0"),
    ],
];

/// And of stage C: scattered voxels, and level of detail.
const FAULTS_C: [&[Fault]; 3] = [
    &[
        ("parts", "asked_x = r_quad_x >> above", "asked_x = r_quad_x"),
        ("parts", "state == ORDER ? order_now : order", "order"),
        ("parts", "leaves[octant]", "mask[octant]"),
        ("parts", "first <= p_first", "first <= first"),
        ("parts", "r_inside <= p_inside", "r_inside <= 1"),
        ("parts", "one << octant_bit << 1", "one << octant_bit"),
        (
            "steps",
            "if (left != 0) state",
            "if (left_there != 0) state",
        ),
        ("steps", "r_w <= parent_w", "r_w <= r_w"),
        ("plane_whole", "doubled >>> 1", "doubled >> 1"),
        (
            "parent_planes",
            "y_k (.plane(edge_y)",
            "y_k (.plane(edge_x)",
        ),
        ("parent_cage", "child[k*W +: W] << 1", "child[k*W +: W]"),
        ("grown_cage", "edge_k >>> 1", "edge_k >> 1"),
        ("silhouette_steps", "if (~looks) begin", "begin"),
        ("silhouettes", "known & coverage != 0", "known"),
    ],
    &[
        ("steps", "draws <= deep", "draws <= 0"),
        (
            "parts",
            "state == OBJECT | state == CHILD",
            "state == CHILD",
        ),
        ("silhouettes", "looks & coverage == 2", "looks"),
    ],
    &[
        ("joined_fill", "| state == CHILD & judged", ""),
        ("joined_fill", "is_written <= joined", "is_written <= 0"),
        ("joined_fill", "== 1 ? quarter", "== 1 ? around"),
        (
            "joined_fill",
            "of_word[3], of_word[1]",
            "of_word[1], of_word[3]",
        ),
        ("joined_fill", "? &written", "? written[0]"),
        ("joined_fill", "c_quad_x <= c_quad_x >> 2", "c_quad_x <= 0"),
        ("silhouette_steps", "known ? ATTRIBUTE : DRAWN", "DRAWN"),
        ("machine", "if (known) choose;\n            else", ""),
    ],
];

/// A small frame, in Icarus Verilog: as it is, and with each fault.
fn faults_are_found(machine: &Machine, view: &[&str], faults: &[Fault]) {
    if !is_there("iverilog") {
        return;
    }
    let expected = Expected::new(machine, view);
    let most = format!("+most={}", 2 * expected.cycles);
    let shelter = tempfile::tempdir().unwrap();
    let modules = shelter.path();
    let compiled = modules.join("frame.vvp");
    let nothing = ("", "", "");
    for &(file, right, fault) in [nothing].iter().chain(faults) {
        // Of files in several folders the first counts.
        let mut found = 1;
        for folder in machine.folders.iter().rev() {
            for path in fs::read_dir(rtl().join(folder)).unwrap() {
                let path = path.unwrap().path();
                let mut source = fs::read_to_string(&path).unwrap();
                if path.file_stem().unwrap() == file {
                    found = source.matches(right).count();
                    source = source.replace(right, fault);
                }
                fs::write(modules.join(path.file_name().unwrap()), source).unwrap();
            }
        }
        assert_eq!(found, 1, "{file}: {right}");
        let arguments = "-g2012 -I . -s frame_tb tb/frame_tb.v -o";
        let mut arguments: Vec<&str> = arguments.split(' ').collect();
        let modules = text(modules);
        arguments.extend([text(&compiled), "-I", modules, "-y", modules]);
        run(&rtl(), "iverilog", &arguments);
        let compared = expected.compare(&["vvp", "-n", text(&compiled), &most]);
        let is_right = compared
            .as_ref()
            .is_ok_and(|agreement| agreement.cycles[0] == agreement.cycles[1]);
        assert_eq!(is_right, file.is_empty(), "{file}: {fault}: {compared:?}");
    }
}

#[test]
fn a_fault_between_the_blocks_is_found() {
    let view = ["gen:menger,depth=2", "--size", "7x8", "--view", "iso"];
    faults_are_found(&STAGE_A, &view, &FAULTS_A);
}

#[test]
fn a_fault_of_stage_b_is_found() {
    let views: [&[&str]; 3] = [
        &[
            "gen:menger,depth=3",
            "--size",
            "5x4",
            "--lod",
            "0.5",
            "--view",
            "front",
        ],
        &[
            "gen:menger,depth=1",
            "--size",
            "13x11",
            "--eye",
            "1.5,1.4,1.2",
            "--target",
            "2.9,1.9,1.8",
        ],
        &[
            "gen:random,depth=2,seed=1",
            "--size",
            "12x9",
            "--fov",
            "100",
            "--eye",
            "2,1,2",
            "--target",
            "2.4,3.1,1.3",
        ],
    ];
    for (view, faults) in views.into_iter().zip(FAULTS_B) {
        faults_are_found(&STAGE_B, view, faults);
    }
}

/// Views that find the faults of stage C.
const VIEWS_C: [&[&str]; 3] = [
    &[
        "gen:random,depth=3,seed=1",
        "--size",
        "9x7",
        "--fov",
        "70",
        "--eye",
        "9,2.3,5.1",
        "--target",
        "2.4,3.1,1.3",
    ],
    &[
        "gen:menger,depth=3",
        "--size",
        "5x4",
        "--lod",
        "0.5",
        "--view",
        "front",
    ],
    &["gen:menger,depth=2", "--size", "11x14", "--view", "iso"],
];

#[test]
fn a_fault_of_stage_c_is_found() {
    faults_are_found(&STAGE_C, VIEWS_C[1], FAULTS_C[1]);
    faults_are_found(&STAGE_C, VIEWS_C[2], FAULTS_C[2]);
}

#[test]
#[ignore = "takes half a minute"]
fn a_fault_on_the_way_back_is_found() {
    faults_are_found(&STAGE_C, VIEWS_C[0], FAULTS_C[0]);
}

/// Synthesis takes all machines: no latch, no loop, no signal with two drivers.
#[test]
#[ignore = "takes minutes"]
fn yosys_takes_the_machines() {
    if !is_there("yosys") {
        return;
    }
    for machine in [&STAGE_A, &STAGE_B, &STAGE_C] {
        // Of modules in several folders the first counts.
        let mut files = BTreeMap::new();
        for folder in machine.folders {
            for path in fs::read_dir(rtl().join(folder)).unwrap() {
                let name = path.unwrap().file_name().into_string().unwrap();
                if name.ends_with(".v") {
                    files
                        .entry(name.clone())
                        .or_insert(format!("{folder}/{name}"));
                }
            }
        }
        let files: Vec<String> = files.into_values().collect();
        let (files, folders) = (files.join(" "), machine.folders.join(" -I"));
        let script = format!(
            "read_verilog -sv -I. -I{folders} {files}; hierarchy -check -top machine; proc; check -assert; \
             select -assert-none t:$dlatch"
        );
        run(&rtl(), "yosys", &["-q", "-p", &script]);
    }
}

/// The bundled tree, a sponge, terrain, and an eye within them; sizes that fill the picture's quadtree and that do not.
#[test]
#[ignore = "takes minutes"]
fn many_scenes() {
    if !is_there("verilator") {
        return;
    }
    let views: [&[&str]; 6] = [
        &[TREE, "--size", "128"],
        &[
            TREE,
            "--size",
            "200x90",
            "--azimuth",
            "80",
            "--elevation",
            "-20",
        ],
        &["gen:menger,depth=4", "--size", "96", "--view", "iso"],
        &[
            "gen:terrain,depth=7",
            "--size",
            "128x64",
            "--lod",
            "0",
            "--view",
            "right",
        ],
        &[
            "gen:terrain,depth=6",
            "--size",
            "64",
            "--eye",
            "20.2,30.7,25.1",
            "--target",
            "40,40,10",
        ],
        &[
            "gen:menger,depth=3",
            "--size",
            "50x70",
            "--lod",
            "4",
            "--zoom",
            "6",
        ],
    ];
    for machine in [&STAGE_A, &STAGE_B, &STAGE_C] {
        for view in views {
            agree(machine, view);
        }
    }
}

/// A graph as this file writes it: its name, its depth, and each node's children by octant.
type Drawn = (&'static str, u32, Vec<[Option<u32>; 8]>);

/// Graphs with shared nodes and with cycles.
fn linked_graphs() -> Vec<Drawn> {
    let no = None;
    let [a, b, c, d] = [Some(0), Some(1), Some(2), Some(3)];
    vec![
        (
            "one node, four times below itself",
            6,
            vec![[a, no, no, a, no, a, a, no]],
        ),
        (
            "two nodes in turns, and a solid",
            7,
            vec![
                [b, no, no, a, no, c, b, no],
                [no, a, b, no, no, no, no, a],
                [no; 8],
            ],
        ),
        (
            "one solid, shared by three, one of them shared by the root",
            3,
            vec![
                [b, c, no, b, b, no, c, b],
                [d, no, d, no, no, d, no, d],
                [no, d, b, no, d, no, no, no],
                [no; 8],
            ],
        ),
    ]
}

/// The hardware draws linked graphs from a memory in which lists of children lie side by side, shared ones once.
#[test]
#[ignore = "takes minutes"]
fn linked_and_cyclic_graphs() {
    if !is_there("verilator") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    for (name, depth, nodes) in linked_graphs() {
        let mut graph = LinkedGraph::new(depth);
        for (at, &children) in nodes.iter().enumerate() {
            graph.add_node([40 * at as u8 + 30, 90, 160], children);
        }
        let graph = graph.build().unwrap();
        let file = shelter.path().join("linked.vxg");
        vxg::write(&graph, &file, true).unwrap();
        for view in [
            &["--size", "64", "--view", "iso"][..],
            &["--size", "40x60", "--azimuth", "130", "--lod", "0"],
            &["--size", "33", "--view", "right", "--zoom", "5"],
        ] {
            let view = [&[text(&file)], view].concat();
            for machine in [&STAGE_A, &STAGE_B, &STAGE_C] {
                eprint!("{name}: ");
                let agreement = agree_linked(machine, &view, Some(&graph.links));
                assert!(agreement.samples > 0, "{name}");
            }
        }
    }
}

/// A number below another, from the seed.
type Dice<'d> = &'d mut dyn FnMut(u64) -> u64;

/// Scattered voxels by seed, from all sides and from near by, at random sizes and levels of detail.
fn any_view(next: Dice<'_>) -> Vec<String> {
    let scene = format!("gen:random,depth={},seed={}", 2 + next(4), next(1000));
    let size = format!("{}x{}", 1 + next(60), 1 + next(60));
    let lod = ["0", "1", "3"][next(3) as usize];
    let (azimuth, elevation, zoom) = (next(360), next(180) as i64 - 90, 1 + next(8));
    let camera = format!("--azimuth={azimuth} --elevation={elevation} --zoom={zoom}");
    words(&format!("{scene} --size {size} --lod {lod} {camera}"))
}

/// From between them; every other eye has a voxel's corner for its place.
fn view_from_within(next: Dice<'_>) -> Vec<String> {
    let (depth, on_corner) = (2 + next(3), next(2) == 0);
    let scene = format!("gen:random,depth={depth},seed={}", next(1000));
    let size = format!("{}x{}", 1 + next(30), 1 + next(30));
    let mut place = |tenths: u64| {
        let mut coordinate = || next(10 << depth) / tenths * tenths;
        let [x, y, z] = [(); 3].map(|()| coordinate() as f64 / 10.0);
        format!("{x:.1},{y:.1},{z:.1}")
    };
    let (eye, target) = (place(if on_corner { 10 } else { 1 }), place(1));
    let fov = 40 + next(100);
    words(&format!(
        "{scene} --size {size} --fov {fov} --eye {eye} --target {target}5"
    ))
}

fn words(line: &str) -> Vec<String> {
    line.split(' ').map(str::to_owned).collect()
}

/// Two hundred views by seed.
fn random_views(machine: &Machine, make: &mut dyn FnMut(Dice<'_>) -> Vec<String>) {
    if !is_there("verilator") {
        return;
    }
    let mut state = 1u64;
    let mut next = |most: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut unlike = 0;
    for at in 0..200 {
        let view = make(&mut next);
        let view: Vec<&str> = view.iter().map(String::as_str).collect();
        let agreement = Expected::new(machine, &view)
            .compare(&[machine.simulator()])
            .unwrap_or_else(|error| panic!("{} {at} {view:?}: {error}", machine.name));
        let [simulated, model] = agreement.cycles;
        if simulated != model {
            eprintln!("{at} {view:?}: {simulated} cycles, {model} in the model");
            unlike += 1;
        }
    }
    let name = machine.name;
    eprintln!("{name}: 200 random views: all events and pictures equal; cycles unlike in {unlike}");
    assert_eq!(unlike, 0);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views() {
    random_views(&STAGE_A, &mut any_view);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views_of_stage_b() {
    random_views(&STAGE_B, &mut any_view);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views_of_stage_c() {
    random_views(&STAGE_C, &mut any_view);
}

/// Where planes are degenerate, and cubes reach behind the eye.
#[test]
#[ignore = "takes minutes"]
fn two_hundred_wide_views_of_stage_b_from_between_the_voxels() {
    random_views(&STAGE_B, &mut view_from_within);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_wide_views_of_stage_c_from_between_the_voxels() {
    random_views(&STAGE_C, &mut view_from_within);
}
