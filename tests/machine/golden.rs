//! Golden pictures: the rows of `tests/golden/pictures.txt` are drawn to the same bits in every build profile and on
//! any number of threads. After a change that is meant to show:
//!
//! ```text
//! SHIFTVOX_BLESS=1 cargo test --release -p shiftvox --test machine golden
//! ```
//!
//! Say in the commit why which rows changed. Random frames and their integers have one recorded hash each.

use crate::common::{lights, with_opacities};
use crate::scenes::*;
use glam::DVec3;
use hwmodel::count::Counter;
use shiftvox::frame::Frame;
use shiftvox::graph::{GraphView, Placement};
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Coverage, Engine, FrameSetup, SetupOptions as Options};
use shiftvox::rays::Rays;
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

const PICTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/pictures.txt");

/// The settings of a row, and whether the oracle draws it.
fn settings(text: &str) -> (Options, bool) {
    let mut words = text.split_whitespace();
    let mut is_oracle = false;
    let mut options = match words.next() {
        Some("paper") => Options::paper(),
        Some("center") => Options::of(Coverage::Center),
        Some("alpha") => Options::of(Coverage::Alpha),
        _ => Options::default(),
    };
    for word in words {
        let (name, value) = word.split_once('=').expect("name=value");
        let number = || value.parse().expect("a number");
        match name {
            "bits" => options.bits = number(),
            "frac" => options.frac = Some(number()),
            "aa" => options.aa_log2 = number(),
            "lod" => options.lod_px = f64::from(number()),
            "tolerance" => options.tolerance_px = f64::from(number()),
            "cage" => options.cage = CageKind::Corners,
            _ => is_oracle = true,
        }
    }
    if text.starts_with("exact") {
        // Down to the leaves.
        options.lod_px = 0.0;
    }
    (options, is_oracle)
}

/// The frame of a row and the machine's operations and accesses, drawn by a new machine and by one that drew others,
/// which draws over its own picture.
fn draw(row: &str, used: &mut Machine) -> (Frame, Option<Counter>) {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let numbers = |cell: usize| -> Vec<f64> {
        let numbers = cells[cell].split(' ').map(|n| n.parse().expect("a number"));
        numbers.collect()
    };
    let mut graph = graph_of(cells[1]);
    let (options, is_oracle) = settings(cells[6]);
    if options.coverage.blends() {
        graph = with_opacities(&graph, &[[0x37; 3], [0x5f, 0x80, 0x22]]);
    }
    let light = lights(&graph);
    let view = GraphView {
        light: &light,
        ..graph.view()
    };
    let (low, side) = cube(&graph);
    let [eye, target] = [2, 3].map(|cell| low + DVec3::from_slice(&numbers(cell)) * side);
    let size = numbers(5);
    let camera = Camera {
        eye,
        target,
        up: DVec3::Z,
        fov_degrees: numbers(4)[0],
        width: size[0] as u32,
        height: size[1] as u32,
    };
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect(row);
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut again = frame.clone();
    if is_oracle {
        Rays.render(&view, &setup, &mut frame).expect(row);
        return (frame, None);
    }
    let counter = Counter::new();
    let drawn = Machine::default().render_probed(&view, &setup, &mut frame, counter);
    for _ in 0..2 {
        used.render(&view, &setup, &mut again).expect(row);
        assert!(again == frame, "a used machine: {row}");
    }
    (frame, Some(drawn.expect(row).1))
}

/// XXH3-128 of all voxels, then all nodes, then what is blended, little-endian.
fn hash(frame: &Frame) -> u128 {
    let mut hash = Xxh3::new();
    for number in frame.voxel.iter().flatten() {
        hash.update(&number.to_le_bytes());
    }
    for node in &frame.node {
        hash.update(&node.to_le_bytes());
    }
    for blend in frame.blend.iter().flatten() {
        hash.update(format!("{blend:?}").as_bytes());
    }
    hash.digest128()
}

#[test]
fn pictures_are_the_golden_ones() {
    let golden = std::fs::read_to_string(PICTURES).expect(PICTURES);
    let mut used = Machine::default();
    let mut draw_row = |row: &str| {
        if row.starts_with('#') {
            return format!("{row}\n");
        }
        let (frame, counter) = draw(row, &mut used);
        let (drawn, all) = (frame.drawn(), frame.node.len());
        assert!(drawn * 30 > all, "{drawn} of {all} drawn: {row}");
        let inputs = &row[..=row.rfind('|').expect("cells")];
        let counts = counter.map_or(String::new(), |counter| {
            let cells: Vec<_> = counter.cells().collect();
            let accesses: Vec<_> = counter.accesses().collect();
            let text = format!("{cells:?} {accesses:?}");
            format!(" {:016x}", xxh3_64(text.as_bytes()))
        });
        format!("{inputs} {:032x} {drawn}/{all}{counts}\n", hash(&frame))
    };
    let drawn: String = golden.lines().map(&mut draw_row).collect();
    if std::env::var_os("SHIFTVOX_BLESS").is_some() {
        std::fs::write(PICTURES, drawn).expect(PICTURES);
        return;
    }
    for (drawn, golden) in drawn.lines().zip(golden.lines()) {
        assert_eq!(drawn, golden, "if that is meant, SHIFTVOX_BLESS=1");
    }
}

const RECORDED_FRAMES: u32 = 400;
/// XXH3-128 of the frames' pictures and counters, or of their errors.
const RECORDED_SAMPLES: u128 = 0x43e2_f529_cc97_8853_7a82_cdb7_33d5_71c0;

/// The rules `any` and `center`, at all tolerances, in words of many widths.
#[test]
fn pictures_by_box_and_centre_are_those_recorded() {
    let specs = "terrain,depth=6,seed=3 menger,depth=3 sierpinski,depth=7 shell,depth=5 truss,depth=5 \
                 wires,depth=5";
    let graph = |spec| graph_of_spec(&format!("gen:{spec}"));
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
    let found = hash.digest128();
    assert_eq!(found, RECORDED_SAMPLES, "{found:#x}");
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
        width: dice.of(&[1, 17, 512, 1024, 1000, 32768]),
        height: dice.of(&[1, 30, 512, 1024, 720]),
    };
    (camera, placement, depth, options)
}

const RECORDED_SETUPS: u32 = 20_000;
/// XXH3-128 of all integers of these frames, or why there is none.
const RECORDED_INTEGERS: u128 = 0xae2c_c388_65cf_460f_4e31_5d6a_d0f7_ebb1;

#[test]
fn the_integers_of_frames_are_those_recorded() {
    let mut hash = Xxh3::new();
    let mut dice = Dice::new(1);
    for _ in 0..RECORDED_SETUPS {
        let (camera, placement, depth, options) = any_frame(&mut dice);
        let made = FrameSetup::new(&camera, &placement, depth, &options);
        let opacity_eye = made.as_ref().map(FrameSetup::opacity_eye);
        hash.update(format!("{made:?} {opacity_eye:?}").as_bytes());
    }
    let found = hash.digest128();
    assert_eq!(found, RECORDED_INTEGERS, "{found:#x}");
}
