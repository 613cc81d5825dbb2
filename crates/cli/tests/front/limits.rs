//! Too little memory, and files that never end: an error with figures and an exit code, never a killed process.
#![cfg(unix)]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::words;

/// Runs the program with so many MB of address space.
fn within(megabytes: u32, folder: &Path, line: &[&str]) -> Output {
    let limit = format!("ulimit -v {}; exec \"$0\" \"$@\"", megabytes << 10);
    Command::new("sh")
        .args(["-c", &limit])
        .arg(crate::common::program())
        .args(line)
        .args(["--threads", "2"])
        .current_dir(folder)
        .output()
        .unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A run that ends by itself within ten seconds.
fn patient(folder: &Path, line: &[&str]) -> Output {
    let mut child = Command::new(crate::common::program())
        .args(line)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > Duration::from_secs(10) {
            child.kill().unwrap();
            panic!("{line:?} waits");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap()
}

/// Want of memory is a limit (exit code 5), and no fault of a file.
#[test]
fn no_limit_of_memory_kills() {
    let folder = tempfile::tempdir().unwrap();
    for line in [
        "render gen:sphere,depth=2 --size 3000 --aov depth -o a.png",
        "convert gen:terrain,depth=9 a.vxg",
    ] {
        let made = patient(folder.path(), &words(line));
        assert!(made.status.success(), "{}", told(&made));
    }
    for (line, step, least_refused) in [
        (
            "render gen:terrain,depth=8 --size 1600 --hash --json",
            60,
            0,
        ),
        ("info gen:terrain,depth=9 --json", 60, 0),
        (
            "bench time gen:menger,depth=2 --runs 1 --size 512 --json",
            60,
            0,
        ),
        // A picture of nine million pixels takes more than any of these limits.
        ("compare a.png a.png --json", 30, 4),
        ("compare a.depth.npy a.depth.npy --json", 30, 1),
        ("render a.vxg --hash --json", 30, 0),
    ] {
        let mut refused = 0;
        for megabytes in (0..4).map(|i| 90 + i * step) {
            let output = within(megabytes, folder.path(), &words(line));
            let (code, told) = (output.status.code(), told(&output));
            assert!(
                matches!(code, Some(0 | 5)),
                "{line}, {megabytes} MB: {code:?} {told}"
            );
            let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(document["error"].is_string(), code == Some(5), "{document}");
            refused += u32::from(code == Some(5));
        }
        assert!(refused >= least_refused, "{line}: {refused}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_mapped_file_that_is_cut_short_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.vxg");
    let made = patient(folder.path(), &["convert", "gen:terrain,depth=7", "a.vxg"]);
    assert!(made.status.success(), "{}", told(&made));
    let child = Command::new(crate::common::program())
        .args("render a.vxg --repeat 1000000 --size 128 -o a.png --json".split(' '))
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    let maps = format!("/proc/{}/maps", child.id());
    while !fs::read_to_string(&maps)
        .unwrap_or_default()
        .contains("a.vxg")
    {
        assert!(started.elapsed() < Duration::from_secs(20), "never mapped");
    }
    std::thread::sleep(Duration::from_millis(200));
    fs::File::options()
        .write(true)
        .open(&file)
        .unwrap()
        .set_len(512)
        .unwrap();
    let output = child.wait_with_output().unwrap();
    let told = told(&output);
    assert_eq!(output.status.signal(), None, "{told}");
    assert_eq!(output.status.code(), Some(4), "{told}");
    assert!(
        told.contains("a.vxg: ") && told.contains("cut short"),
        "{told}"
    );
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["exit_code"], 4);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn meshes_of_endless_work_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let sheet = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    // A face that is a fan without end, in both formats that have faces of any length.
    let corners = 500_000;
    let indices = |from: usize| {
        (0..corners)
            .map(|i| (i % 3 + from).to_string() + " ")
            .collect::<String>()
    };
    fs::write(at("fan.obj"), format!("{sheet}f {}\n", indices(1))).unwrap();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n{corners} {}\n",
        indices(0)
    );
    fs::write(at("fan.ply"), ply).unwrap();
    for name in ["fan.obj", "fan.ply"] {
        let output = patient(folder.path(), &["info", name]);
        assert_eq!(output.status.code(), Some(5), "{}", told(&output));
        let told = told(&output);
        assert!(
            told.contains("500000") && told.contains("corners"),
            "{told}"
        );
    }
    // Triangles that repeat are looked at once, also in turn with others and in several colours.
    let three = ["f 1 2 3", "usemtl a\nf 1 2 3", "f 3 2 1"].join("\n") + "\n";
    fs::write(at("same.obj"), sheet.to_owned() + &three.repeat(40_000)).unwrap();
    let output = patient(folder.path(), &["info", "same.obj"]);
    assert!(output.status.success(), "{}", told(&output));
}

/// 60,000 nodes that show 40 triangles each: refused before they are made, with figures.
#[test]
fn the_triangles_of_a_gltf_are_counted_before_they_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let primitives = vec![r#"{"attributes":{"POSITION":0}}"#; 40].join(",");
    let nodes = vec![r#"{"mesh":0}"#; 60_000].join(",");
    // Corners of a triangle: nine floats.
    let corners: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect();
    fs::write(folder.path().join("a.bin"), &corners).unwrap();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"a.bin","byteLength":36}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "meshes":[{{"primitives":[{primitives}]}}],"nodes":[{nodes}]}}"#
    );
    fs::write(folder.path().join("a.gltf"), text).unwrap();
    let output = within(140, folder.path(), &["info", "a.gltf", "--depth", "4"]);
    let told = told(&output);
    assert_eq!(output.status.code(), Some(5), "{told}");
    assert!(
        told.contains("a.gltf: nodes") && told.contains("bytes of memory"),
        "{told}"
    );
}
