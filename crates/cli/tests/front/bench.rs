//! The timed experiments as a script meets them: tables, exports, exit codes.

use std::fs;

use serde_json::Value;

use crate::program::{bench, folder, json_of, shiftvox, stderr_of, stdout_of};

use crate::common::Run;

const SCENE: &str = "gen:menger,depth=2";

#[test]
fn engines_agree_and_are_told_in_every_form() {
    let folder = folder();
    let line = "engines gen:menger,depth=2 --size 48x32 --lod 0 --tolerance 0 --warmup 0 --runs 3 \
        --threads 1,2 --json --export-json a/r.json --export-svg a/r.svg";
    let line: Vec<&str> = line.split(' ').collect();
    let document = json_of(&bench(folder.path(), &line).success());
    assert_eq!(document["schema"], "shiftvox.bench engines");
    assert_eq!(document["schema_version"], 1);
    assert_eq!(document["schedule"]["runs"], 3);
    let results = document["results"].as_array().unwrap();
    // The oracle uses threads, the others are measured on one.
    let who = |r: &Value| {
        (
            r["engine"].as_str().unwrap().to_owned(),
            r["threads"].as_u64().unwrap(),
        )
    };
    let all: Vec<_> = results.iter().map(who).collect();
    assert!(
        all.contains(&("rays".to_owned(), 1)) && all.contains(&("rays".to_owned(), 2)),
        "{all:?}"
    );
    assert_eq!(all.iter().filter(|(name, _)| name == "machine").count(), 1);
    for result in results {
        let error = |name: &str| result["coverage"][name].as_u64().unwrap();
        assert_eq!(error("pixels"), 48 * 32);
        assert!(error("covered") > 100);
        // Exact coverage, no level of detail, clip space: the machine is exact.
        let allowed = if result["engine"] == "float-rays" {
            3
        } else {
            0
        };
        assert!(
            error("extra") + error("missing") + error("wrong_voxel") <= allowed,
            "{result}"
        );
        assert!(result["work"].as_u64().unwrap() > 10);
        let wall = &result["wall"];
        let ms = |name: &str| wall[name].as_f64().unwrap();
        assert_eq!(wall["runs"], 3);
        assert!(
            0.0 < ms("min_ms")
                && ms("min_ms") <= ms("median_ms")
                && ms("median_ms") <= ms("max_ms")
        );
        assert_eq!(
            result["thread"].is_null(),
            result["threads"] != 1 || !cfg!(unix)
        );
    }
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let written: Value = serde_json::from_str(&file("a/r.json")).unwrap();
    assert_eq!(written, document);
    assert!(file("a/r.svg").starts_with("<svg") && file("a/r.svg").contains("float-rays"));

    // What is there is not replaced, and no time is spent before that is said.
    let line = ["engines", SCENE, "--export-json", "a/r.json"];
    assert!(stderr_of(&bench(folder.path(), &line).code(1)).contains("--force"));
}

