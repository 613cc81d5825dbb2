//! The integers of frames, bit by bit.

use glam::DVec3;
use shiftvox::graph::Placement;
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};

use crate::scenes::Dice;

/// A frame of any kind, some of which cannot be set up.
fn any_frame(dice: &mut Dice) -> (Camera, Placement, u32, SetupOptions) {
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
    use Coverage::{Alpha, Any, Center, Exact};
    let infinite = f64::INFINITY;
    let mut options = SetupOptions {
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
        width: dice.of(&[1, 17, 512, 1024, 1000, 32768]),
        height: dice.of(&[1, 30, 512, 1024, 720]),
    };
    (camera, placement, depth, options)
}

/// A word format as it was printed when the hash was recorded.
#[derive(Debug)]
#[expect(dead_code, reason = "it is printed")]
struct Format {
    bits: u32,
    frac: u32,
}

/// All integers of a frame, as text.
fn integers(setup: &FrameSetup) -> String {
    let format = Format {
        bits: setup.format.bits(),
        frac: setup.format.frac(),
    };
    let sizes = (
        (setup.width, setup.height, setup.levels, setup.depth),
        (format, setup.clip_frac, setup.sub_levels),
        (setup.positive, setup.grow_shift, setup.near),
    );
    let view = (setup.origin_clip, setup.edge_clip);
    let eye = (setup.eye_floor, setup.eye_ceil, setup.opacity_eye());
    let depths = (&setup.screen_depth, &setup.lod_depth);
    let limits = (&setup.size_limit, &setup.lod_limit);
    // The rules that draw outlines have no screen positions to leave room for.
    let outlines = setup.options.coverage.draws_outlines();
    let headroom = (!outlines).then_some(setup.has_headroom);
    format!("{sizes:?} {view:?} {eye:?} {depths:?} {limits:?} {headroom:?}")
}

const RECORDED_FRAMES: u32 = 20_000;
/// FNV-1a of all integers of these frames, or why there is none (recorded at commit 8284428).
const RECORDED_HASH: u64 = 0xe136_c7d9_7fb5_f1e1;

#[test]
fn the_integers_of_frames_are_those_recorded() {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut dice = Dice::new(1);
    for _ in 0..RECORDED_FRAMES {
        let (camera, placement, depth, options) = any_frame(&mut dice);
        let made = FrameSetup::new(&camera, &placement, depth, &options);
        let text = match &made {
            Ok(setup) => integers(setup),
            // With the unit that messages named when this was recorded.
            Err(error) => format!("{error:?}").replace("4096 samples, or", "4096 pixels, or"),
        };
        for byte in text.bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    assert_eq!(hash, RECORDED_HASH, "{hash:#x}");
}
