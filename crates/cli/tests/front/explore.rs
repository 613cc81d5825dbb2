//! `model --explore`: points, interrupted and divided runs. Refusals are rows of `cases/models.txt`.

use serde_json::{Value, json};
use shiftvox_lab::model::explore::front::front;
use shiftvox_lab::model::explore::lines::PointLine;

use crate::program::{Folder, number};

/// Two organisations, words that are too narrow for a right picture, a clock that is too fast.
const SPACE: &str = r#"
hardware = ["paper", "light"]
[ranges]
bits = [18, 32]
clock_mhz = [200.0, 400.0]
contexts = { from = 2, to = 4, times = 2 }
node_cache.bytes = { from = 1024, to = 4096, times = 4 }
"#;

const MODEL: &str = "model gen:menger,depth=3 --size 40";

fn folder(space: &str) -> Folder {
    let folder = Folder::new();
    folder.put("space.toml", space);
    folder
}

/// Lines of JSON.
fn explored(folder: &Folder, more: &str) -> String {
    folder.stdout(&format!("{MODEL} --explore space.toml --json {more}"))
}

fn lines(text: &str, kind: &str) -> Vec<Value> {
    let all = text.lines().map(|line| serde_json::from_str(line).unwrap());
    all.filter(|line: &Value| line["kind"] == kind).collect()
}

/// Figures of a point, and where `model` has them.
const SAME: &str = "
    cycles                    simulated/cycles/cycles
    limits                    simulated/cycles/bottleneck/resource
    differing_samples         differing_samples
    counts/records            counters/records
    counts/deepest_stack      counters/deepest_stack
    counts/hardware_records   simulated/cycles/records
    counts/node_misses        simulated/cycles/node_cache/misses
    counts/record_bits        record_bits
    counts/fill_bits          fill_vector_bits
    counts/extra              coverage_error/extra
    counts/missing            coverage_error/missing
    counts/wrong_voxel        coverage_error/wrong_voxel
    units_nand2               area/units/total
    operations_pj             cost/operations/total
    area_nand2                area/total
    verdict/median            comparison/6/median
    verdict/p_light_less      comparison/6/p_light_less
    ray_caster/cycles         ray_caster/cycles/cycles
    ray_caster/area_nand2     ray_caster/area/total
";

/// Asserts that points have the figures that `model` has of their hardware alone.
fn assert_as_alone(folder: &Folder, points: &[Value]) {
    for found in points {
        let print = format!(
            "{MODEL} --explore space.toml --points {} --print-hw",
            found["point"]
        );
        folder.put("hw.toml", folder.stdout(&print));
        let bits = found["values"]["bits"].as_u64().unwrap_or(32);
        let alone = folder.json(&format!("{MODEL} --hw hw.toml --bits {bits}"));
        let at = |of: &Value, path: &str| of.pointer(&format!("/{path}")).unwrap().clone();
        for row in SAME.trim().lines() {
            let (of_point, of_model) = row.trim().split_once(' ').unwrap();
            assert_eq!(
                at(found, of_point),
                at(&alone, of_model.trim()),
                "{row}: {found}"
            );
        }
        let figure = |of: &Value, path: &str| number(&at(of, path));
        let rate = figure(&alone, "simulated/cycles/frames_per_second");
        assert!((figure(found, "time_ms") * rate / 1e3 - 1.0).abs() < 1e-12);
        let wrong = ["extra", "missing", "wrong_voxel"];
        let wrong = wrong.map(|of| figure(found, &format!("counts/{of}")));
        assert_eq!(figure(found, "wrong_samples"), wrong.iter().sum::<f64>());
        let units = at(&alone, "clock/units");
        let meets = |of: &Value| of["depth"].as_u64() >= of["depth_needed"].as_u64();
        assert_eq!(
            found["meets_clock"],
            units.as_array().unwrap().iter().all(meets)
        );
        for (found, model) in [
            (found, &alone),
            (&found["ray_caster"], &alone["ray_caster"]),
        ] {
            let parts = ["operations", "on_chip", "leakage", "clock", "outer"];
            let parts = parts.map(|of| figure(model, &format!("cost/{of}/total")));
            let sum = parts.iter().fold(0.0, |sum, part| sum + part);
            assert_eq!(found["energy_pj"], sum, "{found}");
        }
    }
}

