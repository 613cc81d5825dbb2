//! Machines of stages B and C side by side, which draw tiles of the picture: the events of each tile in order, the
//! picture, the cycles, whatever the number of lanes and of their contexts.

use std::fs;

use super::faults::{Fault, faults_are_found};
use super::frames::random_views;
use super::machines::{Machine, agree, lanes};
use super::tools::{icarus, is_there, rtl, run, text};
use super::views::{Dice, INSIDE, SCENES, TREE, any_view, view_from_within};

static LANES_B: [Machine; 4] = [
    Machine::lanes_of_stage_b(lanes(1, 1, 2)),
    Machine::lanes_of_stage_b(lanes(2, 1, 2)),
    Machine::lanes_of_stage_b(lanes(3, 1, 3)),
    Machine::lanes_of_stage_b(lanes(4, 1, 2)),
];
static LANES_C: [Machine; 7] = [
    Machine::lanes_of_stage_c(lanes(1, 1, 2), false),
    Machine::lanes_of_stage_c(lanes(1, 2, 2), false),
    Machine::lanes_of_stage_c(lanes(1, 4, 2), false),
    Machine::lanes_of_stage_c(lanes(1, 8, 3), false),
    Machine::lanes_of_stage_c(lanes(4, 1, 2), false),
    Machine::lanes_of_stage_c(lanes(2, 4, 2), false),
    Machine::lanes_of_stage_c(lanes(2, 4, 2), true),
];

/// What only a larger view finds, with four contexts: who is next, and more of what each keeps.
const FAULTS_OF_MANY_TURNS: [Fault; 4] = [
    ("arbiter", "waiting[i] | ~waiting[j]", "1'b1"),
    ("stage", "r_quad_x, r_quad_y, ", ""),
    ("stage", "r_min, r_max, ", "r_min, "),
    ("stage", "middle, leaves, ", "middle, "),
];

static SMALL: Machine = Machine::lanes_of_stage_c(lanes(2, 2, 2), true);

/// Faults in what the lanes share, and in what a lane has of a tile.
const FAULTS: [Fault; 8] = [
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
];

/// And in what contexts of a lane add: their turns, and what each has meanwhile.
const FAULTS_OF_CONTEXTS: [Fault; 10] = [
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
];

/// From within a sponge, where tiles have about the same to do.
const WITHIN: [&str; 7] = [
    "gen:menger,depth=1",
    "--size",
    "13x11",
    "--eye",
    "1.5,1.4,1.2",
    "--target",
    "2.9,1.9,1.8",
];

/// Small frames in Icarus Verilog, as they are and with each fault.
#[test]
fn a_fault_in_what_lanes_share_is_found() {
    faults_are_found(&LANES_B[3], &WITHIN, &FAULTS);
}

#[test]
fn contexts_take_turns() {
    faults_are_found(&SMALL, &WITHIN, &[]);
}

#[test]
#[ignore = "takes half a minute"]
fn a_fault_in_the_turns_of_contexts_is_found() {
    faults_are_found(&SMALL, &WITHIN, &FAULTS_OF_CONTEXTS);
    let view = [
        "gen:random,depth=4,seed=5",
        "--size",
        "24x20",
        "--view",
        "iso",
    ];
    faults_are_found(&LANES_C[2], &view, &FAULTS_OF_MANY_TURNS);
}

#[test]
fn an_arbiter_serves_who_came_first() {
    if !is_there("iverilog") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    let (module, compiled) = (
        shelter.path().join("arbiter.v"),
        shelter.path().join("tb.vvp"),
    );
    let source = fs::read_to_string(rtl().join("machine/arbiter.v")).unwrap();
    let faults = [
        ("", ""),
        ("waiting[i] | ~waiting[j]", "1'b1"),
        ("waiting[j] ? lower_first[i*N + j]", "waiting[j] ? 1'b1"),
        ("request & ~grant", "request"),
        ("first & {N{enable}}", "request & {N{enable}}"),
    ];
    for (right, fault) in faults {
        if !right.is_empty() {
            assert_eq!(source.matches(right).count(), 1, "{right}");
        }
        fs::write(
            &module,
            source.replacen(right, fault, usize::from(!right.is_empty())),
        )
        .unwrap();
        let into = text(&compiled);
        icarus(&[text(shelter.path())], "arbiter_tb", &[], into);
        let printed = run(shelter.path(), "vvp", &["-n", into]);
        assert_eq!(
            printed.trim() == "0 wrong",
            right.is_empty(),
            "{fault}: {printed}"
        );
    }
}

#[test]
#[ignore = "takes minutes"]
fn lanes_draw_many_scenes() {
    if !is_there("verilator") {
        return;
    }
    for machine in LANES_B.iter().chain(&LANES_C) {
        for view in SCENES {
            agree(machine, view);
        }
        agree(machine, &[TREE, "--size", "64"]);
        agree(machine, &INSIDE);
    }
}

/// A view that has tiles: more than eight samples across.
fn with_tiles(make: fn(Dice<'_>) -> Vec<String>, next: Dice<'_>) -> Vec<String> {
    loop {
        let view = make(next);
        let size = view.iter().position(|word| word == "--size").unwrap();
        let (width, _) = view[size + 1].split_once('x').unwrap();
        if width.parse::<u32>().unwrap() > 8 {
            return view;
        }
    }
}

#[test]
#[ignore = "takes minutes"]
fn lanes_draw_many_random_views() {
    for machine in LANES_B.iter().chain(&LANES_C) {
        random_views(machine, 25, &mut |next| with_tiles(any_view, next));
        random_views(machine, 25, &mut |next| with_tiles(view_from_within, next));
    }
}
