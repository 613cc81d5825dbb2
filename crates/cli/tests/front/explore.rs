//! `model --explore`: points, interrupted and divided runs, refusals.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;
use shiftvox_lab::model::explore::front::front;
use shiftvox_lab::model::explore::lines::PointLine;
use shiftvox_lab::model::explore::space::{SPACES, Space};
use shiftvox_lab::model::explore::{PointFigures, PointOutcome};
use shiftvox_lab::model::range::Range;
use std::process::Command;
use tempfile::TempDir;

use crate::common::Run;
use crate::program::{json_of, run, shiftvox, stderr_of, stdout_of};

const SCENE: &str = "gen:menger,depth=3";

/// Two organisations, words that are too narrow for a right picture, a clock that is too fast.
const SPACE: &str = r#"
hardware = ["paper", "light"]
[ranges]
bits = [18, 32]
clock_mhz = [200.0, 400.0]
contexts = { from = 2, to = 4, times = 2 }
node_cache.bytes = { from = 1024, to = 4096, times = 4 }
"#;

/// A folder with a space in it.
struct Folder(TempDir);

impl Folder {
    fn new(space: &str) -> Self {
        let folder = Self(TempDir::new().unwrap());
        fs::write(folder.path("space.toml"), space).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, scene: &str, more: &[&str]) -> Command {
        let mut command = shiftvox(self.0.path());
        command.args(["model", scene, "--size", "40", "--explore", "space.toml"]);
        command.args(more);
        command
    }

    fn run(&self, more: &[&str]) -> String {
        stdout_of(&self.command(SCENE, more).assert().success())
    }

    /// Exit code and stderr.
    fn refusal(&self, scene: &str, more: &[&str]) -> (i32, String) {
        let assert = self.command(scene, more).assert();
        let code = assert.get_output().status.code().unwrap();
        (code, stderr_of(&assert))
    }
}

fn lines(text: &str, kind: &str) -> Vec<Value> {
    let all = text.lines().map(|line| serde_json::from_str(line).unwrap());
    all.filter(|line: &Value| line["kind"] == kind).collect()
}

/// Asserts that points have the figures that `model` has of their hardware alone.
fn assert_as_alone(folder: &Folder, points: &[Value]) {
    for found in points {
        let number = found["point"].to_string();
        let hardware = folder.run(&["--points", &number, "--print-hw"]);
        fs::write(folder.path("hw.toml"), hardware).unwrap();
        let bits = found["values"]["bits"].as_u64().unwrap_or(32).to_string();
        let mut alone = shiftvox(folder.0.path());
        alone.args(["model", SCENE, "--size", "40", "--hw", "hw.toml", "--json"]);
        let model = json_of(&alone.args(["--bits", &bits]).assert().success());
        let cycles = &model["simulated"]["cycles"];
        assert_eq!(found["cycles"], cycles["cycles"], "{found}");
        let rate = cycles["frames_per_second"].as_f64().unwrap();
        let time = found["time_ms"].as_f64().unwrap();
        assert!((time * rate / 1e3 - 1.0).abs() < 1e-12);
        assert_eq!(found["limits"], cycles["bottleneck"]["resource"]);
        let error = &model["coverage_error"];
        let wrong = ["extra", "missing", "wrong_voxel"].map(|of| error[of].as_u64().unwrap());
        assert_eq!(found["wrong_samples"], wrong.iter().sum::<u64>());
        assert_eq!(found["differing_samples"], model["differing_samples"]);
        let units = model["clock"]["units"].as_array().unwrap();
        let meets = |of: &Value| of["depth"].as_u64() >= of["depth_needed"].as_u64();
        assert_eq!(found["meets_clock"], units.iter().all(meets));
        let counts = &found["counts"];
        for (count, alone) in [
            (&counts["records"], &model["counters"]["records"]),
            (
                &counts["deepest_stack"],
                &model["counters"]["deepest_stack"],
            ),
            (&counts["hardware_records"], &cycles["records"]),
            (&counts["node_misses"], &cycles["node_cache"]["misses"]),
            (&counts["record_bits"], &model["record_bits"]),
            (&counts["fill_bits"], &model["fill_vector_bits"]),
            (&counts["extra"], &error["extra"]),
            (&counts["missing"], &error["missing"]),
            (&found["units_nand2"], &model["area"]["units"]["total"]),
            (
                &found["operations_pj"]["value"],
                &model["cost"]["operations"]["total"],
            ),
            (&found["floor_pj"], &model["floor"]["energy_pj"]),
        ] {
            assert_eq!(count, alone, "{found}");
        }
        let rays = &model["ray_caster"];
        assert_eq!(found["ray_caster"]["order"], rays["order"]);
        assert_eq!(found["ray_caster"]["orders"], rays["orders"]);
        assert_eq!(found["ray_caster"]["cycles"], rays["cycles"]["cycles"]);
        for (found, model) in [(found, &model), (&found["ray_caster"], rays)] {
            for (end, name) in [("value", "total"), ("low", "low"), ("high", "high")] {
                assert_eq!(found["area_nand2"][end], model["area"][name], "{found}");
                let cost = ["operations", "on_chip", "outer"]
                    .map(|of| model["cost"][of][name].as_f64().unwrap());
                let sum = cost.iter().fold(0.0, |sum, part| sum + part);
                assert_eq!(found["energy_pj"][end], sum, "{found}");
            }
        }
    }
}

