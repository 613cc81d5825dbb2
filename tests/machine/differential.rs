//! One property: every way to draw a frame gives the same frame ([`agree`]), of every scene of the table and of random
//! graphs.
//!
//! `SHIFTVOX_ROUNDS` sets the number of cameras at each place, `SHIFTVOX_CASES` multiplies the random frames,
//! `SHIFTVOX_CAMERAS` sets the number of absurd cameras.

use std::fmt::Debug;
use std::sync::atomic::{AtomicUsize, Ordering};

use hwmodel::cycles::{
    Hardware, Independence, MAX_TILE_LEVELS, NoObserver, Organisation, StackHolds,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use shiftvox::fast::{Fast, FastOptions, Instructions, Switches};
use shiftvox::frame::{Colors, Frame, NO_NODE, color_word};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::{Machine, MachineOptions, narrowed};
use shiftvox::project::{CageKind, Camera, Coverage, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

use crate::common::*;
use crate::scene_table::SCENES;
use crate::scenes::*;

/// Cameras at each place, unless `SHIFTVOX_ROUNDS` sets another number.
const ROUNDS: u32 = 1;

/// Most records of a frame, and of one under the rules that subdivide solids.
const MOST_RECORDS: u64 = 2_000_000;
const MOST_RECORDS_OF_SOLIDS: u64 = 100_000;

/// Most records of a frame that is also drawn in another organisation and on simulated hardware.
const MOST_SIMULATED: u64 = 4_000;

/// Pictures: pixels across and down, samples per pixel and axis as a power of two.
const SIZES: [(u32, u32, u32); 7] = [
    (112, 112, 0),
    (140, 79, 0),
    (53, 112, 0),
    (29, 37, 0),
    (56, 45, 1),
    (1, 160, 0),
    (30, 27, 2),
];

fn any_fast(dice: &mut Dice, instructions: Instructions, depth: u32) -> FastOptions {
    let mut is_on = || dice.below(7) > 0;
    let switches = Switches {
        hidden: is_on(),
        bricks: is_on(),
    };
    FastOptions {
        threads: dice.of(&[1, 2, 3]),
        instructions,
        // Without skips a fractal of many levels takes hours.
        switches: match depth > 9 || dice.below(2) == 0 {
            true => Switches::default(),
            false => switches,
        },
    }
}

fn any_organisation(dice: &mut Dice) -> Organisation {
    let leaf_masks = dice.below(3) > 0;
    Organisation {
        stack: dice.of(&[StackHolds::Children, StackHolds::Parents, StackHolds::Path]),
        leaf_masks,
        bricks: leaf_masks && dice.below(2) == 0,
        tile_levels: dice.of(&[0, 0, 0, 0, 2, 2, 2, MAX_TILE_LEVELS]),
        hidden_unread: dice.below(2) == 0,
        joined_fill: dice.below(2) == 0,
        packed: dice.below(2) == 0,
    }
}

/// Hardware whose records meet in many ways.
fn any_hardware(dice: &mut Dice) -> Hardware {
    use Independence::{Both, Classes, Image, None};
    let mut hardware = Hardware::preset(dice.of(&["tiny", "paper", "wide"])).unwrap();
    if dice.below(3) > 0 {
        hardware.organisation = any_organisation(dice);
    }
    (hardware.lanes, hardware.contexts) = (1 + dice.below(19), 1 + dice.below(8));
    hardware.stack.entries = 1 + dice.below(79);
    hardware.fill_vectors.banks = 1 + dice.below(4);
    hardware.independence = dice.of(&[None, Image, Classes, Both]);
    if dice.below(3) == 0 {
        // Misses so slow that children of one class overtake one another.
        let cache = &mut hardware.node_cache;
        (cache.ways, cache.line_bytes, cache.bytes) = (1, 8, 8 * (1 + dice.below(15)));
        cache.miss_latency = 700;
        hardware.lanes = 3;
    }
    hardware
}

/// Settings of all kinds, many of them the default ones.
pub(super) fn any_settings(dice: &mut Dice) -> SetupOptions {
    use Coverage::{Alpha, Any, Center, Exact};
    let coverage = dice.of(&[Exact, Exact, Exact, Exact, Alpha, Alpha, Center, Any]);
    let tolerance_px = dice.of(&[0.0, 0.0, 1.0 / 16.0, 1.0 / 8.0, 1.5, f64::INFINITY]);
    let (bits, frac) = match dice.below(8) {
        0 => (24 + dice.below(40), None),
        1 => (24 + dice.below(40), Some(4 + dice.below(8))),
        _ => (64, None),
    };
    SetupOptions {
        bits,
        frac,
        cage: dice.of(&[CageKind::Frame, CageKind::Corners]),
        tolerance_px: tolerance_of(coverage, tolerance_px),
        coverage,
        lod_px: match dice.below(8) {
            0 => dice.between(0.01, 8.0),
            1 => dice.of(&[0.5, 3.0, 16.0, 4096.0]),
            2..5 => 1.0,
            _ => 0.0,
        },
        aa_log2: dice.of(&[0, 0, 0, 1, 2]),
    }
}

/// Opacities by node: some voxels are empty, opaque, or unlike from their sides.
fn airy(graph: &Graph) -> Graph {
    let opacity = (7..graph.len() as u32 + 7).map(|node| {
        let [kind, sides @ ..] = node.wrapping_mul(0x9e37_79b1).to_be_bytes();
        match kind & 7 {
            0 => [0; 3],
            1 => [255; 3],
            2 => [0x0f, 0, 0],
            3 => [0x11; 3],
            _ => sides,
        }
    });
    with_opacities(graph, &opacity.collect::<Vec<_>>())
}

fn empty(setup: &FrameSetup) -> Frame {
    Frame::new(setup.width, setup.height, false)
}

/// Pictures under `t = inf` that depended on the order (`SPEC.md`, 5).
static DEPENDENT: AtomicUsize = AtomicUsize::new(0);

/// [`same`], or counted where the order may matter.
fn is_same(setup: &FrameSetup, frame: &Frame, right: &Frame, what: &dyn Debug) -> bool {
    let is_dependent = setup.options.tolerance_px.is_infinite() && frame != right;
    if is_dependent {
        DEPENDENT.fetch_add(1, Ordering::Relaxed);
    } else {
        same(frame, right, what);
    }
    !is_dependent
}

fn same(frame: &Frame, right: &Frame, what: &dyn Debug) {
    let mut voxels = frame.voxel.iter().zip(&right.voxel).enumerate();
    let first = voxels.find(|(_, (is, should_be))| is != should_be);
    assert!(frame == right, "{what:?}: (at, (is, should be)) {first:?}");
}

/// Draws a frame in all ways. Returns the machine's; `None` where there is none, or one of too many records.
fn agree(graph: &Graph, camera: &Camera, options: &SetupOptions, dice: &mut Dice) -> Option<Frame> {
    let coverage = options.coverage;
    // Without opacities voxels are opaque.
    let blended = (coverage.blends() && dice.below(4) > 0).then(|| airy(graph));
    let graph = blended.as_ref().unwrap_or(graph);
    let light = lights(graph);
    let view = graph.lit(&light);
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, options).ok()?;
    let machine = |machine: MachineOptions, setup: &FrameSetup, most: u64| {
        let mut frame = empty(setup);
        let drawn = Machine::new(machine).render_within(&view, setup, &mut frame, most);
        drawn.map(|stats| Some((frame, stats?))).transpose()
    };
    let outlines = coverage.draws_outlines();
    let most = match outlines {
        true => MOST_RECORDS,
        false => MOST_RECORDS_OF_SOLIDS,
    };
    let drawn = machine(MachineOptions::default(), &setup, most)?;
    // Without headroom, words may overflow in another order or organisation.
    let is_usual = options.bits == 64 && options.frac.is_none() && setup.has_headroom;
    let (corner, side) = cube(graph);
    let is_absurd = camera.fov_degrees > 170.0 || camera.eye.distance(corner) > 1000.0 * side;
    for instructions in [Instructions::Scalar, Instructions::Auto] {
        let options = any_fast(dice, instructions, graph.depth);
        let mut fast = Fast::new(options, Box::new(Machine::default()));
        let mut frame = empty(&setup);
        let result = fast.render(&view, &setup, &mut frame);
        let handed = |stats: &Vec<_>| shiftvox::project::stat(stats, "handed_to_machine") > 0;
        let declined = result.as_ref().is_ok_and(handed);
        assert_eq!(result.err(), drawn.as_ref().err().copied(), "{options:?}");
        let Ok((right, _)) = &drawn else {
            continue;
        };
        same(&frame, right, &options);
        // Deep graphs far away may be beyond the fast engine's lanes.
        let may_decline = !is_usual || !outlines || graph.depth > 12 || is_absurd;
        assert!(may_decline || !declined, "{options:?}");
        let mut colors = Colors::new(setup.width, setup.height);
        colors.words.fill(3);
        let drawn = fast.draw_colors(&view, &graph.color, &setup, &mut colors);
        drawn.expect("drawn before");
        let color = |&node: &u32| match node {
            NO_NODE => 0,
            node => color_word(graph.color[node as usize]),
        };
        assert!(frame.node.iter().map(color).eq(colors.words), "{options:?}");
    }
    let (right, stats) = drawn.ok()?;
    if coverage == Coverage::Exact {
        let threads = dice.of(&[1, 2, 5, 7]);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("a pool");
        let oracle = |setup: &FrameSetup| {
            let mut frame = empty(setup);
            let drawn = pool.install(|| Rays::default().render(&view, setup, &mut frame));
            drawn.expect("the oracle never fails");
            frame
        };
        same(&oracle(&setup), &right, &"the oracle");
        if options.lod_px > 0.0 {
            let all = oracle(&setup.without_detail());
            let mut samples = right.node.iter().zip(&all.node);
            let is_lost = samples.any(|(&drawn, &all)| drawn == NO_NODE && all != NO_NODE);
            assert!(!is_lost, "level of detail loses a sample");
        }
    }
    if !is_usual {
        return Some(right);
    }
    let again = |options: MachineOptions, setup: &FrameSetup, most: u64| {
        machine(options, setup, most).map(|drawn| drawn.expect("no overflow"))
    };
    if options.tolerance_px == 0.0 {
        // In clip space both cages do the same.
        let cage = match options.cage {
            CageKind::Frame => CageKind::Corners,
            CageKind::Corners => CageKind::Frame,
        };
        let other = crate::common::setup(graph, camera, &SetupOptions { cage, ..*options });
        let (frame, counts) = again(MachineOptions::default(), &other, most).expect("as many");
        same(&frame, &right, &"the other cage");
        // Boxes are narrowed by half a sample, which is rounded for each number of a cage. So in a wide view from a
        // corner one cage may have a record more.
        assert!(
            camera.fov_degrees > 170.0 || counts == stats,
            "{counts:?} in the other cage, {stats:?}"
        );
    }
    let records = stat(&stats, "records");
    if records > MOST_SIMULATED {
        return Some(right);
    }
    let all = MachineOptions {
        reject_filled: false,
        ..MachineOptions::default()
    };
    if let Some((frame, more)) = again(all, &setup, 20 * MOST_SIMULATED) {
        let is_same = is_same(&setup, &frame, &right, &"without rejection");
        assert!(!is_same || records <= stat(&more, "records"));
    }
    agree_in_organisations(&view, &setup, dice, &right);
    Some(right)
}

/// Draws in two organisations, in the second also on simulated hardware.
fn agree_in_organisations(
    view: &GraphView<'_>,
    setup: &FrameSetup,
    dice: &mut Dice,
    right: &Frame,
) {
    let options = &setup.options;
    // Where a box or a centre claims a sample, it may be one beside the tile. One walk per sample is slow.
    let most_levels = match right.node.len() {
        _ if !options.coverage.draws_outlines() => 0,
        ..1_500 => MAX_TILE_LEVELS,
        _ => 2,
    };
    let serial = |organisation: &mut Organisation| {
        organisation.tile_levels = organisation.tile_levels.min(most_levels);
        // A wide word that is too narrow traps.
        let setup = match organisation.packed {
            true => narrowed(setup),
            false => setup.clone(),
        };
        let mut machine = Machine::new(MachineOptions {
            organisation: *organisation,
            ..MachineOptions::default()
        });
        let mut frame = empty(&setup);
        let stats = machine.render(view, &setup, &mut frame);
        let stats = stats.unwrap_or_else(|trap| panic!("{trap:?} in {organisation:?}"));
        is_same(&setup, &frame, right, organisation).then_some((setup, stats))
    };
    serial(&mut any_organisation(dice));
    let mut hardware = any_hardware(dice);
    let Some((setup, mut stats)) = serial(&mut hardware.organisation) else {
        return;
    };
    let mut frame = empty(&setup);
    let simulated = Machine::default()
        .simulate(view, &setup, &mut frame, &hardware, &mut NoObserver)
        .expect("what the machine draws");
    let (mut counts, cycles) = (simulated.counts, simulated.cycles);
    // A lane takes up a tile only where no record of another one is ready.
    let (_, open) = counts.pop().expect("the most tiles in progress");
    assert!(open <= hardware.all_contexts() || hardware.lanes != 1);
    let is_possible = cycles.bounds.iter().all(|b| b.cycles <= cycles.cycles);
    assert!(is_possible && cycles.cycles <= cycles.serial, "{cycles:?}");
    let sum = cycles.context_cycles;
    let accounted = sum.working + sum.stalled + sum.order_wait + sum.no_record;
    assert_eq!(accounted, cycles.cycles * hardware.all_contexts());
    match hardware.independence {
        // Records whose image nodes meet have their turns in the serial order.
        Independence::None | Independence::Image => {
            if !is_same(&setup, &frame, right, &hardware) {
                return;
            }
            stats.retain(|(name, _)| *name != "deepest_stack");
            assert_eq!(counts, stats, "{hardware:?}");
        }
        // The image-order paper's claim: children of one class never occlude one another.
        _ if options.coverage == Coverage::Exact => same(&frame, right, &hardware),
        // Under other rules they may claim the same sample, which is drawn by one of them.
        _ if options.tolerance_px.is_finite() && !options.coverage.blends() => {
            let mut samples = frame.node.iter().zip(&right.node);
            let are_same = samples.all(|(&a, &b)| (a == NO_NODE) == (b == NO_NODE));
            assert!(are_same, "{hardware:?}: other samples");
        }
        _ => {}
    }
}

/// Shows what failed.
struct OnPanic<'a>((&'a str, Camera, SetupOptions));

