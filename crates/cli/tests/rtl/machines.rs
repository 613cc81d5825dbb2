//! Simulated machines of `rtl/` against the reference machine: every event with all its bits in order, the picture, and the
//! cycles.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

use super::tools::{rtl, run, shiftvox, text, words};

/// A machine of `rtl/`.
pub(crate) struct Machine {
    /// The folder of its stage.
    pub(crate) stage: &'static str,
    /// Number of lanes, contexts of each, and levels of the picture above its tiles.
    lanes: Option<[u32; 3]>,
    /// Whether it can have bricks.
    bricks: bool,
    /// Its simulator, made once.
    made: OnceLock<(TempDir, PathBuf)>,
}

pub(crate) static STAGE_A: Machine = Machine::new("stage_a", None, false);
pub(crate) static STAGE_B: Machine = Machine::new("stage_b", None, false);
pub(crate) static STAGE_C: Machine = Machine::new("stage_c", None, false);
pub(crate) static STAGE_C_BRICKS: Machine = Machine::new("stage_c", None, true);
pub(crate) static LANES: [Machine; 11] = [
    Machine::new("stage_b", Some([1, 1, 2]), false),
    Machine::new("stage_b", Some([2, 1, 2]), false),
    Machine::new("stage_b", Some([3, 1, 3]), false),
    Machine::new("stage_b", Some([4, 1, 2]), false),
    Machine::new("stage_c", Some([1, 1, 2]), false),
    Machine::new("stage_c", Some([1, 2, 2]), false),
    Machine::new("stage_c", Some([1, 4, 2]), false),
    Machine::new("stage_c", Some([1, 8, 3]), false),
    Machine::new("stage_c", Some([4, 1, 2]), false),
    Machine::new("stage_c", Some([2, 4, 2]), false),
    Machine::new("stage_c", Some([2, 4, 2]), true),
];

impl Machine {
    pub(crate) const fn new(stage: &'static str, lanes: Option<[u32; 3]>, bricks: bool) -> Self {
        Self {
            stage,
            lanes,
            bricks,
            made: OnceLock::new(),
        }
    }

    pub(crate) fn name(&self) -> String {
        match self.lanes {
            Some(_) => format!("{}_lanes {:?}", self.stage, self.parameters()),
            None => format!("{} {:?}", self.stage, self.parameters()),
        }
    }

    /// The rules by which it draws.
    pub(crate) fn rules(&self) -> Vec<&'static str> {
        words(match self.stage {
            "stage_a" => "--paper",
            _ => "--coverage exact --cage frame",
        })
    }

    /// The folders of its modules. The first that has a module counts.
    pub(crate) fn folders(&self) -> Vec<&'static str> {
        words(match self.stage {
            "stage_a" => "machine stage_a blocks",
            "stage_b" => "machine stage_b blocks_exact blocks",
            _ => "machine stage_c stage_b blocks_exact blocks",
        })
    }

    /// Its description for the cycle model.
    pub(crate) fn hardware(&self) -> String {
        let end = if self.lanes.is_some() { "_lanes" } else { "" };
        let file = rtl().join(format!("{}{end}.toml", self.stage));
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

    /// The testbench that draws frames.
    pub(crate) fn testbench(&self) -> &'static str {
        match self.lanes {
            Some(_) => "lanes_tb",
            None => "frame_tb",
        }
    }

    /// The testbench's parameters.
    pub(crate) fn parameters(&self) -> Vec<(&'static str, u64)> {
        let names = ["LANES", "CONTEXTS", "TILE_LEVELS"];
        let lanes = self
            .lanes
            .into_iter()
            .flat_map(|of| names.into_iter().zip(of.map(u64::from)));
        lanes.chain(self.bricks.then_some(("BRICKS", 1))).collect()
    }

    /// Whether records lie on its stack, and not the path to their parents.
    fn stacks_records(&self) -> bool {
        self.stage != "stage_c"
    }

    /// The simulator for words of 32 bits and pictures up to 256 x 256.
    pub(crate) fn simulator(&self) -> &str {
        let (_, path) = self.made.get_or_init(|| {
            let shelter = tempfile::tempdir().unwrap();
            let top = self.testbench();
            let parameters = self.parameters();
            let parameters = parameters.iter().map(|(of, number)| format!("-G{of}={number}"));
            let folders = self.folders();
            let folders = folders.iter().map(|folder| format!("-I{folder}"));
            let line = format!(
                "--binary -O3 --x-assign fast --x-initial fast -CFLAGS -O1 -Wno-fatal -Wno-WIDTH -o frame -I. \
                 --Mdir {} --top-module {top} tb/{top}.v",
                text(shelter.path())
            );
            let arguments = words(&line).into_iter().map(str::to_owned);
            let arguments: Vec<String> = arguments.chain(parameters).chain(folders).collect();
            run(&rtl(), "verilator", &arguments);
            let path = shelter.path().join("frame");
            (shelter, path)
        });
        text(path)
    }
}

/// A port by its number, the address, and the data, as far as the simulation writes it.
type Event = (usize, u64, String);

/// Hexadecimal digits of a record's box in screen space, and of its planes, which come last: words of 32 and 64 bits.
const BOX: usize = 4 * 8;
const PLANES: usize = 12 * 16;

/// Ports by their numbers.
const PORTS: [&str; 8] = [
    "pop",
    "push",
    "fill_read",
    "fill_write",
    "node_read",
    "attribute_read",
    "pixel_write",
    "made",
];

