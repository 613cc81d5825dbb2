//! One property: every way to draw a frame gives the same frame ([`Scene::agree`]). Frames are of every scene of the
//! table, of random graphs, and of voxel files in the folder `SHIFTVOX_DATA`.
//!
//! `SHIFTVOX_ROUNDS` sets the number of cameras at each place, `SHIFTVOX_CASES` multiplies the random frames.

use hwmodel::cycles::{
    Hardware, Independence, MAX_TILE_LEVELS, NoObserver, Organisation, StackHolds,
};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use shiftvox::fast::{Fast, FastOptions, Instructions, Switches};
use shiftvox::frame::{Colors, Frame, NO_NODE, color_word};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::{Machine, MachineOptions, narrowed};
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions, Stats,
};
use shiftvox::rays::Rays;

use crate::common::*;
use crate::scene_table::SCENES;
use crate::scenes::*;

/// Cameras at each place, unless `SHIFTVOX_ROUNDS` sets another number.
const ROUNDS: u32 = 3;

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
        full: is_on(),
        off_screen: is_on(),
        bricks: is_on(),
        whole_blocks: is_on(),
        absent_children: is_on(),
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
    let mut hardware = Hardware::preset(dice.of(&["tiny", "paper", "wide"])).unwrap();
    if dice.below(3) > 0 {
        hardware.organisation = any_organisation(dice);
    }
    (hardware.lanes, hardware.contexts) = (1 + dice.below(19), 1 + dice.below(8));
    hardware.stack.entries = 1 + dice.below(79);
    hardware.fill_vectors.banks = 1 + dice.below(4);
    hardware.independence = dice.of(&[
        Independence::None,
        Independence::Image,
        Independence::Classes,
        Independence::Both,
    ]);
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

fn same(what: &str, frame: &Frame, right: &Frame) -> Result<(), String> {
    if frame == right {
        return Ok(());
    }
    let mut voxels = frame.voxel.iter().zip(&right.voxel).enumerate();
    let first = voxels.find(|(_, (is, should_be))| is != should_be);
    Err(format!("{what}: first (at, (is, should be)) {first:?}"))
}

/// The fast engine's frame, whose picture in colours has the nodes' colours, and whether the fallback drew it.
fn draw_fast(
    options: FastOptions,
    view: &GraphView<'_>,
    setup: &FrameSetup,
    nodes: usize,
) -> (Result<Frame, EngineError>, bool) {
    let mut fast = Fast::new(options, Box::new(Machine::default()));
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = fast.render(view, setup, &mut frame);
    let declined = fast.declined().is_some();
    if drawn.is_ok() && setup.options.coverage != Coverage::Alpha {
        let of_node: Vec<[u8; 3]> = (0..nodes as u32).map(|node| bytes_of(node).1).collect();
        let mut colors = Colors::new(setup.width, setup.height);
        colors.words.fill(3);
        let drawn = fast.draw_colors(view, &of_node, setup, &mut colors);
        drawn.expect("drawn before");
        let color = |&node: &u32| of_node.get(node as usize).copied().map_or(0, color_word);
        let expected = frame.node.iter().map(color);
        assert!(expected.eq(colors.words), "other colours: {options:?}");
    }
    (drawn.map(|_| frame), declined)
}

/// Four arbitrary bytes of a node.
fn bytes_of(node: u32) -> (u8, [u8; 3]) {
    let [first, rest @ ..] = node.wrapping_mul(0x9e37_79b1).to_be_bytes();
    (first, rest)
}

/// Whether cycles lie between the bounds, and every context's cycles are accounted for.
fn is_sound(report: &hwmodel::cycles::CycleReport, hardware: &Hardware) -> bool {
    let sum = report.context_cycles;
    let accounted = sum.working + sum.stalled + sum.order_wait + sum.no_record;
    report
        .bounds
        .iter()
        .all(|bound| bound.cycles <= report.cycles)
        && report.cycles <= report.serial
        && accounted == report.cycles * hardware.all_contexts()
}