#[test]
fn points_have_the_figures_of_model() {
    let folder = Folder::new(SPACE);
    let text = folder.run(&["--json"]);
    let points = lines(&text, "point");
    let numbers: Vec<_> = points.iter().map(|of| of["point"].clone()).collect();
    assert_eq!(numbers, (0..32).collect::<Vec<_>>());
    let some = [0, 9, 14, 17, 26, 31].map(|at: usize| points[at].clone());
    assert_as_alone(&folder, &some);
    for key in ["wrong_samples", "meets_clock", "cycles", "energy_pj"] {
        assert!(points.iter().any(|of| of[key] != points[0][key]), "{key}");
    }
    let front = &lines(&text, "front")[0];
    let on_front = front["front"].as_array().unwrap();
    assert!(!on_front.is_empty());
    assert!(on_front.iter().all(|of| of["meets_clock"] == true));
    assert!(front["too_slow_for_their_clock"].as_u64() > Some(0));
    // Where parents lie on the stack, cycles come from turns that were recorded once.
    let folder = Folder::new(
        "hardware = [\"light\"]\n[ranges]\nindependence = [\"none\", \"image\", \"both\"]\nlanes = [1, 3]\n\
         organisation.tile_levels = [0, 2]\nstack.entries = [1, 64]\n",
    );
    let points = lines(&folder.run(&["--json"]), "point");
    assert_eq!(points.len(), 24);
    assert_as_alone(&folder, &points);
}

#[test]
fn threads_interruptions_and_parts_give_one_result() {
    let folder = Folder::new(SPACE);
    let whole = folder.run(&["--json", "--threads", "1", "--results", "one.jsonl"]);
    let file = fs::read(folder.path("one.jsonl")).unwrap();
    assert!(whole.as_bytes().starts_with(&file));
    assert_eq!(lines(&whole[file.len()..], "front").len(), 1);
    assert!(folder.run(&["--json", "--threads", "2"]) == whole);
    for end in [file.len() * 2 / 3, 20, file.len() - 1, file.len()] {
        fs::write(folder.path("one.jsonl"), &file[..end]).unwrap();
        let after = folder.run(&["--json", "--results", "one.jsonl"]);
        assert!(after == whole, "stopped at byte {end}");
        assert!(fs::read(folder.path("one.jsonl")).unwrap() == file);
    }
    // Existing results are kept: an impossible figure stays.
    let text = String::from_utf8(file).unwrap();
    let marked = text.replacen("\"cycles\":", "\"cycles\":1000000", 1);
    fs::write(folder.path("one.jsonl"), &marked).unwrap();
    let after = folder.run(&["--json", "--results", "one.jsonl"]);
    assert!(after.starts_with(&marked));
    // Printed lines are results too.
    let parts = ["21..31", "0..9", "10..20"].map(|of| folder.run(&["--json", "--points", of]));
    let front = &lines(&parts[1], "front")[0];
    assert_eq!(
        (&front["points"], &front["space_points"]),
        (&10.into(), &32.into())
    );
    fs::write(folder.path("all.jsonl"), parts.concat()).unwrap();
    assert!(folder.run(&["--json", "--results", "all.jsonl"]) == whole);
    let after = fs::read_to_string(folder.path("all.jsonl")).unwrap();
    assert!(after == parts.concat(), "nothing was left to measure");
}

