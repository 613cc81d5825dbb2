//! Golden pictures: the rows of `golden.txt` are drawn to the same bits on every computer, in every build profile, with
//! all instruction sets and any number of threads. After a change that is meant to show:
//!
//! ```text
//! SHIFTVOX_BLESS=1 cargo test --release -p shiftvox-web
//! ```
//!
//! Say in the commit why which rows changed, and put the new identity into `shiftvox::IDENTITY`.

use glam::DVec3;
use hwmodel::count::Counter;
use shiftvox::Coverage;
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Opacity, Silent};
use shiftvox::machine::{Machine, RecordStage};
use shiftvox::project::{CageKind, Camera, Engine, FrameSetup, SetupOptions as Options};
use shiftvox::rays::Rays;
use shiftvox::scene::{NoMeshes, OpenOptions, Source, open_bytes, open_source};
use xxhash_rust::xxh3::{xxh3_64, xxh3_128_with_seed};

use super::frame_hash::hash;

/// The stages in the order in which the identity has their counts.
const STAGES: [RecordStage; RecordStage::ALL.len()] = {
    use RecordStage::*;
    [
        Pop,
        Filled,
        OnePixel,
        Centre,
        Order,
        VertexPool,
        ChildBox,
        QuadtreeFit,
        Push,
        Draw,
        FillUpdate,
        ToScreen,
        Blend,
    ]
};

/// The rows, with the recorded hashes of random frames.
pub const ROWS: &str = include_str!("golden.txt");
const FILES: [(&str, &[u8]); 3] = [
    ("axes.vox", include_bytes!("../../../tests/data/axes.vox")),
    (
        "extended.vox",
        include_bytes!("../../../tests/data/extended.vox"),
    ),
    (
        "sphere.vox",
        include_bytes!("../../../tests/data/sphere.vox"),
    ),
];

/// 32 bytes of XXH3, of two seeds, as hexadecimal digits.
#[must_use]
pub fn identity(rows: &str) -> String {
    let half = |seed| xxh3_128_with_seed(rows.as_bytes(), seed);
    format!("{:032x}{:032x}", half(0), half(1))
}

/// The identity of the rows as they are drawn here, then the rows that differ.
#[must_use]
pub fn report() -> String {
    let drawn = draw_rows(ROWS);
    let mut report = identity(&drawn);
    for (drawn, expected) in drawn.lines().zip(ROWS.lines()) {
        if drawn != expected {
            report += &format!("\n{drawn}");
        }
    }
    report
}

/// The rows, with hashes and counts of the drawn pictures. Lines that begin with `#` or `@` stay.
#[must_use]
pub fn draw_rows(rows: &str) -> String {
    let mut used = Machine::default();
    rows.lines()
        .map(|row| draw_row(row, &mut used) + "\n")
        .collect()
}

fn draw_row(row: &str, used: &mut Machine) -> String {
    if row.starts_with(['#', '@']) {
        return row.to_owned();
    }
    let (frame, counter) = draw(row, used);
    let (drawn, all) = (frame.drawn(), frame.node.len());
    assert!(drawn * 30 > all, "{drawn} of {all} drawn: {row}");
    let inputs = &row[..=row.rfind('|').expect("cells")];
    let counts = counter.map_or(String::new(), |counter| {
        let mut cells: Vec<_> = counter.cells().collect();
        let mut accesses: Vec<_> = counter.accesses().collect();
        let place = |stage| STAGES.iter().position(|&of| stage == of);
        cells.sort_by_key(|of| (of.bits, of.level, place(of.stage)));
        accesses.sort_by_key(|of| (of.level, place(of.stage)));
        let text = format!("{cells:?} {accesses:?}");
        format!(" {:016x}", xxh3_64(text.as_bytes()))
    });
    format!("{inputs} {:032x} {drawn}/{all}{counts}", hash(&frame))
}

/// The settings of a row, and whether the oracle draws it.
fn settings(text: &str) -> (Options, bool) {
    let mut words = text.split_whitespace();
    let mut is_oracle = false;
    let mut options = match words.next() {
        Some("paper") => Options::paper(),
        Some("center") => Options::of(Coverage::Center),
        Some("alpha") => Options {
            lod_px: 1.0,
            ..Options::of(Coverage::Alpha)
        },
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

/// The frame of a row and the machine's operations and accesses. It is drawn by a new machine, by one that drew others,
/// which draws over its own picture, and by the fast engine.
fn draw(row: &str, used: &mut Machine) -> (Frame, Option<Counter>) {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let numbers = |cell: usize| -> Vec<f64> {
        let numbers = cells[cell].split(' ').map(|n| n.parse().expect("a number"));
        numbers.collect()
    };
    let mut graph = graph_of(cells[1]);
    let (options, is_oracle) = settings(cells[6]);
    if options.coverage.blends() {
        let opacity = [[0x37; 3], [0x5f, 0x80, 0x22]].map(Opacity);
        let opacity = opacity.into_iter().cycle().take(graph.len());
        graph.opacity = opacity.collect::<Vec<_>>().into();
    }
    let light: Vec<_> = (0..graph.len() as u16)
        .map(|i| [0, 1, 2].map(|c| i.wrapping_mul(40_503).rotate_left(5 * c)))
        .collect();
    let view = graph.lit(&light);
    let side = (1u64 << graph.depth) as f64;
    let low = DVec3::from_array(graph.placement.origin_index.map(|c| c as f64));
    let [eye, target] = [2, 3].map(|cell| low + DVec3::from_slice(&numbers(cell)) * side);
    let size = numbers(5);
    let camera = Camera::looking(eye, target, numbers(4)[0], (size[0] as u32, size[1] as u32));
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect(row);
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut again = frame.clone();
    if is_oracle {
        Rays::default()
            .render(&view, &setup, &mut frame)
            .expect(row);
        return (frame, None);
    }
    let drawn = Machine::default().count(&view, &setup, &mut frame);
    for _ in 0..2 {
        used.render(&view, &setup, &mut again).expect(row);
        assert!(again == frame, "a used machine: {row}");
    }
    for instructions in [Instructions::Auto, Instructions::Scalar] {
        let options = FastOptions {
            instructions,
            ..FastOptions::default()
        };
        let mut fast = Fast::new(options, Box::new(Machine::default()));
        fast.render(&view, &setup, &mut again).expect(row);
        assert!(again == frame, "{instructions:?}: {row}");
    }
    (frame, Some(drawn.expect(row).1))
}

/// The graph of a generator, or of a file.
fn graph_of(name: &str) -> Graph {
    let options = OpenOptions::default();
    let opened = match FILES.iter().find(|(file, _)| *file == name) {
        Some((_, bytes)) => open_bytes(bytes, name, &options, &NoMeshes, &Silent),
        None => open_source(
            Source::Generated(name.to_owned()),
            &options,
            &NoMeshes,
            &Silent,
        ),
    };
    opened.expect(name).graph
}

#[cfg(test)]
#[test]
fn pictures_and_the_identity_are_those_published() {
    let drawn = draw_rows(ROWS);
    if std::env::var_os("SHIFTVOX_BLESS").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/golden.txt");
        std::fs::write(path, &drawn).expect(path);
    }
    for (drawn, expected) in drawn.lines().zip(ROWS.lines()) {
        assert_eq!(drawn, expected, "if that is meant, SHIFTVOX_BLESS=1");
    }
    assert_eq!(identity(&drawn), shiftvox::IDENTITY);
}