/// A scene, opaque and with opacities.
struct Scene<'g> {
    graph: &'g Graph,
    airy: Graph,
    light: Vec<[u16; 3]>,
}

impl<'g> Scene<'g> {
    fn new(graph: &'g Graph) -> Self {
        // Some voxels are empty, opaque, or unlike from their sides.
        let opacity = (7..graph.len() as u32 + 7).map(|node| match bytes_of(node) {
            (kind, _) if kind & 7 == 0 => [0; 3],
            (kind, _) if kind & 7 == 1 => [255; 3],
            (kind, _) if kind & 7 == 2 => [0x0f, 0, 0],
            (kind, _) if kind & 7 == 3 => [0x11; 3],
            (_, sides) => sides,
        });
        Self {
            graph,
            airy: with_opacities(graph, &opacity.collect::<Vec<_>>()),
            light: lights(graph),
        }
    }

    /// Draws a frame in all ways. The machine's frame; `None` where there is none, or one of too many records.
    fn agree(
        &self,
        camera: &Camera,
        options: &SetupOptions,
        dice: &mut Dice,
    ) -> Result<Option<Frame>, String> {
        let graph = match options.coverage {
            Coverage::Alpha => &self.airy,
            _ => self.graph,
        };
        let Ok(setup) = FrameSetup::new(camera, &graph.placement, graph.depth, options) else {
            return Ok(None);
        };
        let drawn = self.agree_with(graph, camera, &setup, dice);
        drawn.map_err(|error| format!("{error}; {options:?}, {camera:?}"))
    }

    fn agree_with(
        &self,
        graph: &Graph,
        camera: &Camera,
        setup: &FrameSetup,
        dice: &mut Dice,
    ) -> Result<Option<Frame>, String> {
        let options = &setup.options;
        let view = GraphView {
            light: &self.light,
            ..graph.view()
        };
        let outlines = options.coverage.draws_outlines();
        let most = match outlines {
            true => MOST_RECORDS,
            false => MOST_RECORDS_OF_SOLIDS,
        };
        let draw = |machine: MachineOptions, setup: &FrameSetup, most: u64| {
            let mut frame = Frame::new(setup.width, setup.height, false);
            let drawn = Machine::new(machine).render_within(&view, setup, &mut frame, most);
            drawn.map(|stats| stats.map(|stats| (frame, stats)))
        };
        let right = draw(MachineOptions::default(), setup, most);
        if let Ok(None) = right {
            return Ok(None);
        }
        let is_usual = options.bits == 64 && options.frac.is_none();
        for instructions in [Instructions::Scalar, Instructions::Avx2] {
            let options = any_fast(dice, instructions, graph.depth);
            let (drawn, declined) = draw_fast(options, &view, setup, graph.len());
            match (&right, &drawn) {
                (Ok(Some((right, _))), Ok(frame)) => same(&format!("{options:?}"), frame, right)?,
                (Err(right), Err(drawn)) if right == drawn => {}
                (right, drawn) => return Err(format!("machine {right:?}, fast {drawn:?}")),
            }
            // Deep graphs far away may be beyond the fast engine's lanes.
            if declined && is_usual && outlines && graph.depth <= 12 {
                return Err("the fast engine left the frame to the machine".to_owned());
            }
        }
        let Ok(Some((right, stats))) = right else {
            return Ok(None);
        };
        if options.coverage == Coverage::Exact {
            let threads = dice.of(&[1, 2, 5, 7]);
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("a pool");
            let oracle = |setup: &FrameSetup| {
                let mut frame = Frame::new(setup.width, setup.height, false);
                let drawn = pool.install(|| Rays.render(&view, setup, &mut frame));
                drawn.expect("the oracle never fails");
                frame
            };
            same("the oracle", &oracle(setup), &right)?;
            if options.lod_px > 0.0 {
                let all = oracle(&setup.without_detail());
                let mut samples = right.node.iter().zip(&all.node);
                if samples.any(|(&drawn, &covered)| drawn == NO_NODE && covered != NO_NODE) {
                    return Err("level of detail loses a sample".to_owned());
                }
            }
        }
        if !is_usual {
            return Ok(Some(right));
        }
        if options.tolerance_px == 0.0 {
            // In clip space both cages do the same.
            let cage = match options.cage {
                CageKind::Frame => CageKind::Corners,
                CageKind::Corners => CageKind::Frame,
            };
            let other = crate::common::setup(graph, camera, &SetupOptions { cage, ..*options });
            let drawn = draw(MachineOptions::default(), &other, most);
            let (frame, counts) = drawn.expect("no overflow").expect("as many records");
            same("the other cage", &frame, &right)?;
            if counts != stats {
                return Err(format!("the other cage counts {counts:?}, not {stats:?}"));
            }
        }
        if stat(&stats, "records") > MOST_SIMULATED {
            return Ok(Some(right));
        }
        agree_in_organisation(&view, setup, dice, &right)?;
        if options.coverage != Coverage::Alpha {
            let all = MachineOptions {
                reject_filled: false,
                ..MachineOptions::default()
            };
            let drawn = draw(all, setup, 20 * MOST_SIMULATED).expect("no overflow");
            if let Some((frame, more)) = drawn {
                same("without rejection", &frame, &right)?;
                if stat(&stats, "records") > stat(&more, "records") {
                    return Err("rejection makes more records".to_owned());
                }
            }
        }
        Ok(Some(right))
    }
}

