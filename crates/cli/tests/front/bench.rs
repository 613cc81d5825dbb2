//! The rows of experiments.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{bench, folder, json_of, run, stdout_of, words};

const SCENE: &str = "gen:menger,depth=2";

/// The rows of an experiment's document.
fn rows(folder: &Path, line: &str) -> Vec<Value> {
    let line = [&words(line)[..], &["--json"]].concat();
    let document = json_of(&bench(folder, &line).success());
    assert_eq!(document["schema_version"], 1);
    document["rows"].as_array().unwrap().clone()
}

/// The only row with some values.
fn row<'r>(rows: &'r [Value], with: &[(&str, &str)]) -> &'r Value {
    let mut same = rows
        .iter()
        .filter(|row| with.iter().all(|(k, v)| row[k] == *v));
    let found = same.next().unwrap_or_else(|| panic!("{with:?}: {rows:?}"));
    assert!(same.next().is_none(), "{with:?} is not one row");
    found
}

fn number(row: &Value, name: &str) -> f64 {
    let found = row[name].as_f64();
    found.unwrap_or_else(|| panic!("{name}: {row}"))
}

fn count(row: &Value, name: &str) -> u64 {
    let found = row[name].as_u64();
    found.unwrap_or_else(|| panic!("{name}: {row}"))
}

#[test]
fn engines_agree_in_every_form() {
    let folder = folder();
    let line = "time gen:menger,depth=2 --size 48x32 --lod 0 --warmup 0 --runs 3 --threads 1,2";
    let rows = rows(folder.path(), line);
    // The oracle and the fast engine use threads, the others are measured on one.
    let threads = |engine: &str| {
        let of = rows.iter().filter(|row| row["engine"] == engine);
        of.map(|row| count(row, "threads")).collect::<Vec<_>>()
    };
    assert_eq!(["fast", "rays"].map(threads), [vec![1, 2], vec![1, 2]]);
    assert_eq!(["machine", "float-rays"].map(threads), [vec![1], vec![1]]);
    for row in &rows {
        assert_eq!(count(row, "pixels"), 48 * 32);
        assert!(count(row, "covered") > 100 && count(row, "work") > 10);
        // Without level of detail every engine is exact, but for rounding.
        let wrong: u64 = ["extra", "missing", "wrong_voxel"]
            .map(|kind| count(row, kind))
            .iter()
            .sum();
        let allowed = if row["engine"] == "float-rays" { 3 } else { 0 };
        assert!(wrong <= allowed, "{row}");
        let ms = ["wall_min_ms", "wall_ms", "wall_max_ms"].map(|name| number(row, name));
        assert!(
            0.0 < ms[0] && ms.is_sorted() && count(row, "runs") == 3,
            "{row}"
        );
        let has_cpu = count(row, "threads") == 1 && cfg!(unix);
        assert_eq!(row["cpu_ms"].is_number(), has_cpu, "{row}");
    }
}

