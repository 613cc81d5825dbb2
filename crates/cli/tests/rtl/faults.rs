//! Mistakes in a machine: a small frame is then not drawn as the reference machine draws it.

use std::fs;

use rayon::prelude::*;
use shiftvox::graph::vxg;

use super::frames::tree_with_larger_solids;
use super::machines::{
    Expected, LANES, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, agree_in_icarus,
};
use super::tools::{icarus, rtl, run, text};
use super::views::WITHIN;

/// File, text, mistake.
type Fault = (&'static str, &'static str, &'static str);

/// A small frame that reveals mistakes. `SOLIDS` in a view is a tree with solids on each level.
type Group = (&'static Machine, &'static str, &'static [Fault]);

static TWO_LANES: Machine = Machine::new("stage_c", Some([2, 2, 2]), true);

const SPONGE: &str = "gen:menger,depth=3 --size 5x4 --lod 0.5 --view front";
const SOLIDS: &str = "SOLIDS --size 9x8 --lod 0 --view iso";

/// What connects the blocks; the silhouettes of stage B, for small voxels, cubes about the eye, and an eye on a corner;
/// stage C at a level of detail; what lanes share; two contexts; bricks.
static SHORT: [Group; 8] = [
    (
        &STAGE_A,
        "gen:menger,depth=2 --size 7x8 --view iso",
        &[
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
        ],
    ),
    (
        &STAGE_B,
        SPONGE,
        &[
            ("machine", "c_more <= inner_more", "c_more <= c_more"),
            ("plane_constants", "low[3*i + 2]}", "low[3*i + 1]}"),
            ("image_step", "sample ? no_margin : gap", "gap"),
            ("verdict", "leaf | has_lod_depth & deep", "leaf"),
        ],
    ),
    (
        &STAGE_B,
        WITHIN,
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
    ),
    (
        &STAGE_B,
        "gen:random,depth=2,seed=1 --size 12x9 --fov 100 --eye 2,1,2 --target 2.4,3.1,1.3",
        &[
            (
                "silhouettes",
                ".before_eye(t_w_min > 0)",
                ".before_eye(1'b1)",
            ),
            ("plane_side", "none ? 2'd3", "none ? 2'd0"),
        ],
    ),
    (
        &STAGE_C,
        SPONGE,
        &[
            ("steps", "draws <= deep", "draws <= 0"),
            (
                "parts",
                "state == OBJECT | state == CHILD",
                "state == CHILD",
            ),
            ("silhouettes", "looks & coverage == 2", "looks"),
        ],
    ),
    (
        &LANES[3],
        WITHIN,
        &[
            ("arbiter", "waiting[i] | ~waiting[j]", "1'b1"),
            ("arbiter", "first & {N{enable}}", "first"),
            ("shared_cache", "on_its_way = 1;", "on_its_way = 0;"),
            ("shared_cache", "& place == filled", "& place == 0"),
            ("shared_cache", "waits ? wanted", "waits ? at[2:0]"),
            ("lanes", "last_fill ? kinds >> 1 : kinds", "kinds"),
            (
                "machine",
                "fill_place = TILE_WORDS + level",
                "fill_place = TILE_WORDS",
            ),
            (
                "machine",
                "PIXEL: if (pixel_taken) mark_sample",
                "PIXEL: mark_sample",
            ),
        ],
    ),
    (&TWO_LANES, WITHIN, &[]),
    (
        &STAGE_C_BRICKS,
        SOLIDS,
        &[
            ("brick_child", "~leaves & ", ""),
            (
                "bricks",
                "r_is_brick ? voxels : {56'd0, mask}",
                "{56'd0, mask}",
            ),
            ("bricks", "- first_brick + second", "- first_brick"),
        ],
    ),
];

/// Scattered voxels, and fill words, on stage C; the turns of contexts; bricks. If voxels were never taken back from the
/// stack, no view would reveal it: no other brick is read while one lies there, so the registers still have them.
static LONG: [Group; 5] = [
    (
        &STAGE_C,
        "gen:random,depth=3,seed=1 --size 9x7 --fov 70 --eye 9,2.3,5.1 --target 2.4,3.1,1.3",
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
    ),
    (
        &STAGE_C,
        "gen:menger,depth=2 --size 11x14 --view iso",
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
    ),
    (
        &TWO_LANES,
        WITHIN,
        &[
            ("contexts", "state == NODE ? LOOK : state", "state"),
            (
                "contexts",
                "asks_node | runs : asks_node",
                "asks_node : asks_node",
            ),
            (
                "contexts",
                "wanted_by[running] <= wanted",
                "wanted_by[running] <= 0",
            ),
            (
                "contexts",
                "& ~(looks_at_answer ? runs : {CONTEXTS{1'b0}})",
                "",
            ),
            ("contexts", "(begun | start) & ~runs", "begun | start"),
            ("contexts", "state == ATTRIBUTE\n", "1'b0\n"),
            (
                "machine",
                "fill_address} << CONTEXT_LOG2 | running",
                "fill_address} << CONTEXT_LOG2",
            ),
            ("machine", "waiting <= kept_of_next[KEPT +: WAITING];", ""),
            ("joined_fill", "is_written <= 1;", ""),
            ("silhouette", "{a, b, of_divided, here} <= kept[next];", ""),
        ],
    ),
    (
        &LANES[6],
        "gen:random,depth=4,seed=5 --size 24x20 --view iso",
        &[
            ("arbiter", "waiting[i] | ~waiting[j]", "1'b1"),
            ("stage", "r_quad_x, r_quad_y, ", ""),
            ("stage", "r_min, r_max, ", "r_min, "),
            ("stage", "middle, leaves, ", "middle, "),
        ],
    ),
    (
        &STAGE_C_BRICKS,
        SOLIDS,
        &[
            ("bricks", "- first_brick", ""),
            (
                "bricks",
                "if (state == SOLID) second <= 0;\n    else if",
                "if",
            ),
            (
                "bricks",
                "voxels <= p_voxels;",
                "voxels <= {56'd0, p_mask};",
            ),
            (
                "bricks",
                "first_voxel <= p_first_voxel;",
                "first_voxel <= p_first;",
            ),
            (
                "bricks",
                "p_is_brick ? children_in(p_voxels)",
                "p_is_brick ? 8'hff",
            ),
            ("bricks", ".octant(c_octant)", ".octant(octant)"),
            ("bricks", "first_voxel + voxels_before", "first_voxel"),
            (
                "bricks",
                "node_word[63:56], children_in",
                "8'd0, children_in",
            ),
            ("bricks", "c_level + 1'b1 == depth", "c_level == depth"),
            ("brick_child", "i < 7", "i < 3"),
            ("parts", "if (in_brick) go_down;\n  else", ""),
        ],
    ),
];

/// Draws a small frame in Icarus Verilog: as it is, and with each mistake.
fn faults_are_found(&(machine, view, faults): &Group) {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("solids.vxg");
    vxg::write(&tree_with_larger_solids(3), &file, true).unwrap();
    let expected = Expected::new(machine, &view.replace("SOLIDS", text(&file)), None);
    let modules = shelter.path().join("modules");
    fs::create_dir(&modules).unwrap();
    let compiled = shelter.path().join("frame.vvp");
    for &(file, right, fault) in [("", "", "")].iter().chain(faults) {
        // Of files in several folders the first counts.
        let mut found = 1;
        for folder in machine.folders().iter().rev() {
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
        icarus(
            &[text(&modules)],
            machine.testbench(),
            &machine.parameters(),
            &compiled,
        );
        let drawn = agree_in_icarus(&expected, &compiled, 2 * expected.cycles);
        assert_eq!(drawn.is_ok(), file.is_empty(), "{file}: {fault}: {drawn:?}");
    }
}

#[test]
fn faults_of_every_machine_are_found() {
    SHORT.par_iter().for_each(faults_are_found);
}

#[test]
#[ignore = "takes minutes"]
fn more_faults_are_found() {
    LONG.par_iter().for_each(faults_are_found);
}

#[test]
fn an_arbiter_serves_who_came_first() {
    let shelter = tempfile::tempdir().unwrap();
    let [module, compiled] = ["arbiter.v", "tb.vvp"].map(|name| shelter.path().join(name));
    let source = fs::read_to_string(rtl().join("machine/arbiter.v")).unwrap();
    for (right, fault) in [
        ("", ""),
        ("waiting[i] | ~waiting[j]", "1'b1"),
        ("waiting[j] ? lower_first[i*N + j]", "waiting[j] ? 1'b1"),
        ("request & ~grant", "request"),
        ("first & {N{enable}}", "request & {N{enable}}"),
    ] {
        let times = usize::from(!right.is_empty());
        assert!(
            right.is_empty() || source.matches(right).count() == 1,
            "{right}"
        );
        fs::write(&module, source.replacen(right, fault, times)).unwrap();
        icarus(&[text(shelter.path())], "arbiter_tb", &[], &compiled);
        let printed = run(shelter.path(), "vvp", &["-n", text(&compiled)]);
        assert_eq!(
            printed.trim() == "0 wrong",
            right.is_empty(),
            "{fault}: {printed}"
        );
    }
}
