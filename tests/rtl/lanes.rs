//! Several machines of stage B side by side, each of which draws tiles of the picture: the events of each tile in order,
//! the picture, the cycles, whatever the number of lanes.

use super::frames::{
    Fault, INSIDE, SCENES, TREE, any_view, faults_are_found, random_views, view_from_within,
};
use super::machines::{Machine, agree};
use super::tools::is_there;

static LANES: [Machine; 4] = [
    Machine::side_by_side(1, 2),
    Machine::side_by_side(2, 2),
    Machine::side_by_side(3, 3),
    Machine::side_by_side(4, 2),
];

/// Faults in what the lanes share, and in what a lane has of a tile.
const FAULTS: [Fault; 1] = [
    ("arbiter", "waiting[i] | ~waiting[j]", "1'b1"),
];

#[test]
fn a_small_frame_of_four_lanes_and_faults_in_what_they_share() {
    let view = ["gen:menger,depth=2", "--size", "14x9", "--view", "iso"];
    faults_are_found(&LANES[3], &view, &FAULTS);
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

#[test]
#[ignore = "takes minutes"]
fn lanes_draw_two_hundred_random_views() {
    let large = |view: &mut Vec<String>| view.retain(|word| word != "--size=1x1");
    let _ = large;
    for machine in &LANES {
        random_views(machine, 25, &mut any_view);
        random_views(machine, 25, &mut view_from_within);
    }
}
