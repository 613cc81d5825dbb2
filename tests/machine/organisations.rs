//! Each setting of an organisation saves reads and writes. Tiles are drawn one after the other.

use hwmodel::count::Counter;
use hwmodel::cycles::{Organisation, StackHolds};
use hwmodel::{Memory, OpClass, Probe, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{SetupOptions, Stats};

use crate::common::{setup, stat};
use crate::scenes::*;

fn watch<P: Probe>(organisation: Organisation, depth: u32, probe: P) -> (Stats, P) {
    let graph = graph_of_spec(&format!("gen:terrain,depth={depth}"));
    let size = 1 << depth;
    let camera = camera_at(
        CameraPlace::Outside,
        &graph,
        (size, size),
        &mut Dice::new(3),
    );
    let setup = setup(&graph, &camera, &SetupOptions::default());
    let mut machine = Machine::new(MachineOptions {
        organisation,
        ..MachineOptions::default()
    });
    let mut frame = Frame::new(size, size, false);
    let drawn = machine.render_probed(&graph.view(), &setup, &mut frame, probe);
    drawn.unwrap()
}

/// Reads and writes of the stack, nodes and fill vectors for a picture, and its statistics.
fn accesses(organisation: Organisation) -> ([(u64, u64); 3], impl Fn(&str) -> u64) {
    let (stats, counter) = watch(organisation, 7, Counter::new());
    let of = |memory| (counter.reads(memory), counter.writes(memory));
    let all = [Memory::Stack, Memory::Node, Memory::FillVector].map(of);
    (all, move |name| stat(&stats, name))
}

/// The settings in turn, on the same picture.
#[test]
fn each_setting_saves_reads_and_writes() {
    let mut organisation = Organisation::default();
    let ([stack, nodes, _], count) = accesses(organisation);
    assert_eq!(stack, (count("records"), count("records")));
    assert!(nodes.0 <= count("records") && nodes.0 > count("subdivided"));

    (organisation.stack, organisation.leaf_masks) = (StackHolds::Parents, true);
    let (parents, count) = accesses(organisation);
    let [stack, nodes, _] = parents;
    assert_eq!(
        nodes.0,
        count("subdivided"),
        "only what is subdivided is read"
    );
    assert!(
        stack.0 == stack.1 && stack.0 < count("subdivided"),
        "a last child's parent is not stored"
    );
    assert!(2 * count("subdivided") < count("records"));
    assert!(count("deepest_stack") <= 7);

    organisation.stack = StackHolds::Path;
    assert_eq!(accesses(organisation).0, parents, "the same, of fewer bits");

    organisation.hidden_unread = true;
    let unread = accesses(organisation).0;
    assert!(3 * unread[1].0 < 2 * nodes.0, "{unread:?} {nodes:?}");

    organisation.bricks = true;
    let bricks = accesses(organisation).0;
    assert!(10 * bricks[1].0 < 7 * unread[1].0, "{bricks:?} {unread:?}");

    (organisation.bricks, organisation.joined_fill) = (false, true);
    let joined = accesses(organisation).0;
    assert_eq!(joined[..2], unread[..2]);
    assert!(
        2 * joined[2].0 < unread[2].0 && 4 * joined[2].1 < 3 * unread[2].1,
        "{joined:?} {unread:?}"
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
    for stack in [StackHolds::Children, StackHolds::Parents, StackHolds::Path] {
        let organisation = Organisation {
            stack,
            leaf_masks: true,
            tile_levels: 2,
            ..Organisation::default()
        };
        let (_, Drawn(samples)) = watch(organisation, 6, Drawn::default());
        let tile = |sample: &u64| (sample / 64 / 16, sample % 64 / 16);
        assert!(samples.is_sorted_by_key(tile), "{stack:?}");
        let tiles: std::collections::BTreeSet<_> = samples.iter().map(tile).collect();
        assert!(tiles.len() > 4, "{}", tiles.len());
    }
}
