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
