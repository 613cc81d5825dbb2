//! Every scene of the table, and every voxel file beside the repository, drawn by every engine
//! under every rule: the machine with both cages, the fast engine with each instruction set on one
//! thread and on two, the oracle in pools of several sizes. Cameras are outside, inside, in solids,
//! and where ties abound.
//!
//! `SHIFTVOX_ROUNDS` asks for another number of cameras at each place.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::Machine;
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions,
};
use shiftvox::rays::Rays;

use crate::common::{lights, with_opacities};
use crate::scene_table::SCENES;
use crate::scenes::*;

/// Pictures: pixels across and down, samples per pixel and axis as a power of two.
const SIZES: [(u32, u32, u32); 7] = [
    (112, 112, 0),
    (140, 79, 0),
    (53, 112, 0),
    (112, 84, 0),
    (56, 45, 1),
    (1, 160, 0),
    (30, 27, 2),
];

/// The size for rules under which the machine draws sample by sample.
const SMALL: (u32, u32, u32) = (43, 39, 0);

/// Cameras at each place, unless `SHIFTVOX_ROUNDS` asks for more.
const ROUNDS: u32 = 3;

/// Most records of a frame under the rules that subdivide solids.
const MOST_RECORDS: u64 = 200_000;

/// Pools in which the oracle draws the first pictures of a scene.
const POOLS: [usize; 4] = [1, 2, 5, 7];

/// All leaves: the rule that every camera is compared under, with both cages.
fn leaves() -> SetupOptions {
    SetupOptions {
        lod_px: 0.0,
        ..SetupOptions::default()
    }
}

/// The other rules, of which every second camera has one, in turn.
fn rules() -> [SetupOptions; 9] {
    let exact = SetupOptions::default();
    let any = SetupOptions::of(Coverage::Any);
    [
        exact,
        SetupOptions::of(Coverage::Alpha),
        SetupOptions {
            lod_px: 3.0,
            ..exact
        },
        SetupOptions::of(Coverage::Center),
        SetupOptions { bits: 32, ..exact },
        SetupOptions {
            lod_px: 0.1,
            cage: CageKind::Corners,
            ..exact
        },
        any,
        SetupOptions {
            lod_px: 0.0,
            ..SetupOptions::of(Coverage::Alpha)
        },
        // The image-order paper's.
        SetupOptions {
            cage: CageKind::Corners,
            tolerance_px: f64::INFINITY,
            ..any
        },
    ]
}

/// The fast engine, on so many threads with such instructions.
fn fast_engines() -> impl Iterator<Item = (FastOptions, Fast)> {
    [1, 2].into_iter().flat_map(|threads| {
        [Instructions::Scalar, Instructions::Avx2].map(|instructions| {
            let options = FastOptions {
                threads,
                instructions,
                ..FastOptions::default()
            };
            (options, Fast::new(options, Box::new(Machine::default())))
        })
    })
}

fn draw(
    engine: &mut impl Engine,
    graph: &GraphView<'_>,
    setup: &FrameSetup,
) -> Result<Frame, EngineError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    engine.render(graph, setup, &mut frame).map(|_| frame)
}

/// Where two frames differ, if they do.
fn difference(frame: &Frame, right: &Frame) -> Option<String> {
    if frame == right {
        return None;
    }
    let differs = |&at: &usize| {
        (frame.node[at], frame.voxel[at]) != (right.node[at], right.voxel[at])
            || frame.blend.as_ref().map(|b| b[at]) != right.blend.as_ref().map(|b| b[at])
    };
    let samples: Vec<usize> = (0..right.node.len()).filter(differs).collect();
    let covered = |frame: &Frame, at: usize| frame.node[at] != NO_NODE;
    let extra = samples
        .iter()
        .filter(|&&at| covered(frame, at) && !covered(right, at));
    let missing = samples
        .iter()
        .filter(|&&at| !covered(frame, at) && covered(right, at));
    let (extra, missing) = (extra.count(), missing.count());
    Some(match samples.first() {
        None => "the frames differ in size or buffers".to_owned(),
        Some(&at) => format!(
            "{} samples differ, {extra} extra, {missing} missing; the first, ({}, {}), shows {:?}, \
             not {:?}",
            samples.len(),
            at as u32 % right.width,
            at as u32 / right.width,
            frame.voxel[at],
            right.voxel[at],
        ),
    })
}

