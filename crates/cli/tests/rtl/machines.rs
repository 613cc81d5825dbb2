//! Simulated machines of `rtl/` against the reference machine: every event with all its bits in order, the picture, and the
//! cycles.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use serde_json::Value;
use shiftvox::picture::npy::{self, Values};
use tempfile::TempDir;

use super::tools::{SHIFTVOX, each, rtl, run};

/// A machine of `rtl/`.
pub(crate) struct Machine {
    /// The folder of its stage.
    pub(crate) stage: &'static str,
    /// Parameters of its testbenches, which are keys of its description: `LANES`, `CONTEXTS` of each and `TILE_LEVELS`
    /// if it has lanes, `BRICKS`.
    pub(crate) parameters: &'static str,
    /// The folder of its simulator.
    simulator: OnceLock<TempDir>,
}

pub(crate) static STAGE_A: Machine = Machine::new("stage_a", "");
pub(crate) static STAGE_B: Machine = Machine::new("stage_b", "");
pub(crate) static STAGE_C: Machine = Machine::new("stage_c", "");
pub(crate) static STAGE_C_BRICKS: Machine = Machine::new("stage_c", "BRICKS=1");
pub(crate) static LANES: [Machine; 11] = [
    Machine::new("stage_b", "LANES=1 CONTEXTS=1 TILE_LEVELS=2"),
    Machine::new("stage_b", "LANES=2 CONTEXTS=1 TILE_LEVELS=2"),
    Machine::new("stage_b", "LANES=3 CONTEXTS=1 TILE_LEVELS=3"),
    Machine::new("stage_b", "LANES=4 CONTEXTS=1 TILE_LEVELS=2"),
    Machine::new("stage_c", "LANES=1 CONTEXTS=1 TILE_LEVELS=2"),
    Machine::new("stage_c", "LANES=1 CONTEXTS=2 TILE_LEVELS=2"),
    Machine::new("stage_c", "LANES=1 CONTEXTS=4 TILE_LEVELS=2"),
    Machine::new("stage_c", "LANES=1 CONTEXTS=8 TILE_LEVELS=3"),
    Machine::new("stage_c", "LANES=4 CONTEXTS=1 TILE_LEVELS=2"),
    Machine::new("stage_c", "LANES=2 CONTEXTS=4 TILE_LEVELS=2"),
    Machine::new("stage_c", "LANES=2 CONTEXTS=4 TILE_LEVELS=2 BRICKS=1"),
];

impl Machine {
    pub(crate) const fn new(stage: &'static str, parameters: &'static str) -> Self {
        Self {
            stage,
            parameters,
            simulator: OnceLock::new(),
        }
    }

    pub(crate) fn has_lanes(&self) -> bool {
        self.parameters.contains("LANES")
    }

    /// The rules by which it draws.
    fn rules(&self) -> &'static str {
        match self.stage {
            "stage_a" => "--paper",
            _ => "--coverage exact --cage frame",
        }
    }

    /// The folders of its modules. The first that has a module counts.
    pub(crate) fn folders(&self) -> &'static str {
        match self.stage {
            "stage_a" => "machine stage_a blocks",
            "stage_b" => "machine stage_b blocks_exact blocks",
            _ => "machine stage_c stage_b blocks_exact blocks",
        }
    }

    /// The testbench that draws frames.
    pub(crate) fn testbench(&self) -> &'static str {
        match self.has_lanes() {
            true => "lanes_tb",
            false => "frame_tb",
        }
    }

    /// Its description for the cycle model.
    fn hardware(&self) -> String {
        let end = if self.has_lanes() { "_lanes" } else { "" };
        let file = rtl().join(format!("{}{end}.toml", self.stage));
        let mut text = fs::read_to_string(file).unwrap();
        for parameter in self.parameters.split_whitespace() {
            let (name, value) = parameter.split_once('=').unwrap();
            let key = format!("\n{} = ", name.to_lowercase());
            let (head, rest) = text.split_once(&key).unwrap();
            let (_, tail) = rest.split_once(' ').unwrap();
            let value = if name == "BRICKS" { "true" } else { value };
            text = format!("{head}{key}{value} {tail}");
        }
        text
    }

    /// The model's report of a view, by default of words of 32 bits, with more flags that may name files in this folder.
    pub(crate) fn model(&self, folder: &Path, view: &str, flags: &str) -> Value {
        fs::write(folder.join("hardware.toml"), self.hardware()).unwrap();
        let bits = if flags.contains("--bits") {
            ""
        } else {
            "--bits 32"
        };
        let line = format!("model {view} {} {bits} --hw hardware.toml", self.rules());
        let report = run(folder, &format!("{SHIFTVOX} {line} --json {flags}"));
        serde_json::from_str(&report).unwrap()
    }

    /// Makes the simulator for words of 32 bits and pictures up to 256 x 256, once, and returns its command.
    fn simulator(&self) -> String {
        let folder = self.simulator.get_or_init(|| {
            let folder = tempfile::tempdir().unwrap();
            let top = self.testbench();
            let folders = each(self.folders(), |folder| format!(" -I{folder}"));
            let parameters = each(self.parameters, |parameter| format!(" -G{parameter}"));
            let line = "verilator --binary -O3 --x-assign fast --x-initial fast -CFLAGS -O1 -Wno-fatal -Wno-WIDTH -I.";
            let into = format!("-o frame --Mdir {}", folder.path().display());
            let line = format!("{line} {into} --top-module {top} tb/{top}.v{folders}{parameters}");
            run(&rtl(), &line);
            folder
        });
        folder.path().join("frame").display().to_string()
    }

    /// Events of a frame from its vectors, as the testbench writes them: port, address, data, where the hardware has it.
    fn expected_events(&self, vectors: &Path) -> Vec<String> {
        let text = fs::read_to_string(vectors.join("turns.jsonl")).unwrap();
        let event = |line: &str| {
            let event: Value = serde_json::from_str(line).unwrap();
            let [port, data] = ["port", "data"].map(|key| event[key].as_str().unwrap());
            let data = match port {
                // Records lie on the stack, and come from it later.
                "pop" if self.stage != "stage_c" => "",
                "fill_read" | "node_read" | "attribute_read" => "",
                _ => data.trim_start_matches('0'),
            };
            format!("{port} {} {data:0>1}", event["address"])
        };
        text.lines().map(event).collect()
    }
}

