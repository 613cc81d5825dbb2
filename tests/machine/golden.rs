//! Golden pictures: the rows of `tests/golden/pictures.txt` are drawn to the same bits in every build profile and on
//! any number of threads. After a change that is meant to show:
//!
//! ```text
//! SHIFTVOX_BLESS=1 cargo test --release -p shiftvox --test machine golden
//! ```
//!
//! Say in the commit why which rows changed.

use crate::scenes::*;
use glam::DVec3;
use shiftvox::frame::Frame;
use shiftvox::machine::Machine;
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions as Options,
};
use shiftvox::rays::Rays;
use xxhash_rust::xxh3::Xxh3;

const PICTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/pictures.txt");

/// The settings of a row, and whether the oracle draws it.
fn settings(text: &str) -> (Options, bool) {
    let mut words = text.split_whitespace();
    let mut is_oracle = false;
    let mut options = match words.next().expect("settings") {
        "paper" => Options::paper(),
        // Down to the leaves.
        "exact" => Options {
            lod_px: 0.0,
            ..Options::default()
        },
        "center" => Options::of(Coverage::Center),
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
    (options, is_oracle)
}

/// The frame of a row, drawn by a new machine and by one that drew others, which draws over its own picture.
fn draw(row: &str, used: &mut Machine) -> Frame {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let numbers = |cell: &str| -> Vec<f64> {
        let numbers = cell.split(' ').map(|n| n.parse().expect("a number"));
        numbers.collect()
    };
    let graph = graph_of(cells[1]);
    let (low, side) = cube(&graph);
    let at = |cell: &str| low + DVec3::from_slice(&numbers(cell)) * side;
    let size = numbers(cells[5]);
    let camera = Camera {
        eye: at(cells[2]),
        target: at(cells[3]),
        up: DVec3::Z,
        fov_degrees: numbers(cells[4])[0],
        width: size[0] as u32,
        height: size[1] as u32,
    };
    let (options, is_oracle) = settings(cells[6]);
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect(row);
    let render = |engine: &mut dyn Engine, frame: &mut Frame| {
        let drawn = engine.render(&graph.view(), &setup, frame);
        drawn.expect(row);
    };
    let mut frame = Frame::new(setup.width, setup.height, false);
    if is_oracle {
        render(&mut Rays, &mut frame);
        return frame;
    }
    render(&mut Machine::default(), &mut frame);
    let mut again = Frame::new(setup.width, setup.height, false);
    for _ in 0..2 {
        render(used, &mut again);
        assert!(again == frame, "a used machine: {row}");
    }
    frame
}

/// XXH3-128 of all voxels, then all nodes, little-endian.
fn hash(frame: &Frame) -> u128 {
    let mut hash = Xxh3::new();
    for number in frame.voxel.iter().flatten() {
        hash.update(&number.to_le_bytes());
    }
    for node in &frame.node {
        hash.update(&node.to_le_bytes());
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
        let frame = draw(row, &mut used);
        let (drawn, all) = (frame.drawn(), frame.node.len());
        assert!(drawn * 30 > all, "{drawn} of {all} drawn: {row}");
        let inputs = &row[..=row.rfind('|').expect("cells")];
        format!("{inputs} {:032x} {drawn}/{all}\n", hash(&frame))
    };
    let drawn: String = golden.lines().map(&mut draw_row).collect();
    if std::env::var_os("SHIFTVOX_BLESS").is_some() {
        std::fs::write(PICTURES, &drawn).expect(PICTURES);
        return;
    }
    for (drawn, golden) in drawn.lines().zip(golden.lines()) {
        assert_eq!(drawn, golden, "if that is meant, SHIFTVOX_BLESS=1");
    }
}

const RECORDED_FRAMES: u32 = 400;
/// XXH3-128 of the frames' pictures and counters, or of their errors.
const RECORDED_SAMPLES: u128 = 0x18d0_8acf_1d8c_47b5_7535_f004_11f5_07de;

/// The rules `any` and `center`, at all tolerances, in words of many widths.
#[test]
fn pictures_by_box_and_centre_are_those_recorded() {
    const SPECS: [&str; 6] = [
        "gen:terrain,depth=6,seed=3",
        "gen:menger,depth=3",
        "gen:sierpinski,depth=7",
        "gen:shell,depth=5",
        "gen:truss,depth=5",
        "gen:wires,depth=5",
    ];
    let graphs = SPECS.map(graph_of);
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
            hash.update(b"no frame");
            continue;
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let mut machine = Machine::default();
        match machine.render_within(&graph.view(), &setup, &mut frame, 200_000) {
            Ok(Some(stats)) => {
                drawn += 1;
                hash.update(&self::hash(&frame).to_le_bytes());
                hash.update(format!("{stats:?}").as_bytes());
            }
            Ok(None) => hash.update(b"too many records"),
            Err(EngineError::Memory(short)) => panic!("{short}"),
            Err(EngineError::Trap(trap)) => {
                // As the message was when this was recorded.
                let advice = "use more bits, fewer fraction bits, or --overflow wrap|saturate";
                hash.update(format!("{trap}; {advice}").as_bytes());
            }
        }
    }
    assert!(drawn * 2 > RECORDED_FRAMES, "{drawn}");
    let found = hash.digest128();
    assert_eq!(found, RECORDED_SAMPLES, "{found:#x}");
}