fn set_up(graph: &Graph, camera: &Camera, options: SetupOptions) -> Option<FrameSetup> {
    FrameSetup::new(camera, &graph.placement, graph.depth, &options).ok()
}

/// A scene while it is compared.
struct Comparison<'s> {
    name: &'s str,
    graph: &'s Graph,
    /// The same with opacities.
    airy: Graph,
    light: Vec<[u16; 3]>,
    compared: u64,
    drawn: u64,
    /// How often each of [`rules`] was drawn.
    rules_drawn: [u32; 9],
}

impl<'s> Comparison<'s> {
    fn new(name: &'s str, graph: &'s Graph) -> Self {
        Self {
            name,
            graph,
            airy: with_opacities(graph),
            light: lights(graph),
            compared: 0,
            drawn: 0,
            rules_drawn: [0; 9],
        }
    }

    fn insist(&self, engine: &str, setup: &FrameSetup, camera: &Camera, is: &Frame, right: &Frame) {
        if let Some(difference) = difference(is, right) {
            panic!(
                "{}: {engine}: {difference}; {:?}, {camera:?}",
                self.name, setup.options
            );
        }
    }

    /// Every leaf: machine and fast engine show what the oracle shows. `is_first`: in pools of all
    /// sizes.
    fn compare_leaves(&mut self, camera: &Camera, aa_log2: u32, is_first: bool) {
        let options = SetupOptions {
            aa_log2,
            ..leaves()
        };
        let setup = set_up(self.graph, camera, options).expect("a frame in 64 bits");
        let view = self.graph.view();
        let right = draw(&mut Rays, &view, &setup).expect("the oracle never fails");
        if is_first {
            for threads in POOLS {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build();
                let frame = pool
                    .expect("a pool")
                    .install(|| draw(&mut Rays, &view, &setup));
                let frame = frame.expect("the oracle never fails");
                let engine = format!("the oracle on {threads} threads");
                self.insist(&engine, &setup, camera, &frame, &right);
            }
        }
        // Both cages start from the same integers, so one oracle serves both.
        for cage in [CageKind::Frame, CageKind::Corners] {
            let setup = set_up(self.graph, camera, SetupOptions { cage, ..options });
            let setup = setup.expect("a frame in 64 bits");
            let frame =
                draw(&mut Machine::default(), &view, &setup).expect("no overflow in 64 bits");
            self.insist("the machine", &setup, camera, &frame, &right);
        }
        for (options, mut fast) in fast_engines() {
            let frame = draw(&mut fast, &view, &setup).expect("no overflow in 64 bits");
            self.insist(&format!("{options:?}"), &setup, camera, &frame, &right);
        }
        self.compared += right.node.len() as u64;
        self.drawn += right.drawn() as u64;
    }