/// Events of a frame from its vectors.
fn expected_events(folder: &Path, machine: &Machine) -> Vec<Event> {
    let text = fs::read_to_string(folder.join("turns.jsonl")).unwrap();
    let lines = text
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let event = |event: Value| {
        let (port, data) = (
            event["port"].as_str().unwrap(),
            event["data"].as_str().unwrap(),
        );
        let data = match (port, machine.stacks_records()) {
            ("push", true) | ("made", _) => data.trim_start_matches('0').to_owned(),
            ("pop" | "push", false) | ("fill_write", _) => data.to_owned(),
            ("pixel_write", _) => u64::from_str_radix(data, 16).unwrap().to_string(),
            _ => String::new(),
        };
        let port = PORTS.iter().position(|of| *of == port).unwrap();
        (port, event["address"].as_u64().unwrap(), data)
    };
    lines.map(event).collect()
}

/// Events that the simulation wrote, sorted by tile. Records of stage A have no planes, and those of stages B and C no box
/// in screen space.
fn simulated_events(folder: &Path, machine: &Machine) -> Vec<Event> {
    let text = fs::read_to_string(folder.join("events.txt")).unwrap();
    let lines = text.lines().map(|line| line.split_once(' ').unwrap());
    let mut lines: Vec<(u32, &str)> = lines
        .map(|(tile, event)| (tile.parse().unwrap(), event))
        .collect();
    lines.sort_by_key(|&(tile, _)| tile);
    let event = |(_, event): (u32, &str)| {
        let mut words = event.split(' ');
        let mut next = || words.next().unwrap_or_default();
        let (port, address): (usize, u64) = (next().parse().unwrap(), next().parse().unwrap());
        let mut data = next().to_owned();
        match (PORTS[port], machine.stacks_records()) {
            ("pop" | "push", false) => {
                data = format!("{:x}", u64::from_str_radix(&data, 16).unwrap());
            }
            ("push", true) | ("made", _) => {
                let more = next();
                let (no_box, no_planes) = match machine.stage {
                    "stage_a" => (0, PLANES),
                    _ => (BOX, 0),
                };
                data += &"0".repeat(no_box);
                // The bit before the box was written already.
                data += &more[more.len() - (BOX + PLANES - no_box - no_planes)..];
                data += &"0".repeat(no_planes);
                data = data.trim_start_matches('0').to_owned();
            }
            _ => {}
        }
        (port, address, data)
    };
    lines.into_iter().map(event).collect()
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

/// Size of a frame that agrees.
#[derive(Debug)]
pub(crate) struct Agreement {
    pub(crate) events: usize,
    pub(crate) samples: usize,
    /// Simulated hardware, cycle model.
    pub(crate) cycles: [u64; 2],
}

impl<'m> Expected<'m> {
    /// Draws a view by a machine's rules. `links`: those of a linked graph. The hardware has its nodes side by side in
    /// memory, in the order of the links behind the root; the picture has the graph's own numbers.
    pub(crate) fn new(machine: &'m Machine, view: &str, links: Option<&'m [u32]>) -> Self {
        let shelter = tempfile::tempdir().unwrap();
        let folder = shelter.path().join("frame");
        let hardware = shelter.path().join("hardware.toml");
        fs::write(&hardware, machine.hardware()).unwrap();
        let view = [words(view), machine.rules(), words("--bits 32")].concat();
        let of_model = format!(
            "model --hw {} --vectors {} --vector-records 100000000 --json",
            text(&hardware),
            text(&folder)
        );
        let model = shiftvox(shelter.path(), &[words(&of_model), view.clone()].concat());
        let model: Value = serde_json::from_str(&model).unwrap();
        let of_render = words("render --engine machine -o picture.png --aov node,voxel");
        shiftvox(shelter.path(), &[of_render, view].concat());
        Self {
            machine,
            links,
            events: expected_events(&folder, machine),
            nodes: numbers(&shelter.path().join("picture.node.npy")),
            voxels: numbers(&shelter.path().join("picture.voxel.npy")),
            cycles: model["simulated"]["cycles"]["cycles"].as_u64().unwrap(),
            shelter,
        }
    }

    /// Draws the view on the hardware and compares everything except the cycles. `simulator`: its command. `Err`: the first
    /// difference.
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

        let simulated = simulated_events(&folder, self.machine);
        let mut pairs = self.events.iter().zip(&simulated).enumerate();
        if let Some((at, (expected, simulated))) = pairs.find(|(_, (a, b))| a != b) {
            return Err(format!("event {at}: {simulated:?}, not {expected:?}"));
        }
        if self.events.len() != simulated.len() {
            let (there, expected) = (simulated.len(), self.events.len());
            return Err(format!("{there} events, not {expected}"));
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
                unreachable!("four numbers per sample");
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

/// Draws a view on a machine's simulator and on the reference machine. Everything is equal, including the cycles.
pub(crate) fn agree(machine: &Machine, view: &str, links: Option<&[u32]>) -> Agreement {
    let expected = Expected::new(machine, view, links);
    let name = machine.name();
    let agreement = expected
        .compare(&[machine.simulator()])
        .unwrap_or_else(|error| panic!("{name} {view}: {error}"));
    eprintln!("{name} {view}: {agreement:?}");
    assert_eq!(agreement.cycles[0], agreement.cycles[1], "{name} {view}");
    agreement
}

/// As [`agree`], with a compiled testbench in Icarus Verilog, for at most so many cycles.
pub(crate) fn agree_in_icarus(
    expected: &Expected<'_>,
    compiled: &Path,
    most: u64,
) -> Result<(), String> {
    let most = format!("+most={most}");
    let [simulated, model] = expected
        .compare(&["vvp", "-n", text(compiled), &most])?
        .cycles;
    match simulated == model {
        true => Ok(()),
        false => Err(format!("{simulated} cycles, not {model}")),
    }
}
