//! The experiments as a script meets them: rows, exports, exit codes.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{bench, folder, json_of, stderr_of, stdout_of, words};

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
    row[name]
        .as_f64()
        .unwrap_or_else(|| panic!("{name}: {row}"))
}

fn count(row: &Value, name: &str) -> u64 {
    row[name]
        .as_u64()
        .unwrap_or_else(|| panic!("{name}: {row}"))
}

#[test]
fn engines_agree_in_every_form() {
    let folder = folder();
    let line = "time gen:menger,depth=2 --size 48x32 --lod 0 --warmup 0 --runs 3 --threads 1,2 \
        --export-json a/r.json --export-svg a/r.svg --export-csv a/r.csv --export-markdown a/r.md";
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
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let written: Value = serde_json::from_str(&file("a/r.json")).unwrap();
    assert_eq!(
        (written["rows"].as_array(), &written["schema"]),
        (Some(&rows), &"shiftvox.bench time".into())
    );
    let svg = file("a/r.svg");
    assert!(svg.starts_with("<svg") && svg.contains("float-rays"));
    assert!(
        file("a/r.csv").starts_with("scene,") && file("a/r.csv").lines().count() == 1 + rows.len()
    );
    assert!(file("a/r.md").contains("|---"));

    // Existing files are kept, which is reported before any work.
    let line = ["time", SCENE, "--export-json", "a/r.json"];
    assert!(stderr_of(&bench(folder.path(), &line).code(1)).contains("--force"));
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
         any:lod=0:tolerance=0+inf:cage=frame+corners --export-json r.json --export-svg r-{{scene}}.svg"
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

    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let written: Value = serde_json::from_str(&file("r.json")).unwrap();
    assert_eq!(written["rows"].as_array(), Some(&all));
    let svg = file("r-menger-depth-2.svg");
    assert!(svg.contains("dominated") && svg.contains("operations of the machine"));
    for export in ["--export-json=r.json", "--export-svg=r-{scene}.svg"] {
        bench(folder.path(), &["quality", SCENE, export]).code(1);
    }
}

#[test]
fn a_format_too_narrow_is_a_row_and_not_the_end() {
    let folder = folder();
    let line = format!("quality gen:sphere,depth=6 {SMALL} --methods exact:bits=64+16");
    let rows = rows(folder.path(), &line);
    assert_eq!(rows[0]["wrong_share"], 0.0);
    // Sixteen bits are rejected, or far off.
    let wrong = rows[1]["wrong_share"].as_f64();
    assert!(
        rows[1]["refused"].is_string() || wrong.unwrap() > 0.01,
        "{}",
        rows[1]
    );
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
fn wrong_experiments_exit_with_2_or_5() {
    let folder = folder();
    for (line, code) in [
        ("", 2),
        ("speed", 2),
        ("time S --scan size=64", 2),
        ("time S --scan lod=1..2+1", 2),
        ("time assets.vox --scan depth=1..2+1", 4),
        ("time bundled --scan depth=1..2+1", 2),
        ("time S --scan size=64..128*2 --size 64", 2),
        ("time S --runs 0", 2),
        ("time S --engines slow", 2),
        ("time S --variants slow", 2),
        ("time S --engines rays --variants all", 2),
        ("time S --overflow wrap", 2),
        ("time S --threads 1,two", 2),
        ("time S --export-svg a --export-json a", 2),
        ("time S --export-csv a --export-json a", 2),
        ("time S --size 32768", 5),
        ("time missing.vox", 4),
        ("quality S --methods exact:aa=3", 2),
        ("quality S --methods far", 2),
        ("quality S --reference-samples 5", 2),
        ("quality S --export-svg a --export-json a", 2),
        ("quality S --motions dolly --frames 1", 2),
        ("quality S --motions fly", 2),
        ("quality S --threads 1,2", 2),
        ("quality S --size 8192", 5),
    ] {
        let line = line.replace('S', SCENE);
        let assert = bench(folder.path(), &words(&line)).code(code);
        assert!(!stderr_of(&assert).is_empty(), "{line:?}");
        assert_eq!(stdout_of(&assert), "", "{line:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
