//! The program as a script meets it: exit codes, streams, files.

use std::fs;
use std::path::Path;

use crate::program::{folder, shiftvox, stderr_of, stdout_of};

use crate::common::Run;

const SCENE: &str = "gen:sphere,depth=3";

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn wrong_command_lines_exit_with_2() {
    let folder = folder();
    let lines: [&[&str]; 14] = [
        &["paint"],
        &["render", SCENE, "--size", "0", "-o", "a.png"],
        &["render", SCENE, "--size", "40000", "-o", "a.png"],
        &["render", SCENE, "--eye", "1,2", "-o", "a.png"],
        &["render", SCENE, "--eye", "1,2,3", "-o", "a.png"],
        &["render", SCENE, "--fov", "180", "-o", "a.png"],
        &["render", SCENE, "--tolerance", "-1", "-o", "a.png"],
        &["render", SCENE, "--background", "red", "-o", "a.png"],
        &["render", SCENE, "--aa", "3", "-o", "a.png"],
        &["render", SCENE, "--paper", "--cage", "frame", "-o", "a.png"],
        &["render", SCENE, "--bits", "8", "-o", "a.png"],
        &["render", SCENE, "-o", "a.jpg"],
        &["render", SCENE],
        &["render", "-o", "a.png"],
    ];
    for line in lines {
        let assert = shiftvox(folder.path()).args(line).assert().code(2);
        assert!(!stderr_of(&assert).is_empty(), "{line:?} says nothing");
        assert_eq!(stdout_of(&assert), "", "{line:?}");
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn exact_pictures_have_no_tolerance() {
    let folder = folder();
    for coverage in ["exact", "alpha"] {
        for tolerance in ["0.125", "inf"] {
            let line = [
                "render",
                SCENE,
                "--coverage",
                coverage,
                "--tolerance",
                tolerance,
            ];
            let assert = shiftvox(folder.path())
                .args(line)
                .args(["-o", "a.png"])
                .assert()
                .code(2);
            let told = stderr_of(&assert);
            assert!(told.contains("approximates nothing"), "{told}");
        }
    }
    assert!(names(folder.path()).is_empty());
    let line = format!("render {SCENE} --size 16 --tolerance 0 -o a.png");
    let line: Vec<&str> = line.split(' ').collect();
    shiftvox(folder.path()).args(line).assert().success();
}

#[test]
fn bad_inputs_exit_with_4_and_name_the_file() {
    let folder = folder();
    fs::write(folder.path().join("noise.vox"), b"this is not a scene").unwrap();
    fs::write(folder.path().join("empty.vox"), b"").unwrap();
    for name in ["missing.vox", "noise.vox", "empty.vox"] {
        let assert = shiftvox(folder.path())
            .args(["render", name, "-o", "a.png"])
            .assert()
            .code(4);
        assert!(stderr_of(&assert).contains(name));
        shiftvox(folder.path())
            .args(["info", name])
            .assert()
            .code(4);
    }
    let unknown = ["render", "gen:nonsense", "-o", "a.png"];
    shiftvox(folder.path()).args(unknown).assert().code(4);
    assert_eq!(names(folder.path()), ["empty.vox", "noise.vox"]);
}

#[test]
fn an_existing_file_stays_as_it_is() {
    let folder = folder();
    let picture = folder.path().join("a.png");
    fs::write(&picture, b"mine").unwrap();
    let line = ["render", SCENE, "--size", "16", "-o", "a.png"];
    let assert = shiftvox(folder.path()).args(line).assert().code(1);
    assert!(stderr_of(&assert).contains("--force"));
    assert_eq!(fs::read(&picture).unwrap(), b"mine");

    // A buffer in the way stops the run before the picture is written.
    fs::write(folder.path().join("b.depth.npy"), b"mine").unwrap();
    let line = [
        "render", SCENE, "--size", "16", "-o", "b.png", "--aov", "depth",
    ];
    shiftvox(folder.path()).args(line).assert().code(1);
    assert_eq!(names(folder.path()), ["a.png", "b.depth.npy"]);

    let line = ["render", SCENE, "--size", "16", "-o", "a.png", "--force"];
    shiftvox(folder.path()).args(line).assert().success();
    assert_eq!(&fs::read(&picture).unwrap()[1..4], b"PNG");
}

#[test]
fn a_bad_scene_does_not_stop_the_others() {
    let folder = folder();
    let other = "gen:menger,depth=2";
    let line = [
        "render",
        SCENE,
        "missing.vox",
        other,
        "--size",
        "16",
        "-o",
        "{stem}.png",
    ];
    let assert = shiftvox(folder.path()).args(line).assert().code(4);
    assert!(stderr_of(&assert).contains("missing.vox"));
    assert_eq!(names(folder.path()).len(), 2);
    let line = ["render", SCENE, other, "--size", "16", "-o", "one.png"];
    let assert = shiftvox(folder.path()).args(line).assert().code(2);
    assert!(stderr_of(&assert).contains("{stem}"));
}

#[test]
fn hashes_are_printed_and_expected() {
    let folder = folder();
    let line = ["render", SCENE, "--size", "24x16", "--hash"];
    let hash = stdout_of(&shiftvox(folder.path()).args(line).assert().success());
    let hash = hash.trim();
    assert_eq!(hash.len(), 32);
    let expect = |hash: &str| {
        let mut command = shiftvox(folder.path());
        command.args(["render", SCENE, "--size", "24x16", "--expect-hash", hash]);
        command.assert()
    };
    expect(hash).success();
    let other = "0123456789abcdef0123456789abcdef";
    let assert = expect(other).code(3);
    assert!(stderr_of(&assert).contains(hash));
    expect("abc").code(2);
    // Threads never change a bit.
    let line = format!("render {SCENE} --size 24x16 --hash --threads 1");
    let line: Vec<&str> = line.split(' ').collect();
    let one = stdout_of(&shiftvox(folder.path()).args(line).assert().success());
    assert_eq!(one.trim(), hash);
}

#[test]
fn json_parses_and_stands_alone_on_stdout() {
    let folder = folder();
    let line = ["render", SCENE, "--size", "16", "-o", "a.png", "--json"];
    let text = stdout_of(&shiftvox(folder.path()).args(line).assert().success());
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["schema"], "shiftvox.render");
    assert_eq!(json["schema_version"], 1);
    let scene = &json["scenes"][0];
    assert_eq!(
        (scene["width"].as_u64(), scene["output"].as_str()),
        (Some(16), Some("a.png"))
    );
    assert_eq!(scene["hash"].as_str().map(str::len), Some(32));

    let line = ["info", SCENE, "missing.vox", "--json"];
    let text = stdout_of(&shiftvox(folder.path()).args(line).assert().code(4));
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(json["scenes"][0]["voxels"].as_u64() > Some(0));
    assert!(json["scenes"][1]["error"].is_string());
}

#[test]
fn a_frame_that_the_fast_engine_hands_on_says_why() {
    let folder = folder();
    let cases: [(&[&str], Option<&str>); 3] = [
        (&[], None),
        (&["--paper"], Some("handed_for_rule")),
        (
            &["--aov", "records", "-o", "a.png"],
            Some("handed_for_records"),
        ),
    ];
    for (flags, why) in cases {
        let line = ["render", SCENE, "--size", "16", "--hash"];
        let run = |more: &[&str]| {
            let mut command = shiftvox(folder.path());
            command.args(line).args(flags).args(["--force"]).args(more);
            command.assert().success()
        };
        let document: serde_json::Value =
            serde_json::from_str(&stdout_of(&run(&["--json"]))).unwrap();
        let counters = document["scenes"][0]["counters"].as_object().unwrap();
        let told: Vec<&str> = counters.keys().map(String::as_str).collect();
        let told: Vec<&str> = told
            .into_iter()
            .filter(|name| name.starts_with("handed_for"))
            .collect();
        assert_eq!(told, why.into_iter().collect::<Vec<_>>(), "{flags:?}");
        let said = stderr_of(&run(&["-v"]));
        assert_eq!(said.contains("handed_for"), why.is_some(), "{said}");
    }
}

#[test]
fn the_printed_camera_draws_the_same_picture() {
    let folder = folder();
    let common = ["render", SCENE, "--size", "32"];
    let view = ["--view", "front", "--azimuth", "-20.5", "--zoom", "1.3"];
    let run = |extra: &[&str]| {
        let assert = shiftvox(folder.path()).args(common).args(extra).assert();
        stdout_of(&assert.success()).trim().to_owned()
    };
    let hash = run(&[&view[..], &["--hash"]].concat());
    let camera = run(&[&view[..], &["--print-camera"]].concat());
    let words: Vec<&str> = camera.split(' ').collect();
    assert_eq!(run(&[&words[..], &["--hash"]].concat()), hash);
    assert_ne!(run(&["--hash"]), hash);
}

#[test]
fn a_recorded_run_can_be_repeated() {
    let folder = folder();
    let line = format!(
        "render {SCENE} --size 20x16 --paper --view left --background none --outdir run \
        --hash"
    );
    let line: Vec<&str> = line.split(' ').collect();
    let hash = stdout_of(&shiftvox(folder.path()).args(line).assert().success());
    let run = folder.path().join("run");
    let pictures = names(&run).into_iter().filter(|n| n.ends_with(".png"));
    assert_eq!(pictures.count(), 1);
    let stats = fs::read_to_string(run.join("stats.json")).unwrap();
    assert!(serde_json::from_str::<serde_json::Value>(&stats).is_ok());
    let line = ["render", "--config", "run/config.toml", "--hash"];
    let again = stdout_of(&shiftvox(folder.path()).args(line).assert().success());
    assert_eq!(again, hash);
    // The command line comes first.
    let line = "render --config run/config.toml --hash --size 8";
    let line: Vec<&str> = line.split(' ').collect();
    let smaller = stdout_of(&shiftvox(folder.path()).args(line).assert().success());
    assert_ne!(smaller, hash);
    shiftvox(folder.path())
        .args(["render", "--config", "none.toml"])
        .assert()
        .code(4);
}

#[test]
fn a_turntable_numbers_its_frames() {
    let folder = folder();
    let line = format!("turntable {SCENE} -o t/##.png --frames 3 --size 8 --json");
    let line: Vec<&str> = line.split(' ').collect();
    let assert = shiftvox(folder.path()).args(line).assert().success();
    let document: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let frames = document["frames"].as_array().unwrap();
    for frame in frames {
        // Every camera is another, so every frame is drawn; as by itself.
        assert_eq!(frame["counters"]["frames_unchanged"], 0);
        assert!(frame["pixels_drawn"].as_u64().unwrap() > 0);
    }
    assert_ne!(frames[0]["hash"], frames[1]["hash"]);
    assert_eq!(
        names(&folder.path().join("t")),
        ["00.png", "01.png", "02.png"]
    );
    let line = ["turntable", SCENE, "-o", "t.png", "--frames", "3"];
    shiftvox(folder.path()).args(line).assert().code(2);
}

#[test]
fn comparisons_pass_and_fail() {
    let folder = folder();
    let render = |name: &str, extra: &[&str]| {
        let mut command = shiftvox(folder.path());
        command.args([
            "render",
            SCENE,
            "--size",
            "32",
            "--aov",
            "voxel,depth",
            "-o",
            name,
        ]);
        command.args(extra).assert().success();
    };
    render("a.png", &[]);
    render("b.png", &["--zoom", "0.5"]);
    let compare = |line: &[&str]| shiftvox(folder.path()).arg("compare").args(line).assert();
    compare(&["a.png", "a.png", "--threshold", "0"]).success();
    compare(&["a.png", "a.png"]).success();
    // As `cmp` and `diff` do.
    compare(&["a.png", "b.png"]).code(3);
    compare(&["a.png", "b.png", "--threshold", "ssim=0"]).success();
    compare(&["a.png", "b.png", "--threshold", "0"]).code(3);
    compare(&["a.png", "b.png", "--threshold", "ssim=0.999"]).code(3);
    compare(&["a.png", "b.png", "--threshold", "beauty=1"]).code(2);
    compare(&["a.png", "a.voxel.npy"]).code(4);
    compare(&["a.png", "missing.png"]).code(4);
    compare(&["a.png", "b.png", "--diff", "d.png"]).code(3);
    compare(&["a.png", "b.png", "--diff", "d.png"]).code(1);
    let assert = compare(&["b.voxel.npy", "a.voxel.npy", "--json"]).code(3);
    let json: serde_json::Value = serde_json::from_str(&stdout_of(&assert)).unwrap();
    assert!(json["missing"].as_u64() > Some(0), "{json}");
    compare(&["a.depth.npy", "a.depth.npy", "--threshold", "0"]).success();
    compare(&["a.depth.npy", "b.depth.npy", "--threshold", "0"]).code(3);
}

#[test]
fn help_manual_and_completions_go_to_stdout() {
    let folder = folder();
    let lines: [(&[&str], &str); 5] = [
        (&["--help"], "turntable"),
        (&["render", "--help"], "--expect-hash"),
        (&["--version"], env!("CARGO_PKG_VERSION")),
        (&["man"], ".TH"),
        (&["completions", "bash"], "_shiftvox"),
    ];
    for (line, part) in lines {
        let assert = shiftvox(folder.path()).args(line).assert().success();
        assert!(stdout_of(&assert).contains(part), "{line:?}");
        assert_eq!(stderr_of(&assert), "", "{line:?}");
    }
}

#[test]
fn the_demo_replaces_its_own_picture_only() {
    let folder = folder();
    for _ in 0..2 {
        let assert = shiftvox(folder.path()).assert().success();
        assert!(stdout_of(&assert).contains("out/demo.png"));
        assert_eq!(names(&folder.path().join("out")), ["demo.png"]);
    }
}
