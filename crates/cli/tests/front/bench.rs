//! The rows of experiments.

use serde_json::Value;

use crate::program::{Folder, number};

const SCENE: &str = "gen:menger,depth=2";

/// The rows of an experiment's document.
fn rows(folder: &Folder, line: &str) -> Vec<Value> {
    let document = folder.json(line);
    document["rows"].as_array().unwrap().clone()
}

/// The only row of a method, or of a variant.
fn row<'r>(rows: &'r [Value], name: &str) -> &'r Value {
    let mut same = rows
        .iter()
        .filter(|row| row["method"] == name || row["variant"] == name);
    let found = same.next().unwrap_or_else(|| panic!("{name}: {rows:?}"));
    assert!(same.next().is_none(), "{name} is not one row");
    found
}

#[test]
fn engines_agree_in_every_form() {
    let line =
        "bench time gen:menger,depth=2 --size 48x32 --lod 0 --warmup 0 --runs 3 --threads 1,2";
    let rows = rows(&Folder::new(), line);
    // The oracle and the fast engine use threads, the others are measured on one.
    let threads = |engine: &str| {
        let of = rows.iter().filter(|row| row["engine"] == engine);
        of.map(|row| number(&row["threads"])).collect::<Vec<_>>()
    };
    assert_eq!(
        ["fast", "rays", "machine", "float-rays"].map(threads),
        [vec![1.0, 2.0], vec![1.0, 2.0], vec![1.0], vec![1.0]]
    );
    for row in &rows {
        let of = |name: &str| number(&row[name]);
        assert_eq!([of("pixels"), of("runs")], [48.0 * 32.0, 3.0]);
        assert!(of("covered") > 100.0 && of("work") > 10.0);
        // Without level of detail every engine is exact, but for rounding.
        let allowed = if row["engine"] == "float-rays" {
            3.0
        } else {
            0.0
        };
        assert!(
            of("extra") + of("missing") + of("wrong_voxel") <= allowed,
            "{row}"
        );
        let ms = ["wall_min_ms", "wall_ms", "wall_max_ms"].map(of);
        assert!(0.0 < ms[0] && ms.is_sorted(), "{row}");
        let has_cpu = of("threads") == 1.0 && cfg!(unix);
        assert_eq!(row["cpu_ms"].is_number(), has_cpu, "{row}");
    }
}

#[test]
fn pictures_and_scenes_grow() {
    let folder = Folder::new();
    let line = "bench time gen:menger,depth=2 --scan size=16..64*2 --runs 1 --engines machine,float-rays \
        --export-svg {scene}.svg";
    let of_size = rows(&folder, line);
    let heights = of_size.iter().filter(|row| row["engine"] == "machine");
    let heights: Vec<f64> = heights.map(|row| number(&row["height"])).collect();
    assert_eq!(heights, [16.0, 32.0, 64.0]);
    assert_eq!(of_size[0]["growing"], "pixels");
    let exponent = number(&of_size[0]["work_exponent"]);
    assert!((0.1..1.5).contains(&exponent), "{exponent}");
    assert!(number(&of_size[0]["work_r_squared"]) <= 1.0);
    let svg = folder.text("menger-depth-2.svg");
    assert!(svg.contains("pixels") && svg.contains("polyline"));
    let line =
        "bench time gen:terrain,depth=9 --scan depth=5..6+1 --size 16 --runs 1 --engines fast";
    let of_depth = rows(&folder, line);
    let voxels: Vec<f64> = of_depth.iter().map(|row| number(&row["voxels"])).collect();
    assert_eq!(voxels, [2637.0, 11998.0]);
    assert_eq!(of_depth[0]["growing"], "voxels");
    let text = folder.stdout(line);
    let is_narrow = text.lines().all(|line| line.chars().count() <= 100);
    assert!(text.contains("exponent") && is_narrow, "{text}");
}

