//! `model`: what it prints, what it writes, what it refuses.

use serde_json::Value;
use std::process::Command;
use tempfile::TempDir;

use crate::common::Run;

fn shiftvox() -> Command {
    crate::common::command()
}

/// Runs and reads the JSON document.
fn document(args: &[&str]) -> Value {
    let output = shiftvox()
        .args(args)
        .arg("--json")
        .output()
        .expect("it runs");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    serde_json::from_slice(&output.stdout).expect("a JSON document")
}

const SCENE: [&str; 4] = ["model", "gen:menger,depth=3", "--size", "64"];

fn with(more: &[&'static str]) -> Vec<&'static str> {
    [&SCENE[..], more].concat()
}

#[test]
fn the_document_adds_up() {
    let found = document(&with(&["--hw", "paper"]));
    assert_eq!(found["schema"], "shiftvox.model");
    assert_eq!(found["schema_version"], 1);
    let cells = found["operations"].as_array().expect("cells");
    let sum: u64 = cells.iter().filter_map(|c| c["times"].as_u64()).sum();
    let stat = |name: &str| {
        let list = found["statistics"]["statistics"]
            .as_array()
            .expect("a list");
        let found = list.iter().find(|s| s["name"] == name);
        found.unwrap_or_else(|| panic!("{name}"))["value"].clone()
    };
    assert_eq!(stat("machine.ops.total"), sum);
    // Readers of stats.txt keep one value a name.
    let list = found["statistics"]["statistics"].as_array();
    let names: Vec<&str> = list
        .expect("a list")
        .iter()
        .filter_map(|s| s["name"].as_str())
        .collect();
    let distinct: std::collections::BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(distinct.len(), names.len());
    assert_eq!(stat("machine.ops.multiply"), 0);
    assert!(cells.iter().all(|cell| cell["class"] != "multiply"));
    let cycles = &found["simulated"]["cycles"];
    let number = |value: &Value| value.as_u64().expect("a number");
    assert!(number(&cycles["span"]) <= number(&cycles["cycles"]));
    assert!(number(&cycles["cycles"]) <= number(&cycles["serial"]));
    // Fill vectors: four bits a node of a quadtree of six levels below its root.
    assert_eq!(found["fill_vector_bits"], 4 * (4u64.pow(7) - 1) / 3);
    // Every figure names its rows and their source.
    for part in ["operations", "on_chip", "outer"] {
        let lines = found["cost"][part]["lines"].as_array().expect("lines");
        assert!(!lines.is_empty(), "{part}");
        for line in lines {
            for key in ["rows", "source"] {
                let text = line["each"][key].as_str().expect("text");
                assert!(!text.is_empty(), "{part}: {line}");
            }
        }
    }
    assert!(found["ray_caster"]["counts"]["cells"].as_u64() > Some(1000));
    let differing = number(&found["differing_samples"]);
    assert_eq!(found["same_picture"], differing == 0);
    let told = &found["claims"][1]["evidence"];
    assert!(
        told.as_str().is_some_and(
            |text| text.starts_with("11 operations (3 compares, 8 exclusive ors of 3 bits)")
        ),
        "{told}"
    );
    let claims = found["claims"].as_array().expect("claims");
    assert!(
        claims.iter().all(|claim| claim["holds"] != false),
        "{claims:?}"
    );
}

#[test]
fn tables_of_rules_formats_lanes_and_growth() {
    let found = document(&with(&["--rules", "--sweep", "bits=16..32+8", "--lanes"]));
    let rules = found["rules"].as_array().expect("rules");
    assert_eq!(rules.len(), 2 * (1 + 2 * 3));
    let exact = |row: &&Value| row["coverage"] == "exact";
    for row in rules.iter().filter(exact) {
        let error = &row["error"];
        let wrong = ["extra", "missing", "wrong_voxel"].map(|key| error[key].as_u64());
        assert_eq!(row["outcome"], "drawn");
        assert_eq!(row["divide_steps"], 0);
        assert!(wrong.iter().all(|w| *w <= Some(2)), "32 bits: {row}");
    }
    assert!(rules.iter().any(|row| row["tolerance_px"] == "inf"));
    let formats = found["formats"].as_array().expect("formats");
    let widths: Vec<u64> = formats.iter().filter_map(|f| f["bits"].as_u64()).collect();
    assert_eq!(widths, [16, 24, 32]);
    let area = |at: usize| formats[at]["area_nand2"].as_f64().expect("an area");
    assert!(area(0) < area(1) && area(1) < area(2));
    let depth = |at: usize| formats[at]["safe"]["depth"].as_u64().unwrap_or(0);
    assert!(depth(0) < depth(1) && depth(1) < depth(2));
    let lanes = found["lanes"].as_array().expect("lanes");
    assert_eq!(lanes.len(), 7);
    assert_eq!(lanes[0]["speedup"], 1.0);
}

/// Both designs at five sizes of the node cache, and the words that follow from it.
#[test]
fn node_caches_of_many_sizes() {
    let found = document(&with(&["--caches"]));
    let rows = found["caches"].as_array().expect("rows");
    let sizes: Vec<u64> = rows.iter().filter_map(|r| r["bytes"].as_u64()).collect();
    assert_eq!(sizes, [4096, 16_384, 65_536, 262_144, 1_048_576]);
    let number = |value: &Value| value.as_f64().expect("a number");
    for row in rows {
        let rays = row["ray_caster"].as_array().expect("orders");
        let orders: Vec<&Value> = rays.iter().map(|point| &point["order"]).collect();
        assert_eq!(orders, ["rows", "tiles", "morton"]);
        let best = number(&row["best"]["energy_pj"]["value"]);
        assert!(
            rays.iter()
                .all(|p| number(&p["energy_pj"]["value"]) >= best)
        );
        let (light, best) = (&row["light"]["energy_pj"], &row["best"]["energy_pj"]);
        let winner = if number(&light["high"]) < number(&best["low"]) {
            "light"
        } else if number(&best["high"]) < number(&light["low"]) {
            "ray_caster"
        } else {
            "neither"
        };
        assert_eq!(row["winner"], winner);
    }
    // A larger cache misses no more, for the rays that were cast once for all sizes.
    let misses: Vec<f64> = rows
        .iter()
        .map(|r| number(&r["ray_caster"][0]["node_misses"]))
        .collect();
    assert!(misses.is_sorted_by(|a, b| a >= b), "{misses:?}");
    let says = found["caches_say"].as_str().expect("a sentence");
    assert!(
        says.starts_with("Energy of the frame over the size of the node cache"),
        "{says}"
    );
    // The hardware's own size is among them, and comes to the same as without the sweep.
    let alone = &found["cost"];
    let sum: f64 = ["operations", "on_chip", "outer"]
        .iter()
        .map(|part| number(&alone[part]["total"]))
        .sum();
    assert!((number(&rows[1]["light"]["energy_pj"]["value"]) - sum).abs() < 1e-6 * sum);
    let rows_alone = document(&with(&["--ray-order", "rows"]));
    assert_eq!(rows_alone["ray_caster"]["order"], "rows");
    let own: f64 = ["operations", "on_chip", "outer"]
        .iter()
        .map(|part| number(&rows_alone["ray_caster"]["cost"][part]["total"]))
        .sum();
    let swept = number(&rows[1]["ray_caster"][0]["energy_pj"]["value"]);
    assert!((own - swept).abs() < 1e-6 * own);
}

/// Figures with ranges: power follows from energy and speed, and the ends say who has less.
#[test]
fn both_designs_line_by_line() {
    let found = document(&with(&["--hw", "paper"]));
    let lines = found["comparison"].as_array().expect("lines");
    let of = |what: &str| lines.iter().find(|l| l["what"] == what).expect("a line");
    let number = |value: &Value| value.as_f64().expect("a number");
    let energy = number(&of("energy of the frame")["light"]["value"]);
    let rate = number(&found["simulated"]["cycles"]["frames_per_second"]);
    let power = number(&of("power at its own speed, without leakage")["light"]["value"]);
    assert!((power - energy * 1e-6 * rate).abs() < 1e-9 * power.max(1.0));
    for line in lines {
        for design in ["light", "ray_caster"] {
            let range = ["low", "value", "high"].map(|end| number(&line[design][end]));
            assert!(range.is_sorted(), "{line}");
        }
        assert_eq!(line["overlap"], line["less"] == "neither");
    }
    let area = &found["area"];
    let parts =
        ["units", "registers", "memories", "control"].map(|part| number(&area[part]["total"]));
    assert!(parts.iter().all(|part| *part > 0.0));
    assert!((parts.iter().sum::<f64>() - number(&area["total"])).abs() < 1e-6 * parts[2]);
    // 200 MHz are no trouble; five gigahertz are.
    let units = found["clock"]["units"].as_array().expect("units");
    assert!(
        units
            .iter()
            .all(|unit| unit["depth"].as_u64() >= unit["depth_needed"].as_u64())
    );
    // Every record is popped that was pushed.
    let kinds = found["records_by_kind"].as_array().expect("kinds");
    let sum = |key: &str| {
        kinds
            .iter()
            .filter_map(|kind| kind[key].as_u64())
            .sum::<u64>()
    };
    assert_eq!(sum("popped"), sum("pushed"));
    assert_eq!(found["statistics"]["statistics"][0]["value"], sum("popped"));
}

#[test]
fn threads_change_no_table() {
    let tables = ["rules", "formats", "pictures", "objects", "lanes"];
    let [one, three] = ["1", "3"].map(|threads| {
        document(&with(&[
            "--rules",
            "--sweep",
            "bits=16..32+8",
            "--threads",
            threads,
        ]))
    });
    for table in tables {
        assert_eq!(one[table], three[table], "{table}");
    }
    assert_eq!(one["rules"].as_array().map(Vec::len), Some(2 * (1 + 2 * 3)));
}

#[test]
fn two_outputs_are_two_files() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("r.html").display().to_string();
    for other in ["--export-json", "--export-csv", "--stats"] {
        let mut command = shiftvox();
        command.args(SCENE);
        let assert = command
            .args(["--html", &path, other, &path])
            .assert()
            .code(2);
        let told = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(told.contains("two outputs to one file"), "{told}");
    }
}

#[test]
fn files_are_written_once() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let files = [
        "r.html",
        "stats.txt",
        "heat.png",
        "t.json",
        "r.md",
        "r.csv",
        "r.svg",
        "r.json",
    ];
    let flags = [
        "--html",
        "--stats",
        "--heat",
        "--trace",
        "--export-markdown",
        "--export-csv",
        "--export-svg",
        "--export-json",
    ];
    let mut command = shiftvox();
    command.args(SCENE);
    for (flag, name) in flags.iter().zip(files) {
        command.args([*flag, &path(name)]);
    }
    command.assert().success();
    let text = |name: &str| std::fs::read_to_string(path(name)).expect("written");
    let html = text("r.html");
    assert!(html.starts_with("<!doctype html>") && html.contains("data:image/png;base64,"));
    assert!(
        html.contains("<svg") && !html.contains("http://localhost") && !html.contains("<script")
    );
    assert!(text("stats.txt").contains("Begin Simulation Statistics"));
    assert!(text("r.csv").lines().count() > 100);
    assert!(text("r.md").contains("Area of the light hardware"));
    let trace: Value = serde_json::from_str(&text("t.json")).expect("trace events");
    assert!(
        trace["traceEvents"]
            .as_array()
            .is_some_and(|e| e.len() > 100)
    );
    assert_eq!(
        &std::fs::read(path("heat.png")).expect("written")[1..4],
        b"PNG"
    );
    // Not a second time, unless told to; and before the work.
    let again = ["--html".to_owned(), path("r.html")];
    shiftvox().args(SCENE).args(&again).assert().failure();
    shiftvox()
        .args(SCENE)
        .args(&again)
        .arg("--force")
        .assert()
        .success();
    let wave = path("t.vcd");
    shiftvox()
        .args(SCENE)
        .args(["--trace", &wave])
        .assert()
        .success();
    assert!(text("t.vcd").contains("$enddefinitions"));
}

