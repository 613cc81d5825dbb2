//! Experiments give the same rows in every run, but for times. Other rules are rows of `cases/experiments.txt`.

use serde_json::Value;

use crate::program::Folder;

#[test]
fn everything_but_times_is_the_same_in_every_run() {
    let folder = Folder::new();
    for line in [
        "bench time gen:menger,depth=2 --size 32 --runs 1",
        "bench quality gen:wires,depth=4 --size 24 --reference-samples 4 --runs 1 --warmup 0 --methods exact,center \
         --motions pan --frames 2",
    ] {
        let lasting = || {
            let mut document = folder.json(line);
            let rows = document["rows"].as_array_mut().unwrap();
            for row in rows.iter_mut().filter_map(Value::as_object_mut) {
                row.retain(|name, _| !name.ends_with("ms") && name != "time_ratio");
            }
            document["rows"].take()
        };
        assert_eq!(lasting(), lasting(), "{line}");
    }
}

#[test]
fn reproduced_results_are_the_same_in_every_run() {
    let folder = Folder::new();
    // The paper's list with smaller pictures and scenes.
    let mut list = include_str!("../../../lab/src/reproduce.toml").to_owned();
    for (from, to) in [
        ("512", "32"),
        ("[64, 128, 256, 32, 1024]", "[16, 64]"),
        ("bundled", "gen:maze,depth=3"),
        ("menger,depth=5", "menger,depth=2"),
        ("truss,depth=8", "truss,depth=4"),
        ("\"gen:terrain,depth=7\", \"gen:terrain,depth=8\", ", ""),
        ("\"gen:terrain,depth=9\", \"gen:terrain,depth=10\"", ""),
        ("terrain,depth=6", "terrain,depth=5"),
    ] {
        list = list.replace(from, to);
    }
    folder.put("list.toml", list);
    let lasting = "table scene size settings hash work operations changed";
    let reproduced = |outdir: &str| -> Vec<Vec<Value>> {
        let told = folder.stdout(&format!("reproduce list.toml --runs 1 --outdir {outdir}"));
        assert!(told.contains("Table I") && told.contains("<1"), "{told}");
        let text = folder.text(&format!("{outdir}/results.json"));
        let document: Value = serde_json::from_str(&text).unwrap();
        let rows = document["rows"].as_array().unwrap().iter();
        let rows = rows.map(|row| lasting.split(' ').map(|of| row[of].clone()));
        rows.map(Iterator::collect).collect()
    };
    let one = reproduced("one");
    assert_eq!(one, reproduced("two"));
    // The machine with everything on draws two sizes, five scenes, a terrain and four scenes, each twice.
    let hashes = one.iter().filter(|row| row[4].is_string());
    assert_eq!(hashes.count(), 2 * (2 + 5 + 1 + 4));
    assert!(folder.at("two/figures.svg").exists());
    let csv = folder.text("one/results.csv");
    let parts = [
        "Table I",
        "occlusion order",
        "Objects of all kinds",
        "exponent",
    ];
    assert!(parts.iter().all(|part| csv.contains(part)), "{csv}");
}
