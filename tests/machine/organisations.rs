//! However the record loop's data is organised (children or parents on the stack, leaves known from
//! their parents, the picture by tiles), every frame is the same to the bit, drawn serially or on
//! simulated hardware. Tiles are for the rules that draw outlines: where a box or a centre claims a
//! sample, it may be one beside the tile.

use std::ops::Range;

use hwmodel::count::Counter;
use hwmodel::cycles::{
    Hardware, Independence, MAX_TILE_LEVELS, NoObserver, Organisation, StackHolds,
};
use hwmodel::{Memory, OpClass, Probe, StageLevel};
use rayon::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::{MOST_OPEN_TILES, Machine, MachineOptions, narrowed};
use shiftvox::project::{CageKind, Coverage, FrameSetup, SetupOptions};

use crate::common::{lights, octree, times, with_opacities};
use crate::scene_table::{SCENES, TestScene};
use crate::scenes::*;

/// Cameras of a scene.
const CAMERAS: usize = 5;

/// Most records of a frame: each is drawn dozens of times.
const MOST_RECORDS: u64 = 2_500;

fn machine(organisation: Organisation) -> Machine {
    Machine::new(MachineOptions {
        organisation,
        ..MachineOptions::default()
    })
}

/// All organisations, that of the image-order paper first.
fn organisations() -> Vec<Organisation> {
    let mut all = Vec::new();
    for stack in [StackHolds::Children, StackHolds::Parents, StackHolds::Path] {
        for (leaf_masks, bricks) in [(false, false), (true, false), (true, true)] {
            for tile_levels in [0, 2, MAX_TILE_LEVELS] {
                // All eight ways of the rest come up.
                let rest = all.len();
                all.push(Organisation {
                    stack,
                    leaf_masks,
                    bricks,
                    tile_levels,
                    hidden_unread: rest & 1 != 0,
                    joined_fill: rest & 2 != 0,
                    packed: rest & 4 != 0,
                });
            }
        }
    }
    all
}

/// The set-up in the words of an organisation: a wide word that is too narrow traps.
fn in_words(setup: &FrameSetup, organisation: Organisation) -> FrameSetup {
    match organisation.packed {
        true => narrowed(setup),
        false => setup.clone(),
    }
}

fn rules() -> [SetupOptions; 5] {
    let exact = SetupOptions::default();
    [
        exact,
        SetupOptions {
            cage: CageKind::Corners,
            lod_px: 0.0,
            ..exact
        },
        SetupOptions::of(Coverage::Alpha),
        SetupOptions::of(Coverage::Center),
        SetupOptions {
            cage: CageKind::Corners,
            tolerance_px: f64::INFINITY,
            ..SetupOptions::of(Coverage::Any)
        },
    ]
}

/// Hardware with an organisation, whose records meet in many ways.
fn hardware(organisation: Organisation, contexts: u32, independence: Independence) -> Hardware {
    let mut hardware = Hardware::preset("paper").unwrap();
    hardware.organisation = organisation;
    hardware.contexts = contexts;
    hardware.lanes = 1 + contexts % 3;
    hardware.independence = independence;
    hardware
}

/// Draws a graph for some cameras with every organisation, serially and simulated; how many frames were the same.
fn same_frames(name: &str, graph: &Graph, cameras: Range<usize>) -> u64 {
    let airy = with_opacities(graph);
    let light = lights(graph);
    let mut dice = Dice::new(xxhash_rust::xxh3::xxh3_64(name.as_bytes()));
    let mut frames = 0;
    for number in cameras.clone() {
        let place = PLACES[number % PLACES.len()];
        let camera = camera_at(place, graph, (33, 41), &mut dice);
        let options = rules()[number % 5];
        let graph = match options.coverage {
            Coverage::Alpha => &airy,
            _ => graph,
        };
        let Ok(setup) = FrameSetup::new(&camera, &graph.placement, graph.depth, &options) else {
            continue;
        };
        let view = GraphView {
            light: &light,
            ..graph.view()
        };
        let draw = |organisation: Organisation| {
            let mut frame = Frame::new(setup.width, setup.height, false);
            let setup = in_words(&setup, organisation);
            let stats = machine(organisation)
                .render_within(&view, &setup, &mut frame, MOST_RECORDS)
                .unwrap();
            stats.map(|_| frame)
        };
        let Some(right) = draw(Organisation::default()) else {
            continue;
        };
        for (turn, organisation) in organisations().into_iter().enumerate() {
            // Tiles leave a picture as it is where samples are claimed by rays.
            if organisation.tile_levels > 0 && !options.coverage.draws_outlines() {
                continue;
            }
            // One walk a sample is slow, and says no more than one for a few.
            if organisation.tile_levels == MAX_TILE_LEVELS && number % 4 != 0 {
                continue;
            }
            let what = || format!("{}, {organisation:?}, {options:?}, {camera:?}", name);
            if let Some(frame) = draw(organisation) {
                assert!(frame == right, "{}", what());
                frames += 1;
            }
            // A sixth of them, in turn: simulated frames take many times as long.
            if !(turn + number + graph.depth as usize).is_multiple_of(6) && times() == 1 {
                continue;
            }
            let serial = [Independence::None, Independence::Image];
            // Children of one class may claim the same sample under other rules.
            let independent = match options.coverage {
                Coverage::Exact => Independence::Both,
                _ => serial[number % 2],
            };
            for (contexts, independence) in [(1, serial[number % 2]), (8, independent)] {
                let hardware = hardware(organisation, contexts, independence);
                let mut frame = Frame::new(setup.width, setup.height, false);
                let setup = in_words(&setup, organisation);
                let simulated = machine(Organisation::default())
                    .simulate(&view, &setup, &mut frame, &hardware, &mut NoObserver)
                    .unwrap();
                assert!(frame == right, "{independence:?}, {contexts}: {}", what());
                // A lane takes up a tile only where no record of another one is ready.
                let mut counts = simulated.counts.iter();
                let open = counts.find(|(name, _)| *name == MOST_OPEN_TILES).unwrap().1;
                let is_enough = open <= hardware.all_contexts() || hardware.lanes > 1;
                assert!(is_enough, "{open} tiles at once: {}", what());
                frames += 1;
            }
        }
    }
    frames
}

#[test]
fn every_organisation_draws_every_scene_alike() {
    let of_scene = |scene: &TestScene| same_frames(scene.name, scene.graph(), 0..CAMERAS);
    let frames: u64 = SCENES.par_iter().map(of_scene).sum();
    eprintln!("{frames} frames compared");
    assert!(frames > 500, "{frames}");
}

/// Twenty random scenes and cameras.
#[test]
fn every_organisation_draws_random_scenes_alike() {
    let of_seed = |seed: usize| {
        let is_filled = |[x, y, z]: [i32; 3]| {
            let key = [seed as i32, x, y, z].map(i32::to_le_bytes).concat();
            xxhash_rust::xxh3::xxh3_64(&key).is_multiple_of(1 + 7 * (seed as u64 % 3))
        };
        let graph = octree(2 + seed as u32 % 3, &is_filled);
        same_frames(
            &format!("random voxels {seed}"),
            &graph,
            seed..seed + CAMERAS,
        )
    };
    let frames: Vec<u64> = (0..20).into_par_iter().map(of_seed).collect();
    eprintln!("{frames:?} frames compared");
    assert!(frames.iter().all(|&of_scene| of_scene >= 10), "{frames:?}");
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
