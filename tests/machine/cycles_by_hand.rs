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
use hwmodel::cycles::{Hardware, Organisation, StackHolds, VisitSpan};
use shiftvox::frame::Frame;
use shiftvox::machine::Machine;
use shiftvox::project::SetupOptions;

use crate::common::{camera, octree, setup};

/// One record at a time, operations that cost nothing, memories of one port.
fn hardware(organisation: Organisation) -> Hardware {
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.organisation = organisation;
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
    use StackHolds::{Parents, Path};
    let mut all = Organisation::default();
    let mut next = |change: fn(&mut Organisation), turns, cycles| {
        change(&mut all);
        follow(&hardware(all), turns, cycles);
    };
    next(|_| {}, CHILDREN, 84);
    next(|all| all.stack = Parents, PARENTS, 78);
    next(|all| all.leaf_masks = true, LEAF_MASKS, 76);
    next(|all| all.stack = Path, LEAF_MASKS, 76);
    next(|all| all.hidden_unread = true, HIDDEN_UNREAD, 79);
    // B's voxels are in its own mask: a brick of one level.
    next(|all| all.bricks = true, HIDDEN_UNREAD, 79);
    next(|all| all.tile_levels = 1, TILES, 115);
    next(|all| all.tile_levels = 0, HIDDEN_UNREAD, 79);
    next(|all| all.joined_fill = true, JOINED_FILL, 53);
    let mut sequential = hardware(all);
    (sequential.sequential, sequential.organisation.bricks) = (true, false);
    follow(&sequential, SEQUENTIAL, 74);
}

/// Draws the scene, whose visits must be those listed.
fn follow(hardware: &Hardware, turns: &str, cycles: u64) {
    let graph = octree(2, &|at| [[0, 0, 0], [0, 0, 1], [0, 1, 0]].contains(&at));
    let mut camera = camera([2.0, -8.0, 2.0], [2.0, 0.0, 2.0], 4);
    camera.fov_degrees = 2.0 * libm::atan(2.0 / 8.0).to_degrees();
    let setup = setup(&graph, &camera, &SetupOptions::default());
    let mut frame = Frame::new(4, 4, false);
    let mut visits: Vec<VisitSpan> = Vec::new();
    let simulated = Machine::default()
        .simulate(&graph.view(), &setup, &mut frame, hardware, &mut visits)
        .unwrap();
    let drawn = [frame.voxel[8], frame.voxel[12]];
    assert_eq!(drawn, [[0, 0, 1, 2], [0, 0, 0, 2]]);
    let (mut now, mut last, mut found) = (0, None, String::new());
    for visit in visits {
        if last != Some(visit.record) {
            found += "\n   ";
        }
        found += &match visit.ends - visit.begins {
            1 => format!(" {:?}", visit.stage),
            takes => format!(" {:?}:{takes}", visit.stage),
        };
        assert_eq!(visit.begins, now, "{found}");
        (now, last) = (visit.ends, Some(visit.record));
    }
    let organisation = &hardware.organisation;
    assert_eq!(found, turns, "{organisation:?}");
    assert_eq!(
        [now, simulated.cycles.cycles],
        [cycles; 2],
        "{organisation:?}"
    );
}