/// The best hardware known for the rule, and the paper's for the paper's rules.
#[test]
fn the_default_hardware_follows_the_rule() {
    for (flags, wanted) in [
        (&[] as &[&str], "light"),
        (&["--coverage", "alpha"], "light"),
        (&["--paper"], "paper"),
        (&["--coverage", "center"], "paper"),
        (&["--rules"], "paper"),
        (&["--paper", "--hw", "light"], "light"),
    ] {
        let printed = shiftvox()
            .args(["model", "--print-hw"])
            .args(flags)
            .output()
            .expect("it runs");
        let printed = String::from_utf8(printed.stdout).expect("text");
        let named = printed
            .lines()
            .any(|line| line.starts_with(&format!("name = \"{wanted}\"")));
        assert!(named, "{flags:?}: {printed}");
    }
}

#[test]
fn hardware_and_costs_of_one_s_own() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let printed = shiftvox()
        .args(["model", "--print-hw", "--hw", "tiny"])
        .output()
        .expect("it runs");
    let tiny = String::from_utf8(printed.stdout).expect("text");
    let mine = tiny.replace("name = \"tiny\"", "name = \"mine\"");
    assert_ne!(tiny, mine);
    std::fs::write(path("mine.toml"), &mine).expect("written");
    let hw = ["--hw".to_owned(), path("mine.toml")];
    let found = shiftvox()
        .args(SCENE)
        .args(&hw)
        .arg("--json")
        .output()
        .expect("it runs");
    let found: Value = serde_json::from_slice(&found.stdout).expect("a document");
    assert_eq!(found["hardware"]["name"], "mine");

    let costs =
        "row = [{ operation = \"add\", width = 32, energy_pj = 1000.0, source = \"mine\" }]\n";
    std::fs::write(path("costs.toml"), costs).expect("written");
    let energy = |args: &[String]| {
        let output = shiftvox()
            .args(SCENE)
            .args(args)
            .arg("--json")
            .output()
            .expect("it runs");
        let found: Value = serde_json::from_slice(&output.stdout).expect("a document");
        found["cost"]["operations"]["total"]
            .as_f64()
            .expect("a number")
    };
    let dear = energy(&["--costs".to_owned(), path("costs.toml")]);
    assert!(dear > 100.0 * energy(&[]));
    // What is wrong is said, with the exit code of bad input.
    for (name, text) in [
        ("a.toml", "lanes = 0"),
        ("b.toml", "row = [{ operation = \"add\" }]"),
        (
            "c.toml",
            "row = [{ operation = \"ad\", width = 32, energy_pj = 1.0, source = \"mine\" }]",
        ),
        ("d.toml", "quadratic = [\"ad\"]"),
    ] {
        std::fs::write(path(name), text).expect("written");
        let flag = if name == "a.toml" { "--hw" } else { "--costs" };
        let failed = shiftvox()
            .args(SCENE)
            .args([flag, &path(name)])
            .assert()
            .code(4);
        let told = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(told.contains(name), "{told}");
    }
    shiftvox()
        .args(SCENE)
        .args(["--hw", "none-such"])
        .assert()
        .code(4);
    shiftvox()
        .args(SCENE)
        .args(["--sweep", "bits=8..12"])
        .assert()
        .code(2);
    shiftvox()
        .args(SCENE)
        .args(["--trace", "x.txt"])
        .assert()
        .code(2);
}

