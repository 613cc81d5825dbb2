//! Names, files that belong together, terminals and full disks. (`cases/refused.txt` has the rest.)

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::common::{Assert, Run};
use std::process::Command;

use crate::program::{folder, run, stderr_of};

const SCENE: &str = "gen:sphere,depth=3";

#[test]
fn a_wrong_name_is_told_before_other_scenes_are_made() {
    let folder = folder();
    let list = "[[run]]\ntable = \"t\"\nsettings = \"default\"\nengines = [\"fast\"]\nsizes = [16]\n\
        scenes = [\"gen:terrain,depth=12\", \"gen:terrain,depth=3\"]\n";
    fs::write(folder.path().join("list.toml"), list).unwrap();
    let line = ["reproduce", "list.toml", "--outdir", "r"];
    let started = Instant::now();
    let assert = run(folder.path(), &line).code(4);
    assert!(stderr_of(&assert).contains("from 5 to 16"));
    assert!(
        started.elapsed() < Duration::from_secs(1),
        "{:?}",
        started.elapsed()
    );
}

#[cfg(unix)]
mod unix {

    use super::*;

    fn sh(folder: &Path, script: &str) -> Assert {
        let mut command = Command::new("sh");
        let program = crate::common::program();
        command
            .current_dir(folder)
            .args(["-c", script])
            .arg(program)
            .assert()
    }

    #[test]
    fn names_are_shown_escaped() {
        let folder = folder();
        let odd = "t\x1b[2J.vox";
        run(folder.path(), &["generate", SCENE, "-o", odd]).success();
        let told = run(
            folder.path(),
            &["render", odd, "--size", "16", "-o", "{stem}.png"],
        );
        assert!(!stderr_of(&told).contains('\x1b'), "{}", stderr_of(&told));
        assert!(folder.path().join("t\x1b[2J.png").exists());
        let missing = run(folder.path(), &["info", "\x1b[31mred.vox"]).code(4);
        assert!(
            !stderr_of(&missing).contains('\x1b'),
            "{}",
            stderr_of(&missing)
        );
    }

    #[test]
    fn a_picture_and_its_buffers_are_all_written_or_none() {
        let folder = folder();
        // The picture fits, its depths do not.
        let draw = "exec \"$0\" render gen:sphere,depth=3 --size 512 --aov depth -o a.png --force";
        let script = format!("trap '' XFSZ; ulimit -f 256; {draw}");
        sh(folder.path(), &script).code(1);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        // The signal of a file that is too large ends nothing either.
        let assert = sh(folder.path(), &format!("ulimit -f 256; {draw}")).code(1);
        assert!(stderr_of(&assert).contains("a."), "{}", stderr_of(&assert));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(folder.path().join("a.png"), b"old").unwrap();
        fs::write(folder.path().join("a.depth.npy"), b"old").unwrap();
        sh(folder.path(), &script).code(1);
        for name in ["a.png", "a.depth.npy"] {
            assert_eq!(fs::read(folder.path().join(name)).unwrap(), b"old");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    #[ignore = "needs the program `script`, which makes a terminal"]
    fn progress_is_for_terminals_that_can_draw_it() {
        let folder = folder();
        let drawn = |term: &str| {
            let line = "\"$PROGRAM\" convert gen:terrain,depth=8 a.vxg --force";
            let script = format!(
                "PROGRAM=\"$0\" TERM={term} SHELL=/bin/sh script -qec '{line}' /dev/null < /dev/null"
            );
            let assert = sh(folder.path(), &script).success();
            String::from_utf8_lossy(&assert.get_output().stdout).into_owned()
        };
        for term in ["", "dumb"] {
            let told = drawn(term);
            assert!(
                told.contains("voxels") && !told.contains(['\x1b', '%']),
                "{told:?}"
            );
        }
        assert!(drawn("xterm").contains('%'));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told_by_help_too() {
        let folder = folder();
        for line in [
            "--help",
            "render --help",
            "--version",
            "man",
            "info gen:sphere,depth=2",
        ] {
            sh(folder.path(), &format!("exec \"$0\" {line} > /dev/full")).code(1);
        }
        sh(folder.path(), "\"$0\" --help | true").success();
    }
}
