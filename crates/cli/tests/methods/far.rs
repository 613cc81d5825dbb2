//! The program with far voxels: commands, exit codes, messages.

use std::fs;
use std::path::Path;

use std::process::Command;

use crate::common::Run;

fn shiftvox(folder: &Path) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command
}

/// A sheet of small triangles, as a Wavefront file.
fn sheet() -> String {
    sheet_of(12)
}

/// A sheet of so many vertices along each side.
fn sheet_of(side: usize) -> String {
    let mut text = String::new();
    for z in 0..side {
        for x in 0..side {
            text += &format!("v {x} {} {z}\n", (x * z) % 3);
        }
    }
    for z in 0..side - 1 {
        for x in 1..side {
            let a = z * side + x;
            text += &format!("f {a} {} {} {}\n", a + 1, a + side + 1, a + side);
        }
    }
    text
}

#[test]
fn convert_info_render() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    let settings = "--leaf-triangles 50 --grid 16 --rays 20000 -q".split(' ');
    for (output, threads) in [("a.far", "1"), ("b.far", "2")] {
        let command = ["convert", "sheet.obj", output, "--threads", threads];
        shiftvox(at)
            .args(command)
            .args(settings.clone())
            .assert()
            .success();
    }
    assert_eq!(
        fs::read(at.join("a.far")).unwrap(),
        fs::read(at.join("b.far")).unwrap()
    );
    shiftvox(at)
        .args(["convert", "sheet.obj", "a.far"])
        .assert()
        .code(1);
    let output = shiftvox(at)
        .args(["info", "a.far", "--json"])
        .assert()
        .success();
    let document: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let scene = &document["scenes"][0];
    assert_eq!(scene["triangles"], 242);
    assert!(scene["levels"].as_array().unwrap().len() > 2);
    let share = |name: &str| scene[name].as_f64().unwrap();
    // Nothing is counted twice, and nothing is left out.
    let kinds = ["voxels_seen", "voxels_untested", "voxels_occluded"].map(share);
    assert_eq!(kinds.iter().sum::<f64>(), share("voxels_touched"));
    assert_eq!(kinds[0] + kinds[1], share("voxels_kept"));
    assert_eq!(kinds[2], share("voxels_dropped"));
    let sum = share("opaque_share") + share("scalar_share") + share("six_share");
    assert!((sum - 1.0).abs() < 1e-9);
    assert!(share("rays") <= 20_000.0 && share("rays_per_voxel") > 1.0);
    let text = shiftvox(at).args(["info", "a.far"]).assert().success();
    let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
    assert!(text.contains("242") && text.contains("dropped"), "{text}");
    // Too few rays are warned of.
    for (rays, is_warned) in [("500", true), ("200000", false)] {
        let few = ["convert", "sheet.obj", "few.far", "--force", "--rays", rays];
        let settings = ["--leaf-triangles", "50", "--grid", "16"];
        let output = shiftvox(at).args(few).args(settings).assert().success();
        let stderr = String::from_utf8(output.get_output().stderr.clone()).unwrap();
        assert_eq!(stderr.contains("are too few"), is_warned, "{stderr}");
    }
    let mut hashes = Vec::new();
    for opacity in ["none", "scalar", "six"] {
        // So far away that its nodes are drawn as voxels.
        let render = "render a.far --engine far --size 256 --hash --eye 200,200,200 --target 5,1,5"
            .split(' ');
        let more = ["--far-opacity", opacity, "-o", "{stem}.png", "--force"];
        let output = shiftvox(at).args(render).args(more).assert().success();
        hashes.push(output.get_output().stdout.clone());
    }
    assert!(hashes[0] != hashes[2]);
    assert!(at.join("a.png").exists());
}

/// The JSON of `info` of a file, and its text.
fn info(at: &Path, file: &str) -> (serde_json::Value, String) {
    let told = |more: &[&str]| {
        let told = shiftvox(at).args(["info", file]).args(more).assert();
        told.success().get_output().stdout.clone()
    };
    let document: serde_json::Value = serde_json::from_slice(&told(&["--json"])).unwrap();
    let text = String::from_utf8(told(&[])).unwrap();
    (document["scenes"][0].clone(), text)
}

