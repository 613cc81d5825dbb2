//! Machines of `rtl/`, simulated, and what the reference machine does in the same frames: every event with all its
//! bits, in order; the picture; the cycles.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

use super::tools::{rtl, run, shiftvox, text};

/// A machine of `rtl/`: its hardware's file, its stage's folder, the rules that it draws by, where its modules are.
pub(crate) struct Machine {
    pub(crate) name: &'static str,
    pub(crate) stage: &'static str,
    pub(crate) rules: &'static [&'static str],
    pub(crate) folders: &'static [&'static str],
    /// Several side by side.
    lanes: Option<Lanes>,
    /// Whether it can have bricks.
    bricks: bool,
    /// Its simulator, made once.
    made: OnceLock<(TempDir, PathBuf)>,
}

const EXACT: &[&str] = &["--coverage", "exact", "--cage", "frame"];
const FOLDERS_B: &[&str] = &["machine", "stage_b", "blocks_exact", "blocks"];
const FOLDERS_C: &[&str] = &["machine", "stage_c", "stage_b", "blocks_exact", "blocks"];

/// How many lanes, contexts of each, and levels of the picture above the tiles that they draw.
#[derive(Clone, Copy)]
pub(crate) struct Lanes {
    lanes: u32,
    contexts: u32,
    tile_levels: u32,
}

pub(crate) const fn lanes(lanes: u32, contexts: u32, tile_levels: u32) -> Lanes {
    Lanes {
        lanes,
        contexts,
        tile_levels,
    }
}

pub(crate) static STAGE_A: Machine = Machine {
    name: "stage_a",
    stage: "stage_a",
    rules: &["--paper"],
    folders: &["machine", "stage_a", "blocks"],
    lanes: None,
    bricks: false,
    made: OnceLock::new(),
};
pub(crate) static STAGE_B: Machine = Machine {
    name: "stage_b",
    stage: "stage_b",
    rules: EXACT,
    folders: FOLDERS_B,
    lanes: None,
    bricks: false,
    made: OnceLock::new(),
};
pub(crate) static STAGE_C: Machine = Machine {
    name: "stage_c",
    stage: "stage_c",
    rules: EXACT,
    folders: FOLDERS_C,
    lanes: None,
    bricks: false,
    made: OnceLock::new(),
};
/// The same with bricks.
pub(crate) static STAGE_C_BRICKS: Machine = Machine {
    name: "stage_c",
    stage: "stage_c",
    rules: EXACT,
    folders: FOLDERS_C,
    lanes: None,
    bricks: true,
    made: OnceLock::new(),
};

impl Machine {
    /// Lanes of stage B.
    pub(crate) const fn lanes_of_stage_b(lanes: Lanes) -> Self {
        Self::side_by_side("stage_b_lanes", "stage_b", FOLDERS_B, lanes, false)
    }

    /// Lanes of stage C, with bricks or without.
    pub(crate) const fn lanes_of_stage_c(lanes: Lanes, bricks: bool) -> Self {
        Self::side_by_side("stage_c_lanes", "stage_c", FOLDERS_C, lanes, bricks)
    }

    const fn side_by_side(
        name: &'static str,
        stage: &'static str,
        folders: &'static [&'static str],
        lanes: Lanes,
        bricks: bool,
    ) -> Self {
        Self {
            name,
            stage,
            rules: EXACT,
            folders,
            lanes: Some(lanes),
            bricks,
            made: OnceLock::new(),
        }
    }

    /// Its description for the cycle model.
    pub(crate) fn hardware(&self) -> String {
        let file = rtl().join(format!("{}.toml", self.name));
        let mut text = fs::read_to_string(file).unwrap();
        for (of, number) in self.parameters() {
            let key = format!("\n{} = ", of.to_lowercase());
            let (head, rest) = text.split_once(&key).unwrap();
            let (_, tail) = rest.split_once(' ').unwrap();
            let value = match of {
                "BRICKS" => "true".to_owned(),
                _ => number.to_string(),
            };
            text = format!("{head}{key}{value} {tail}");
        }
        text
    }

    /// The testbench that draws frames with it.
    pub(crate) fn testbench(&self) -> &'static str {
        match self.lanes {
            Some(_) => "lanes_tb",
            None => "frame_tb",
        }
    }

    /// That one's parameters.
    pub(crate) fn parameters(&self) -> Vec<(&'static str, u64)> {
        let of_lanes = |of: Lanes| {
            [
                ("LANES", of.lanes.into()),
                ("CONTEXTS", of.contexts.into()),
                ("TILE_LEVELS", of.tile_levels.into()),
            ]
        };
        let bricks = self.bricks.then_some(("BRICKS", 1));
        let lanes = self.lanes.into_iter().flat_map(of_lanes);
        lanes.chain(bricks).collect()
    }

    /// Whether records lie on its stack, and not what leads to their parents.
    fn stacks_records(&self) -> bool {
        self.stage != "stage_c"
    }

    /// The simulator of words of 32 bits, for pictures up to 256 x 256.
    pub(crate) fn simulator(&self) -> &str {
        let (_, path) = self.made.get_or_init(|| {
            let shelter = tempfile::tempdir().unwrap();
            let arguments = "--binary -O3 --x-assign fast --x-initial fast -CFLAGS -O1 -Wno-fatal -Wno-WIDTH \
                             -o frame -I. --Mdir";
            let mut arguments: Vec<String> =
                arguments.split_whitespace().map(str::to_owned).collect();
            arguments.push(text(shelter.path()).to_owned());
            let top = self.testbench();
            arguments.extend([
                "--top-module".to_owned(),
                top.to_owned(),
                format!("tb/{top}.v"),
            ]);
            let parameters = self.parameters();
            arguments.extend(parameters.iter().map(|(of, number)| format!("-G{of}={number}")));
            arguments.extend(self.folders.iter().map(|folder| format!("-I{folder}")));
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            run(&rtl(), "verilator", &arguments);
            let path = shelter.path().join("frame");
            (shelter, path)
        });
        text(path)
    }
}

