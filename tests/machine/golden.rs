//! Random frames and their integers have one recorded hash each, in the rows of the golden pictures.

use crate::frame_hash::hash;
use crate::scenes::*;
use glam::DVec3;
use shiftvox::frame::Frame;
use shiftvox::graph::Placement;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions as Options};
use xxhash_rust::xxh3::Xxh3;

const ROWS: &str = include_str!("../../crates/web/src/golden.txt");

#[track_caller]
fn compare(kind: &str, found: u128) {
    let line = ROWS.lines().find(|line| line.contains(kind)).expect(kind);
    assert!(
        line.ends_with(&format!("{found:032x}")),
        "{line}: {found:032x}"
    );
}

const RECORDED_FRAMES: u32 = 400;

/// The rules `any` and `center`, at all tolerances, in words of many widths.
#[test]
fn pictures_by_box_and_centre_are_those_recorded() {
    let specs = "terrain,depth=6,seed=3 menger,depth=3 sierpinski,depth=7 shell,depth=5 truss,depth=5 \
                 wires,depth=5";
    let graph = |spec| graph_of(&format!("gen:{spec}"));
    let graphs: Vec<_> = specs.split(' ').map(graph).collect();
    let mut dice = Dice::new(5);
    let mut hash = Xxh3::new();
    let mut drawn = 0;
    for _ in 0..RECORDED_FRAMES {
        let graph = &graphs[dice.below(6) as usize];
        let place = dice.of(&PLACES);
        let camera = camera_at(place, graph, (40, 31), &mut dice);
        let options = Options {
            bits: dice.of(&[20, 24, 32, 48, 64, 64]),
            frac: dice.of(&[None, None, Some(6), Some(12)]),
            cage: dice.of(&[CageKind::Corners, CageKind::Frame]),
            tolerance_px: dice.of(&[0.0, 1.0 / 64.0, 0.125, 1.5, f64::INFINITY]),
            coverage: dice.of(&[Coverage::Any, Coverage::Center]),
            lod_px: dice.of(&[0.0, 1.0, 2.5]),
            aa_log2: dice.below(2),
        };
        let made = FrameSetup::new(&camera, &graph.placement, graph.depth, &options);
        let Ok(setup) = made else {
            continue;
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let mut machine = Machine::default();
        let stats = machine.render_within(&graph.view(), &setup, &mut frame, 200_000);
        hash.update(format!("{stats:?}").as_bytes());
        if let Ok(Some(_)) = stats {
            drawn += 1;
            hash.update(&self::hash(&frame).to_le_bytes());
        }
    }
    assert!(drawn * 2 > RECORDED_FRAMES, "{drawn}");
    compare("400 frames", hash.digest128());
}

/// A frame of any kind, some of which cannot be set up.
fn any_frame(dice: &mut Dice) -> (Camera, Placement, u32, Options) {
    use Coverage::{Alpha, Any, Center, Exact};
    let depth = dice.below(18);
    let side = (1u64 << depth) as f64;
    let far = dice.of(&[1.0, 1.0, 1.0, 30.0, 1e6, 1e15]);
    let mut point = |low, high| DVec3::from_array([0; 3].map(|_| dice.between(low, high) * side));
    let (eye, seen) = (point(-1.5 * far, 2.5 * far), point(0.0, 1.0));
    let target = match dice.below(12) {
        0..3 => eye + dice.of(&DVec3::AXES),
        3 => eye,
        _ => seen,
    };
    let infinite = f64::INFINITY;
    let mut options = Options {
        bits: dice.of(&[16, 20, 24, 32, 32, 40, 64, 64]),
        frac: dice.of(&[None, None, None, Some(4), Some(8), Some(14), Some(24)]),
        cage: dice.of(&[CageKind::Corners, CageKind::Frame]),
        tolerance_px: dice.of(&[0.0, 1.0 / 64.0, 0.1, 0.125, 0.3, 1.0, 7.0, 4097.0, infinite]),
        coverage: dice.of(&[Any, Center, Exact, Alpha]),
        lod_px: dice.of(&[0.0, 0.5, 1.0, 3.3]),
        aa_log2: dice.of(&[0, 0, 0, 0, 0, 1, 1, 2, 2, 3]),
    };
    // Rules that draw outlines have one tolerance. A value that no rule accepts stays.
    if options.coverage.draws_outlines() && options.tolerance_px != 4097.0 {
        options.tolerance_px = 0.0;
    }
    let placement = Placement {
        world_origin: [0; 3].map(|_| dice.of(&[0.0, 0.1, -3.7])),
        voxel_size: dice.of(&[1.0, 1.0, 0.037]),
        origin_index: [0; 3].map(|_| dice.of(&[0, 0, 5, -9])),
        mesh: None,
    };
    let camera = Camera {
        eye,
        target,
        up: dice.of(&[DVec3::Z, DVec3::Z, DVec3::Y, DVec3::new(0.3, -2.0, 9.0)]),
        fov_degrees: dice.between(0.5, 179.0),
        ortho: None,
        width: dice.of(&[1, 17, 512, 1024, 1000, 32768]),
        height: dice.of(&[1, 30, 512, 1024, 720]),
    };
    (camera, placement, depth, options)
}

const RECORDED_SETUPS: u32 = 20_000;

#[test]
fn the_integers_of_frames_are_those_recorded() {
    let mut hash = Xxh3::new();
    let mut dice = Dice::new(1);
    for _ in 0..RECORDED_SETUPS {
        let (camera, placement, depth, options) = any_frame(&mut dice);
        let made = FrameSetup::new(&camera, &placement, depth, &options);
        let opacity_eye = made.as_ref().map(FrameSetup::opacity_eye);
        // Parallel rays came after the record.
        let made = format!("{made:?}").replace(", ortho_eye: None", "");
        hash.update(format!("{made} {opacity_eye:?}").as_bytes());
    }
    compare("20000 frames", hash.digest128());
}