#[test]
fn counters_do_not_depend_on_the_run() {
    let folder = folder();
    let line = ["engines", SCENE, "--size", "32", "--runs", "1", "--json"];
    let work = || {
        let document = json_of(&bench(folder.path(), &line).success());
        let results = document["results"].as_array().unwrap().clone();
        let of = |r: &Value| {
            (
                r["engine"].clone(),
                r["counters"].clone(),
                r["coverage"].clone(),
            )
        };
        results.iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(work(), work());
}

#[test]
fn scaling_scans_and_fits() {
    let folder = folder();
    let line = "scaling gen:menger,depth=2 --scan size=16..64*2 --size 32 --max-voxels 2e4 --runs 1 \
        --engines machine,float-rays --export-svg r.svg --export-json r.json";
    let line: Vec<&str> = line.split(' ').collect();
    let assert = bench(folder.path(), &line).success();
    let told = stdout_of(&assert);
    assert!(told.contains("paper table 1 ms") && told.contains("<1"));
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let document: Value = serde_json::from_str(&file("r.json")).unwrap();
    let growths = document["growths"].as_array().unwrap();
    assert_eq!(growths.len(), 2 + 4);
    let pick = |growing: &str, engine: &str, name: &str| -> Vec<u64> {
        let of = growths.iter();
        of.filter(|g| g["growing"] == growing && g["engine"] == engine)
            .flat_map(|g| g["points"].as_array().unwrap())
            .map(|point| point[name].as_u64().unwrap())
            .collect()
    };
    assert_eq!(pick("pixels", "machine", "height"), [16, 32, 64]);
    // Terrain of depth 5 and 6, sponges of depth 2 and 3.
    let voxels = pick("voxels", "float-rays", "voxels");
    assert_eq!(voxels, [2637, 11998, 400, 8000]);
    assert_eq!(pick("voxels", "machine", "width"), [32; 4]);
    let law = &growths[0]["work_law"];
    assert_eq!(law["points"], 3);
    let exponent = law["exponent"].as_f64().unwrap();
    assert!((0.1..1.5).contains(&exponent), "{law}");
    assert!(law["r_squared"].as_f64().unwrap() <= 1.0);
    let svg = file("r.svg");
    for part in ["Time by pixels", "Time by voxels", "Table I"] {
        assert!(svg.contains(part), "{part}");
    }
}

#[test]
fn ablation_tells_what_a_technique_changes() {
    let folder = folder();
    let line = [
        "ablation", SCENE, "--size", "48", "--lod", "0", "--runs", "1", "--json",
    ];
    let document = json_of(&bench(folder.path(), &line).success());
    let results = document["results"].as_array().unwrap();
    let row = |engine: &str, variant: &str| {
        let same = |r: &&Value| r["engine"] == engine && r["variant"] == variant;
        results
            .iter()
            .find(same)
            .unwrap_or_else(|| panic!("{variant}"))
    };
    let of = |variant: &str, name: &str| row("machine", variant)[name].as_u64().unwrap();
    assert_eq!(of("everything on", "changed"), 0);
    assert_eq!(of("fill-vector rejection off", "changed"), 0);
    assert!(of("fill-vector rejection off", "work") > of("everything on", "work"));
    assert!(of("occlusion order off", "changed") > 50);
    // It is off already.
    assert_eq!(
        of("level of detail off", "work"),
        of("everything on", "work")
    );
    let screen = &row("machine", "everything on")["coverage"];
    assert_eq!(
        (&screen["extra"], &screen["missing"], &screen["wrong_voxel"]),
        (&0.into(), &0.into(), &0.into())
    );
    let text = stdout_of(&bench(folder.path(), &line[..line.len() - 1]).success());
    assert!(
        text.contains("WRONG") && text.contains("time ratio"),
        "{text}"
    );
}

#[test]
fn ablation_of_the_fast_engine_changes_no_picture() {
    let folder = folder();
    let write = |line: &[&str]| {
        shiftvox(folder.path()).args(line).assert().success();
    };
    write(&["generate", "gen:terrain,depth=8", "-o", "t.vxg"]);
    let line = "ablation t.vxg --engines fast --size 64 --runs 1 --json";
    let line: Vec<&str> = line.split(' ').collect();
    let document = json_of(&bench(folder.path(), &line).success());
    let results = document["results"].as_array().unwrap();
    let row = |variant: &str| {
        let of_name = results.iter().find(|r| r["variant"] == variant);
        of_name.unwrap_or_else(|| panic!("{variant}"))
    };
    let count = |variant: &str, name: &str| {
        let counters = &row(variant)["counters"];
        counters[name]
            .as_u64()
            .unwrap_or_else(|| panic!("{variant}, {name}: {counters}"))
    };
    for result in results {
        let may_change = ["level of detail off", "screen space off"];
        let variant = result["variant"].as_str().unwrap();
        assert!(
            result["changed"] == 0 || may_change.contains(&variant),
            "{result}"
        );
    }
    let whole = "everything on";
    assert!(count(whole, "samples_drawn") > 500);
    assert!(count(whole, "skipped_absent_children") > 0);
    let looked_at = "absent children looked at";
    assert_eq!(count(looked_at, "skipped_absent_children"), 0);
    let left = |variant| count(variant, "skipped_hidden") + count(variant, "skipped_off_screen");
    assert!(left(looked_at) > left(whole));
    let kept = "unchanged frame kept";
    assert_eq!(count(kept, "frames_unchanged"), 1);
    assert_eq!(count(kept, "records"), 0);
    let all = "attributes of all read";
    assert!(count(all, "attributes_read") > count(whole, "samples_drawn"));
}

#[test]
fn wrong_experiments_exit_with_2() {
    let folder = folder();
    let lines: [&[&str]; 14] = [
        &[],
        &["speed"],
        &["engines", SCENE, "--scan", "size=64"],
        &["engines", SCENE, "--scan", "depth=1..2+1"],
        &["engines", SCENE, "--scan", "size=64..128*2", "--size", "64"],
        &["engines", SCENE, "--runs", "0"],
        &["engines", SCENE, "--engines", "slow"],
        &["engines", SCENE, "--threads", "1,two"],
        &["engines", SCENE, "--export-svg", "a", "--export-json", "a"],
        &["scaling", SCENE, "--max-voxels", "0.5"],
        &["ablation", SCENE, "--scan", "size=16..32*2"],
        &["ablation", SCENE, "--threads", "2"],
        &["ablation", SCENE, "--engines", "rays"],
        &["vertex-error", "--threads", "1,2"],
    ];
    for line in lines {
        let assert = bench(folder.path(), line).code(2);
        assert!(!stderr_of(&assert).is_empty(), "{line:?} says nothing");
        assert_eq!(stdout_of(&assert), "", "{line:?}");
    }
    bench(folder.path(), &["engines", SCENE, "--size", "32768"]).code(5);
    bench(folder.path(), &["engines", "missing.vox"]).code(4);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A row and a table for everything that is measured, in the same order.
#[test]
fn tables_go_to_files_too() {
    let folder = folder();
    for (what, line, head, rows) in [
        (
            "engines",
            "engines gen:menger,depth=2 --size 16 --runs 1",
            "scene,size,engine",
            4,
        ),
        (
            "error",
            "error gen:menger,depth=2 --size 16 --families voxels --runs 1",
            "scene,size,method",
            4,
        ),
        (
            "flicker",
            "flicker gen:menger,depth=2 --size 16 --frames 3 --motions pan",
            "scene",
            4,
        ),
        (
            "scaling",
            "scaling gen:menger,depth=2 --scan size=16..32*2 --runs 1 --max-voxels 2e3",
            "growing",
            1,
        ),
    ] {
        let (csv, markdown) = (format!("{what}.csv"), format!("{what}.md"));
        let exports = ["--export-csv", &csv, "--export-markdown", &markdown];
        let line: Vec<&str> = line.split(' ').chain(exports).collect();
        bench(folder.path(), &line).success();
        let text = fs::read_to_string(folder.path().join(&csv)).unwrap();
        assert!(
            text.lines().next().unwrap().contains(head) && text.lines().count() > rows,
            "{text}"
        );
        let text = fs::read_to_string(folder.path().join(&markdown)).unwrap();
        assert!(text.contains("|---"), "{text}");
    }
    let same = ["engines", SCENE, "--export-csv", "a", "--export-json", "a"];
    bench(folder.path(), &same).code(2);
}
