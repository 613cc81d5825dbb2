//! A viewer draws nothing where nothing changed, and never shows a stale picture.

use std::cell::Cell;

use crate::common::*;
use proptest::prelude::*;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{
    Camera, Contents, Coverage, Engine, EngineError, FrameSetup, SetupOptions, Stats, Viewer,
    viewer::FRAMES_UNCHANGED,
};
use shiftvox::rays::Rays;

/// The fast engine on one thread, which counts its frames, and fails on request.
struct Watched<'w> {
    engine: Fast,
    frames: &'w Cell<u32>,
    fails: &'w Cell<bool>,
}

impl Watched<'_> {
    fn begin(&self) -> Result<(), EngineError> {
        self.frames.set(self.frames.get() + 1);
        if self.fails.get() {
            Err(trap())
        } else {
            Ok(())
        }
    }
}

impl Engine for Watched<'_> {
    fn draw(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<(), EngineError> {
        self.begin()?;
        self.engine.draw(graph, setup, frame)
    }

    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        self.begin().inspect_err(|_| frame.node.fill(7))?;
        self.engine.render(graph, setup, frame)
    }
}

/// Some error: a frame in words that are too small for it.
fn trap() -> EngineError {
    let graph = solid(3);
    let options = SetupOptions {
        bits: 20,
        frac: Some(14),
        tolerance_px: f64::INFINITY,
        ..SetupOptions::of(Coverage::Any)
    };
    let setup = setup(&graph, &camera([-3.0, 4.0, 4.0], [4.0; 3], 64), &options);
    draw_with(MachineOptions::default(), &graph, &setup).expect_err("a trap")
}

fn fast() -> Fast {
    let options = FastOptions {
        threads: 1,
        ..FastOptions::default()
    };
    Fast::new(options, Box::new(Machine::default()))
}

/// The frame of a new engine.
fn anew(graph: &Graph, setup: &FrameSetup, with_records: bool) -> Frame {
    let mut frame = Frame::new(setup.width, setup.height, with_records);
    let drawn = fast().render(&graph.view(), setup, &mut frame);
    drawn.expect("a frame");
    frame
}

fn unchanged(stats: &Stats) -> u64 {
    stat(stats, FRAMES_UNCHANGED)
}

/// An event between two pictures.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// A camera and settings of those that there are; whether it is counted.
    Draw(usize, usize, bool),
    /// The viewer drops its frame.
    Forget,
    /// The engine fails once.
    Fail(usize, usize),
}

fn any_step() -> impl Strategy<Value = Step> {
    // Few of each, so that many pictures come twice.
    prop_oneof![
        8 => (0..3usize, 0..3usize, any::<bool>()).prop_map(|(c, s, r)| Step::Draw(c, s, r)),
        1 => Just(Step::Forget),
        1 => (0..3usize, 0..3usize).prop_map(|(c, s)| Step::Fail(c, s)),
    ]
}

