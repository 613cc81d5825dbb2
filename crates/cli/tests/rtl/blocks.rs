//! The blocks against the rows of the vectors.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;
use tempfile::TempDir;

use super::tools::{SHIFTVOX, each, rtl, run};

/// A view from outside, where records change to screen space.
const OUTSIDE: &str = "gen:menger,depth=3 --size 48";
/// A view from within, where they do not.
const WITHIN: &str = "gen:menger,depth=3 --size 48 --eye 13.4,12.7,3.5 --target 20,14,9";

/// Rules of stage A, and of stages B and C.
const PAPER: &str = "--paper";
const EXACT: &str = "--coverage exact --cage frame";
/// Rules with margins, whose blocks stage A shares.
const WIDENED: &str = "--coverage any --cage corners --tolerance 0.125";
const CENTRES: &str = "--coverage center --cage corners --tolerance 0.125";

/// The folders of blocks with corners and with frames. The first that has a module counts.
const CORNERS: &str = "blocks";
const FRAMES: &str = "blocks_exact blocks";

/// Vectors of a view.
struct Rows {
    shelter: TempDir,
    /// Descriptions of the blocks with rows.
    blocks: Vec<Value>,
    /// The word's widths, as definitions.
    defines: String,
}

fn name(block: &Value) -> &str {
    block["name"].as_str().unwrap()
}

impl Rows {
    fn new(rules: &str, view: &str, bits: u32, records: u32) -> Self {
        let shelter = tempfile::tempdir().unwrap();
        let line = format!("{SHIFTVOX} model {view} {rules} --bits {bits} --vectors rows");
        run(
            shelter.path(),
            &format!("{line} --vector-records {records}"),
        );
        let manifest = fs::read(shelter.path().join("rows/manifest.json")).unwrap();
        let manifest: Value = serde_json::from_slice(&manifest).unwrap();
        let word = |key: &str| manifest["word"][key].as_u64().unwrap();
        let [bits, wide, fraction] = ["bits", "wide_bits", "screen_fraction_bits"].map(word);
        let mut blocks = manifest["blocks"].as_array().unwrap().clone();
        // Under a tolerance, the limit of size is not one sample, which stage A's is.
        let is_widened = rules.contains("--tolerance");
        blocks.retain(|block| block["rows"] != 0 && !(is_widened && name(block) == "size_limit"));
        Self {
            shelter,
            blocks,
            defines: format!("-DWORD_BITS={bits} -DWIDE_BITS={wide} -DFRACTION_BITS={fraction}"),
        }
    }

    fn folder(&self) -> PathBuf {
        self.shelter.path().join("rows")
    }
}

/// A testbench of a block: `rtl/tb/rows.vh` with its macros.
fn testbench(block: &Value) -> String {
    let name = name(block);
    let mut connections = Vec::new();
    for (side, wire) in [("in", "row"), ("out", "result")] {
        for port in block[side]["ports"].as_array().unwrap() {
            let (name, lowest) = (port["name"].as_str().unwrap(), &port["lowest_bit"]);
            let bits = port["count"].as_u64().unwrap() * port["bits"].as_u64().unwrap();
            connections.push(format!(".{name}({wire}[{lowest} +: {bits}])"));
        }
    }
    let (mut clock, mut unclock) = ("", "");
    if name == "to_screen_divide" {
        connections.push(".clk(clk), .start(start), .last(last)".to_owned());
        (clock, unclock) = ("`define CLOCKED\n", "`undef CLOCKED\n");
    }
    let [into, out] = ["in", "out"].map(|side| &block[side]["bits"]);
    let ports = connections.join(", ");
    format!(
        "`define BENCH {name}_tb\n`define BLOCK {name}\n`define ROWS \"{name}.jsonl\"\n`define INTO {into}\n\
         `define OUT {out}\n`define PORTS {ports}\n{clock}`include \"tb/rows.vh\"\n{unclock}"
    )
}

/// Runs all blocks through their rows, with modules from the first folder that has them. Returns the blocks with wrong
/// rows.
fn wrong_blocks<'r>(rows: &'r Rows, folders: &str) -> Vec<&'r str> {
    let source: String = rows.blocks.iter().map(testbench).collect();
    let shelter = tempfile::tempdir().unwrap();
    let [file, compiled] = ["rows.v", "rows.vvp"].map(|name| shelter.path().join(name));
    fs::write(&file, source).unwrap();
    let rtl = rtl();
    let folders = each(folders, |folder| {
        let folder = rtl.join(folder);
        format!(" -y {0} -I {0}", folder.display())
    });
    let tops = rows.blocks.iter();
    let tops: String = tops
        .map(|block| format!(" -s {}_tb", name(block)))
        .collect();
    let [file, compiled] = [file, compiled].map(|path| path.display().to_string());
    let line = format!(
        "iverilog -g2012 -I {} -o {compiled} {}",
        rtl.display(),
        rows.defines
    );
    run(&rows.folder(), &format!("{line}{folders}{tops} {file}"));
    let printed = run(&rows.folder(), &format!("vvp -n {compiled}"));
    let is_wrong = |name: &str, rows: u64| {
        let mut lines = printed.lines();
        let line = lines.find_map(|line| line.strip_prefix(&format!("{name}_tb: ")));
        let (wrong, all) = line.and_then(|line| line.split_once(" of ")).unwrap();
        assert_eq!(all, rows.to_string(), "{name}: {printed}");
        wrong != "0"
    };
    let names = rows
        .blocks
        .iter()
        .map(|block| (name(block), block["rows"].as_u64().unwrap()));
    let wrong = names.filter(|&(name, rows)| is_wrong(name, rows));
    wrong.map(|(name, _)| name).collect()
}

#[test]
fn every_row_of_every_block_in_two_formats() {
    let settings = [
        (PAPER, CORNERS),
        (EXACT, FRAMES),
        (WIDENED, CORNERS),
        (CENTRES, CORNERS),
    ];
    // Of the last two settings only the margins are new.
    for (bits, settings) in [(24, &settings[..]), (32, &settings[..2])] {
        for view in [OUTSIDE, WITHIN] {
            for (rules, folders) in settings {
                let rows = Rows::new(rules, view, bits, 60);
                assert!(rows.blocks.len() >= 22, "{bits} {rules} {view}");
                let wrong = wrong_blocks(&rows, folders);
                assert!(wrong.is_empty(), "{bits} {rules} {view}: {wrong:?}");
            }
        }
    }
}
