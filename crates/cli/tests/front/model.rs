//! `model`: its report, its files, its errors.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::program::{folder, json_of, run, stderr_of, stdout_of, words};

/// The report of a small sponge, with further flags.
fn report(flags: &str) -> Value {
    let line = format!("model gen:menger,depth=3 --size 64 --json {flags}");
    json_of(&run(folder().path(), &words(&line)).success())
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is not a number"))
}

/// The sum of a figure over the elements of an array.
fn sum(array: &Value, key: &str) -> u64 {
    let items = array.as_array().unwrap().iter();
    items.filter_map(|item| item[key].as_u64()).sum()
}

#[test]
fn the_report_adds_up() {
    let found = report("--hw paper");
    assert_eq!(found["schema"], "shiftvox.model");
    let mut of_order = BTreeMap::<&str, u64>::new();
    let cells = found["operations"].as_array().unwrap();
    for cell in cells.iter().filter(|cell| cell["stage"] == "order") {
        *of_order.entry(cell["class"].as_str().unwrap()).or_default() +=
            cell["times"].as_u64().unwrap();
    }
    // Each ordering takes three compares and eight exclusive ors, in every record that is subdivided.
    let orderings = of_order["logic"] / 8;
    assert_eq!(
        of_order,
        BTreeMap::from([("compare", 3 * orderings), ("logic", 8 * orderings)])
    );
    assert!(orderings >= found["counters"]["subdivided"].as_u64().unwrap() && orderings > 100);
    // The machine has no multiplier and no divider.
    let light = [
        "add",
        "sub",
        "compare",
        "min_max",
        "select",
        "shift",
        "logic",
        "divide_step",
    ];
    assert!(
        cells
            .iter()
            .all(|cell| light.contains(&cell["class"].as_str().unwrap()))
    );
    // The same records, in three lists.
    let records = found["counters"]["records"].as_u64().unwrap();
    for (list, key) in [
        ("levels", "records"),
        ("records_by_kind", "popped"),
        ("records_by_kind", "pushed"),
    ] {
        assert_eq!(sum(&found[list], key), records, "{list}: {key}");
    }
    assert_eq!(
        sum(&found["levels"], "operations"),
        sum(&found["operations"], "times")
    );
    let cycles = &found["simulated"]["cycles"];
    let order = ["span", "cycles", "serial"].map(|key| number(&cycles[key]));
    assert!(order.is_sorted(), "{order:?}");
    // Fill vectors: four bits per node of a quadtree of six levels below its root.
    assert_eq!(found["fill_vector_bits"], 4 * (4u64.pow(7) - 1) / 3);
    // Every figure names its rows and their source.
    for part in ["operations", "on_chip", "outer"] {
        let lines = found["cost"][part]["lines"].as_array().unwrap();
        assert!(!lines.is_empty(), "{part}");
        for (line, key) in lines
            .iter()
            .flat_map(|line| [(line, "rows"), (line, "source")])
        {
            assert!(
                !line["each"][key].as_str().unwrap().is_empty(),
                "{part}: {line}"
            );
        }
    }
    let area = &found["area"];
    let parts =
        ["units", "registers", "memories", "control"].map(|part| number(&area[part]["total"]));
    assert!(parts.iter().all(|part| *part > 0.0));
    assert!((parts.iter().sum::<f64>() - number(&area["total"])).abs() < 1e-6 * parts[2]);
    // 200 MHz is slow enough for all units.
    let units = found["clock"]["units"].as_array().unwrap();
    assert!(
        units
            .iter()
            .all(|unit| unit["depth"].as_u64() >= unit["depth_needed"].as_u64())
    );
    assert!(found["ray_caster"]["counts"]["cells"].as_u64() > Some(1000));
}

/// Power follows from energy and speed, and the ends of the ranges decide which design has less.
#[test]
fn both_designs_line_by_line() {
    let found = report("--hw paper --ray-order rows");
    assert_eq!(found["ray_caster"]["order"], "rows");
    let lines = found["comparison"].as_array().unwrap();
    let of = |what: &str| lines.iter().find(|line| line["what"] == what).unwrap();
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
}

/// Where boxes claim samples, children that are processed at once may change the picture. Rays claim one sample each.
#[test]
fn samples_that_the_order_of_children_changes_are_counted() {
    for (flags, differs) in [
        ("--paper", true),
        ("", false),
        // One context processes one record after the other, like the serial machine.
        ("--paper --hw tiny", false),
    ] {
        let line = format!("model gen:terrain,depth=6 --size 64 --json {flags}");
        let found = json_of(&run(folder().path(), &words(&line)).success());
        let differing = found["differing_samples"].as_u64().unwrap();
        assert_eq!(
            (differing > 0, found["same_picture"] == false),
            (differs, differs),
            "{flags}"
        );
        assert!(differing < 64 * 64);
    }
}