impl Drop for OnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{:?}", self.0);
        }
    }
}

/// Draws a scene from every place: all leaves, and in turn other settings.
fn agree_on_scene(name: &str, graph: &Graph) {
    let rounds = number_of("SHIFTVOX_ROUNDS", ROUNDS);
    let mut dice = Dice::new(xxhash_rust::xxh3::xxh3_64(name.as_bytes()));
    let (mut samples, mut drawn) = (0, 0);
    for (number, place) in (0..rounds).flat_map(|_| PLACES).enumerate() {
        let (width, height, aa_log2) = SIZES[number % SIZES.len()];
        let camera = camera_at(place, graph, (width, height), &mut dice);
        let leaves = SetupOptions {
            lod_px: 0.0,
            aa_log2,
            ..SetupOptions::default()
        };
        let other = SetupOptions {
            aa_log2,
            ..any_settings(&mut dice)
        };
        let mut smaller = camera;
        if !other.coverage.draws_outlines() {
            // The machine draws the other rules sample by sample.
            (smaller.width, smaller.height) = (43, 39);
        }
        for (camera, options) in [(camera, leaves), (smaller, other)] {
            let _shown = OnPanic((name, camera, options));
            if let Some(frame) = agree(graph, &camera, &options, &mut dice) {
                samples += frame.node.len();
                drawn += frame.drawn();
            }
        }
    }
    // Pictures of nothing would agree too.
    assert!(drawn * 20 > samples, "{name}: {drawn} of {samples}");
}

