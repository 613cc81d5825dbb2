//! What each setting of an organisation is for: fewer reads and writes of the same picture, and tiles one after the other.

use hwmodel::count::Counter;
use hwmodel::cycles::{Organisation, StackHolds};
use hwmodel::{Memory, OpClass, Probe, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{FrameSetup, SetupOptions};

use crate::scenes::*;

fn machine(organisation: Organisation) -> Machine {
    Machine::new(MachineOptions {
        organisation,
        ..MachineOptions::default()
    })
}

/// What the organisation is for: fewer reads and writes of the same picture.
#[test]
fn parents_are_stored_less_often_and_leaves_are_not_read() {
    let graph = graph_of_spec("gen:terrain,depth=7");
    let camera = camera_at(CameraPlace::Outside, &graph, (128, 128), &mut Dice::new(3));
    let options = SetupOptions::default();
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
    let count = |stack, leaf_masks| {
        let organisation = Organisation {
            stack,
            leaf_masks,
            ..Organisation::default()
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let drawn =
            machine(organisation).render_probed(&graph.view(), &setup, &mut frame, Counter::new());
        let (stats, counter) = drawn.unwrap();
        let of = |memory| {
            let all = counter.accesses_by(|cell| cell.memory);
            all.get(&memory).map_or((0, 0), |a| (a.reads, a.writes))
        };
        let stat = |wanted: &str| stats.iter().find(|(name, _)| *name == wanted).unwrap().1;
        let (stored, loaded) = of(Memory::Stack);
        assert_eq!(stored, loaded, "what is stored is loaded");
        (
            stored,
            of(Memory::Node).0,
            stat("subdivided"),
            stat("records"),
            stat("deepest_stack"),
        )
    };
    let (stored, read, subdivided, records, _) = count(StackHolds::Children, false);
    assert_eq!(stored, records);
    assert!(read <= records && read > subdivided);
    let (stored, read, subdivided, records, deepest) = count(StackHolds::Parents, true);
    assert_eq!(read, subdivided, "only what is subdivided is read");
    assert!(stored < subdivided, "a last child's parent is not stored");
    assert!(2 * subdivided < records, "{subdivided} of {records}");
    assert!(deepest <= u64::from(graph.depth), "{deepest}");
}

/// What each further setting is for, on the same picture.
#[test]
fn what_is_hidden_is_not_read_and_what_is_known_is_not_stored() {
    let graph = graph_of_spec("gen:terrain,depth=7");
    let camera = camera_at(CameraPlace::Outside, &graph, (128, 128), &mut Dice::new(3));
    let options = SetupOptions::default();
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
    let reads = |organisation: Organisation| {
        let mut frame = Frame::new(setup.width, setup.height, false);
        let drawn =
            machine(organisation).render_probed(&graph.view(), &setup, &mut frame, Counter::new());
        let all = drawn.unwrap().1.accesses_by(|cell| cell.memory);
        let of = |memory: Memory| all.get(&memory).map_or((0, 0), |of| (of.reads, of.writes));
        (
            of(Memory::Stack).0,
            of(Memory::Node).0,
            of(Memory::FillVector),
        )
    };
    let parents = Organisation {
        stack: StackHolds::Parents,
        leaf_masks: true,
        ..Organisation::default()
    };
    let (stored, nodes, fill) = reads(parents);
    let path = Organisation {
        stack: StackHolds::Path,
        ..parents
    };
    assert_eq!(
        reads(path),
        (stored, nodes, fill),
        "the same, of fewer bits"
    );
    let unread = Organisation {
        hidden_unread: true,
        ..path
    };
    let seen = reads(unread);
    assert!(3 * seen.1 < 2 * nodes, "{} of {nodes} nodes", seen.1);
    let bricks = Organisation {
        bricks: true,
        ..unread
    };
    let of_bricks = reads(bricks);
    assert!(
        10 * of_bricks.1 < 7 * seen.1,
        "{} of {} words",
        of_bricks.1,
        seen.1
    );
    let joined = Organisation {
        joined_fill: true,
        ..unread
    };
    let of_joined = reads(joined);
    assert_eq!((of_joined.0, of_joined.1), (seen.0, seen.1));
    let (before, after) = (seen.2, of_joined.2);
    assert!(2 * after.0 < before.0, "{} of {} reads", after.0, before.0);
    assert!(
        4 * after.1 < 3 * before.1,
        "{} of {} writes",
        after.1,
        before.1
    );
}

/// The samples that are drawn, in order.
#[derive(Default)]
struct Drawn(Vec<u64>);

impl Probe for Drawn {
    fn op(&mut self, _: OpClass, _: u32, _: StageLevel, _: u32) {}

    fn read(&mut self, _: Memory, _: u64, _: StageLevel) {}

    fn write(&mut self, memory: Memory, address: u64, _: StageLevel) {
        if memory == Memory::Pixel {
            self.0.push(address);
        }
    }
}

/// A walk for a tile draws nothing outside of it.
#[test]
fn tiles_are_drawn_one_after_the_other() {
    let graph = graph_of_spec("gen:terrain,depth=6");
    let camera = camera_at(CameraPlace::Outside, &graph, (64, 64), &mut Dice::new(7));
    let options = SetupOptions::default();
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
    for stack in [StackHolds::Children, StackHolds::Parents, StackHolds::Path] {
        let organisation = Organisation {
            stack,
            leaf_masks: true,
            tile_levels: 2,
            ..Organisation::default()
        };
        let mut frame = Frame::new(64, 64, false);
        let drawn = machine(organisation).render_probed(
            &graph.view(),
            &setup,
            &mut frame,
            Drawn::default(),
        );
        let (_, Drawn(samples)) = drawn.unwrap();
        let tile = |sample: &u64| (sample / 64 / 16, sample % 64 / 16);
        assert!(samples.is_sorted_by_key(tile), "{stack:?}");
        let tiles: std::collections::BTreeSet<_> = samples.iter().map(tile).collect();
        assert!(tiles.len() > 4, "{}", tiles.len());
    }
}
