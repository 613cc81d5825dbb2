//! The report of `model`.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::program::{folder, json_of, run, stdout_of, words};

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
    let light = "add sub compare min_max select shift logic divide_step";
    let is_light = |cell: &Value| words(light).contains(&cell["class"].as_str().unwrap());
    assert!(cells.iter().all(is_light));
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
        for line in lines {
            assert!(
                ["rows", "source"].iter().all(|key| line["each"][key] != ""),
                "{line}"
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

#[test]
fn hardware_and_costs_of_one_s_own() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let tiny = stdout_of(&run(folder.path(), &["model", "--print-hw", "--hw", "tiny"]).success());
    write("mine.toml", &tiny.replace("\"tiny\"", "\"mine\""));
    let costs = "row = [{ operation = \"add\", width = 32, energy_pj = 1000.0, source = \"x\" }]\n";
    write("costs.toml", costs);
    let energy = |flags: &str| {
        let line = format!("model gen:menger,depth=3 --size 64 --json --hw mine.toml {flags}");
        let found = json_of(&run(folder.path(), &words(&line)).success());
        assert_eq!(found["hardware"]["name"], "mine");
        number(&found["cost"]["operations"]["total"])
    };
    assert!(energy("--costs costs.toml") > 100.0 * energy(""));
}