/// What crossed a port, the first number; and where, and what, as far as the simulation writes it down.
type Event = (u8, u64, String);

/// Hexadecimal digits of a record's box in screen space, and of its planes, which come last: words of 32 and 64 bits.
const BOX: usize = 4 * 8;
const PLANES: usize = 12 * 16;

/// Ports, by their numbers in the vectors.
const POP: u8 = 0;
const PUSH: u8 = 1;
const FILL_WRITE: u8 = 3;
const PIXEL: u8 = 6;
const MADE: u8 = 7;

/// Events of a frame from its vectors.
fn expected_events(folder: &Path, machine: &Machine) -> Vec<Event> {
    let rows = |name: &str| {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with("//"));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    let records = rows("turns.records.hex");
    rows("turns.ports.hex")
        .iter()
        .map(|row| {
            // 3 bits of port, 32 of address, 40 of data.
            let row = u128::from_str_radix(row, 16).unwrap();
            let (port, address) = ((row >> 72) as u8, (row >> 40) as u64 & 0xffff_ffff);
            let data = row as u64 & 0xff_ffff_ffff;
            let data = match (port, machine.stacks_records()) {
                (PUSH, true) | (MADE, _) => {
                    records[data as usize].trim_start_matches('0').to_owned()
                }
                (POP | PUSH, false) | (FILL_WRITE, _) => format!("{data:x}"),
                (PIXEL, _) => data.to_string(),
                _ => String::new(),
            };
            (port, address, data)
        })
        .collect()
}

/// Events that the simulation wrote down, those of a tile together, tile by tile. Of a record stage A has no planes, and
/// B no box in screen space.
fn simulated_events(folder: &Path, machine: &Machine) -> Vec<Event> {
    let text = fs::read_to_string(folder.join("events.txt")).unwrap();
    let split = |line| str::split_once(line, ' ').unwrap();
    let mut lines: Vec<(u32, &str)> = text
        .lines()
        .map(split)
        .map(|(tile, event)| (tile.parse().unwrap(), event))
        .collect();
    lines.sort_by_key(|&(tile, _)| tile);
    lines
        .into_iter()
        .map(|(_, event)| {
            let mut words = event.split(' ');
            let mut next = || words.next().unwrap_or_default();
            let (port, address) = (next().parse().unwrap(), next().parse().unwrap());
            let mut data = next().to_owned();
            if matches!((port, machine.stacks_records()), (POP | PUSH, false)) {
                data = format!("{:x}", u64::from_str_radix(&data, 16).unwrap());
            }
            if matches!((port, machine.stacks_records()), (PUSH, true) | (MADE, _)) {
                let more = next();
                let (no_box, no_planes) = match machine.stage {
                    "stage_a" => (0, PLANES),
                    _ => (BOX, 0),
                };
                data += &"0".repeat(no_box);
                // Before the box is a bit that was written down already.
                data += &more[more.len() - (BOX + PLANES - no_box - no_planes)..];
                data += &"0".repeat(no_planes);
                data = data.trim_start_matches('0').to_owned();
            }
            (port, address, data)
        })
        .collect()
}

/// Whole numbers of a `.npy` file.
fn numbers(path: &Path) -> Vec<i32> {
    let bytes = fs::read(path).unwrap();
    let head = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let number = |bytes: &[u8]| i32::from_le_bytes(bytes.try_into().unwrap());
    bytes[head..].chunks_exact(4).map(number).collect()
}

/// A view on the reference machine.
pub(crate) struct Expected<'m> {
    machine: &'m Machine,
    shelter: TempDir,
    events: Vec<Event>,
    nodes: Vec<i32>,
    voxels: Vec<i32>,
    /// Those of a linked graph.
    links: Option<&'m [u32]>,
    /// Of the cycle model.
    pub(crate) cycles: u64,
}

/// What a frame showed.
#[derive(Debug)]
pub(crate) struct Agreement {
    pub(crate) events: usize,
    pub(crate) samples: usize,
    /// Simulated hardware, cycle model.
    pub(crate) cycles: [u64; 2],
}