#[test]
fn variants_change_what_they_should() {
    let folder = Folder::new();
    let machine =
        "bench time gen:menger,depth=2 --size 48 --lod 0 --runs 1 --engines machine --variants all";
    let machine = rows(&folder, machine);
    let of = |variant: &str, name: &str| number(&row(&machine, variant)[name]);
    for (variant, changes) in [
        ("everything on", false),
        ("fill-vector rejection off", false),
        ("occlusion order off", true),
    ] {
        assert_eq!(of(variant, "changed") > 50.0, changes, "{variant}");
        assert_eq!(of(variant, "wrong_voxel") > 50.0, changes, "{variant}");
    }
    let work = |variant| of(variant, "work");
    assert!(work("fill-vector rejection off") > work("everything on"));
    // It is off already.
    assert_eq!(work("level of detail off"), work("everything on"));

    let fast = "bench time gen:terrain,depth=8 --engines fast --variants all --size 64 --runs 1";
    let fast = rows(&folder, fast);
    for row in &fast {
        let may_change = row["variant"] == "level of detail off";
        assert!(row["changed"] == 0 || may_change, "{row}");
    }
    let of = |variant: &str, name: &str| number(&row(&fast, variant)[name]);
    let (whole, looked_at) = ("everything on", "absent children looked at");
    assert!(of(whole, "samples_drawn") > 500.0 && of(whole, "skipped_absent_children") > 0.0);
    assert_eq!(of(looked_at, "skipped_absent_children"), 0.0);
    let left = |variant| of(variant, "skipped_hidden") + of(variant, "skipped_off_screen");
    assert!(left(looked_at) > left(whole));
    let kept = ["frames_unchanged", "work"].map(|name| of("unchanged frame kept", name));
    assert_eq!(kept, [1.0, 0.0]);
    assert!(of("attributes of all read", "attributes_read") > of(whole, "samples_drawn"));
}

const SMALL: &str = "--size 24 --reference-samples 4 --runs 1 --warmup 0";

#[test]
fn quality_in_every_form() {
    let folder = Folder::new();
    let line = format!(
        "bench quality {SCENE} {SMALL} --methods exact:lod=0:aa=1+2:cage=frame+corners,\
         any:lod=0:tolerance=0+inf:cage=frame+corners --export-svg r-{{scene}}.svg"
    );
    let all = rows(&folder, &line);
    // Two cages with two numbers of samples or two tolerances, and the noise floor.
    assert_eq!(all.len(), 2 * 2 + 2 * 2 + 1);
    let of = |method: &str, name: &str| number(&row(&all, method)[name]);
    // In clip space, down to the leaves, the exact rule is the oracle.
    let exact = "exact frame lod 0";
    let wrong = ["extra", "missing", "coarser", "elsewhere"].map(|name| of(exact, name));
    assert_eq!(wrong, [0.0; 4]);
    let any = "any 0 frame lod 0";
    assert!(of(any, "extra") > 0.0 && of(any, "bias_percent") > 0.0);
    assert!(of(any, "flip") > of(exact, "flip"));
    // More samples are nearer to the reference; noise is nearest.
    let rms = |method| of(method, "rms_linear");
    assert!(rms("exact frame lod 0 aa 2") < rms(exact));
    assert!(rms("noise floor") < rms(exact));
    assert!(of(exact, "operations") > 1000.0 && of(exact, "ms") > 0.0);
    let paper = row(&all, "any inf corners lod 0");
    assert!(paper["beaten_by"].is_string() && row(&all, exact)["beaten_by"].is_null());
    let svg = folder.text("r-menger-depth-2.svg");
    assert!(svg.contains("dominated") && svg.contains("operations of the machine"));
}

#[test]
fn films_flicker_and_more_samples_calm_them() {
    let line = "bench quality gen:sphere,depth=5 --size 20 --frames 3 --motions turntable,dolly --runs 1 \
        --reference-samples 4 --methods exact:aa=1+4";
    let rows = rows(&Folder::new(), line);
    let of = |method: &str, name: &str| number(&row(&rows, method)[name]);
    for flicker in ["flicker_turntable", "flicker_dolly"] {
        let one = of("exact frame", flicker);
        assert!(of("exact frame aa 4", flicker) < one, "{rows:?}");
        assert!(of("exact frame", &format!("{flicker}_worst")) >= one);
        assert!(of("noise floor", flicker) > 0.0);
    }
}

#[test]
fn everything_but_times_is_the_same_in_every_run() {
    let folder = Folder::new();
    let quality = "--methods exact,center --motions pan --frames 2";
    for line in [
        format!("bench time {SCENE} --size 32 --runs 1"),
        format!("bench quality gen:wires,depth=4 {SMALL} {quality}"),
    ] {
        let lasting = || {
            let mut rows = rows(&folder, &line);
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
    let folder = Folder::new();
    // The paper's list with smaller pictures and scenes.
    let mut list = include_str!("../../../lab/src/reproduce.toml").to_owned();
    for (from, to) in [
        ("512", "32"),
        ("[64, 128, 256, 32, 1024]", "[16, 64]"),
        ("bundled", "gen:maze,depth=3"),
        ("menger,depth=5", "menger,depth=2"),
        ("truss,depth=8", "truss,depth=4"),
        (
            "\"gen:terrain,depth=7\", \"gen:terrain,depth=8\", \"gen:terrain,depth=9\", \"gen:terrain,depth=10\"",
            "",
        ),
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
    let page = folder.text("one/report.md");
    for part in [
        "Table I",
        "occlusion order",
        "Objects of all kinds",
        "exponent",
    ] {
        assert!(page.contains(part), "{part}");
    }
}
