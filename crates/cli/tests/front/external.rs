//! `convert --memory`: a graph file that is built out of core.

use std::fs;
use std::path::Path;

fn shiftvox(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = crate::common::command();
    command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn convert_builds_within_a_limit_of_memory() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "gen:terrain,depth=7";
    let plain = shiftvox(folder.path(), &["convert", scene, "plain.vxg"]);
    assert!(plain.status.success());
    let limited: &[&str] = &["convert", scene, "limited.vxg", "--memory", "64M", "--json"];
    let found = shiftvox(folder.path(), limited);
    assert!(found.status.success());
    let document: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    assert_eq!(document["schema"], "shiftvox.convert");
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("limited.vxg") == read("plain.vxg"));
    let wrong: [(&[&str], i32); 5] = [
        (limited, 1),
        (&["convert", scene, "a.ply", "--memory", "1G"], 2),
        (&["convert", scene, "a.vxg", "--memory", "1M"], 2),
        (&["convert", scene, "a.vxg", "--temp", "."], 2),
        (
            &[
                "convert",
                scene,
                "a.vxg",
                "--memory",
                "1G",
                "--temp",
                "no/folder",
            ],
            1,
        ),
    ];
    for (arguments, code) in wrong {
        let found = shiftvox(folder.path(), arguments);
        assert_eq!(found.status.code(), Some(code), "{arguments:?}");
        assert!(!found.stderr.is_empty(), "{arguments:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}