#[test]
fn every_scene_is_drawn_alike() {
    SCENES
        .par_iter()
        .for_each(|(name, graph)| agree_on_scene(name, graph));
}

#[test]
#[ignore = "needs the folder SHIFTVOX_DATA"]
fn every_file_is_drawn_alike() {
    let folder = std::env::var_os("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names a folder");
    let mut drawn = 0;
    for below in ["", "voxelshop/fit_to_bb", "voxelshop/fit_to_size"] {
        for file in
            std::fs::read_dir(std::path::Path::new(&folder).join("vox").join(below)).unwrap()
        {
            let path = file.unwrap().path();
            if let Ok(scene) = shiftvox::Scene::open(&path) {
                agree_on_scene(&path.display().to_string(), scene.graph());
                drawn += 1;
            }
        }
    }
    assert!(drawn > 9, "{drawn} files");
}

/// Random graphs, and octrees with voxels of about a sample, dense and sparse ones.
fn any_scene() -> impl Strategy<Value = Graph> {
    prop_oneof![
        3 => any_graph(1..9),
        1 => any_octree(3, 0.2),
        1 => any_octree(4, 0.3),
        1 => any_octree(4, 0.02),
    ]
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn random_scenes_are_drawn_alike(
        (graph, camera) in any_view(any_scene(), 1..100),
        seed: u64,
    ) {
        let mut dice = Dice::new(seed);
        let settings = any_settings(&mut dice);
        // Under the other rules a cyclic graph is subdivided to the last bit.
        prop_assume!(settings.coverage.draws_outlines() || graph.depth < 5);
        agree(&graph, &camera, &settings, &mut dice);
    }
}

