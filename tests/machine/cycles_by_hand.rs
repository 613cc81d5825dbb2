//! A tiny scene on simulated hardware, worked out by hand from the rules of `hwmodel::cycles` for each organisation.
//!
//! Three voxels of a cube of 4 x 4 x 4, seen from the front at 4 x 4 samples: the root A has one child B. Its children
//! are the voxels C and D, seen at samples (0, 2) and (0, 3), and E behind D. Every operation is a wire and there is
//! one context, so a visit takes a cycle, and:
//!
//! - one more for each further access at the port of a memory that is read or written several times;
//! - 11 where a line of nodes (A's, which holds all) or of attributes (C's, which holds all) is missed;
//! - 21 where the picture's fill vectors are cleared, 1 + 4 + 16, and 6 for a tile of 2 x 2: root, tile, four samples.
//!
//! With parents on the stack only B is stored, and E is hidden when it is made. Leaf masks save the nodes' reads of C,
//! D and E. Tests for occluded nodes read the fill vectors once more. With joined fill vectors every pair of reads or
//! writes is one. By tiles A is walked four times, and B in one of them.
//!
//! On *sequential* hardware a read takes a cycle more. A silhouette takes one for its planes, and one for each quadrant
//! to which they are moved. The way back from B to A is out of a quadrant and up a level.

use hwmodel::OpClass;
use hwmodel::cycles::{Hardware, Organisation, Recorder, START, StackHolds};
use shiftvox::frame::Frame;
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::SetupOptions;

use crate::common::{camera, octree, setup};

/// One record at a time, operations that cost nothing, memories of one port.
fn hardware() -> Hardware {
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.wires = OpClass::ALL.to_vec();
    hardware.units.clear();
    let caches = [&mut hardware.node_cache, &mut hardware.attribute_cache];
    for (cache, entry_bytes) in caches.into_iter().zip([8, 4]) {
        (cache.bytes, cache.line_bytes, cache.entry_bytes) = (4096, 64, entry_bytes);
        cache.miss_latency = 10;
    }
    (hardware.pixels.buffer, hardware.pixels.drain_interval) = (16, 1);
    hardware.outer_memory.bytes_per_cycle = 0;
    hardware
}

/// Turns, a line each: stages in order, with their cycles where these are not 1.
const CHILDREN: &str = "
    ChildBox QuadtreeFit Push FillUpdate:21
    Pop Filled OnePixel:11 Centre Order VertexPool ChildBox QuadtreeFit:2 Push
    Pop Filled OnePixel Centre Order VertexPool ChildBox QuadtreeFit:6 Push:3
    Pop Filled OnePixel Draw:11 FillUpdate:2
    Pop Filled OnePixel Draw FillUpdate:2
    Pop Filled";
const PARENTS: &str = "
    OnePixel:11 ChildBox QuadtreeFit Push FillUpdate:21
    OnePixel Centre Order VertexPool ChildBox QuadtreeFit:2 Push
    OnePixel Centre Order VertexPool ChildBox QuadtreeFit:2 Draw:11 FillUpdate:2
    OnePixel ChildBox QuadtreeFit:2 Draw FillUpdate:2
    VertexPool ChildBox QuadtreeFit
    Pop Filled Centre Order VertexPool";
const LEAF_MASKS: &str = "
    OnePixel:11 ChildBox QuadtreeFit Push FillUpdate:21
    OnePixel Centre Order VertexPool ChildBox QuadtreeFit:2 Push
    Centre Order VertexPool ChildBox QuadtreeFit:2 Draw:11 FillUpdate:2
    ChildBox QuadtreeFit:2 Draw FillUpdate:2
    VertexPool ChildBox QuadtreeFit
    Pop Filled Centre Order VertexPool";
const HIDDEN_UNREAD: &str = "
    OnePixel:11 ChildBox QuadtreeFit Push Draw:2 FillUpdate:21
    OnePixel Centre Order VertexPool ChildBox QuadtreeFit:2 Push Draw
    Centre Order VertexPool ChildBox QuadtreeFit:2 Draw:11 FillUpdate:2
    ChildBox QuadtreeFit:2 Draw FillUpdate:2
    VertexPool ChildBox QuadtreeFit
    Pop Filled Centre Order VertexPool";
const JOINED_FILL: &str = "
    OnePixel:11 ChildBox QuadtreeFit Push Draw FillUpdate
    OnePixel Centre Order VertexPool ChildBox QuadtreeFit Push Draw
    Centre Order VertexPool ChildBox QuadtreeFit Draw:11 FillUpdate
    ChildBox QuadtreeFit Draw FillUpdate
    VertexPool ChildBox QuadtreeFit
    Pop Filled Centre Order VertexPool";