#[test]
fn a_hybrid_is_converted_told_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet_of(60)).unwrap();
    for (output, more) in [("h.far", &["--hybrid"][..]), ("f.far", &[])] {
        let settings = "--leaf-triangles 300 --grid 32 --rays 200000 -q".split(' ');
        let convert = ["convert", "sheet.obj", output];
        let mut command = shiftvox(at);
        command.args(convert).args(settings).args(more);
        command.assert().success();
    }
    // A sheet is wide everywhere: surfaces, and no voxels.
    let ((hybrid, text), (voxels, other)) = (info(at, "h.far"), info(at, "f.far"));
    assert_eq!(hybrid["voxels_kept"], 0, "{hybrid}");
    assert!(voxels["voxels_kept"].as_u64() > Some(1000), "{voxels}");
    assert!(
        text.contains("decimated triangles of inner nodes"),
        "{text}"
    );
    assert!(other.contains("surface   0 decimated"), "{other}");
    let inner = |of: &serde_json::Value| of["levels"][0]["surface_triangles"].as_u64().unwrap();
    let (kept, all) = (inner(&hybrid), hybrid["triangles"].as_u64().unwrap());
    assert!(
        kept > 0 && kept < all && inner(&voxels) == 0,
        "{kept} {all}"
    );
    // From afar both are drawn by their roots, in other ways.
    let hashes = ["h.far", "f.far"].map(|file| {
        let view = "--size 64 --eye 200,200,200 --target 5,1,5 --hash -q -o {stem}.png".split(' ');
        let drawn = shiftvox(at).args(["render", file]).args(view).assert();
        drawn.success().get_output().stdout.clone()
    });
    assert!(hashes[0] != hashes[1]);
}

#[test]
fn what_cannot_be_built_is_told_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // A sheet of twelve steps, so far away that its file could not be read.
    let far_away: String = sheet()
        .lines()
        .map(|line| match line.strip_prefix("v ") {
            Some(rest) => {
                let (x, rest) = rest.split_once(' ').unwrap();
                format!("v {} {rest}\n", x.parse::<f64>().unwrap() + 1e12)
            }
            None => format!("{line}\n"),
        })
        .collect();
    fs::write(at.join("away.obj"), far_away).unwrap();
    fs::write(at.join("sheet.obj"), sheet_of(200)).unwrap();
    fs::write(at.join("old.far"), "kept").unwrap();
    let told = |words: &str, code: i32| {
        let mut command = shiftvox(at);
        let output = command.args(words.split(' ')).assert().code(code);
        String::from_utf8(output.get_output().stderr.clone()).unwrap()
    };
    for more in ["", " --hybrid", " --resume"] {
        let text = told(&format!("convert away.obj old.far --force{more}"), 4);
        assert!(
            text.contains("away.obj") && text.contains("move it to the origin"),
            "{text}"
        );
        assert_eq!(fs::read(at.join("old.far")).unwrap(), b"kept");
    }
    // The advice is enough.
    let text = told("convert sheet.obj a.far --rays 20000 --memory 64M", 5);
    let (_, advised) = text.split_once("--memory ").unwrap();
    let advised = advised.split(' ').next().unwrap();
    told(
        &format!("convert sheet.obj a.far --rays 20000 --memory {advised}"),
        0,
    );
}

#[test]
fn turntables_and_samples() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    let convert = ["convert", "sheet.obj", "a.far", "--rays", "20000", "-q"];
    let settings = ["--leaf-triangles", "50", "--grid", "16"];
    shiftvox(at).args(convert).args(settings).assert().success();
    let hashes = |arguments: &[&str]| -> Vec<String> {
        let output = shiftvox(at).args(arguments).assert().success();
        let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
        let first = |line: &str| line.split(' ').next().unwrap().to_owned();
        text.lines().map(first).collect()
    };
    let turn = ["turntable", "a.far", "--engine", "far", "--frames", "4"];
    let more = ["-o", "f#.png", "--size", "48", "--hash", "--aov", "depth"];
    let frames = hashes(&[&turn[..], &more].concat());
    assert_eq!(frames.len(), 4);
    assert!((0..4).all(|i| at.join(format!("f{i}.png")).exists()));
    assert!(at.join("f3.depth.npy").exists());
    // The sheet is not the same from all sides.
    assert!(frames[1] != frames[0] && frames[2] != frames[0]);
    let again = hashes(&[&turn[..], &more, &["--force", "--threads", "1"]].concat());
    assert_eq!(frames, again);
    shiftvox(at)
        .args(["turntable", "a.far", "--engine", "fast", "-o", "g#.png"])
        .assert()
        .code(2);
    // One sample is what there is without the flag; more are another picture.
    let render = [
        "render", "a.far", "--engine", "far", "--size", "48", "--hash",
    ];
    let by_samples = ["1", "2", "4"].map(|n| hashes(&[&render[..], &["--aa", n]].concat()));
    assert_eq!(hashes(&render), by_samples[0]);
    assert!(by_samples[0] != by_samples[1] && by_samples[1] != by_samples[2]);
    shiftvox(at)
        .args(["render", "a.far", "--engine", "far", "--hash"])
        .args(["--size", "8000", "--aa", "4"])
        .assert()
        .code(5);
}

