//! Pictures and scenes that do not fit in memory are the documented errors, never the end of the process.

#![cfg(all(target_os = "linux", feature = "png"))]

use std::process::Command;

use shiftvox::{Buffer, Camera, Coverage, Error, Renderer, Scene, Voxel};

const ALL: [Buffer; 4] = [Buffer::Depth, Buffer::Normal, Buffer::Voxel, Buffer::Node];
/// Holds the side of a picture, in processes with a limit.
const SIDE: &str = "SHIFTVOX_LIMITED_SIDE";

/// 1 if something fitted in memory, otherwise 0.
fn fits<T>(made: Result<T, Error>) -> u8 {
    match made {
        Ok(_) => 1,
        Err(Error::Memory(_) | Error::Threads(_)) => 0,
        Err(Error::Build(reason)) if reason.to_string().contains("bytes of memory") => 0,
        Err(other) => panic!("{other:?}"),
    }
}

/// Makes large things of many kinds, and prints which of them fitted.
fn attack(side: u32) {
    let scene = Scene::generate("menger,depth=2").expect("a small scene");
    let folder = tempfile::tempdir().expect("a folder");
    let draw = |coverage, buffers: &[Buffer], samples, (width, height): (u32, u32)| {
        let renderer = Renderer::new().threads(2).coverage(coverage);
        let renderer = renderer.samples(samples).buffers(buffers.iter().copied());
        let camera = Camera::fit(&scene);
        let picture = renderer.render(&scene, &camera, width / samples, height / samples);
        if let Ok(picture) = &picture {
            fits(picture.save_png(folder.path().join("a.png")));
            fits(picture.save_npy(Buffer::Color, folder.path().join("a.npy")));
        }
        fits(picture)
    };
    let square = (side, side);
    let large = [
        draw(Coverage::Exact, &ALL, 1, square),
        draw(Coverage::Alpha, &ALL[..2], 1, square),
    ];
    if side > 10_000 {
        return println!("fits {large:?}");
    }
    let others = [
        // The machine's memory depends on the longer side alone.
        draw(Coverage::Any, &ALL, 1, (2 * side, side / 1000)),
        draw(Coverage::Exact, &[], 2, square),
        fits(Scene::from_voxels((0..side as i32 * 300).map(|i| Voxel {
            index: [i & 0xff, i >> 8 & 0xff, i >> 16],
            ..Voxel::default()
        }))),
    ];
    println!("fits {large:?} {others:?}");
}

#[test]
fn all_that_does_not_fit_is_an_error() {
    if let Ok(side) = std::env::var(SIDE) {
        return attack(side.parse().expect("a number"));
    }
    let limited = |kibibytes: u32, side: u32| {
        let output = Command::new("sh")
            .args([
                "-c",
                "ulimit -v \"$0\"; exec \"$@\"",
                &kibibytes.to_string(),
            ])
            .arg(std::env::current_exe().expect("this program"))
            .args(["--nocapture", "--test-threads", "1"])
            .env(SIDE, side.to_string())
            // Otherwise each thread reserves 64 MB of addresses.
            .env("MALLOC_ARENA_MAX", "1")
            .env("RAYON_NUM_THREADS", "2")
            .output()
            .expect("a shell");
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success(),
            "{kibibytes} KiB: {}: {told}",
            output.status
        );
        let printed = String::from_utf8(output.stdout).expect("text");
        let (_, fitted) = printed.split_once("fits ").expect("a line");
        fitted.lines().next().expect("a line").to_owned()
    };
    let limits = (24_000..=184_000).step_by(20_000);
    let runs: Vec<_> = limits.map(|kibibytes| limited(kibibytes, 1000)).collect();
    assert!(runs[0].starts_with("[0, 0]"), "{runs:?}");
    assert_eq!(runs[8], "[1, 1] [1, 1, 1]");
    assert_eq!(limited(6_000_000, 11_000), "[0, 0]");
}