const TILES: &str = "
    OnePixel:11 ChildBox QuadtreeFit Push Draw:2 FillUpdate:6
    Centre Order VertexPool ChildBox QuadtreeFit
    OnePixel ChildBox QuadtreeFit Push Draw:2 FillUpdate:6
    Centre Order VertexPool ChildBox QuadtreeFit
    OnePixel ChildBox QuadtreeFit Push Draw:2 FillUpdate:6
    OnePixel Centre Order VertexPool ChildBox QuadtreeFit:2 Push Draw
    Centre Order VertexPool ChildBox QuadtreeFit:2 Draw:11 FillUpdate:2
    ChildBox QuadtreeFit:2 Draw FillUpdate:2
    VertexPool ChildBox QuadtreeFit
    Pop Filled Centre Order VertexPool
    OnePixel ChildBox QuadtreeFit Push Draw:2 FillUpdate:6
    Centre Order VertexPool ChildBox QuadtreeFit";

/// The path on the stack, leaf masks, nothing hidden read, joined fill vectors: stage C of `rtl/`.
const SEQUENTIAL: &str = "
    FillUpdate Push ChildBox QuadtreeFit:2 OnePixel Draw Draw Draw Draw OnePixel:12
    Centre Order ChildBox QuadtreeFit:2 OnePixel Draw Draw OnePixel:2 Push
    Centre Order ChildBox QuadtreeFit:2 Draw Draw Draw:13 FillUpdate
    ChildBox QuadtreeFit:2 Draw Draw Draw:3 FillUpdate
    ChildBox QuadtreeFit:2
    Pop:2 Filled:2 Pop Pop Centre Order";

#[test]
fn a_tiny_scene_in_each_organisation() {
    let mut organisation = Organisation::default();
    follow(hardware(), organisation, CHILDREN, 84);
    organisation.stack = StackHolds::Parents;
    follow(hardware(), organisation, PARENTS, 78);
    organisation.leaf_masks = true;
    follow(hardware(), organisation, LEAF_MASKS, 76);
    organisation.stack = StackHolds::Path;
    follow(hardware(), organisation, LEAF_MASKS, 76);
    organisation.hidden_unread = true;
    follow(hardware(), organisation, HIDDEN_UNREAD, 79);
    // B's voxels are in its own mask: a brick of one level.
    organisation.bricks = true;
    follow(hardware(), organisation, HIDDEN_UNREAD, 79);
    organisation.tile_levels = 1;
    follow(hardware(), organisation, TILES, 115);
    (organisation.tile_levels, organisation.joined_fill) = (0, true);
    follow(hardware(), organisation, JOINED_FILL, 53);
}

#[test]
fn a_tiny_scene_step_by_step() {
    let mut hardware = hardware();
    hardware.sequential = true;
    let organisation = Organisation {
        stack: StackHolds::Path,
        leaf_masks: true,
        hidden_unread: true,
        joined_fill: true,
        ..Organisation::default()
    };
    follow(hardware, organisation, SEQUENTIAL, 74);
}

/// Draws the scene, whose visits must be those listed.
fn follow(mut hardware: Hardware, organisation: Organisation, turns: &str, cycles: u64) {
    let graph = octree(2, &|at| [[0, 0, 0], [0, 0, 1], [0, 1, 0]].contains(&at));
    let mut camera = camera([2.0, -8.0, 2.0], [2.0, 0.0, 2.0], 4);
    camera.fov_degrees = 2.0 * libm::atan(2.0 / 8.0).to_degrees();
    let setup = setup(&graph, &camera, &SetupOptions::default());
    hardware.organisation = organisation;
    let mut frame = Frame::new(4, 4, false);
    let mut recorder = Recorder::new(u64::MAX);
    let simulated = Machine::new(MachineOptions::default())
        .simulate(&graph.view(), &setup, &mut frame, &hardware, &mut recorder)
        .unwrap();
    let drawn = [frame.voxel[8], frame.voxel[12]];
    assert_eq!(drawn, [[0, 0, 1, 2], [0, 0, 0, 2]]);
    // The expected visits.
    let starts = organisation.tile_levels == 0;
    let lines = turns.lines().skip(1).enumerate();
    let listed = lines.flat_map(|(number, line)| {
        let record = match starts {
            true => (number as u64).checked_sub(1).unwrap_or(START),
            false => number as u64,
        };
        line.split_whitespace().map(move |visit| (record, visit))
    });
    let mut now = 0;
    let mut visits = recorder.visits().iter();
    for (record, visit) in listed {
        let (stage, takes) = visit.split_once(':').unwrap_or((visit, "1"));
        let found = visits.next().unwrap();
        assert_eq!(
            (found.record, format!("{:?}", found.stage)),
            (record, stage.to_owned())
        );
        assert_eq!(found.begins, now, "{stage} of {record}, {organisation:?}");
        now += takes.parse::<u64>().unwrap();
        assert_eq!(found.ends, now, "{stage} of {record}, {organisation:?}");
    }
    assert!(visits.next().is_none());
    assert_eq!(now, cycles);
    assert_eq!(simulated.cycles.cycles, cycles, "{organisation:?}");
}