/// It is the machine that is modelled, so what chooses another engine is refused.
#[test]
fn engines_are_not_chosen() {
    for flag in [
        ["--engine", "fast"],
        ["--engine", "rays"],
        ["--isa", "avx2"],
        ["--erosion", "2"],
        ["--far-opacity", "none"],
    ] {
        let failed = shiftvox().args(SCENE).args(flag).assert().code(2);
        let told = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(told.contains(flag[0]), "{told}");
    }
}

/// Where boxes claim samples, children that are worked on at once may change
/// the picture, and it is told at how many samples; rays claim one each.
#[test]
fn samples_that_the_order_of_children_changes_are_counted() {
    let differing = |more: &[&'static str]| {
        let scene = ["model", "gen:terrain,depth=6", "--size", "64"];
        let found = document(&[&scene[..], more].concat());
        let claims = found["claims"].as_array().expect("claims");
        let told = claims.iter().any(|claim| {
            claim["evidence"]
                .as_str()
                .is_some_and(|text| text.contains("not the same, at "))
        });
        let differing = found["differing_samples"].as_u64().expect("a number");
        assert_eq!(told, differing > 0, "{claims:?}");
        differing
    };
    let samples = 64 * 64;
    assert!((1..samples).contains(&differing(&["--paper"])));
    assert_eq!(differing(&[]), 0);
    // One context works on one record after the other, as the serial machine does.
    assert_eq!(differing(&["--paper", "--hw", "tiny"]), 0);
}

/// A claim of growth tells each step, so that no bend is hidden.
#[test]
#[ignore = "takes long"]
fn growth_is_told_step_by_step() {
    let found = document(&with(&["--growth", "--paper"]));
    let claims = found["claims"].as_array().expect("claims");
    let evidence = |of: &str| {
        let claim = claims.iter().find(|claim| claim["claim"] == of);
        let claim = claim.unwrap_or_else(|| panic!("{of}"));
        claim["evidence"].as_str().expect("text").to_owned()
    };
    // One picture of 64 x 64 alone: no growth to tell of.
    assert_eq!(found["growing_pictures"].as_array().map(Vec::len), Some(1));
    let told = evidence("cost does not follow the object's voxels");
    for part in [
        "gen:terrain: ",
        "gen:menger: ",
        "fitted to 6 points",
        "fitted to 3 points",
        "; of those with no fewer voxels",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn a_word_that_overflows_is_told() {
    let narrow = ["--bits", "16", "--frac", "12"];
    let failed = shiftvox().args(SCENE).args(narrow).assert().code(5);
    let told = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
    assert!(told.contains("a word of"), "{told}");
}
