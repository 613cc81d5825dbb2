//! On real voxel files and on every generator, the machine with tolerance 0,
//! exact coverage and no level of detail draws what the oracle draws: in
//! every sample the same voxel and the same node, none extra, none missing.

use std::time::Instant;

use crate::scenes::*;
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

/// Pictures: pixels across and down, samples per pixel and axis as a power of two.
const SIZES: [(u32, u32, u32); 7] = [
    (160, 160, 0),
    (200, 113, 0),
    (75, 160, 0),
    (160, 120, 0),
    (80, 64, 1),
    (1, 160, 0),
    (43, 39, 2),
];

/// Cameras at each place, unless `SHIFTVOX_ROUNDS` asks for more.
const ROUNDS: u32 = 5;

/// Scenes of moderate depth from every generator.
const SPECS: [&str; 10] = [
    "gen:checker,depth=5",
    "gen:maze,depth=6",
    "gen:menger,depth=4",
    "gen:random,depth=6,density=3,seed=5",
    "gen:shell,depth=7",
    "gen:sierpinski,depth=16",
    "gen:sphere,depth=6",
    "gen:terrain,depth=9",
    "gen:truss,depth=7",
    "gen:wires,depth=7",
];

/// What a scene's comparison found.
#[derive(Debug, Default)]
struct Tally {
    cameras: u64,
    compared: u64,
    drawn: u64,
    extra: u64,
    missing: u64,
    wrong: u64,
    /// The first picture that differs.
    first: Option<String>,
}

impl Tally {
    fn differing(&self) -> u64 {
        self.extra + self.missing + self.wrong
    }

    fn compare(&mut self, machine: &Frame, oracle: &Frame, what: impl Fn() -> String) {
        let before = self.differing();
        for at in 0..oracle.node.len() {
            let seen = (machine.node[at], oracle.node[at]);
            match (seen.0 != NO_NODE, seen.1 != NO_NODE) {
                (true, false) => self.extra += 1,
                (false, true) => self.missing += 1,
                _ if seen.0 != seen.1 || machine.voxel[at] != oracle.voxel[at] => self.wrong += 1,
                _ => {}
            }
            if self.first.is_none() && self.differing() > before {
                let (x, y) = (at as u32 % oracle.width, at as u32 / oracle.width);
                self.first = Some(format!(
                    "sample ({x}, {y}): machine {:?}, oracle {:?}; {}",
                    machine.voxel[at],
                    oracle.voxel[at],
                    what()
                ));
            }
        }
        self.compared += oracle.node.len() as u64;
        self.drawn += oracle.drawn() as u64;
    }
}

fn draw(engine: &mut impl Engine, graph: &Graph, setup: &FrameSetup) -> Frame {
    let mut frame = Frame::new(setup.width, setup.height, false);
    engine
        .render(&graph.view(), setup, &mut frame)
        .expect("no overflow in 64 bits");
    frame
}

fn set_up(graph: &Graph, camera: &Camera, cage: CageKind, aa_log2: u32) -> FrameSetup {
    let options = SetupOptions {
        cage,
        lod_px: 0.0,
        aa_log2,
        ..SetupOptions::default()
    };
    FrameSetup::new(camera, &graph.placement, graph.depth, &options).expect("a frame")
}

/// Compares a scene from `rounds` cameras at every place, sizes in turn.
fn compare(name: &str, graph: &Graph, rounds: u32) -> Tally {
    let began = Instant::now();
    let mut dice = Dice::new(xxhash_rust::xxh3::xxh3_64(name.as_bytes()));
    let mut tally = Tally::default();
    let mut machine = Machine::default();
    for round in 0..rounds {
        for place in PLACES {
            let (width, height, aa_log2) = SIZES[tally.cameras as usize % SIZES.len()];
            let camera = camera_at(place, graph, (width, height), &mut dice);
            // Both cages start from the same integers, so one oracle serves both.
            let setup = set_up(graph, &camera, CageKind::Frame, aa_log2);
            let oracle = draw(&mut Rays, graph, &setup);
            for cage in [CageKind::Frame, CageKind::Corners] {
                let setup = set_up(graph, &camera, cage, aa_log2);
                let drawn = draw(&mut machine, graph, &setup);
                tally.compare(&drawn, &oracle, || {
                    format!(
                        "{name}, {place:?}, round {round}, {cage:?}, aa_log2 {aa_log2}, {camera:?}"
                    )
                });
            }
            tally.cameras += 1;
        }
    }
    eprintln!(
        "{name}: {} cameras, {} samples compared ({} drawn), {} differing, {:.1} s",
        tally.cameras,
        tally.compared,
        tally.drawn,
        tally.differing(),
        began.elapsed().as_secs_f64()
    );
    tally
}

/// Compares and insists.
fn insist(name: &str, graph: &Graph) {
    let rounds = std::env::var("SHIFTVOX_ROUNDS").map_or(ROUNDS, |n| n.parse().expect("a number"));
    let tally = compare(name, graph, rounds);
    assert_eq!(tally.differing(), 0, "{tally:#?}");
    // Pictures of nothing would agree too.
    assert!(tally.drawn * 20 > tally.compared, "{tally:#?}");
}

#[test]
fn every_generator_is_drawn_exactly() {
    for spec in SPECS {
        insist(spec, &graph_of_spec(spec));
    }
}

#[test]
fn every_shipped_file_is_drawn_exactly() {
    let files = shipped_files();
    assert_eq!(files.len(), 3);
    for path in files {
        let name = path.file_name().expect("a name").to_string_lossy();
        insist(&name, &graph_of_file(&path).expect("a scene"));
    }
}

#[test]
fn every_shared_file_is_drawn_exactly() {
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
                insist(&name, &graph);
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
