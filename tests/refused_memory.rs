//! Pictures and scenes that do not fit in memory are the documented errors, never the end of the process.

#![cfg(all(target_os = "linux", feature = "png"))]

use std::process::Command;

use shiftvox::{Buffer, Camera, Coverage, Error, Renderer, Scene, Voxel};

const ALL: [Buffer; 5] = [
    Buffer::Depth,
    Buffer::Normal,
    Buffer::Voxel,
    Buffer::Node,
    Buffer::Records,
];
const MENGER: &str = "menger,depth=2";
/// Holds the side of a picture, in processes with a limit.
const SIDE: &str = "SHIFTVOX_LIMITED_SIDE";

/// Whether something fitted in memory.
fn fits<T>(made: Result<T, Error>) -> bool {
    match made {
        Ok(_) => true,
        Err(Error::Memory(_) | Error::Threads(_)) => false,
        Err(Error::Build(reason)) if reason.to_string().contains("bytes of memory") => false,
        Err(other) => panic!("{other:?}"),
    }
}

/// Makes large things of many kinds. Prints how many of them fitted, and how many did not.
fn attack(side: u32) {
    let scene = Scene::generate(MENGER).expect("a small scene");
    let folder = tempfile::tempdir().expect("a folder");
    let draw = |coverage, buffers: &[Buffer], samples, (width, height): (u32, u32)| {
        let renderer = Renderer::new()
            .threads(2)
            .coverage(coverage)
            .samples(samples);
        let renderer = renderer.buffers(buffers.iter().copied());
        let picture = renderer.render(
            &scene,
            &Camera::fit(&scene),
            width / samples,
            height / samples,
        );
        if let Ok(picture) = &picture {
            fits(picture.save_png(folder.path().join("a.png")));
            fits(picture.save_npy(Buffer::Color, folder.path().join("a.npy")));
        }
        fits(picture)
    };
    let index = |i: i32| [i & 0xff, i >> 8 & 0xff, i >> 16];
    let voxels = (0..side as i32 * 300).map(|i| Voxel {
        index: index(i),
        ..Voxel::default()
    });
    let square = (side, side);
    let fitted = [
        draw(Coverage::Exact, &[], 1, square),
        draw(Coverage::Exact, &[], 2, square),
        draw(Coverage::Exact, &ALL, 1, square),
        draw(Coverage::Alpha, &ALL[..2], 1, square),
        // Drawn by the machine, whose memory depends on the longer side alone.
        draw(Coverage::Any, &[], 1, (2 * side, 1)),
        draw(Coverage::Center, &ALL, 1, (2 * side, 1)),
        fits(Scene::from_voxels(voxels)),
    ];
    println!(
        "fits {}",
        fitted.map(|fits| u32::from(fits).to_string()).concat()
    );
}

/// Runs the test of this name again, in a process with so many kibibytes of addresses.
fn limited(test: &str, kibibytes: u32, side: u32) -> String {
    let output = Command::new("sh")
        .args([
            "-c",
            "ulimit -v \"$0\"; exec \"$@\"",
            &kibibytes.to_string(),
        ])
        .arg(std::env::current_exe().expect("this program"))
        .args(["--exact", test, "--nocapture", "--test-threads", "1"])
        .env(SIDE, side.to_string())
        // Otherwise each thread reserves 64 MB of addresses.
        .env("MALLOC_ARENA_MAX", "1")
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
}

#[test]
fn all_that_does_not_fit_is_an_error() {
    if let Ok(side) = std::env::var(SIDE) {
        return attack(side.parse().expect("a number"));
    }
    let name = "all_that_does_not_fit_is_an_error";
    let runs: Vec<String> = (24_000..=184_000)
        .step_by(20_000)
        .map(|kibibytes| limited(name, kibibytes, 1000))
        .collect();
    // Each kind is refused under the least limit, and fits under the highest.
    assert_eq!(
        [&runs[0][..], &runs[runs.len() - 1]],
        ["0000000", "1111111"],
        "{runs:?}"
    );
}

#[test]
fn the_least_memory_of_a_large_picture_is_told() {
    if std::env::var(SIDE).is_ok() {
        let scene = Scene::generate(MENGER).expect("a small scene");
        for coverage in [
            Coverage::Exact,
            Coverage::Any,
            Coverage::Center,
            Coverage::Alpha,
        ] {
            let renderer = Renderer::new().coverage(coverage).buffers(ALL);
            let drawn = renderer.render(&scene, &Camera::fit(&scene), 11_000, 11_000);
            let Err(Error::Memory(short)) = drawn else {
                panic!("{drawn:?}");
            };
            // 24 bytes per sample, and 32 per pixel.
            assert!(short.needed >= 11_000 * 11_000 * 56, "{short}");
        }
        println!("fits 0");
        return;
    }
    let name = "the_least_memory_of_a_large_picture_is_told";
    assert_eq!(limited(name, 6_000_000, 1), "0");
}
