//! The sums in the report of `model`. Other rules are rows of `cases/models.txt`.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde_json::Value;

use crate::program::{Folder, ROOT, number};

/// The sum of a figure over the elements of an array.
fn sum(array: &Value, key: &str) -> f64 {
    let items = array.as_array().unwrap().iter();
    items.filter_map(|item| item[key].as_f64()).sum()
}

#[test]
fn the_report_adds_up() {
    let found = Folder::new().json("model gen:menger,depth=3 --size 64 --hw paper");
    let at = |pointer: &str| number(found.pointer(pointer).unwrap());
    let list = |pointer: &str| found.pointer(pointer).unwrap().as_array().unwrap();
    let of_order = |class: &str| {
        let cells = list("/operations").iter();
        let cells = cells.filter(|cell| cell["stage"] == "order" && cell["class"] == class);
        cells.map(|cell| number(&cell["times"])).sum::<f64>()
    };
    // Each ordering takes three compares and eight exclusive ors, in every record that is subdivided.
    let orderings = of_order("logic") / 8.0;
    assert_eq!(of_order("compare"), 3.0 * orderings);
    assert!(orderings >= at("/counters/subdivided") && orderings > 100.0);
    let light = "add sub compare min_max select shift logic divide_step";
    for cell in list("/operations") {
        let class = cell["class"].as_str().unwrap();
        assert!(light.split(' ').any(|of| of == class), "{cell}");
        assert!(
            cell["stage"] != "order" || ["logic", "compare"].contains(&class),
            "{cell}"
        );
    }
    // The same records, in three lists.
    for (list, key, expected) in [
        ("levels", "records", at("/counters/records")),
        ("records_by_kind", "popped", at("/counters/records")),
        ("records_by_kind", "pushed", at("/counters/records")),
        ("levels", "operations", sum(&found["operations"], "times")),
    ] {
        assert_eq!(sum(&found[list], key), expected, "{list}: {key}");
    }
    let parts = ["units", "registers", "memories", "control"];
    let parts = parts.map(|part| at(&format!("/area/{part}/total")));
    assert!((parts.iter().sum::<f64>() - at("/area/total")).abs() < 1e-6 * parts[2]);
    // 200 MHz is slow enough for all units.
    for unit in list("/clock/units") {
        assert!(
            number(&unit["depth"]) >= number(&unit["depth_needed"]),
            "{unit}"
        );
    }
    let line = |what: &str| {
        let mut lines = list("/comparison").iter();
        lines.find(|line| line["what"] == what).unwrap().clone()
    };
    // Power follows from energy and speed.
    let of = |what: &str| number(&line(what)["light"]);
    let rate = at("/simulated/cycles/frames_per_second");
    let power = of("power at its own speed");
    let expected = of("energy of the frame") * 1e-6 * rate;
    assert!((power - expected).abs() < 1e-9 * power.max(1.0));
    // The price that decides makes both designs equal where the report says so.
    for what in ["energy on the chip", "energy of the frame", "area"] {
        let line = line(what);
        let ends = ["low", "median", "high"].map(|end| number(&line[end]));
        assert!(ends.is_sorted() && ends[0] < ends[2], "{line}");
        let less = number(&line["p_light_less"]);
        assert_eq!(ends[1] < 1.0, less > 0.5, "{line}");
        assert!(
            line["decides"]
                .as_str()
                .is_some_and(|name| !name.is_empty())
        );
    }
}

/// In wide views a voxel near the eye covers little of the picture, but reaches from behind the eye far into it. Views
/// that would take much work are refused.
#[test]
fn wide_views_take_bounded_work() {
    let folder = Folder::new();
    let is_refused = AtomicBool::new(false);
    let run = |scene: &str, view: &str, most: f64, may_refuse: bool| {
        let line = format!("model {ROOT}/assets/{scene} {view} --bits 64 --json");
        let output = folder.command(&line).output().unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        if may_refuse && output.status.code() == Some(5) {
            let error = found["error"].as_str().unwrap();
            assert!(error.contains("records"), "{line}: {error}");
            is_refused.store(true, Ordering::Relaxed);
            return;
        }
        let operations = sum(&found["operations"], "times");
        assert!(operations < most, "{line}: {operations}");
    };
    let knots = [1, 2, 4].map(|depth| format!("knot.obj --depth {depth}"));
    let scenes = knots.iter().map(String::as_str);
    let scenes: Vec<&str> = scenes.chain(["wires.obj --depth 2", "tree.vox"]).collect();
    scenes.into_par_iter().for_each(|scene| {
        for fov in [178.0, 179.999] {
            for rule in ["exact", "alpha"] {
                let view = format!("--fov {fov} --coverage {rule} --size 8");
                run(scene, &view, 2e6, false);
            }
            // Each rule from one side. The deepest knot's centres at 178 degrees take longest and are left out.
            for end in ["any --size 8", "center --size 8 --view top --zoom 2"] {
                if fov < 179.0 && end.starts_with("center") && scene == knots[2] {
                    continue;
                }
                run(scene, &format!("--fov {fov} --coverage {end}"), 1e9, true);
            }
            if fov > 179.0 && scene != "tree.vox" {
                // Also if the middle is not that of the quadtree.
                for end in ["any --size 12", "center --size 8", "center --size 24x16"] {
                    run(scene, &format!("--fov {fov} --coverage {end}"), 1e7, false);
                }
            }
        }
    });
    assert!(is_refused.into_inner());
}
