//! A viewer draws nothing where nothing changed, and never shows a stale picture.

use std::cell::Cell;

use crate::common::*;
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::graph::GraphView;
use shiftvox::machine::Machine;
use shiftvox::project::{
    Camera, Contents, Coverage, Engine, EngineError, FrameSetup, SetupOptions, Stats, Viewer,
    viewer::FRAMES_UNCHANGED,
};

/// The machine, which counts its frames, and fails on request.
struct Watched<'w> {
    machine: Machine,
    frames: &'w Cell<u32>,
    error: &'w Cell<Option<EngineError>>,
}

impl Engine for Watched<'_> {
    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        self.frames.set(self.frames.get() + 1);
        if let Some(error) = self.error.take() {
            frame.node.fill(7);
            return Err(error);
        }
        self.machine.render(graph, setup, frame)
    }
}

/// A frame in words that are too small for it.
fn trap() -> EngineError {
    let graph = solid(3);
    let options = SetupOptions {
        bits: 20,
        frac: Some(14),
        tolerance_px: f64::INFINITY,
        ..SetupOptions::of(Coverage::Any)
    };
    let setup = setup(&graph, &camera([-3.0, 4.0, 4.0], [4.0; 3], 64), &options);
    let mut frame = Frame::new(64, 64, false);
    let drawn = Machine::default().render(&graph.view(), &setup, &mut frame);
    drawn.expect_err("a trap")
}

/// An event between two pictures.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// A camera and settings of those that there are; whether it is counted.
    Draw(usize, usize, bool),
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
    [(1.0, 0), (4.0, 0), (1.0, 1)].map(|(lod_px, aa_log2)| SetupOptions {
        lod_px,
        aa_log2,
        ..SetupOptions::default()
    })
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn a_viewer_shows_what_a_new_engine_draws(
        graph in any_octree(3, 0.3),
        cameras in proptest::array::uniform2(any_camera(8.0, 1..60)),
        steps in proptest::collection::vec(any_step(), 1..16),
        with_records: bool,
        of_one_size: bool,
    ) {
        let [first, second] = cameras;
        let second = match of_one_size {
            true => Camera { width: first.width, height: first.height, ..second },
            false => second,
        };
        // The third differs little.
        let moved = Camera { eye: first.eye + glam::DVec3::X * 1e-6, ..first };
        let cameras = [first, second, moved];
        let (frames, error) = (Cell::new(0), Cell::new(None));
        let engine = Watched { machine: Machine::default(), frames: &frames, error: &error };
        let contents = if with_records { Contents::Records } else { Contents::Voxels };
        let mut viewer = Viewer::new(graph.view(), Box::new(engine), contents);
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
                    let mut right = Frame::new(setup.width, setup.height, with_records);
                    let work = Machine::default().render(&graph.view(), &setup, &mut right);
                    if counted {
                        let mut stats = viewer.render(&setup).expect("a frame");
                        prop_assert_eq!(stats.pop(), Some((FRAMES_UNCHANGED, u64::from(!is_new))));
                        if is_new {
                            prop_assert_eq!(stats, work.expect("a frame"));
                        } else {
                            prop_assert!(stats.iter().all(|&(_, count)| count == 0));
                        }
                    } else {
                        prop_assert_eq!(viewer.draw(&setup).expect("a frame"), is_new);
                    }
                    prop_assert_eq!(frames.get() - before, u32::from(is_new));
                    prop_assert!(viewer.frame() == Some(&right), "a stale picture");
                    last = Some(setup);
                }
                Step::Forget => {
                    viewer.forget();
                    prop_assert!(viewer.frame().is_none());
                    last = None;
                }
                Step::Fail(camera, options) => {
                    let Ok(setup) = set_up(camera, options) else { continue };
                    error.set(Some(trap()));
                    let drawn = viewer.render(&setup);
                    error.set(None);
                    // An unchanged frame does not call the engine.
                    prop_assert_eq!(drawn.is_ok(), last.as_ref() == Some(&setup));
                    if drawn.is_err() {
                        prop_assert!(viewer.frame().is_none(), "half a picture");
                        last = None;
                    }
                }
            }
        }
    }
}
