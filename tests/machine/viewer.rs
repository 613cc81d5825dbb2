//! A viewer draws nothing where nothing changed, and never shows a stale picture.

use crate::common::*;
use crate::scenes::{CameraPlace, Dice, camera_at};
use glam::DVec3;
use proptest::prelude::*;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::{Colors, Frame};
use shiftvox::machine::Machine;
use shiftvox::project::viewer::FRAMES_UNCHANGED;
use shiftvox::project::{
    Camera, Canvas, Contents, Coverage, Engine, FrameSetup, SetupOptions, Viewer,
};
use shiftvox::rays::Rays;

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
        let moved = Camera { eye: first.eye + DVec3::X * 1e-6, ..first };
        let wider = Camera { width: first.width + 1, ..first };
        let cameras = [first, inside, moved, wider];
        let contents = if with_records { Contents::Records } else { Contents::Voxels };
        let canvas = Canvas::new(Box::new(Machine::default()));
        let mut viewer = Viewer::new(graph.view(), canvas, contents);
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
            let shown = viewer.render(&setup, &[]).map(|mut stats| {
                let (name, unchanged) = stats.pop().expect("a counter");
                assert_eq!(name, FRAMES_UNCHANGED);
                match unchanged {
                    0 => assert_eq!(Some(&stats), drawn.as_ref().ok()),
                    _ => assert!(stats.iter().all(|&(_, count)| count == 0)),
                }
                unchanged == 0
            });
            prop_assert_eq!(shown, drawn.as_ref().map(|_| is_new).map_err(|&error| error));
            let is_drawn = drawn.is_ok();
            prop_assert!(viewer.frame() == is_drawn.then_some(&right), "a stale picture");
            last = is_drawn.then_some(setup);
        }
    }
}

/// The fast engine declines the rule `any` and frames with records.
#[test]
fn used_engines_and_frames_of_other_sizes_draw_as_new_ones() {
    let graph = sierpinski(5);
    let light = lights(&graph);
    let view = graph.lit(&light);
    let fast = || {
        Box::new(Fast::new(
            FastOptions::default(),
            Box::new(Machine::default()),
        )) as Box<dyn Engine>
    };
    let engines = [
        fast as fn() -> Box<dyn Engine>,
        || Box::new(Machine::default()),
        || Box::new(Rays::default()),
    ];
    for (kind, new) in engines.iter().enumerate() {
        let mut used = new();
        let mut frames = [false, true].map(|with_records| Frame::new(7, 3, with_records));
        let mut colors = Colors::new(2, 200);
        for (coverage, size, with_records) in [
            (Coverage::Exact, (40, 30), false),
            (Coverage::Any, (40, 30), false),
            (Coverage::Exact, (65, 9), false),
            (Coverage::Exact, (65, 9), true),
            (Coverage::Alpha, (9, 65), false),
            (Coverage::Exact, (30, 40), false),
            (Coverage::Any, (1, 1), false),
            (Coverage::Alpha, (40, 30), false),
        ] {
            let (eye, target) = (DVec3::new(51.0, -22.0, 40.0), DVec3::splat(13.0));
            let camera = Camera::looking(eye, target, 50.0, size);
            let options = SetupOptions {
                coverage,
                ..SetupOptions::default()
            };
            let setup = setup(&graph, &camera, &options);
            let what = format!("{kind}, {coverage:?}, {size:?}");
            let mut right = Frame::new(size.0, size.1, with_records);
            let counts = new().render(&view, &setup, &mut right).expect("a frame");
            let frame = &mut frames[usize::from(with_records)];
            assert_eq!(
                used.render(&view, &setup, frame),
                Ok(counts.clone()),
                "{what}"
            );
            assert!(*frame == right && right.drawn() > 0, "{what}");
            let handed = counts.iter().any(|(name, _)| *name == "handed_to_machine");
            assert_eq!(
                handed,
                kind == 0 && (coverage == Coverage::Any || with_records)
            );
            *frame = Frame::new(3, 5, with_records);
            assert_eq!(used.render(&view, &setup, frame), Ok(counts), "{what}");
            assert!(*frame == right, "{what}");
            let mut right = Colors::new(size.0, size.1);
            let drawn = new().draw_colors(&view, &graph.color, &setup, &mut right);
            let again = used.draw_colors(&view, &graph.color, &setup, &mut colors);
            assert!(
                drawn == Ok(()) && again == drawn && colors.words == right.words,
                "{what}"
            );
        }
    }
}