#[test]
fn pictures_and_scenes_grow() {
    let folder = folder();
    let line = "time gen:menger,depth=2 --scan size=16..64*2 --runs 1 --engines machine,float-rays \
        --export-svg {scene}.svg";
    let of_size = rows(folder.path(), line);
    let heights = of_size.iter().filter(|row| row["engine"] == "machine");
    let heights: Vec<u64> = heights.map(|row| count(row, "height")).collect();
    assert_eq!(heights, [16, 32, 64]);
    assert_eq!(of_size[0]["growing"], "pixels");
    let exponent = number(&of_size[0], "work_exponent");
    assert!((0.1..1.5).contains(&exponent), "{exponent}");
    assert!(number(&of_size[0], "work_r_squared") <= 1.0);
    let svg = fs::read_to_string(folder.path().join("menger-depth-2.svg")).unwrap();
    assert!(svg.contains("pixels") && svg.contains("polyline"));
    let line = "time gen:terrain,depth=9 --scan depth=5..6+1 --size 16 --runs 1 --engines fast";
    let of_depth = rows(folder.path(), line);
    let voxels: Vec<u64> = of_depth.iter().map(|row| count(row, "voxels")).collect();
    assert_eq!(voxels, [2637, 11998]);
    assert_eq!(of_depth[0]["growing"], "voxels");
    let text = stdout_of(&bench(folder.path(), &words(line)).success());
    assert!(
        text.contains("exponent") && text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
}

#[test]
fn variants_change_what_they_should() {
    let folder = folder();
    let machine = rows(
        folder.path(),
        "time gen:menger,depth=2 --size 48 --lod 0 --runs 1 --engines machine --variants all",
    );
    let of = |variant: &str, name: &str| count(row(&machine, &[("variant", variant)]), name);
    for (variant, changes) in [
        ("everything on", false),
        ("fill-vector rejection off", false),
        ("occlusion order off", true),
    ] {
        assert_eq!(of(variant, "changed") > 50, changes, "{variant}");
        assert_eq!(of(variant, "wrong_voxel") > 50, changes, "{variant}");
    }
    let work = |variant| of(variant, "work");
    assert!(work("fill-vector rejection off") > work("everything on"));
    // It is off already.
    assert_eq!(work("level of detail off"), work("everything on"));
    let wrong = row(&machine, &[("variant", "occlusion order off")]);
    assert!(wrong["about"].as_str().unwrap().contains("WRONG"));

    let fast = rows(
        folder.path(),
        "time gen:terrain,depth=8 --engines fast --variants all --size 64 --runs 1",
    );
    for row in &fast {
        assert!(
            row["changed"] == 0 || row["variant"] == "level of detail off",
            "{row}"
        );
    }
    let of = |variant: &str, name: &str| count(row(&fast, &[("variant", variant)]), name);
    let (whole, looked_at) = ("everything on", "absent children looked at");
    assert!(of(whole, "samples_drawn") > 500 && of(whole, "skipped_absent_children") > 0);
    assert_eq!(of(looked_at, "skipped_absent_children"), 0);
    let left = |variant| of(variant, "skipped_hidden") + of(variant, "skipped_off_screen");
    assert!(left(looked_at) > left(whole));
    assert_eq!(of("unchanged frame kept", "frames_unchanged"), 1);
    assert_eq!(of("unchanged frame kept", "work"), 0);
    assert!(of("attributes of all read", "attributes_read") > of(whole, "samples_drawn"));
}

const SMALL: &str = "--size 24 --reference-samples 4 --runs 1 --warmup 0";

#[test]
fn quality_in_every_form() {
    let folder = folder();
    let line = format!(
        "quality {SCENE} {SMALL} --methods exact:lod=0:aa=1+2:cage=frame+corners,\
         any:lod=0:tolerance=0+inf:cage=frame+corners --export-svg r-{{scene}}.svg"
    );
    let all = rows(folder.path(), &line);
    // Two cages with two numbers of samples or two tolerances, and the noise floor.
    assert_eq!(all.len(), 2 * 2 + 2 * 2 + 1);
    let of = |method: &str| row(&all, &[("method", method)]);
    // In clip space, down to the leaves, the exact rule is the oracle.
    let exact = of("exact frame lod 0");
    for name in ["extra", "missing", "coarser", "elsewhere"] {
        assert_eq!(number(exact, name), 0.0, "{name}");
    }
    let any = of("any 0 frame lod 0");
    assert!(number(any, "extra") > 0.0 && number(any, "bias_percent") > 0.0);
    assert!(number(any, "flip") > number(exact, "flip"));
    // More samples are nearer to the reference; noise is nearest.
    let rms = |row| number(row, "rms_linear");
    assert!(rms(of("exact frame lod 0 aa 2")) < rms(exact));
    assert!(rms(of("noise floor")) < rms(exact));
    assert!(number(exact, "operations") > 1000.0 && number(exact, "ms") > 0.0);
    let paper = of("any inf corners lod 0");
    assert_eq!(paper["remark"], "the paper's; drawn by the machine");
    assert!(paper["beaten_by"].is_string() && exact["beaten_by"].is_null());

    let svg = fs::read_to_string(folder.path().join("r-menger-depth-2.svg")).unwrap();
    assert!(svg.contains("dominated") && svg.contains("operations of the machine"));
}

#[test]
fn films_flicker_and_more_samples_calm_them() {
    let folder = folder();
    let line = "quality gen:sphere,depth=5 --size 20 --frames 3 --motions turntable,dolly --runs 1 \
        --reference-samples 4 --methods exact:aa=1+4 --export-svg f.svg";
    let rows = rows(folder.path(), line);
    let [one, four] =
        ["exact frame", "exact frame aa 4"].map(|method| row(&rows, &[("method", method)]));
    for motion in ["turntable", "dolly"] {
        let flicker = format!("flicker_{motion}");
        assert!(
            number(four, &flicker) < number(one, &flicker),
            "{one} {four}"
        );
        let worst = number(one, &format!("{flicker}_worst"));
        assert!(worst >= number(one, &flicker));
        assert!(number(row(&rows, &[("method", "noise floor")]), &flicker) > 0.0);
    }
    let svg = fs::read_to_string(folder.path().join("f.svg")).unwrap();
    assert!(svg.contains("flicker of a dolly") && !svg.contains("flicker of a pan"));
}

#[test]
fn everything_but_times_is_the_same_in_every_run() {
    let folder = folder();
    let lines = [
        format!("time {SCENE} --size 32 --runs 1"),
        format!(
            "quality gen:wires,depth=4 {SMALL} --methods exact,center --motions pan --frames 2"
        ),
    ];
    for line in lines {
        let lasting = || {
            let mut rows = rows(folder.path(), &line);
            for row in rows.iter_mut().filter_map(Value::as_object_mut) {
                row.retain(|name, _| !name.ends_with("ms") && name != "time_ratio");
            }
            rows
        };
        assert_eq!(lasting(), lasting(), "{line}");
    }
}

#[test]
fn reproduced_results_are_the_same_in_every_run() {
    let folder = folder();
    // The paper's list with smaller pictures and scenes.
    let mut list = include_str!("../../../lab/src/reproduce.toml").to_owned();
    for (from, to) in [
        ("512", "32"),
        ("[64, 128, 256, 32, 1024]", "[16, 64]"),
        ("menger,depth=5", "menger,depth=2"),
        ("truss,depth=8", "truss,depth=4"),
    ] {
        list = list.replace(from, to);
    }
    for depth in 6..=10 {
        list = list.replace(&format!("terrain,depth={depth}"), "terrain,depth=5");
    }
    fs::write(folder.path().join("list.toml"), list).unwrap();
    let reproduced = |outdir: &str| {
        let line = format!("reproduce list.toml --runs 1 --outdir {outdir}");
        let told = stdout_of(&run(folder.path(), &words(&line)).success());
        assert!(told.contains("Table I") && told.contains("<1"), "{told}");
        let text = fs::read(folder.path().join(outdir).join("results.json")).unwrap();
        let document: Value = serde_json::from_slice(&text).unwrap();
        let lasting = "table scene size settings hash work operations changed";
        let rows = document["rows"].as_array().unwrap().iter();
        let rows = rows.map(|row| words(lasting).into_iter().map(|of| row[of].clone()));
        rows.map(Iterator::collect).collect::<Vec<Vec<Value>>>()
    };
    let one = reproduced("one");
    assert_eq!(one, reproduced("two"));
    // The machine with everything on draws two sizes, five scenes, five terrains and four scenes, each twice.
    let hashes = one.iter().filter(|row| row[4].is_string());
    assert_eq!(hashes.count(), 2 * (2 + 5 + 5 + 4));
    assert!(folder.path().join("two/figures.svg").exists());
    let page = fs::read_to_string(folder.path().join("one/report.md")).unwrap();
    for part in [
        "Table I",
        "occlusion order",
        "Objects of all kinds",
        "exponent",
    ] {
        assert!(page.contains(part), "{part}");
    }
}
