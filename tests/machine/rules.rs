//! Properties of the machine's rules: nothing has holes, every input ends, narrow words trap, a tolerance has its rules.

use crate::common::*;
use crate::differential::any_settings;
use crate::scenes::Dice;
use hwmodel::{Overflow, Probe};
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupError, SetupOptions, Stats,
};
use shiftvox::rays::Rays;

fn any_cage() -> impl Strategy<Value = CageKind> {
    prop_oneof![Just(CageKind::Corners), Just(CageKind::Frame)]
}

/// A probe that ends a frame that does not end by itself.
#[derive(Default)]
struct Bounded {
    records: u64,
}

impl Probe for Bounded {
    fn record(&mut self, _: u64, _: u32) {
        self.records += 1;
        assert!(self.records < 20_000_000, "this frame does not end");
    }
}

fn oracle(graph: &Graph, setup: &FrameSetup) -> Frame {
    let mut frame = Frame::new(setup.width, setup.height, false);
    Rays.render(&graph.view(), &setup.without_detail(), &mut frame)
        .expect("the oracle never fails");
    frame
}

proptest! {
    #![proptest_config(cases(50))]

    /// Every input ends: cyclic graphs, all formats, all policies.
    #[test]
    fn every_frame_ends(
        (graph, camera) in any_graph(1..7).prop_flat_map(|graph| {
            let side = f64::from(1u32 << graph.depth);
            (Just(graph), any_camera(side, 1..24))
        }),
        seed: u64,
        overflow in prop_oneof![
            Just(Overflow::Trap), Just(Overflow::Wrap), Just(Overflow::Saturate)
        ],
    ) {
        let mut dice = Dice::new(seed);
        let options = SetupOptions {
            bits: 16 + dice.below(49),
            frac: dice.of(&[None, Some(dice.clone().below(20))]),
            ..any_settings(&mut dice)
        };
        let Ok(setup) = FrameSetup::new(&camera, &graph.placement, graph.depth, &options) else {
            return Ok(());
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let machine = MachineOptions { overflow, ..MachineOptions::default() };
        let result = Machine::new(machine).render_probed(
            &graph.view(), &setup, &mut frame, Bounded::default(),
        );
        if overflow != Overflow::Trap {
            prop_assert!(result.is_ok());
        }
    }

    /// Dense planes at all angles, and a sphere's shell that is thick enough to be closed, under `center`: a sample
    /// whose neighbours are all covered is drawn.
    #[test]
    fn surfaces_have_no_holes(
        which in 0..4usize,
        from in proptest::array::uniform3(-1.0..1.0f64),
        distance in 1.2..6.0f64,
        tolerance_px in prop_oneof![Just(0.0), Just(1.0 / 16.0), Just(0.25)],
        cage in any_cage(),
        lod_px in prop_oneof![Just(0.0), Just(1.0)],
    ) {
        let graph = octree(4, &|at| match which {
            3 => {
                let square: i32 = at.iter().map(|c| (2 * c - 15) * (2 * c - 15)).sum();
                (11 * 11..15 * 15).contains(&square)
            }
            axis => at[axis] == 8,
        });
        no_holes(&graph, from, distance, tolerance_px, cage, lod_px)?;
    }
}

fn no_holes(
    graph: &Graph,
    from: [f64; 3],
    distance: f64,
    tolerance_px: f64,
    cage: CageKind,
    lod_px: f64,
) -> Result<(), TestCaseError> {
    let length = from.iter().map(|c| c * c).sum::<f64>().sqrt();
    prop_assume!(length > 0.1);
    let eye = from.map(|c| 8.0 + c / length * 16.0 * distance);
    let size = 96;
    let camera = Camera {
        fov_degrees: 50.0,
        ..camera(eye, [8.0, 8.0, 8.0], size)
    };
    let options = SetupOptions {
        cage,
        tolerance_px,
        coverage: Coverage::Center,
        lod_px,
        ..SetupOptions::of(Coverage::Center)
    };
    let setup = setup(graph, &camera, &options);
    let drawn = draw(graph, &setup);
    let exact = oracle(graph, &setup);
    let size = size as usize;
    let mut inner = 0;
    for y in 1..size - 1 {
        for x in 1..size - 1 {
            let covered = (0..9).all(|i| {
                let at = (y + i / 3 - 1) * size + x + i % 3 - 1;
                exact.voxel[at][3] >= 0
            });
            if covered {
                inner += 1;
                prop_assert!(drawn.voxel[y * size + x][3] >= 0, "a hole at ({x}, {y})");
            }
        }
    }
    prop_assume!(inner > 20);
    Ok(())
}

#[test]
fn an_object_beside_the_picture_costs_next_to_nothing() {
    let graph = solid(8);
    for target in [[-1000.0, -900.0, 0.0], [900.0, -1000.0, 128.0]] {
        let camera = camera([128.0, -300.0, 128.0], target, 512);
        for coverage in [Coverage::Any, Coverage::Center, Coverage::Exact] {
            let setup = setup(&graph, &camera, &SetupOptions::of(coverage));
            let (frame, stats) =
                draw_with(MachineOptions::default(), &graph, &setup).expect("a frame");
            assert_eq!(frame.drawn(), 0);
            assert!(stat(&stats, "records") <= 1, "{stats:?}");
        }
    }
}

#[test]
fn what_is_outside_the_picture_costs_no_more_than_the_border() {
    // A dense wall: a narrow view of it, and one that is cut by the border.
    let graph = octree(7, &|at| at[1] == 64);
    let options = SetupOptions::default();
    let records = |fov_degrees: f64, size: u32| {
        let camera = Camera {
            fov_degrees,
            ..camera([64.0, -100.0, 64.0], [64.0, 64.0, 64.0], size)
        };
        let setup = setup(&graph, &camera, &options);
        let (_, stats) = draw_with(MachineOptions::default(), &graph, &setup).expect("a frame");
        stat(&stats, "records")
    };
    // The whole wall (128 voxels) across 256 samples, then a quarter of it
    // (32 voxels) across 64: the same size on screen, a sixteenth of it seen.
    let whole = records(2.0 * (64.0f64 / 164.0).atan().to_degrees(), 256);
    let part = records(2.0 * (16.0f64 / 164.0).atan().to_degrees(), 64);
    let border = 4 * 32 * 4;
    assert!(
        part <= whole / 16 + border,
        "{part} records for a sixteenth of {whole}"
    );
}

/// A wall in words of 16 bits, which are too narrow for it.
fn wall_in_16_bits(overflow: Overflow) -> Result<(Frame, Stats), EngineError> {
    let graph = octree(7, &|at| at[1] == 64);
    let options = SetupOptions {
        bits: 16,
        frac: Some(10),
        ..SetupOptions::default()
    };
    let camera = camera([64.0, -200.0, 64.0], [64.0; 3], 256);
    let machine = MachineOptions {
        overflow,
        ..MachineOptions::default()
    };
    draw_with(machine, &graph, &setup(&graph, &camera, &options))
}

#[test]
fn narrow_words_trap_with_the_place_named_or_finish() {
    let trapped = wall_in_16_bits(Overflow::Trap);
    let Err(EngineError::Trap(trap)) = trapped else {
        panic!("no trap: {trapped:?}");
    };
    assert_eq!(trap.bits, 16);
    let message = trap.to_string();
    for part in ["16 bits", "stage", "octree level", "record"] {
        assert!(message.contains(part), "{message}");
    }
    for overflow in [Overflow::Wrap, Overflow::Saturate] {
        let (_, stats) = wall_in_16_bits(overflow).expect("no trap");
        assert!(stat(&stats, "overflows") > 0);
    }
}

/// There is no other tolerance than 0 to ask for.
#[test]
fn a_tolerance_is_refused_with_the_reason() {
    let graph = solid(2);
    let camera = camera([9.0, 7.0, 6.0], [2.0; 3], 16);
    for coverage in [Coverage::Exact, Coverage::Alpha] {
        for tolerance_px in [1.0 / 256.0, 0.125, f64::INFINITY] {
            let options = SetupOptions {
                tolerance_px,
                ..SetupOptions::of(coverage)
            };
            let error = FrameSetup::new(&camera, &graph.placement, graph.depth, &options)
                .expect_err("no such frame");
            assert_eq!(error, SetupError::Tolerance(tolerance_px));
            assert!(
                error.to_string().contains("approximates nothing"),
                "{error}"
            );
        }
    }
    for coverage in [Coverage::Any, Coverage::Center] {
        assert_eq!(SetupOptions::of(coverage).tolerance_px, 0.125);
    }
    assert_eq!(SetupOptions::default().tolerance_px, 0.0);
}
