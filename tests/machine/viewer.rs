//! A viewer draws nothing where nothing changed, and never shows a stale picture.

use crate::common::*;
use crate::scenes::{CameraPlace, Dice, camera_at};
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::machine::Machine;
use shiftvox::project::viewer::FRAMES_UNCHANGED;
use shiftvox::project::{Camera, Contents, Engine, FrameSetup, SetupOptions, Viewer};

fn settings(number: usize) -> SetupOptions {
    let mut options = SetupOptions::default();
    match number {
        0 => {}
        1 => options.lod_px = 4.0,
        2 => options.aa_log2 = 1,
        // Words that are too small for many cameras: frames fail when they are half drawn.
        _ => {
            options = SetupOptions::paper();
            (options.bits, options.frac) = (20, Some(14));
        }
    }
    options
}

proptest! {
    #![proptest_config(cases(32))]

    // Few cameras and settings, so that many pictures come twice.
    #[test]
    fn a_viewer_shows_what_a_new_engine_draws(
        (graph, first) in any_view(any_octree(3, 0.3), 1..60),
        seed: u64,
        steps in proptest::collection::vec((0..4usize, 0..4usize, 0..9), 1..16),
        with_records: bool,
    ) {
        let size = (first.width, first.height);
        let inside = camera_at(CameraPlace::Inside, &graph, size, &mut Dice::new(seed));
        // These differ little.
        let moved = Camera { eye: first.eye + glam::DVec3::X * 1e-6, ..first };
        let wider = Camera { width: first.width + 1, ..first };
        let cameras = [first, inside, moved, wider];
        let contents = if with_records { Contents::Records } else { Contents::Voxels };
        let mut viewer = Viewer::new(graph.view(), Machine::default(), contents);
        let mut last: Option<FrameSetup> = None;
        for (camera, options, step) in steps {
            if step == 0 {
                viewer.forget();
                prop_assert!(viewer.frame().is_none());
                last = None;
                continue;
            }
            let (camera, options) = (&cameras[camera], settings(options));
            let Ok(setup) = FrameSetup::new(camera, &graph.placement, graph.depth, &options) else {
                continue;
            };
            let is_new = last.as_ref() != Some(&setup);
            let mut right = Frame::new(setup.width, setup.height, with_records);
            let drawn = Machine::default().render(&graph.view(), &setup, &mut right);
            let shown = match step {
                1..5 => viewer.draw(&setup),
                _ => viewer.render(&setup).map(|mut stats| {
                    let (name, unchanged) = stats.pop().expect("a counter");
                    assert_eq!(name, FRAMES_UNCHANGED);
                    match unchanged {
                        0 => assert_eq!(Some(&stats), drawn.as_ref().ok()),
                        _ => assert!(stats.iter().all(|&(_, count)| count == 0)),
                    }
                    unchanged == 0
                }),
            };
            prop_assert_eq!(shown, drawn.as_ref().map(|_| is_new).map_err(|&error| error));
            let is_drawn = drawn.is_ok();
            prop_assert!(viewer.frame() == is_drawn.then_some(&right), "a stale picture");
            last = is_drawn.then_some(setup);
        }
    }
}