/// A view of up to 179.999 or down to 0.0001 degrees, from up to 10 million sides of the cube or a tiny part of a voxel
/// away.
fn absurd_camera(graph: &Graph, dice: &mut Dice) -> Camera {
    let mut camera = any_camera(graph, 1..17, dice);
    match dice.below(4) {
        0 => camera.fov_degrees = 180.0 - 10f64.powf(dice.between(-3.0, 1.5)),
        1 => camera.fov_degrees = 10f64.powf(dice.between(-4.0, 1.0)),
        _ => {}
    }
    if dice.below(2) == 0 {
        let distance = cube(graph).1 * 10f64.powf(dice.between(-12.0, 7.0));
        camera.eye = camera.target + distance * dice.point(-1.0, 1.0);
        camera.up = up_of(camera.target - camera.eye);
    }
    camera
}

#[test]
fn absurd_cameras_are_drawn_alike() {
    let cameras = number_of("SHIFTVOX_CAMERAS", 300);
    // Made here: where a thread of the pool makes them, it may take up a job that waits for them.
    let scenes = &*SCENES;
    let draw = |seed: u32| {
        let mut dice = Dice::new(u64::from(seed));
        let bytes = [(); 32].map(|()| dice.below(256) as u8);
        let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
        let random = any_scene().new_tree(&mut TestRunner::new_with_rng(cases(1), rng));
        let random = random.expect("a graph").current();
        let graph = match dice.below(2) {
            0 => &scenes[dice.below(scenes.len() as u32) as usize].1,
            _ => &random,
        };
        let (camera, settings) = (absurd_camera(graph, &mut dice), any_settings(&mut dice));
        let _shown = OnPanic((&format!("seed {seed}"), camera, settings));
        let frame = agree(graph, &camera, &settings, &mut dice);
        frame.map_or([0; 3], |frame| [1, frame.node.len(), frame.drawn()])
    };
    let add = |one: [usize; 3], other: [usize; 3]| std::array::from_fn(|i| one[i] + other[i]);
    // Few long jobs: a thread that waits for an engine takes up others, each deeper in its stack.
    let jobs = (0..8u32).into_par_iter().map(|job| {
        let seeds = (job..cameras).step_by(8);
        seeds.map(draw).fold([0; 3], add)
    });
    let sums = jobs.reduce(Default::default, add);
    let [frames, samples, drawn] = sums;
    let dependent = DEPENDENT.load(Ordering::Relaxed);
    println!(
        "{cameras} cameras: {frames} frames compared, {samples} samples, {drawn} drawn; \
         {dependent} pictures under t = inf depended on the order"
    );
    assert!(dependent <= 2 + frames / 1000, "{dependent}");
    assert!(
        frames > cameras as usize / 2 && drawn > samples / 20,
        "{sums:?}"
    );
}
