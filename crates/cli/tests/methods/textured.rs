//! The program with textured voxels: commands, exit codes, messages.

use std::fs;
use std::path::Path;

use serde_json::Value;
use std::process::Command;

use crate::common::Run;

fn shiftvox(folder: &Path) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command
}

/// A hilly sheet, as a Wavefront file.
fn sheet() -> String {
    let mut text = String::new();
    for z in 0..12 {
        for x in 0..12 {
            text += &format!("v {x} {} {z}\n", (x * z) % 3);
        }
    }
    for z in 0..11 {
        for x in 1..12 {
            let a = z * 12 + x;
            text += &format!("f {a} {} {} {}\n", a + 1, a + 13, a + 12);
        }
    }
    text
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = shiftvox(folder).args(arguments).assert().success();
    serde_json::from_slice(&output.get_output().stdout).unwrap()
}

#[test]
fn convert_info_render() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    for (output, threads) in [("a.tvx", "1"), ("b.tvx", "2")] {
        let line =
            format!("convert sheet.obj {output} --grid 4,8 --texels 4 --threads {threads} -q");
        shiftvox(at).args(line.split(' ')).assert().success();
    }
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    assert_eq!(read("a.tvx"), read("b.tvx"));
    let document = json(at, &["info", "a.tvx", "--json"]);
    let scene = &document["scenes"][0];
    assert_eq!(scene["format"], ".tvx");
    assert_eq!(scene["triangles"], 242);
    assert_eq!(scene["bytes"], read("a.tvx").len());
    let grid = &scene["grids"][1];
    assert_eq!(grid["cells"], 8);
    let levels = grid["levels"].as_array().unwrap();
    assert_eq!(levels.last().unwrap()["faces"], 242);
    assert_eq!(levels[0]["primitives"], 0);
    let output = shiftvox(at)
        .args(["info", "a.tvx", "--levels"])
        .assert()
        .success();
    let output = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    for word in ["sub-textures", "surfels", "242", "afresh"] {
        assert!(output.contains(word), "{word}: {output}");
    }
    let camera = ["--size", "64", "--json", "--hash", "-q"];
    let render = |more: &[&str]| {
        let mut arguments = vec!["render", "a.tvx", "--engine", "textured"];
        arguments.extend(camera);
        arguments.extend(more);
        json(at, &arguments)["scenes"][0].clone()
    };
    let auto = render(&["-o", "auto.png", "--aov", "depth,color", "--aa", "2"]);
    assert!(auto["pixels_drawn"].as_u64().unwrap() > 100);
    assert!(at.join("auto.depth.npy").exists());
    let zero = render(&["--erosion", "0", "--erosion-grid", "8"]);
    assert_eq!(zero["counters"]["grid"], 8);
    assert_eq!(zero["counters"]["primitives"], 0);
    let all = render(&["--erosion", "99", "--repeat", "2"]);
    assert_eq!(all["counters"]["primitives"], 242);
    assert_ne!(zero["hash"], all["hash"]);
    let turn = "turntable a.tvx --engine textured --frames 3 -o f#.png --size 48 --json -q --aa 2";
    let turned = json(at, &turn.split(' ').collect::<Vec<_>>());
    let frames = turned["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    assert_ne!(frames[0]["hash"], frames[1]["hash"]);
    assert!(frames[2]["counters"]["texel_px"].as_f64().unwrap() <= 1.0);
    assert!(at.join("f2.png").exists());
    // What was resolved draws the same picture.
    let record = ["--outdir", "run", "--erosion", "1", "--erosion-grid", "4"];
    let first = render(&record);
    let again = json(
        at,
        &["render", "--config", "run/config.toml", "--json", "--hash"],
    );
    assert_eq!(first["hash"], again["scenes"][0]["hash"]);
}

#[test]
fn what_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet()).unwrap();
    fs::write(at.join("empty.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    let converted = ["convert", "sheet.obj", "a.tvx", "-q"];
    shiftvox(at).args(converted).assert().success();
    // Nothing is replaced unasked.
    shiftvox(at).args(converted).assert().code(1);
    let bytes = fs::read(at.join("a.tvx")).unwrap();
    fs::write(at.join("short.tvx"), &bytes[..bytes.len() / 2]).unwrap();
    let mut damaged = bytes.clone();
    *damaged.last_mut().unwrap() ^= 1;
    fs::write(at.join("damaged.tvx"), damaged).unwrap();
    let cases = [
        ("convert sheet.obj x.tvx --grid 0", 2, "--grid"),
        ("convert sheet.obj x.tvx --grid 15", 2, "even"),
        ("convert sheet.obj x.tvx --grid 200", 2, "128"),
        ("convert sheet.obj x.tvx --grid 1000000000000", 2, "--grid"),
        ("convert sheet.obj x.tvx --grid 8,8", 2, "another number"),
        ("convert sheet.obj x.tvx --grid 128 --texels 64", 2, "4096"),
        ("convert sheet.obj x.tvx --texels 0", 2, "--texels"),
        ("convert sheet.obj x.tvx --memory 64M", 2, "--memory"),
        ("convert sheet.obj x.tvx --instances 4", 2, "--instances"),
        (
            "convert sheet.obj x.tvx --far-opacity six",
            2,
            "--far-opacity",
        ),
        ("convert sheet.obj x.vxg --texels 4", 2, "--texels"),
        ("convert sheet.obj x.far --grid 8,16", 2, "--grid"),
        ("convert empty.obj x.tvx", 4, "triangle"),
        ("convert none.obj x.tvx", 4, "none.obj"),
        ("info short.tvx", 4, "a file of"),
        ("info damaged.tvx", 4, "texels"),
        ("render a.tvx --engine fast --hash", 2, "--engine textured"),
        (
            "render damaged.tvx --engine textured --erosion 0 --hash",
            4,
            "byte",
        ),
        ("render sheet.obj --engine textured --hash", 4, "convert"),
        (
            "render a.tvx --engine textured --erosion=-1 --hash",
            2,
            "erosion",
        ),
        (
            "render a.tvx --engine textured --erosion 0 --erosion-grid 4 --hash",
            2,
            "grids of 16",
        ),
        (
            "render a.tvx --engine textured --aov node -o x.png",
            2,
            "--aov node",
        ),
    ];
    for (line, code, word) in cases {
        let output = shiftvox(at).args(line.split(' ')).assert().code(code);
        let output = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(output.contains(word), "{line}: {output}");
        assert!(!output.contains("panicked"), "{output}");
        for output in ["x.tvx", "x.vxg", "x.far", "x.png"] {
            assert!(!at.join(output).exists(), "{line}");
        }
    }
}