fn settings() -> [SetupOptions; 3] {
    let usual = SetupOptions::default();
    [
        usual,
        SetupOptions {
            lod_px: 4.0,
            ..usual
        },
        SetupOptions {
            aa_log2: 1,
            ..usual
        },
    ]
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn a_viewer_shows_what_a_new_engine_draws(
        graph in any_octree(3, 0.3),
        cameras in proptest::array::uniform3(any_camera(8.0, 1..60)),
        steps in proptest::collection::vec(any_step(), 1..16),
        with_records: bool,
        of_one_size: bool,
    ) {
        let [first, ..] = cameras;
        let cameras = cameras.map(|camera| match of_one_size {
            true => Camera { width: first.width, height: first.height, ..camera },
            false => camera,
        });
        let (frames, fails) = (Cell::new(0), Cell::new(false));
        let engine = Watched {
            engine: fast(),
            frames: &frames,
            fails: &fails,
        };
        let contents = if with_records { Contents::Records } else { Contents::Voxels };
        let mut viewer = Viewer::new(graph.view(), engine, contents);
        let mut last: Option<FrameSetup> = None;
        let set_up = |camera: usize, options: usize| {
            FrameSetup::new(&cameras[camera], &graph.placement, graph.depth, &settings()[options])
        };
        for step in steps {
            let before = frames.get();
            match step {
                Step::Draw(camera, options, counted) => {
                    let Ok(setup) = set_up(camera, options) else { continue };
                    let is_new = last.as_ref() != Some(&setup);
                    if counted {
                        let stats = viewer.render(&setup).expect("a frame");
                        prop_assert_eq!(unchanged(&stats), u64::from(!is_new));
                    } else {
                        prop_assert_eq!(viewer.draw(&setup).expect("a frame"), is_new);
                    }
                    prop_assert_eq!(frames.get() - before, u32::from(is_new));
                    let shown = viewer.frame().expect("a frame");
                    prop_assert!(*shown == anew(&graph, &setup, with_records), "a stale picture");
                    last = Some(setup);
                }
                Step::Forget => {
                    viewer.forget();
                    prop_assert!(viewer.frame().is_none());
                    last = None;
                }
                Step::Fail(camera, options) => {
                    let Ok(setup) = set_up(camera, options) else { continue };
                    fails.set(true);
                    let drawn = viewer.render(&setup);
                    fails.set(false);
                    if last.as_ref() == Some(&setup) {
                        // The engine is not called.
                        prop_assert!(drawn.is_ok());
                    } else {
                        prop_assert!(drawn.is_err());
                        prop_assert!(viewer.frame().is_none(), "half a picture");
                        last = None;
                    }
                }
            }
        }
    }
}

#[test]
fn every_part_of_a_setup_counts() {
    let graph = octree(3, &|[x, y, z]| (x + y + z) % 3 == 0);
    let first = camera([-5.0, -3.0, 9.0], [4.0, 4.0, 4.0], 48);
    let wider = Camera { width: 49, ..first };
    let moved = Camera {
        eye: first.eye + glam::DVec3::X * 1e-6,
        ..wider
    };
    let other_field = Camera {
        fov_degrees: 60.5,
        ..moved
    };
    let [usual, lod, _] = settings();
    let mut viewer = Viewer::new(graph.view(), fast(), Contents::default());
    for (camera, options, is_new) in [
        (first, usual, true),
        (first, usual, false),
        (first, lod, true),
        (first, usual, true),
        (wider, usual, true),
        (moved, usual, true),
        (moved, usual, false),
        (other_field, usual, true),
        (moved, usual, true),
    ] {
        let setup = setup(&graph, &camera, &options);
        let stats = viewer.render(&setup).expect("a frame");
        assert_eq!(unchanged(&stats), u64::from(!is_new));
        assert_eq!(
            stat(&stats, "samples_drawn") > 0,
            is_new,
            "an unchanged frame is no work"
        );
        assert!(viewer.frame() == Some(&anew(&graph, &setup, false)));
    }
}

#[test]
fn viewers_do_not_disturb_each_other() {
    // Graphs of one shape in memory, made and dropped in turn, so that a later
    // one may lie where an earlier one lay; and other engines in between.
    let camera = camera([-5.0, -3.0, 9.0], [4.0, 4.0, 4.0], 48);
    let options = SetupOptions::default();
    let mut pictures = Vec::new();
    for seed in 0..4 {
        let graph = octree(3, &|[x, y, z]| (x + y * 2 + z + seed) % 4 == 0);
        let setup = setup(&graph, &camera, &options);
        let mut fast = Viewer::new(graph.view(), fast(), Contents::Voxels);
        let mut rays = Viewer::new(graph.view(), Rays, Contents::Voxels);
        let boxed: Box<dyn Engine> = Box::new(Machine::default());
        let mut machine = Viewer::new(graph.view(), boxed, Contents::Voxels);
        assert!(fast.draw(&setup).expect("a frame"));
        assert!(machine.draw(&setup).expect("a frame"));
        assert!(rays.draw(&setup).expect("a frame"));
        assert!(!fast.draw(&setup).expect("a frame"));
        assert!(!machine.draw(&setup).expect("a frame"));
        assert!(fast.frame() == machine.frame());
        let right = anew(&graph, &setup, false);
        assert!(fast.frame() == Some(&right), "a stale picture");
        pictures.push(right);
    }
    assert!(pictures[0] != pictures[1], "the graphs look alike");
}
