//! Stage C with bricks: nodes two levels above the finest voxels in two words, with the voxels below them.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use shiftvox::graph::{Graph, LinkedGraph, NodeLayout, vxg};
use tempfile::TempDir;

use super::faults::{Fault, faults_are_found};
use super::frames::{linked_graphs, random_views};
use super::machines::{STAGE_C, STAGE_C_BRICKS, agree, agree_linked};
use super::tools::{is_there, text};
use super::views::{INSIDE, SCENES, TREE, any_view, view_from_within};

/// A tree with solids on each level, which trees of voxels do not have, so also next to voxels in a brick. Its nodes
/// are numbered as they lie side by side.
fn tree_with_larger_solids(depth: u32) -> Graph {
    let mut state = 5u64;
    let mut dice = |most: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut graph = LinkedGraph::new(depth);
    let (mut levels, mut next) = (VecDeque::from([0]), 1);
    while let Some(level) = levels.pop_front() {
        let mask = match level {
            0 => 0xff,
            _ if level == depth || dice(3) == 0 => 0,
            _ => 1 + dice(255),
        };
        let children = std::array::from_fn(|octant| {
            (mask >> octant & 1 != 0).then(|| {
                levels.push_back(level + 1);
                next += 1;
                next - 1
            })
        });
        graph.add_node([40, 90, 160], children);
    }
    graph.build().unwrap()
}

/// That tree in a file.
fn file_of_tree(depth: u32) -> (TempDir, PathBuf) {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("solids.vxg");
    let graph = tree_with_larger_solids(depth);
    assert!(!bricks_of(&graph).is_empty());
    vxg::write(&graph, &file, true).unwrap();
    (shelter, file)
}

/// The nodes that are bricks where lists of children lie side by side.
fn bricks_of(graph: &Graph) -> std::ops::Range<u32> {
    let graph = graph.side_by_side().unwrap();
    NodeLayout::new(&graph.view(), true, true).bricks()
}

/// Faults in what bricks add; the first few in the short set. That voxels are not taken back from the stack at all
/// would not be found: while a brick lies there no other is read, so the registers still have them.
const FAULTS: [Fault; 14] = [
    ("brick_child", "~leaves & ", ""),
    (
        "bricks",
        "r_is_brick ? voxels : {56'd0, mask}",
        "{56'd0, mask}",
    ),
    ("bricks", "- first_brick + second", "- first_brick"),
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
];
const SHORT: usize = 3;

fn small_view(file: &Path) -> [&str; 7] {
    ["--size", "9x8", "--lod", "0", "--view", "iso", text(file)]
}

#[test]
fn a_fault_of_bricks_is_found() {
    let (_shelter, file) = file_of_tree(3);
    faults_are_found(&STAGE_C_BRICKS, &small_view(&file), &FAULTS[..SHORT]);
}

#[test]
#[ignore = "takes a minute"]
fn more_faults_of_bricks_are_found() {
    let (_shelter, file) = file_of_tree(3);
    faults_are_found(&STAGE_C_BRICKS, &small_view(&file), &FAULTS[SHORT..]);
}

/// Cycles with bricks stand beside those without.
#[test]
#[ignore = "takes minutes"]
fn bricks_in_many_scenes() {
    if !is_there("verilator") {
        return;
    }
    let tree = [TREE, "--size", "64"];
    let (_shelter, file) = file_of_tree(5);
    let solids = [text(&file), "--size", "64", "--view", "iso"];
    // No brick: less than two levels; the root alone.
    let small = ["gen:random,depth=1,seed=2", "--size", "20"];
    let root = ["gen:random,depth=2,seed=3", "--size", "20"];
    let views = [&tree[..], &INSIDE, &solids, &small, &root];
    for view in views.into_iter().chain(SCENES) {
        let [with, without] = [&STAGE_C_BRICKS, &STAGE_C].map(|machine| agree(machine, view));
        assert_eq!(with.samples, without.samples);
        let is_fewer = with.cycles[0] < without.cycles[0];
        assert!(is_fewer || view == small || view == root, "{view:?}");
    }
}

#[test]
#[ignore = "takes minutes"]
fn bricks_in_a_hundred_random_views_and_a_hundred_from_between_the_voxels() {
    random_views(&STAGE_C_BRICKS, 100, &mut any_view);
    random_views(&STAGE_C_BRICKS, 100, &mut view_from_within);
}

/// Lists that are shared, or lead back, have no bricks: on a machine that can have them, too.
#[test]
#[ignore = "takes minutes"]
fn linked_graphs_have_no_bricks() {
    if !is_there("verilator") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("linked.vxg");
    for (name, depth, nodes) in linked_graphs() {
        let mut graph = LinkedGraph::new(depth);
        for children in nodes {
            graph.add_node([30, 90, 160], children);
        }
        let graph = graph.build().unwrap();
        assert!(bricks_of(&graph).is_empty(), "{name}");
        vxg::write(&graph, &file, true).unwrap();
        let view = [text(&file), "--size", "64", "--view", "iso"];
        let [with, without] = [&STAGE_C_BRICKS, &STAGE_C]
            .map(|machine| agree_linked(machine, &view, Some(&graph.links)));
        assert_eq!(with.cycles, without.cycles, "{name}");
    }
}
