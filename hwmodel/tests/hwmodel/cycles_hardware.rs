//! Hardware descriptions: the presets, and errors in others.
use crate::common::*;
use hwmodel::cycles::{Hardware, PRESETS};
use hwmodel::{OpClass, Stage};

#[test]
fn presets_can_be_read_and_written_and_every_setting_is_explained() {
    for (name, text) in PRESETS {
        let hardware = Hardware::preset(name).unwrap();
        assert_eq!(hardware.name, name);
        for line in text.lines() {
            assert!(!line.contains('=') || line.contains('#'), "{name}: {line}");
        }
        let json = serde_json::to_string(&hardware).unwrap();
        assert_eq!(serde_json::from_str::<Hardware>(&json).unwrap(), hardware);
    }
    let paper = Hardware::preset("paper").unwrap();
    let adders = |stage| paper.unit(stage, OpClass::Add).unwrap().count;
    assert_eq!(
        (adders(RecordStage::VertexPool), adders(RecordStage::Pop)),
        (57, 8)
    );
    assert_eq!(paper.unit(RecordStage::VertexPool, OpClass::Shift), None);
    assert!(Hardware::preset("huge").is_err());
}

/// A part of the tiny hardware, its replacement, and a part of the error.
const WRONG: &str = r#"lanes = 1 -> lanes = 257 -> lanes is 257; it must be 1 to 256
contexts = 1 -> contexts = 65 -> contexts is 65; it must be 1 to 64
contexts = 1 -> contexts = 2; sequential = true -> contexts is 2; it must be 1 where lanes are sequential and draw no tiles
[stack] -> [organisation]; bricks = true; [stack] -> organisation.bricks is true; it must be false where leaf_masks is
[stack] -> [organisation]; tile_levels = 9; [stack] -> organisation.tile_levels is 9; it must be 0 to 8
clock_mhz = 50.0 -> clock_mhz = nan -> clock_mhz is NaN; it must be 0.001 to 1000000
clock_mhz = 50.0 -> clock_mhz = 1e300 -> clock_mhz is 1e300; it must be 0.001 to 1000000
name = "tiny" -> name = " " -> name is " "; it must be a line of text
name = "tiny" -> name = "a\nb" -> name is "a\nb"; it must be
wires = ["shift"] -> wires = ["shift", "add"] -> `add` is among `wires`, which take no units, and has a [units]
wires = ["shift"] -> wires = [] -> `shift` has neither a [units] nor a place among `wires`
add = { count = 1 -> add = { count = 0 -> units.add.count is 0
interval = 1, width -> interval = 0, width -> units.add.interval is 0; it must be 1 to 16777216
[stack] -> [stages.draw]; add = { count = 1, latency = 0, interval = 1, width = 0 }; [stack] -> stages.draw.add.width is 0
[stack] -> [stages.draws]; add = { count = 1, latency = 0, interval = 1, width = 8 }; [stack] -> [stages.draws] is none of pop, filled, to_screen, one_pixel
ports = 1  -> ports = 0  -> stack.ports is 0; it must be 1 to
bytes = 4096 -> bytes = 4100 -> node_cache.bytes is 4100; it must be a multiple of ways * line_bytes, 32
ways = 1 -> ways = 0 -> node_cache.ways is 0; it must be 1
line_bytes = 32 -> line_bytes = 24 -> node_cache.line_bytes is 24; it must be a power of two
line_bytes = 32 -> line_bytes = 4 -> node_cache.line_bytes is 4; it must be 8 to
entry_bytes = 8 -> entry_bytes = 4097 -> node_cache.entry_bytes is 4097; it must be 1 to 4096
misses = 1  -> misses = 0  -> node_cache.misses is 0
miss_latency = 40 -> miss_latency = 99999999 -> node_cache.miss_latency is 99999999
banks = 1 -> banks = 0 -> fill_vectors.banks is 0
[stack] -> [outer_memory.dram]; banks = 2; row_bytes = 4; t_rcd = 3; t_rp = 3; t_cl = 3; [stack] -> outer_memory.dram.row_bytes is 4
[stack] -> [outer_memory.dram]; banks = 2; row_bytes = 64; t_rcd = 3; [stack] -> missing field `t_rp`
buffer = 4  -> buffer = 70000  -> pixels.buffer is 70000; it must be 1 to 65536
lanes = 1 -> lane = 1 -> unknown field `lane`
"none" -> "some" -> unknown variant `some`"#;

#[test]
fn wrong_descriptions_are_refused_with_what_and_where() {
    let (_, tiny) = PRESETS[0];
    for row in WRONG.lines() {
        let [from, to, expected] = [0, 1, 2].map(|column| row.split(" -> ").nth(column).unwrap());
        assert!(tiny.contains(from), "{from}");
        let wrong = tiny.replacen(from, &to.replace("; ", "\n"), 1);
        let known = RecordStage::ALL.map(Stage::from);
        let found = Hardware::from_toml(&wrong).and_then(|of| of.check_stages(&known));
        let text = found.unwrap_err().to_string();
        assert!(text.contains(expected), "{to}: {text}");
        assert!(text.starts_with("hardware description: "), "{text}");
    }
}
