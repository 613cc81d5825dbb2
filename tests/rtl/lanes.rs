//! Several machines of stage B side by side, each of which draws tiles of the picture: the events of each tile in order,
//! the picture, the cycles, whatever the number of lanes.

use std::fs;

use super::faults::{Fault, faults_are_found};
use super::frames::random_views;
use super::machines::{Machine, agree};
use super::tools::{icarus, is_there, rtl, run, text};
use super::views::{Dice, INSIDE, SCENES, TREE, any_view, view_from_within};

static LANES: [Machine; 4] = [
    Machine::side_by_side(1, 2),
    Machine::side_by_side(2, 2),
    Machine::side_by_side(3, 3),
    Machine::side_by_side(4, 2),
];

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

/// A small frame of four lanes in Icarus Verilog, as it is and with each fault.
#[test]
fn a_fault_in_what_lanes_share_is_found() {
    let view = [
        "gen:menger,depth=1",
        "--size",
        "13x11",
        "--eye",
        "1.5,1.4,1.2",
        "--target",
        "2.9,1.9,1.8",
    ];
    faults_are_found(&LANES[3], &view, &FAULTS);
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
    for machine in &LANES {
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
fn lanes_draw_two_hundred_random_views() {
    for machine in &LANES {
        random_views(machine, 25, &mut |next| with_tiles(any_view, next));
        random_views(machine, 25, &mut |next| with_tiles(view_from_within, next));
    }
}
