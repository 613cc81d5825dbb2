//! Properties of the machine's rules: every input ends, narrow words trap, an object beside the picture costs nothing,
//! and classes of children are independent.

use crate::common::*;
use crate::differential::any_settings;
use crate::scenes::Dice;
use hwmodel::Overflow;
use hwmodel::cycles::{Child, Hardware, ImageNode, Independence, NoObserver};
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::machine::{Machine, MachineOptions, OCCLUSION_ORDER};
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions,
};
use shiftvox::rays::Rays;

fn machine(overflow: Overflow) -> Machine {
    Machine::new(MachineOptions {
        overflow,
        ..MachineOptions::default()
    })
}

proptest! {
    #![proptest_config(cases(50))]

    /// Cyclic graphs, all formats, all policies.
    #[test]
    fn every_frame_ends(
        (graph, camera) in any_view(any_graph(1..6), 1..24),
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
        // With a level more, a frame of 92 x 4 samples, seen from an eye on the object's face, took 99 million records.
        let drawn = machine(overflow).render_within(&graph.view(), &setup, &mut frame, 100_000_000);
        match drawn {
            Ok(stats) => prop_assert!(stats.is_some(), "this frame does not end"),
            Err(_) => prop_assert_eq!(overflow, Overflow::Trap),
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
        cage in prop_oneof![Just(CageKind::Corners), Just(CageKind::Frame)],
        lod_px in prop_oneof![Just(0.0), Just(1.0)],
    ) {
        let graph = octree(4, &|at| match which {
            3 => {
                let square: i32 = at.iter().map(|c| (2 * c - 15) * (2 * c - 15)).sum();
                (11 * 11..15 * 15).contains(&square)
            }
            axis => at[axis] == 8,
        });
        let length = from.iter().map(|c| c * c).sum::<f64>().sqrt();
        prop_assume!(length > 0.1);
        let size = 96;
        let camera = Camera {
            fov_degrees: 50.0,
            ..camera(from.map(|c| 8.0 + c / length * 16.0 * distance), [8.0; 3], size)
        };
        let options = SetupOptions { cage, tolerance_px, lod_px, ..SetupOptions::of(Coverage::Center) };
        let setup = setup(&graph, &camera, &options);
        let (drawn, _) = draw(&graph, &setup);
        let mut exact = Frame::new(size, size, false);
        let oracle = Rays::default().render(&graph.view(), &setup.without_detail(), &mut exact);
        oracle.expect("the oracle never fails");
        let size = size as usize;
        let inner = (0..size * size).filter(|at| {
            let (x, y) = (at % size, at / size);
            let is_inside = (1..size - 1).contains(&x) && (1..size - 1).contains(&y);
            let near = |i: usize| (y + i / 3 - 1) * size + x + i % 3 - 1;
            is_inside && (0..9).all(|i| exact.voxel[near(i)][3] >= 0)
        });
        let inner: Vec<usize> = inner.collect();
        for &at in &inner {
            prop_assert!(drawn.voxel[at][3] >= 0, "a hole at {}", at);
        }
        prop_assume!(inner.len() > 20);
    }
}

#[test]
fn an_object_beside_the_picture_costs_next_to_nothing() {
    let graph = solid(8);
    for target in [[-1000.0, -900.0, 0.0], [900.0, -1000.0, 128.0]] {
        let camera = camera([128.0, -300.0, 128.0], target, 512);
        for coverage in Coverage::UNBLENDED {
            let setup = setup(&graph, &camera, &SetupOptions::of(coverage));
            let (frame, stats) = draw(&graph, &setup);
            assert!(
                frame.drawn() == 0 && stat(&stats, "records") <= 1,
                "{stats:?}"
            );
        }
    }
}

/// Also on simulated hardware.
#[test]
fn narrow_words_trap_or_finish() {
    let graph = octree(7, &|at| at[1] == 64);
    let options = SetupOptions {
        bits: 16,
        frac: Some(10),
        ..SetupOptions::default()
    };
    let camera = camera([64.0, -200.0, 64.0], [64.0; 3], 256);
    let setup = setup(&graph, &camera, &options);
    let mut frame = Frame::new(256, 256, false);
    let mut draw = |overflow| machine(overflow).render(&graph.view(), &setup, &mut frame);
    let trapped = draw(Overflow::Trap).expect_err("a trap");
    assert!(matches!(trapped, EngineError::Trap(trap) if trap.bits == 16));
    for overflow in [Overflow::Wrap, Overflow::Saturate] {
        let stats = draw(overflow).expect("no trap");
        assert!(stat(&stats, "overflows") > 0);
    }
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.independence = Independence::None;
    let view = graph.view();
    let simulated =
        Machine::default().simulate(&view, &setup, &mut frame, &hardware, &mut NoObserver);
    assert_eq!(simulated.unwrap_err().to_string(), trapped.to_string());
}

/// No child of a class may hide another: none whose octant has all bits of the other's.
#[test]
fn classes_of_the_cycle_model_are_independent_by_geometry() {
    let child = |place: usize| Child {
        item: 0,
        place: place as u8,
        image_node: ImageNode::default(),
    };
    let pairs = (0..8).flat_map(|later| (0..later).map(move |earlier| (earlier, later)));
    let is_allowed = |&(earlier, later): &(usize, usize)| {
        Independence::Classes.allows(&child(earlier), &child(later))
    };
    let allowed: Vec<_> = pairs.filter(is_allowed).collect();
    // Three pairs in each class of three.
    assert_eq!(allowed.len(), 6);
    for (earlier, later) in allowed {
        let [earlier, later] = [earlier, later].map(|place| OCCLUSION_ORDER[place]);
        assert_ne!(earlier & later, later, "{earlier} may hide {later}");
    }
}
