//! Faults that somebody might write into a machine: a small frame is not drawn as the reference machine draws it.

use std::fs;

use super::machines::{Expected, Machine, STAGE_A, STAGE_B, STAGE_C};
use super::tools::{icarus, is_there, parameter, rtl, text};

/// File, text, what somebody might have written.
pub(crate) type Fault = (&'static str, &'static str, &'static str);

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
            "parts",
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
pub(crate) fn faults_are_found(machine: &Machine, view: &[&str], faults: &[Fault]) {
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
        let top = machine.testbench();
        let parameters = machine.parameters().into_iter();
        let parameters: Vec<String> = parameters
            .map(|(name, value)| parameter(top, name, value))
            .collect();
        icarus(&[text(modules)], top, &parameters, text(&compiled));
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
}

#[test]
#[ignore = "takes a minute"]
fn more_faults_of_stage_c_are_found() {
    faults_are_found(&STAGE_C, VIEWS_C[2], FAULTS_C[2]);
    faults_are_found(&STAGE_C, VIEWS_C[0], FAULTS_C[0]);
}
