//! Disks with too little room: told with figures before the work, where the need is known; also on a system that cannot
//! make such a disk for a test, which then asks for more than any has.
#![cfg(unix)]

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Runs the program in an empty folder on a disk of 1 MB; the names of the files afterwards. `None` where the system
/// does not let a test mount one.
fn on_small_disk(line: &str) -> Option<(Output, String)> {
    let folder = tempfile::tempdir().unwrap();
    let mount = "mount -t tmpfs -o size=1m none \"$PWD\" && cd \"$PWD\"";
    let can = Command::new("unshare")
        .args(["-m", "sh", "-c", mount])
        .current_dir(folder.path())
        .stderr(Stdio::null())
        .status();
    if !can.is_ok_and(|status| status.success()) {
        eprintln!("skipped: a test may not mount here");
        return None;
    }
    let script = format!("{mount} || exit 99; \"$0\" \"$@\"; code=$?; ls -A >&2; exit $code");
    let output = Command::new("unshare")
        .args(["-m", "sh", "-c", &script])
        .arg(crate::common::program())
        .args(line.split_whitespace())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    Some((output, told))
}

#[test]
fn what_takes_more_disk_than_there_is_is_refused_before_the_work() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let (tree, knot) = (root.join("assets/tree.vox"), root.join("assets/knot.obj"));
    let (tree, knot) = (tree.display(), knot.display());
    let lines = [
        // A terrain of 4^12 columns would take a minute to make.
        "convert gen:terrain,depth=12 a.vxg --memory 64M".to_owned(),
        format!("convert {tree} a.vxg --memory 64M"),
        format!("convert {knot} a.vxg --depth 13 --memory 64M"),
        "render gen:terrain,depth=5 -o a.png --size 1024 --aov depth".to_owned(),
        "turntable gen:terrain,depth=5 -o ##.png --frames 90 --size 128 --aov voxel".to_owned(),
        // Known as soon as it is built.
        "generate gen:terrain,depth=9 -o a.vxg".to_owned(),
        "convert gen:terrain,depth=8 a.ply".to_owned(),
    ];
    for line in lines {
        let Some((output, told)) = on_small_disk(&line) else {
            return;
        };
        assert_eq!(output.status.code(), Some(5), "{line}: {told}");
        assert!(
            told.contains(" bytes of disk are needed, and ") && told.contains(" are free"),
            "{line}: {told}"
        );
        assert!(
            !told.contains("a.vxg\n") && !told.contains(".tmp\n"),
            "{line}: {told}"
        );
    }
    // What fits is written.
    if let Some((output, told)) = on_small_disk("generate gen:terrain,depth=6 -o a.vxg") {
        assert!(output.status.success() && told.contains("a.vxg"), "{told}");
    }
}
