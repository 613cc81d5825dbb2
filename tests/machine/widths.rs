//! The widths that a frame's set-up proves: no record of any frame needs more, and with a bit less some do.

use hwmodel::cycles::{Organisation, StackHolds};
use rayon::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::machine::{Machine, MachineOptions, RecordNumber, narrowed, proven_widths};
use shiftvox::project::{CageKind, Coverage, Engine, FrameSetup, SetupOptions};

use crate::scene_table::SCENES;
use crate::scenes::*;

/// Cameras of a scene.
const CAMERAS: usize = 10;

fn machine() -> Machine {
    Machine::new(MachineOptions {
        organisation: Organisation {
            stack: StackHolds::Path,
            leaf_masks: true,
            hidden_unread: true,
            ..Organisation::default()
        },
        ..MachineOptions::default()
    })
}

/// Every test scene from random places, with either cage.
fn frames() -> impl ParallelIterator<Item = (&'static shiftvox::graph::Graph, FrameSetup)> {
    SCENES.par_iter().flat_map_iter(|(name, graph)| {
        let mut dice = Dice::new(xxhash_rust::xxh3::xxh3_64(name.as_bytes()) ^ 19);
        (0..CAMERAS).filter_map(move |number| {
            let place = PLACES[number % PLACES.len()];
            let camera = camera_at(place, graph, (37, 29), &mut dice);
            let options = SetupOptions {
                cage: [CageKind::Frame, CageKind::Corners][number % 2],
                bits: [32, 24][number / 2 % 2],
                ..SetupOptions::of(Coverage::Exact)
            };
            let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).ok()?;
            setup.has_headroom.then_some((graph, setup))
        })
    })
}

#[test]
fn no_record_needs_more_bits_than_are_proven() {
    let spare = frames().flat_map_iter(|(graph, setup)| {
        let proven = proven_widths(&setup, graph.len()).unwrap();
        let mut frame = Frame::new(setup.width, setup.height, false);
        let seen = machine().seen_numbers(&graph.view(), &setup, &mut frame);
        seen.unwrap().into_iter().map(move |(number, span)| {
            let bound = proven.numbers[&number];
            assert!(bound.holds(span), "{number:?}: {span:?}, not in {bound:?}");
            (number, bound.bits() - span.bits())
        })
    });
    let mut spare: Vec<(RecordNumber, u32)> = spare.collect();
    spare.sort();
    spare.dedup_by_key(|(number, _)| *number);
    // Only the bound of this one adds numbers that never come together.
    let loose = |number| match number {
        RecordNumber::AxisC => 2,
        _ => 0,
    };
    assert_eq!(
        spare,
        RecordNumber::ALL.map(|number| (number, loose(number)))
    );
}

/// Wide words of the proven width hold all sums on planes (`differential.rs` draws in them). Narrower ones trap.
#[test]
fn wide_words_are_hardly_wider_than_needed() {
    let fewest = frames().filter_map(|(graph, setup)| {
        let bits = narrowed(&setup).format.wide().bits();
        let draws = |spare: u32| {
            let mut setup = setup.clone();
            setup.format = setup.format.with_wide_bits(bits - spare);
            let mut frame = Frame::new(setup.width, setup.height, false);
            machine().render(&graph.view(), &setup, &mut frame).is_ok()
        };
        (0..5).find(|&spare| !draws(spare))
    });
    assert!(fewest.min().is_some_and(|spare| spare > 0));
}