#[test]
fn a_build_that_is_cut_short_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    let program = crate::common::program();
    for wait_ms in [0, 5, 20, 80] {
        let mut child = Command::new(&program)
            .current_dir(at)
            .args(["convert", "sheet.obj", "cut.far", "--rays", "300000", "-q"])
            .args(["--leaf-triangles", "20"])
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(wait_ms));
        child.kill().unwrap();
        child.wait().unwrap();
        if at.join("cut.far").exists() {
            // It was done before: then it is whole.
            shiftvox(at).args(["info", "cut.far"]).assert().success();
            fs::remove_file(at.join("cut.far")).unwrap();
        }
    }
    // Nothing of it is in the way of the next.
    let again = ["convert", "sheet.obj", "cut.far", "--rays", "1000", "-q"];
    shiftvox(at).args(again).assert().success();
}

#[test]
fn copies_budgets_and_walks() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    let convert = ["convert", "sheet.obj", "four.far", "--instances", "4"];
    let settings = "--leaf-triangles 60 --grid 12 --rays 20000 -q".split(' ');
    shiftvox(at).args(convert).args(settings).assert().success();
    let json = |arguments: &[&str]| -> serde_json::Value {
        let output = shiftvox(at)
            .args(arguments)
            .arg("--json")
            .assert()
            .success();
        serde_json::from_slice(&output.get_output().stdout).unwrap()
    };
    let info = json(&["info", "four.far"]);
    let scene = &info["scenes"][0];
    assert_eq!(scene["triangles"], 4 * 242);
    // Two by two, a tenth of a side apart, on the same ground.
    let side = |k: usize| scene["high"][k].as_f64().unwrap() - scene["low"][k].as_f64().unwrap();
    assert!((side(0) - 23.1).abs() < 0.1 && (side(2) - 23.1).abs() < 0.1);
    assert!((side(1) - 2.0).abs() < 0.1);
    let render = [
        "render", "four.far", "--engine", "far", "--hash", "--size", "64",
    ];
    let free = json(&render);
    let bound = json(&[&render[..], &["--memory", "2K"]].concat());
    assert_eq!(free["scenes"][0]["hash"], bound["scenes"][0]["hash"]);
    assert!(free["scenes"][0]["memory"].is_null());
    if cfg!(unix) {
        assert!(
            bound["scenes"][0]["memory"]["nodes_released"]
                .as_u64()
                .unwrap()
                > 0
        );
    }
}

#[test]
fn a_dolly_shows_where_levels_change() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet_of(48)).unwrap();
    // From one percent nearer to the next, to two thirds of the distance.
    let film = "bench quality sheet.obj --methods far --motions dolly --depth 3 --frames 40 --size 128 \
        --zoom 0.3 --far-rays 30000 --runs 1 --warmup 0 --json";
    let output = shiftvox(at).args(film.split(' ')).assert().success();
    let document: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 3 + 1);
    for row in &rows[..3] {
        // Nodes change one after the other; between, the other cut is the same.
        let popped = row["popped_dolly"].as_u64().unwrap();
        assert!((1..20).contains(&popped), "{row}");
        // In thousandths of white.
        assert!(row["pop_dolly"].as_f64().unwrap() > 0.1, "{row}");
        assert_eq!(row["reference_samples"], 256);
    }
}