impl<'m> Expected<'m> {
    /// Draws a view by a machine's rules.
    pub(crate) fn new(machine: &'m Machine, view: &[&str]) -> Self {
        Self::linked(machine, view, None)
    }

    /// As [`Expected::new`]. `links`: those of a linked graph, whose nodes the hardware has side by side in its memory,
    /// one after the other as they stand there, behind the root; the picture has the graph's own.
    pub(crate) fn linked(machine: &'m Machine, view: &[&str], links: Option<&'m [u32]>) -> Self {
        let shelter = tempfile::tempdir().unwrap();
        let folder = shelter.path().join("frame");
        let hardware = shelter.path().join("hardware.toml");
        fs::write(&hardware, machine.hardware()).unwrap();
        let common = [view, machine.rules, &["--bits", "32"]].concat();
        let rows = [
            "--vectors",
            text(&folder),
            "--vector-records",
            "100000000",
            "--json",
        ];
        let of_model = [&["model", "--hw", text(&hardware)], &common[..], &rows].concat();
        let model: Value = serde_json::from_str(&shiftvox(shelter.path(), &of_model)).unwrap();
        let of_render = [
            "--engine",
            "machine",
            "-o",
            "picture.png",
            "--aov",
            "node,voxel",
        ];
        shiftvox(
            shelter.path(),
            &[&["render"], &common[..], &of_render].concat(),
        );
        Self {
            machine,
            links,
            events: expected_events(&folder, machine),
            nodes: numbers(&shelter.path().join("picture.node.npy")),
            voxels: numbers(&shelter.path().join("picture.voxel.npy")),
            cycles: model["simulated"]["cycles"]["cycles"]
                .as_u64()
                .unwrap_or_default(),
            shelter,
        }
    }

    /// Draws the view on the hardware, and compares all but the cycles. `simulator`: the command that runs it. `Err`:
    /// what differs.
    pub(crate) fn compare(&self, simulator: &[&str]) -> Result<Agreement, String> {
        let folder = self.shelter.path().join("frame");
        let (program, arguments) = simulator.split_first().unwrap();
        let printed = run(&folder, program, &[arguments, &["+events"]].concat());
        let cycles = printed
            .lines()
            .find_map(|line| line.strip_suffix(" cycles"));
        let cycles = cycles
            .ok_or_else(|| printed.clone())?
            .trim()
            .parse()
            .unwrap();

        let (expected, simulated) = (&self.events, simulated_events(&folder, self.machine));
        let pairs = expected.iter().zip(&simulated);
        if let Some(at) = pairs
            .clone()
            .position(|(expected, simulated)| expected != simulated)
        {
            let (expected, simulated) = (&expected[at], &simulated[at]);
            return Err(format!("event {at}: {simulated:?}, not {expected:?}"));
        }
        if expected.len() != simulated.len() {
            return Err(format!(
                "{} events, not {}",
                simulated.len(),
                expected.len()
            ));
        }

        let node_of = |word: i32| match (self.links, word) {
            (Some(links), 1..) => links[word as usize - 1] as i32,
            // The root of a graph made by hand is the node added first.
            _ => word,
        };
        let mut drawn = vec![-1i32; self.nodes.len()];
        // From the object's lowest corner to the file's indices: the same for all.
        let mut moved = None;
        for line in fs::read_to_string(folder.join("pixels.txt"))
            .unwrap()
            .lines()
        {
            let pixel: Vec<i32> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            let [at, node, x, y, z, level] = pixel[..] else {
                return Err(format!("pixel {line}"));
            };
            let at = at as usize;
            drawn[at] = node_of(node);
            let [ix, iy, iz, shown] = self.voxels[4 * at..][..4] else {
                unreachable!("four numbers a sample");
            };
            let by = [ix - x, iy - y, iz - z];
            if shown != level || *moved.get_or_insert(by) != by {
                return Err(format!("sample {at} shows voxel {x}, {y}, {z}, {level}"));
            }
        }
        if drawn != self.nodes {
            return Err("other samples are drawn".to_owned());
        }
        Ok(Agreement {
            events: simulated.len(),
            samples: drawn.iter().filter(|&&node| node >= 0).count(),
            cycles: [cycles, self.cycles],
        })
    }
}

/// Draws a view on a machine's own simulator and on the reference machine: all is equal, the cycles, too.
pub(crate) fn agree(machine: &Machine, view: &[&str]) -> Agreement {
    agree_linked(machine, view, None)
}

/// As [`agree`], with the links of a linked graph.
pub(crate) fn agree_linked(machine: &Machine, view: &[&str], links: Option<&[u32]>) -> Agreement {
    let agreement = Expected::linked(machine, view, links)
        .compare(&[machine.simulator()])
        .unwrap_or_else(|error| panic!("{} {view:?}: {error}", machine.name));
    let (name, parameters) = (machine.name, machine.parameters());
    eprintln!("{name} {parameters:?} {view:?}: {agreement:?}");
    assert_eq!(
        agreement.cycles[0], agreement.cycles[1],
        "{} {view:?}",
        machine.name
    );
    agreement
}