/// The spaces that ship, on a small scene: names, points, and figures that only they vary.
#[test]
fn spaces_that_ship() {
    let folder = Folder::new("");
    let explored = |space: &str, more: &[&str]| {
        let line = ["model", SCENE, "--size", "32", "--json", "--explore", space];
        let line = [&line, more].concat();
        lines(&stdout_of(&run(folder.0.path(), &line).success()), "point")
    };
    let of = |points: &[Value], path: &str| -> Vec<f64> {
        let numbers = points.iter().filter(|of| of["outcome"] == "drawn");
        let numbers = numbers.map(|of| of.pointer(path).unwrap().as_f64().unwrap());
        numbers.collect()
    };
    let rules = explored("rules", &[]);
    assert_eq!(rules.len(), 2 * 3 * 3);
    let exact = rules
        .iter()
        .filter(|of| of["values"]["coverage"] == "exact");
    let (drawn, refused): (Vec<_>, Vec<_>) = exact.partition(|of| of["outcome"] == "drawn");
    assert_eq!(refused.len(), 4);
    assert_eq!(drawn.len() + 4 + 12, rules.len());
    for point in drawn {
        assert_eq!(point["counts"]["divide_steps"], 0);
        assert!(point["wrong_samples"].as_u64() <= Some(6), "{point}");
    }
    let words = explored("words", &["--points", "0..4"]);
    assert_eq!(of(&words, "/values/bits"), [16.0, 20.0, 24.0, 28.0, 32.0]);
    for path in ["/area_nand2/value", "/format/safe_depth"] {
        assert!(of(&words, path).is_sorted_by(|a, b| a < b), "{path}");
    }
    let lanes = explored("lanes", &["--hw", "tiny"]);
    assert_eq!(lanes.len(), 7);
    assert!(lanes.iter().all(|of| of["values"]["hardware"] == "tiny"));
    let caches = explored("caches", &[]);
    // A larger cache misses no more, for rays that were cast once for all sizes.
    assert!(of(&caches, "/ray_caster/node_misses").is_sorted_by(|a, b| a >= b));
    for point in &caches {
        let energy = |path: &str| point.pointer(path).unwrap()["energy_pj"].clone();
        let [light, rays] = ["", "/ray_caster"].map(energy);
        let less = |a: &Value, b: &Value| a["high"].as_f64() < b["low"].as_f64();
        let wanted = match (less(&light, &rays), less(&rays, &light)) {
            (true, _) => "light",
            (_, true) => "ray_caster",
            _ => "neither",
        };
        assert_eq!(point["less_energy"], wanted);
        let orders = point["ray_caster"]["orders"].as_array().unwrap();
        let least = orders.iter().map(|of| of["energy_pj"].as_f64().unwrap());
        assert_eq!(least.reduce(f64::min), rays["value"].as_f64());
    }
    let steps = explored("steps", &[]);
    assert_eq!(steps.len(), 1 + 8 + 7);
    // All settings together are `light`.
    let light = explored("caches", &["--points", "1"]);
    for key in ["cycles", "energy_pj", "area_nand2", "counts"] {
        assert_eq!(steps[15][key], light[0][key], "{key}");
    }
    let sizes = explored("sizes", &["--points", "0..1"]);
    assert_eq!(of(&sizes, "/values/size"), [64.0, 128.0]);
}