const SCENE: [&str; 4] = ["model", "gen:menger,depth=3", "--size", "64"];

#[test]
fn files_are_written_once() {
    let folder = folder();
    let files = [
        ("--html", "r.html", "<!doctype html>"),
        ("--html", "r.html", "data:image/png;base64,"),
        ("--heat", "heat.png", "PNG"),
        ("--trace", "t.json", "\"traceEvents\":["),
        ("--export-markdown", "r.md", "Area of the light hardware"),
        ("--export-csv", "r.csv", "cost.operations.total,"),
        ("--export-svg", "r.svg", "Roofline"),
        ("--export-json", "r.json", "shiftvox.model"),
    ];
    let mut flags: Vec<&str> = files
        .iter()
        .flat_map(|(flag, name, _)| [*flag, *name])
        .collect();
    flags.drain(..2);
    run(folder.path(), &[&SCENE[..], &flags].concat()).success();
    for (_, name, part) in files {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        assert!(
            String::from_utf8_lossy(&bytes).contains(part),
            "{name}: {part}"
        );
    }
    let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(
        page.contains("<svg") && !page.contains("http://localhost") && !page.contains("<script")
    );
    // Existing files are kept without --force.
    let again = [&SCENE[..], &["--html", "r.html"]].concat();
    run(folder.path(), &again).failure();
    run(folder.path(), &[&again[..], &["--force"]].concat()).success();
    for other in ["--export-json", "--export-csv", "--heat"] {
        let twice = [&SCENE[..], &["--html", "x", other, "x"]].concat();
        let told = stderr_of(&run(folder.path(), &twice).code(2));
        assert!(told.contains("two outputs to one file"), "{told}");
    }
}

/// The best hardware known for the rule, and the paper's for the paper's rules.
#[test]
fn the_default_hardware_follows_the_rule() {
    for (flags, wanted) in [
        ("", "light"),
        ("--coverage alpha", "light"),
        ("--paper", "paper"),
        ("--coverage center", "paper"),
        ("--paper --hw light", "light"),
    ] {
        let line = format!("model --print-hw {flags}");
        let printed = stdout_of(&run(folder().path(), &words(&line)).success());
        assert!(
            printed.contains(&format!("\nname = \"{wanted}\"")),
            "{flags}: {printed}"
        );
    }
}

#[test]
fn hardware_and_costs_of_one_s_own() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let tiny = stdout_of(&run(folder.path(), &["model", "--print-hw", "--hw", "tiny"]).success());
    write(
        "mine.toml",
        &tiny.replace("name = \"tiny\"", "name = \"mine\""),
    );
    let costs =
        "row = [{ operation = \"add\", width = 32, energy_pj = 1000.0, source = \"mine\" }]\n";
    write("costs.toml", costs);
    let energy = |flags: &[&str]| {
        let line = [&SCENE[..], &["--json", "--hw", "mine.toml"], flags].concat();
        let found = json_of(&run(folder.path(), &line).success());
        assert_eq!(found["hardware"]["name"], "mine");
        number(&found["cost"]["operations"]["total"])
    };
    assert!(energy(&["--costs", "costs.toml"]) > 100.0 * energy(&[]));
    // Errors name the file.
    let row = "row = [{ operation = \"ad\", width = 32, energy_pj = 1.0, source = \"mine\" }]";
    for (flag, name, text) in [
        ("--hw", "a.toml", "lanes = 0"),
        ("--costs", "b.toml", "row = [{ operation = \"add\" }]"),
        ("--costs", "c.toml", row),
        ("--costs", "d.toml", "quadratic = [\"ad\"]"),
    ] {
        write(name, text);
        let told = stderr_of(&run(folder.path(), &[&SCENE[..], &[flag, name]].concat()).code(4));
        assert!(told.contains(name), "{told}");
    }
}

#[test]
fn wrong_command_lines() {
    for (flags, code, expected) in [
        ("--hw none-such", 4, "none-such"),
        ("--bits 16 --frac 12", 5, "a word of"),
        // The machine is modelled, so flags that choose another engine are rejected.
        ("--engine fast", 2, "--engine"),
        ("--engine rays", 2, "--engine"),
        ("--isa avx2", 2, "--isa"),
        ("--erosion 2", 2, "--erosion"),
        ("--far-opacity none", 2, "--far-opacity"),
    ] {
        let flags_list: Vec<&str> = flags.split(' ').collect();
        let told = run(folder().path(), &[&SCENE[..], &flags_list].concat()).code(code);
        assert!(
            stderr_of(&told).contains(expected),
            "{flags}: {}",
            stderr_of(&told)
        );
    }
}