#[test]
fn what_is_wrong_is_said_with_an_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    let convert = "convert sheet.obj a.far --leaf-triangles 100 -q";
    let convert: Vec<&str> = convert.split(' ').collect();
    shiftvox(at).args(convert).assert().success();
    let sound = fs::read(at.join("a.far")).unwrap();
    let mut version = sound.clone();
    version[8] = 9;
    let mut voxel = sound.clone();
    let middle = sound.len() / 2;
    voxel[middle] ^= 4;
    for (name, bytes) in [
        ("cut.far", &sound[..sound.len() / 2]),
        ("short.far", &sound[..20]),
        ("version.far", &version),
        ("voxel.far", &voxel),
    ] {
        fs::write(at.join(name), bytes).unwrap();
        shiftvox(at).args(["info", name]).assert().code(4);
        let render = [
            "render", name, "--engine", "far", "--lod", "9", "-o", "x.png",
        ];
        if name != "voxel.far" {
            shiftvox(at).args(render).assert().code(4);
            assert!(!at.join("x.png").exists());
        }
    }
    let usage: [&[&str]; 5] = [
        &[
            "render", "a.far", "--engine", "far", "--lod", "0", "-o", "x.png",
        ],
        &["convert", "sheet.obj", "b.vxg", "--rays", "7"],
        &["convert", "sheet.obj", "b.vxg", "--resume"],
        &["convert", "sheet.obj", "b.vxg", "--instances", "2"],
        &["render", "sheet.obj", "--memory", "1G", "--hash"],
    ];
    for arguments in usage {
        shiftvox(at).args(arguments).assert().code(2);
    }
    shiftvox(at)
        .args(["render", "sheet.obj", "--engine", "far", "-o", "x.png"])
        .assert()
        .code(4);
    shiftvox(at)
        .args(["turntable", "sheet.obj", "--engine", "far", "-o", "#.png"])
        .assert()
        .code(4);
    // More than 32 bits number, or than any memory holds: said at once.
    fs::write(at.join("one.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n").unwrap();
    let copies = |mesh| ["convert", mesh, "b.far", "--instances", "4294967295"];
    shiftvox(at).args(copies("sheet.obj")).assert().code(5);
    if cfg!(target_os = "linux") {
        let output = shiftvox(at).args(copies("one.obj")).assert().code(5);
        let stderr = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(
            stderr.contains("one.obj") && stderr.contains("are free"),
            "{stderr}"
        );
    }
    shiftvox(at)
        .args(["convert", "missing.obj", "b.far"])
        .assert()
        .code(4);
}

/// No engine named: a file is drawn with its own, also beside voxels. Flags that its engine does not
/// follow are refused, and what a run leaves as its configuration draws it again.
#[test]
fn a_file_has_its_own_engine_and_no_idle_flags() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    for file in ["a.far", "b.tvx"] {
        let convert = ["convert", "sheet.obj", file, "-q"];
        shiftvox(at).args(convert).assert().success();
    }
    let hash = |arguments: &[&str]| {
        let size = ["render", "--size", "32", "--hash", "-q"];
        let output = shiftvox(at).args(size).args(arguments).assert().success();
        String::from_utf8(output.get_output().stdout.clone()).unwrap()
    };
    for (file, engine) in [("a.far", "far"), ("b.tvx", "textured")] {
        let named = hash(&[file, "--engine", engine]);
        assert_eq!(hash(&[file]), named);
        let outdir = ["--outdir", engine, "--far-opacity", "none"];
        let kept = hash(&[&[file][..], &outdir[..if file == "a.far" { 4 } else { 2 }]].concat());
        let again = format!("{engine}/config.toml");
        assert_eq!(hash(&["--config", &again]), kept);
        let other = [
            ["--engine", "fast"],
            ["--coverage", "any"],
            ["--cage", "frame"],
            ["--tolerance", "0"],
            ["--bits", "32"],
            ["--frac", "9"],
            ["--overflow", "trap"],
            ["--depth", "5"],
            ["--aov", "voxel"],
            ["--opacities", "--hash"],
            ["--paper", "--hash"],
            if file == "a.far" {
                ["--erosion", "1"]
            } else {
                ["--far-opacity", "none"]
            },
        ];
        for flags in other {
            let render = ["render", file, "-o", "x.png"];
            let output = shiftvox(at).args(render).args(flags).assert().code(2);
            let stderr = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
            let flag = flags[0].trim_start_matches('-');
            assert!(
                stderr.contains(file) && stderr.contains(flag),
                "{flags:?}: {stderr}"
            );
            let turn = ["turntable", file, "--frames", "1", "-o", "#.png"];
            shiftvox(at).args(turn).args(flags).assert().code(2);
        }
        for verb in ["model", "triangles"] {
            let wrong = [verb, file, "-o", "x.png"];
            let count = if verb == "model" { 2 } else { 4 };
            let output = shiftvox(at).args(&wrong[..count]).assert().code(4);
            let stderr = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
            assert!(stderr.contains("render and turntable draw it"), "{stderr}");
            assert_eq!(stderr.matches(file).count(), 1, "{stderr}");
        }
    }
    // One command for files of three kinds.
    let all = hash(&["a.far", "gen:menger,depth=2", "b.tvx", "--outdir", "all"]);
    assert_eq!(all.lines().count(), 3);
    assert_eq!(hash(&["--config", "all/config.toml"]), all);
    for flags in [["--far-opacity", "six"], ["--erosion", "auto"]] {
        let render = ["render", "gen:menger,depth=2", "--hash"];
        shiftvox(at).args(render).args(flags).assert().code(2);
    }
    let render = ["render", "b.tvx", "--hash", "--erosion", "0", "--lod", "2"];
    shiftvox(at).args(render).assert().code(2);
}