/// Spaces, their lines parted by `;`, and the errors about them.
const BAD_SPACES: &str = r#"
ranges = 3 => ranges: it must be a table
[range]; lanes = [1] => there is no `range`; a space has `hardware`, [[variants]] and [ranges]
[ranges]; lane = [1] => there is no `ranges.lane`; hardware `paper` has
[ranges]; node_cache.size = [1] => there is no `ranges.node_cache.size`
[ranges]; stages.blend.add.count = [1] => there is no `ranges.stages.blend.add.count`
[ranges]; lanes = [] => ranges.lanes: it has no values
[ranges.node_cache] => ranges.node_cache: it has no values
[ranges]; lanes = [1, 2, 1] => ranges.lanes: it has 1 twice
[ranges]; lanes = [[1]] => ranges.lanes: its values must be numbers, words or booleans
[ranges]; lanes = { from = 3, to = 2, step = 1 } => ranges.lanes: it is empty, from 3 to 2
[ranges]; lanes = { from = 1, to = 2 } => ranges.lanes: it needs one of `step`
[ranges]; lanes = { from = 1, to = 2, times = 1 } => ranges.lanes: it needs one of
[ranges]; lanes = { from = 0, to = 2, times = 2 } => ranges.lanes: it needs one of
[ranges]; lanes = { from = 1, to = -2, step = 1 } => ranges.lanes: invalid value
[ranges]; lanes = { from = 1, to = 2, by = 1 } => ranges.lanes: unknown field `by`
[ranges]; lanes = [0] => lanes is 0; it must be 1 to 256
[ranges]; lanes = ["many"] => point 0, hardware = "paper", lanes = "many"
[ranges]; organisation.stack = ["heaps"] => unknown variant `heaps`
[ranges]; node_cache.bytes = [4096, 100] => point 1, hardware = "paper", node_cache.bytes = 100
[ranges]; node_cache.bytes = [100] => node_cache.bytes is 100; it must be a multiple of ways
[ranges]; bits = [8, 32] => ranges.bits: 8: a word has 16 to 64 bits
hardware = ["papier"] => hardware `papier`: no hardware and no file is called papier
hardware = [3] => hardware: it must be a list of names or files
hardware = [] => hardware: it has no values
[ranges]; lanes = { from = 1, to = 256, step = 1 }; contexts = { from = 1, to = 64, step = 1 }; stack.entries = { from = 1, to = 99, step = 1 } => more than 65536 points
lanes = [1 => TOML parse error
variants = 1 => variants: it must be a list
[[variants]]; lanes = 1 => each with a `name`
[[variants]]; name = "a"; lane = 1 => there is no `variants.a.lane`
[[variants]]; name = "a"; lanes = [1, 2] => one value for each key
[ranges]; size = 0 => ranges.size: 0 is too small
[ranges]; cage = "box" => ranges.cage: unknown variant
"#;

#[test]
fn bad_spaces_are_refused_by_name() {
    for line in BAD_SPACES.trim().lines() {
        let (space, expected) = line.split_once(" => ").unwrap();
        let folder = Folder::new(&space.replace("; ", "\n"));
        let (code, told) = folder.refusal(SCENE, &[]);
        assert_eq!(code, 4, "{space}: {told}");
        assert!(told.contains("space.toml: "), "{space}: {told}");
        assert!(told.contains(expected), "{space}: {told}");
    }
}

/// A change of a file of results, and the refusal.
const BAD_RESULTS: &str = r#"
"schema_version":1 => "schema_version":9 => `schema_version` is 9, not 1
{"kind":"point" => {"kind":" => line 2: this is no result
"kind":"point" => "kind":"poem" => line 2: this is no result
{"kind":"space" => {"kind":"front" => line 2: what this point is of
"point":1, => "point":7, => there.jsonl: there is no point 7
"#;

#[test]
fn results_of_something_else_are_refused_and_kept() {
    let folder = Folder::new("[ranges]\ncontexts = [4, 8]\n");
    folder.run(&["--results", "there.jsonl"]);
    let there = fs::read_to_string(folder.path("there.jsonl")).unwrap();
    let refused = |text: &str, more: &[&str], expected: &str| {
        fs::write(folder.path("there.jsonl"), text).unwrap();
        let more = [&["--results", "there.jsonl"], more].concat();
        let (code, told) = folder.refusal(SCENE, &more);
        assert_eq!(code, 4, "{told}");
        assert!(
            told.contains("there.jsonl: ") && told.contains(expected),
            "{told}"
        );
        assert_eq!(
            fs::read_to_string(folder.path("there.jsonl")).unwrap(),
            text
        );
    };
    for line in BAD_RESULTS.trim().lines() {
        let (change, expected) = line.rsplit_once(" => ").unwrap();
        let (from, to) = change.split_once(" => ").unwrap();
        assert!(there.contains(from), "{from}: {there}");
        refused(&there.replacen(from, to, 1), &[], expected);
    }
    refused(&there, &["--bits", "40"], "`options` is");
    refused(&there, &["--goal", "delay"], "`prices` is");
    refused(
        &there,
        &["--eye", "9,9,9", "--target", "0,0,0"],
        "`scene` is",
    );
    fs::write(folder.path("space.toml"), "[ranges]\ncontexts = [4, 16]\n").unwrap();
    refused(&there, &[], "`space` is");
    refused("notes without an end of line", &[], "");
}

/// The space that ships holds two designs that ship, and is what `--print-space` prints.
#[test]
fn the_bundled_space_holds_paper_and_light() {
    let mut print = crate::common::command();
    print.args(["model", "--explore", "bundled", "--print-space"]);
    let told = String::from_utf8(print.output().unwrap().stdout).unwrap();
    assert_eq!(told.trim_end(), SPACES[0].1.trim_end());
    use hwmodel::cycles::Hardware;
    let open = |name: &str| Hardware::preset(name).map_err(|error| error.to_string());
    let space = Space::from_toml(&told, None, open).unwrap();
    for name in ["paper", "light"] {
        let hardware = Hardware::preset(name).unwrap();
        let points = (0..space.len()).map(|number| space.point(number).unwrap());
        let mut alike = points.filter(|of| of.hardware == hardware && of.drawing.bits == Some(32));
        assert!(alike.next().is_some(), "{name}");
    }
}

/// A point with other figures.
fn line(of: &PointLine, point: usize, [time_ms, area, energy, wrong]: [f64; 4]) -> PointLine {
    let range = |value: f64| Range::new((value, value / 2.0, value * 2.0));
    let PointOutcome::Drawn(figures) = &of.outcome else {
        panic!("{of:?}");
    };
    let figures = PointFigures {
        time_ms,
        area_nand2: range(area),
        energy_pj: range(energy),
        wrong_samples: wrong as u64,
        meets_clock: true,
        ..(**figures).clone()
    };
    PointLine {
        point,
        outcome: PointOutcome::Drawn(Box::new(figures)),
        ..of.clone()
    }
}

#[test]
fn a_front_by_hand() {
    let folder = Folder::new("[ranges]\ncontexts = [4]\n");
    let drawn = lines(&folder.run(&["--json"]), "point").remove(0);
    let drawn: PointLine = serde_json::from_value(drawn).unwrap();
    let line = |point, figures| line(&drawn, point, figures);
    let mut points = vec![
        line(0, [4.0, 1.0, 2.0, 0.0]),
        line(1, [2.0, 2.0, 2.0, 0.0]),
        line(2, [1.0, 8.0, 2.0, 0.0]),
        line(3, [2.0, 2.0, 2.0, 0.0]), // as 1
        line(4, [2.0, 3.0, 2.0, 0.0]), // beaten by 1
        line(5, [2.0, 2.0, 1.0, 3.0]),
        line(6, [0.5, 0.5, 0.5, 0.0]), // misses its clock
        line(7, [0.5, 0.5, 0.5, 0.0]), // refused
    ];
    if let PointOutcome::Drawn(figures) = &mut points[6].outcome {
        figures.meets_clock = false;
    }
    let reason = String::new();
    points[7].outcome = PointOutcome::Refused { reason };
    let found = front(&points);
    let numbers: Vec<usize> = found.iter().map(|of| of.line.point).collect();
    assert_eq!(numbers, [2, 5, 1, 0]);
    assert!(found.iter().all(|of| of.stands_out));
    // A slightly slower, clearly smaller point replaces another.
    points.push(line(8, [1.05, 6.0, 2.0, 0.0]));
    let clear = front(&points);
    let clear = clear.iter().map(|of| (of.line.point, of.stands_out));
    assert_eq!(
        clear.collect::<Vec<_>>(),
        [(2, false), (8, true), (5, true), (1, true), (0, true)]
    );
    points.pop();
    // The order of the points does not matter.
    points.reverse();
    assert_eq!(front(&points), found);
}
