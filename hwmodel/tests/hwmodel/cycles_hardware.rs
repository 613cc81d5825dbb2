//! Hardware descriptions: the presets, and errors in others.
use hwmodel::cycles::{Hardware, Independence, PRESETS, StackOverflow};
use hwmodel::{OpClass, Stage};

#[test]
fn what_ships_reads_and_every_line_says_what_it_is() {
    for (name, text) in PRESETS {
        let hardware = Hardware::preset(name).unwrap();
        assert_eq!(hardware.name, name);
        for line in text.lines() {
            let is_bare = line.is_empty() || line == "[units]";
            assert!(
                is_bare || line.contains('#') || line.starts_with('['),
                "{name}: {line}"
            );
            let is_setting = line.contains('=');
            assert!(!is_setting || line.contains('#'), "{name}: {line}");
        }
    }
    let paper = Hardware::preset("paper").unwrap();
    assert_eq!(
        paper.unit(Stage::VertexPool, OpClass::Add).unwrap().count,
        57
    );
    assert_eq!(paper.unit(Stage::Pop, OpClass::Add).unwrap().count, 8);
    assert_eq!(paper.unit(Stage::VertexPool, OpClass::Shift), None);
    assert_eq!(paper.independence, Independence::Both);
    assert_eq!(paper.stack.overflow, StackOverflow::Spill);
}

#[test]
fn a_description_survives_being_written_and_read() {
    for (name, _) in PRESETS {
        let hardware = Hardware::preset(name).unwrap();
        let json = serde_json::to_string(&hardware).unwrap();
        let back: Hardware = serde_json::from_str(&json).unwrap();
        assert_eq!(back, hardware);
    }
}

/// The error for the tiny hardware with one text replaced.
fn complaint(from: &str, to: &str) -> String {
    let (_, tiny) = PRESETS[0];
    assert!(tiny.contains(from), "{from}");
    Hardware::from_toml(&tiny.replacen(from, to, 1))
        .unwrap_err()
        .to_string()
}

/// A part of the tiny hardware, its replacement, and a part of the error.
const WRONG: &str = r#"lanes = 1 -> lanes = 0 -> lanes is 0; it must be 1 to 256
contexts = 1 -> contexts = 65 -> contexts is 65; it must be 1 to 64
clock_mhz = 50.0 -> clock_mhz = nan -> clock_mhz is NaN; it must be 0.001 to 1000000
clock_mhz = 50.0 -> clock_mhz = 0.0 -> clock_mhz is 0.0; it
clock_mhz = 50.0 -> clock_mhz = -50.0 -> clock_mhz is -50.0;
clock_mhz = 50.0 -> clock_mhz = inf -> clock_mhz is inf; it
clock_mhz = 50.0 -> clock_mhz = 1e300 -> clock_mhz is 1e300; it must be 0.001 to 1000000
clock_mhz = 50.0 -> clock_mhz = 1e-300 -> clock_mhz is 1e-300; it
name = "tiny" -> name = " " -> name is " "; it must be a line of text
name = "tiny" -> name = "a\nb" -> name is "a\nb"; it must be
wires = ["shift"] -> wires = ["shift", "add"] -> `add` is among `wires`, which take no units, and has a [units.add]
line_bytes = 32 -> line_bytes = 24 -> node_cache.line_bytes is 24; it must be a power of two
ports = 1  -> ports = 0  -> stack.ports is 0; it must be 1 to
ways = 1 -> ways = 0 -> node_cache.ways is 0; it must be 1
interval = 1, width -> interval = 0, width -> units.add.interval is 0; it must be 1
count = 1, latency -> count = 4294967296, latency -> expected u32
add = { count = 1 -> add = { count = 0 -> units.add.count is 0
min_max = { count = 1 -> min_max = { count = 0 -> units.min_max.count is 0
bytes = 4096 -> bytes = 4100 -> node_cache.bytes is 4100; it must be a multiple of ways * line_bytes, 32
line_bytes = 32 -> line_bytes = 4 -> node_cache.line_bytes is 4; it must be 8 to
misses = 1  -> misses = 0  -> node_cache.misses is 0
entry_bytes = 8 -> entry_bytes = 16777216 -> node_cache.entry_bytes is 16777216; it must be 1 to 4096
buffer = 4  -> buffer = 70000  -> pixels.buffer is 70000; it must be 1 to 65536
banks = 1 -> banks = 0 -> fill_vectors.banks is 0
wires = ["shift"] -> wires = [] -> nothing does `shift`
lanes = 1 -> lane = 1 -> unknown field `lane`
lanes = 1 -> lanes = -1 -> lanes
drain_interval = 2 ->  -> missing field `drain_interval`
"none" -> "some" -> unknown variant `some`
[stack] -> [stages.draws]; add = { count = 1, latency = 0, interval = 1, width = 8 }; [stack] -> draws
miss_latency = 40 -> miss_latency = 99999999 -> node_cache.miss_latency is 99999999"#;

#[test]
fn wrong_descriptions_are_refused_with_what_and_where() {
    for row in WRONG.lines() {
        let [from, to, expected] = [0, 1, 2].map(|column| row.split(" -> ").nth(column).unwrap());
        let text = complaint(from, &to.replace("; ", "\n"));
        assert!(text.contains(expected), "{to}: {text}");
        assert!(text.starts_with("hardware description: "), "{text}");
    }
    // A value that was changed after reading is checked before anything runs.
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.contexts = 0;
    assert!(hardware.check().is_err());
    let text = Hardware::preset("huge").unwrap_err().to_string();
    assert!(text.contains("tiny, paper, light and wide"), "{text}");
}