/// Draws in two organisations, serially and on simulated hardware.
fn agree_in_organisation(
    view: &GraphView<'_>,
    setup: &FrameSetup,
    dice: &mut Dice,
    right: &Frame,
) -> Result<(), String> {
    let coverage = setup.options.coverage;
    let serial = |organisation: Organisation| -> Result<(FrameSetup, Stats), String> {
        // A wide word that is too narrow traps.
        let setup = match organisation.packed {
            true => narrowed(setup),
            false => setup.clone(),
        };
        let options = MachineOptions {
            organisation,
            ..MachineOptions::default()
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let stats = Machine::new(options).render(view, &setup, &mut frame);
        same(&format!("{organisation:?}"), &frame, right)?;
        Ok((setup, stats.expect("no overflow")))
    };
    // Where a box or a centre claims a sample, it may be one beside the tile. One walk per sample is slow.
    let allowed = |mut organisation: Organisation| {
        organisation.tile_levels = match coverage.draws_outlines() {
            true if right.node.len() < 1_500 => organisation.tile_levels,
            true => organisation.tile_levels.min(2),
            false => 0,
        };
        organisation
    };
    serial(allowed(any_organisation(dice)))?;
    let mut hardware = any_hardware(dice);
    hardware.organisation = allowed(hardware.organisation);
    let (setup, mut stats) = serial(hardware.organisation)?;
    let mut frame = Frame::new(setup.width, setup.height, false);
    let simulated = Machine::default()
        .simulate(view, &setup, &mut frame, &hardware, &mut NoObserver)
        .expect("what the machine draws");
    let mut counts = simulated.counts;
    // A lane takes up a tile only where no record of another one is ready.
    let open = counts.pop().expect("the most tiles in progress");
    let is_open = open.1 <= hardware.all_contexts() || hardware.lanes != 1;
    if !is_open || !is_sound(&simulated.cycles, &hardware) {
        return Err(format!("{open:?}, {:?}, {hardware:?}", simulated.cycles));
    }
    let what = format!("on {hardware:?}");
    match hardware.independence {
        // Records whose image nodes meet have their turns in the serial order.
        Independence::None | Independence::Image => {
            same(&what, &frame, right)?;
            stats.retain(|(name, _)| *name != "deepest_stack");
            if counts != stats {
                return Err(format!("{what}: {counts:?}, not {stats:?}"));
            }
        }
        // The image-order paper's claim: children of one class never occlude one another.
        _ if coverage == Coverage::Exact => same(&what, &frame, right)?,
        // Under other rules they may claim the same sample, which is drawn by one of them.
        _ if setup.options.tolerance_px.is_finite() && coverage != Coverage::Alpha => {
            let is_drawn = |frame: &Frame| -> Vec<bool> {
                frame.node.iter().map(|&node| node != NO_NODE).collect()
            };
            if is_drawn(&frame) != is_drawn(right) {
                return Err(format!("{what}: other samples"));
            }
        }
        _ => {}
    }
    Ok(())
}

/// Draws a scene from every place: all leaves, and in turn other settings.
fn agree_on_scene(name: &str, graph: &Graph) {
    let rounds = std::env::var("SHIFTVOX_ROUNDS").map_or(ROUNDS, |n| n.parse().expect("a number"));
    let mut dice = Dice::new(xxhash_rust::xxh3::xxh3_64(name.as_bytes()));
    let scene = Scene::new(graph);
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
        // The machine draws the other rules sample by sample.
        let (width, height) = if other.coverage.draws_outlines() {
            (width, height)
        } else {
            (43, 39)
        };
        let smaller = Camera {
            width,
            height,
            ..camera
        };
        for (camera, options) in [(camera, leaves), (smaller, other)] {
            let frame = scene.agree(&camera, &options, &mut dice);
            if let Some(frame) = frame.unwrap_or_else(|error| panic!("{name}: {error}")) {
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
        .for_each(|scene| agree_on_scene(scene.name, scene.graph()));
}

#[test]
#[ignore = "needs the folder SHIFTVOX_DATA"]
fn every_file_is_drawn_alike() {
    let folder = std::env::var_os("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names a folder with vox/");
    let files = vox_files(&std::path::Path::new(&folder).join("vox"));
    let mut refused = 0;
    for path in files {
        match graph_of_file(&path) {
            Ok(graph) => agree_on_scene(&path.display().to_string(), &graph),
            Err(_) => refused += 1,
        }
    }
    assert!(refused <= 1, "one of the files is none");
}

#[test]
fn the_table_has_every_generator_and_every_file() {
    for generator in shiftvox::scene::generate::GENERATORS {
        let begins = format!("gen:{},", generator.name);
        let mut named = SCENES.iter();
        assert!(
            named.any(|scene| scene.name.starts_with(&begins)),
            "{begins}"
        );
    }
    for path in vox_files(&data()) {
        let mut named = SCENES.iter();
        assert!(named.any(|scene| path.ends_with(scene.name)), "{path:?}");
    }
}

/// Random graphs: cyclic ones, octrees with voxels of about a sample and large leaves, dense and sparse ones.
fn any_scene() -> impl Strategy<Value = Graph> {
    prop_oneof![
        2 => any_graph(1..9),
        1 => any_octree(3, 0.2),
        1 => any_octree(4, 0.3),
        1 => any_octree(4, 0.02),
        1 => any_mixed_octree(5),
    ]
}

proptest! {
    #![proptest_config(cases(600))]

    #[test]
    fn random_scenes_are_drawn_alike(
        (graph, camera) in any_scene().prop_flat_map(|graph| {
            let side = f64::from(1u32 << graph.depth);
            (Just(graph), any_camera(side, 1..100))
        }),
        seed: u64,
    ) {
        let mut dice = Dice::new(seed);
        let settings = any_settings(&mut dice);
        // Under the other rules a cyclic graph is subdivided to the last bit.
        prop_assume!(settings.coverage.draws_outlines() || graph.depth < 5);
        let drawn = Scene::new(&graph).agree(&camera, &settings, &mut dice);
        prop_assert!(drawn.is_ok(), "{}", drawn.unwrap_err());
    }
}