    /// A rule: the fast engine draws what the machine draws, and what the oracle draws, if that
    /// draws the rule.
    fn compare_rule(&mut self, number: usize, camera: &Camera, aa_log2: u32) {
        let options = SetupOptions {
            aa_log2,
            ..rules()[number]
        };
        let graph = match options.coverage {
            Coverage::Alpha => &self.airy,
            _ => self.graph,
        };
        let Some(setup) = set_up(graph, camera, options) else {
            return;
        };
        let view = GraphView {
            light: &self.light,
            ..graph.view()
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let most = match options.coverage.draws_outlines() {
            true => u64::MAX,
            false => MOST_RECORDS,
        };
        let right = match Machine::default().render_within(&view, &setup, &mut frame, most) {
            Ok(None) => return,
            Ok(Some(_)) => Ok(frame),
            Err(error) => Err(error),
        };
        for (options, mut fast) in fast_engines() {
            match (&right, draw(&mut fast, &view, &setup)) {
                (Ok(right), Ok(frame)) => {
                    self.insist(&format!("{options:?}"), &setup, camera, &frame, right);
                }
                // A frame that overflows does so on either.
                (right, frame) => assert_eq!(right.as_ref().err(), frame.as_ref().err()),
            }
        }
        if let (Coverage::Exact, Ok(frame)) = (options.coverage, &right) {
            let oracle = draw(&mut Rays, &view, &setup).expect("the oracle never fails");
            self.insist("the machine", &setup, camera, frame, &oracle);
        }
        self.rules_drawn[number] += u32::from(right.is_ok());
    }
}

/// Compares all engines on a scene.
fn compare(name: &str, graph: &Graph) {
    let rounds = std::env::var("SHIFTVOX_ROUNDS").map_or(ROUNDS, |n| n.parse().expect("a number"));
    let mut dice = Dice::new(xxhash_rust::xxh3::xxh3_64(name.as_bytes()));
    let mut comparison = Comparison::new(name, graph);
    let places = (0..rounds).flat_map(|_| PLACES);
    for (number, place) in places.enumerate() {
        let (width, height, aa_log2) = SIZES[number % SIZES.len()];
        let camera = camera_at(place, graph, (width, height), &mut dice);
        comparison.compare_leaves(&camera, aa_log2, number == 0);
        if number % 2 == 1 {
            continue;
        }
        let rule = number / 2 % comparison.rules_drawn.len();
        let (width, height, aa_log2) = match rules()[rule].coverage.draws_outlines() {
            true => (width, height, aa_log2),
            false => SMALL,
        };
        let camera = Camera {
            width,
            height,
            ..camera
        };
        comparison.compare_rule(rule, &camera, aa_log2);
    }
    let Comparison {
        compared,
        drawn,
        rules_drawn,
        ..
    } = comparison;
    eprintln!("{name}: {compared} samples compared ({drawn} drawn), other rules {rules_drawn:?}");
    // Pictures of nothing would agree too.
    assert!(drawn * 20 > compared, "{name}: {drawn} of {compared}");
    let exact = rules_drawn
        .iter()
        .zip(rules())
        .filter(|(_, rule)| rule.bits == 64);
    for (times, rule) in exact.filter(|(_, rule)| rule.coverage.draws_outlines()) {
        assert!(*times > 0, "{name}: never drawn: {rule:?}");
    }
}

#[test]
fn every_engine_draws_every_scene_alike() {
    SCENES
        .par_iter()
        .for_each(|scene| compare(scene.name, scene.graph()));
}

#[test]
fn the_table_has_every_generator_and_every_file() {
    for generator in shiftvox::scene::generate::GENERATORS {
        let begins = format!("gen:{},", generator.name);
        let is_there = SCENES.iter().any(|scene| scene.name.starts_with(&begins));
        assert!(is_there, "{begins}");
    }
    let files = shipped_files();
    assert_eq!(files.len(), 3);
    for path in files {
        let is_there = SCENES.iter().any(|scene| path.ends_with(scene.name));
        assert!(is_there, "{}", path.display());
    }
}

#[test]
#[ignore = "takes long"]
fn every_engine_draws_every_shared_file_alike() {
    let Some(folder) = shared_data().map(|data| data.join("vox")) else {
        eprintln!("skipped: no shared data beside the repository");
        return;
    };
    let mut compared = 0;
    for path in vox_files(&folder) {
        let name = path.strip_prefix(&folder).expect("a file of the folder");
        let name = name.display().to_string();
        match graph_of_file(&path) {
            Ok(graph) => {
                compare(&name, &graph);
                compared += 1;
            }
            Err(error) => {
                assert_eq!(name, "not_a.vox", "{error}");
                eprintln!("{name}: refused, as it must be");
            }
        }
    }
    assert!(compared >= 14, "{compared} files");
}