/// Events that a simulation wrote, by tiles.
fn simulated_events(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("events.txt")).unwrap();
    let lines = text.lines().map(|line| line.split_once(' ').unwrap());
    let mut lines: Vec<(u32, &str)> = lines
        .map(|(t, event)| (t.parse().unwrap(), event))
        .collect();
    lines.sort_by_key(|&(tile, _)| tile);
    lines
        .into_iter()
        .map(|(_, event)| event.to_owned())
        .collect()
}

fn numbers(path: &Path) -> Vec<i32> {
    match npy::decode(&fs::read(path).unwrap()).unwrap().values {
        Values::I32(numbers) => numbers,
        _ => unreachable!("a buffer of integers"),
    }
}

/// A view on the reference machine.
pub(crate) struct Expected<'m> {
    shelter: TempDir,
    events: Vec<String>,
    nodes: Vec<i32>,
    voxels: Vec<i32>,
    /// Those of a linked graph.
    links: Option<&'m [u32]>,
    pub(crate) cycles: u64,
}

/// Size of a frame that agrees.
#[derive(Debug)]
pub(crate) struct Agreement {
    pub(crate) events: usize,
    pub(crate) samples: usize,
    pub(crate) cycles: u64,
}

impl<'m> Expected<'m> {
    /// Draws a view by a machine's rules. `links`: those of a linked graph. The hardware has its nodes side by side in
    /// memory, in the order of the links behind the root; the picture has the graph's own numbers.
    pub(crate) fn new(machine: &Machine, view: &str, links: Option<&'m [u32]>) -> Self {
        let shelter = tempfile::tempdir().unwrap();
        let folder = shelter.path();
        let model = machine.model(folder, view, "--vectors frame --vector-records 100000000");
        let rules = machine.rules();
        let line = format!("render {view} {rules} --bits 32 --engine machine -o picture.png");
        run(folder, &format!("{SHIFTVOX} {line} --aov node,voxel"));
        Self {
            links,
            events: machine.expected_events(&folder.join("frame")),
            nodes: numbers(&folder.join("picture.node.npy")),
            voxels: numbers(&folder.join("picture.voxel.npy")),
            cycles: model["simulated"]["cycles"]["cycles"].as_u64().unwrap(),
            shelter,
        }
    }

    /// Draws the view by a simulator's command and compares everything. `Err`: the first difference.
    pub(crate) fn compare(&self, simulator: &str) -> Result<Agreement, String> {
        let folder = self.shelter.path().join("frame");
        let printed = run(&folder, &format!("{simulator} +events"));
        let simulated = simulated_events(&folder);
        if simulated != self.events {
            let mut pairs = self.events.iter().zip(&simulated);
            let at = pairs.position(|(a, b)| a != b);
            let at = at.unwrap_or(simulated.len().min(self.events.len()));
            let [there, expected] = [&simulated, &self.events].map(|events| events.get(at));
            return Err(format!(
                "event {at}: {there:?}, not {expected:?}: {printed}"
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
        let pixels = fs::read_to_string(folder.join("pixels.txt")).unwrap();
        for line in pixels.lines() {
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
        let cycles = format!("{} cycles", self.cycles);
        if !printed.lines().any(|line| line == cycles) {
            return Err(format!("not {cycles}: {printed}"));
        }
        Ok(Agreement {
            events: simulated.len(),
            samples: drawn.iter().filter(|&&node| node >= 0).count(),
            cycles: self.cycles,
        })
    }

    /// As [`Self::compare`], with a compiled testbench in Icarus Verilog, for at most so many cycles.
    pub(crate) fn compare_in_icarus(
        &self,
        compiled: &Path,
        most: u64,
    ) -> Result<Agreement, String> {
        self.compare(&format!("vvp -n {} +most={most}", compiled.display()))
    }
}

/// Draws a view on a machine's simulator and on the reference machine. Everything is equal, including the cycles.
pub(crate) fn agree(machine: &Machine, view: &str, links: Option<&[u32]>) -> Agreement {
    let name = format!("{} {} {view}", machine.stage, machine.parameters);
    let compared = Expected::new(machine, view, links).compare(&machine.simulator());
    let agreement = compared.unwrap_or_else(|error| panic!("{name}: {error}"));
    eprintln!("{name}: {agreement:?}");
    agreement
}
