//! The program with meshes: commands, exit codes, messages.

use std::fs;
use std::path::Path;

use std::process::Command;

use super::shapes::squares;

use crate::common::Run;

fn shiftvox(folder: &Path) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command
}

const CUBE: &str = "v 0 0 0\nv 0 0 2\nv 0 2 0\nv 0 2 2\nv 2 0 0\nv 2 0 2\nv 2 2 0\nv 2 2 2\n\
    f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";

#[test]
fn every_format_is_told_by_content_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for (i, (name, _, bytes)) in squares().into_iter().enumerate() {
        let file = format!("scene{i}.dat");
        fs::write(folder.path().join(&file), bytes).unwrap();
        let output = shiftvox(folder.path())
            .args(["info", "--json", &file, "--depth", "4"])
            .assert()
            .success()
            .get_output()
            .stdout
            .clone();
        let document: serde_json::Value = serde_json::from_slice(&output).unwrap();
        let scene = &document["scenes"][0];
        assert_eq!(scene["mesh"]["triangles"], 2, "{name}");
        assert_eq!(scene["voxels"], 256, "{name}");
        // STL is customarily Z-up, all others Y-up.
        let camera = scene["camera"].as_str().unwrap();
        let up = camera.split("--up ").nth(1).unwrap();
        let up: Vec<f64> = up
            .split(' ')
            .next()
            .unwrap()
            .split(',')
            .map(|n| n.parse().unwrap())
            .collect();
        assert_eq!(up[2] > up[1], name.starts_with("stl"), "{name}: {camera}");
    }
}

#[test]
fn conversions_keep_the_place_and_do_not_depend_on_memory() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    for (output, more) in [
        ("a.vxg", &[][..]),
        ("b.vxg", &["--memory", "64M"][..]),
        ("c.vxg", &["--threads", "2"][..]),
    ] {
        shiftvox(folder.path())
            .args(["convert", "cube.obj", output, "--depth", "6", "-q"])
            .args(more)
            .assert()
            .success();
    }
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("a.vxg"), read("b.vxg"));
    assert_eq!(read("a.vxg"), read("c.vxg"));
    let graph = shiftvox::graph::vxg::open(&folder.path().join("a.vxg")).unwrap();
    assert_eq!(graph.voxels, 64 * 64 * 64 - 62 * 62 * 62);
    assert!((graph.placement.voxel_size - 2.0 / 63.0).abs() < 1e-12);
    assert!((graph.placement.world_origin[0] + 1.0 / 63.0).abs() < 1e-12);
}

#[test]
fn triangles_and_voxels_of_a_cube_are_nearly_one_picture() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    for line in [
        "render cube.obj -o a.png --depth 9 --aa 4 -q",
        "triangles cube.obj -o b.png --samples 16 --aov depth,coverage -q",
    ] {
        let camera = "--eye 5,4,6 --target 1,1,1 --up 0,1,0 --size 128";
        let words = line.split(' ').chain(camera.split(' '));
        shiftvox(folder.path()).args(words).assert().success();
    }
    let ok = shiftvox(folder.path())
        .args(["compare", "a.png", "b.png", "--threshold", "psnr_srgb=35"])
        .assert();
    ok.success();
    assert!(
        folder.path().join("b.depth.npy").exists() && folder.path().join("b.coverage.npy").exists()
    );
    // No overwriting, no other format.
    shiftvox(folder.path())
        .args(["triangles", "cube.obj", "-o", "b.png"])
        .assert()
        .failure();
    shiftvox(folder.path())
        .args(["triangles", "cube.obj", "-o", "b.jpg"])
        .assert()
        .code(2);
}

#[test]
fn bad_meshes_exit_with_4_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        (
            "range.obj",
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n",
            "range.obj: face at line 4: expected a corner from 1 to 3",
        ),
        (
            "empty.obj",
            "v 0 0 0\n",
            "empty.obj: mesh: expected at least one triangle",
        ),
        (
            "far.obj",
            "v 3e38 0 0\nv 3e38 1e-30 0\nv 3e38 0 1e-30\nf 1 2 3\n",
            "far.obj: the mesh spans",
        ),
        (
            "cut.stl",
            "solid a\nfacet normal 0 0 1\n",
            "cut.stl: triangle 1",
        ),
        // A binary one without most of its triangles, and without its count.
        (
            "binary.STL",
            &"\x07".repeat(200),
            "binary.STL: header at byte 80: expected 5895053234 bytes",
        ),
        (
            "short.stl",
            "binary",
            "short.stl: header at byte 0: expected 84 bytes",
        ),
    ];
    for (file, text, expected) in cases {
        fs::write(folder.path().join(file), text).unwrap();
        for verb in [
            &["convert", file, "out.vxg"][..],
            &["render", file, "-o", "out.png"],
            &["convert", file, "out.vxg", "--memory", "64M"],
        ] {
            let assert = shiftvox(folder.path()).args(verb).assert().code(4);
            let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
            assert!(stderr.contains(expected), "{stderr}");
            assert!(
                !folder.path().join("out.vxg").exists() && !folder.path().join("out.png").exists()
            );
        }
    }
    fs::write(folder.path().join("a.obj"), CUBE).unwrap();
    shiftvox(folder.path())
        .args(["info", "a.obj", "--depth", "21"])
        .assert()
        .code(2);
    fs::copy(
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/axes.vox"),
        folder.path().join("axes.vox"),
    )
    .unwrap();
    let assert = shiftvox(folder.path())
        .args(["triangles", "axes.vox", "-o", "x.png"])
        .assert()
        .code(4);
    let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(
        stderr.contains("axes.vox: this is a .vox file, which has no triangles"),
        "{stderr}"
    );
}