#[test]
fn points_have_the_figures_of_model() {
    let space = folder(SPACE);
    let text = explored(&space, "");
    let points = lines(&text, "point");
    let numbers: Vec<_> = points.iter().map(|of| of["point"].clone()).collect();
    assert_eq!(numbers, (0..32).collect::<Vec<_>>());
    assert_as_alone(
        &space,
        &[0, 9, 14, 26, 31].map(|at: usize| points[at].clone()),
    );
    for key in ["wrong_samples", "meets_clock", "cycles", "energy_pj"] {
        assert!(points.iter().any(|of| of[key] != points[0][key]), "{key}");
    }
    let front = &lines(&text, "front")[0];
    let on_front = front["front"].as_array().unwrap();
    assert!(!on_front.is_empty() && on_front.iter().all(|of| of["meets_clock"] == true));
    assert!(number(&front["too_slow_for_their_clock"]) > 0.0);
}

#[test]
fn threads_interruptions_and_parts_give_one_result() {
    let folder = folder(SPACE);
    let whole = explored(&folder, "--threads 1 --results one.jsonl");
    let file = folder.text("one.jsonl");
    assert!(whole.starts_with(&file));
    assert_eq!(lines(&whole[file.len()..], "front").len(), 1);
    assert!(explored(&folder, "--threads 2") == whole);
    for end in [file.len() * 2 / 3, 20, file.len() - 1, file.len()] {
        folder.put("one.jsonl", &file[..end]);
        let after = explored(&folder, "--results one.jsonl");
        assert!(after == whole, "stopped at byte {end}");
        assert!(folder.text("one.jsonl") == file);
    }
    // Existing results are kept: an impossible figure stays.
    let marked = file.replacen("\"cycles\":", "\"cycles\":1000000", 1);
    folder.put("one.jsonl", &marked);
    assert!(explored(&folder, "--results one.jsonl").starts_with(&marked));
    // Printed lines are results too.
    let parts = ["21..31", "0..9", "10..20"];
    let parts = parts.map(|of| explored(&folder, &format!("--points {of}")));
    let front = &lines(&parts[1], "front")[0];
    assert_eq!([&front["points"], &front["space_points"]], [10, 32]);
    folder.put("all.jsonl", parts.concat());
    assert!(explored(&folder, "--results all.jsonl") == whole);
    assert!(
        folder.text("all.jsonl") == parts.concat(),
        "nothing was left to measure"
    );
}

#[test]
fn a_front_by_hand() {
    let drawn = lines(
        &explored(&folder("[ranges]\ncontexts = [4]\n"), ""),
        "point",
    )
    .remove(0);
    let line = |(point, [time, area, energy, wrong]): (usize, [f64; 4])| -> PointLine {
        let mut line = drawn.clone();
        line["point"] = json!(point);
        line["time_ms"] = json!(time);
        line["area_nand2"] = json!(area);
        line["energy_pj"] = json!(energy);
        line["wrong_samples"] = json!(wrong as u64);
        line["meets_clock"] = json!(point != 6);
        if point == 7 {
            line["outcome"] = json!("refused");
            line["reason"] = json!("");
        }
        serde_json::from_value(line).unwrap()
    };
    let points = [
        [4.0, 1.0, 2.0, 0.0],
        [2.0, 2.0, 2.0, 0.0],
        [1.0, 8.0, 2.0, 0.0],
        [2.0, 2.0, 2.0, 0.0], // as 1
        [2.0, 3.0, 2.0, 0.0], // beaten by 1
        [2.0, 2.0, 1.0, 3.0],
        [0.5, 0.5, 0.5, 0.0],  // misses its clock
        [0.5, 0.5, 0.5, 0.0],  // refused
        [1.05, 6.0, 2.0, 0.0], // slightly slower than 2, clearly smaller
    ];
    let mut points: Vec<PointLine> = points.into_iter().enumerate().map(line).collect();
    let found = |points: &[PointLine]| -> Vec<(usize, bool)> {
        let found = front(points).into_iter();
        found.map(|of| (of.line.point, of.stands_out)).collect()
    };
    let all = [(2, false), (8, true), (5, true), (1, true), (0, true)];
    assert_eq!(found(&points), all);
    // The order of the points does not matter.
    points.reverse();
    assert_eq!(found(&points), all);
    points.remove(0);
    assert_eq!(found(&points), [(2, true), (5, true), (1, true), (0, true)]);
}
