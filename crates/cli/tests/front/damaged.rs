//! Files whose checksums are right and whose contents are not: the file and its field are to blame, whatever is done
//! with it.

use std::fs;

use shiftvox::graph::{Silent, vxg};
use shiftvox::scene::{NoMeshes, OpenOptions, Source, open_source};
use xxhash_rust::xxh3::xxh3_64;

use crate::program::{run, stderr_of};

/// Writes a number into a header of so many bytes, whose last eight are its checksum.
fn patch(bytes: &mut [u8], header: usize, at: usize, number: [u8; 8]) {
    bytes[at..at + 8].copy_from_slice(&number);
    let sum = xxh3_64(&bytes[..header - 8]).to_le_bytes();
    bytes[header - 8..header].copy_from_slice(&sum);
}

#[test]
fn a_place_that_cannot_be_drawn_is_the_files_fault() {
    let folder = tempfile::tempdir().unwrap();
    let sheet = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n";
    fs::write(folder.path().join("sheet.obj"), sheet).unwrap();
    // Ending, bytes of the header, and where a place is in it.
    let (voxel_size, origin, mesh_low, mesh_high) = (88, 64, 448, 480);
    let formats: [(&str, usize, &[usize]); 3] = [
        ("vxg", 512, &[voxel_size, origin, mesh_low, mesh_high]),
        ("far", 128, &[48, 56]),
        ("tvx", 128, &[32, 64]),
    ];
    for (ending, header, fields) in formats {
        let sound = format!("sheet.{ending}");
        run(folder.path(), &["convert", "sheet.obj", &sound]).success();
        let sound = fs::read(folder.path().join(&sound)).unwrap();
        for at in fields {
            for odd in [1e308, -1e300, 1e120, f64::NAN, f64::INFINITY] {
                let mut bytes = sound.clone();
                patch(&mut bytes, header, *at, odd.to_le_bytes());
                let name = format!("odd.{ending}");
                fs::write(folder.path().join(&name), bytes).unwrap();
                let drawn = run(folder.path(), &["render", &name, "--size", "16", "--hash"]);
                let told = stderr_of(&drawn);
                drawn.code(4);
                let place = told.contains(&name) && told.contains("header, byte");
                assert!(place, "{ending} {at} {odd}: {told}");
                run(folder.path(), &["info", &name]).code(4);
            }
        }
    }
}

#[test]
fn who_reads_all_of_a_graph_checks_all_of_it_at_any_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vxg");
    run(
        folder.path(),
        &["generate", "gen:menger,depth=2", "-o", "a.vxg"],
    )
    .success();
    let sound = fs::read(&path).unwrap();
    let open = |verify_up_to| {
        let options = OpenOptions {
            verify_up_to,
            ..OpenOptions::default()
        };
        open_source(Source::find(&path).unwrap(), &options, &NoMeshes, &Silent)
    };
    assert!(open(sound.len() as u64).unwrap().is_verified);
    assert!(!open(sound.len() as u64 - 1).unwrap().is_verified);
    // A damaged byte of the last section.
    let mut damaged = sound.clone();
    damaged[sound.len() - 1] ^= 1;
    // A count that is not that of the voxels, under a right checksum.
    let mut counted = sound.clone();
    patch(&mut counted, 512, 32, 401u64.to_le_bytes());
    for bytes in [damaged, counted] {
        fs::write(&path, bytes).unwrap();
        assert!(vxg::open(&path).is_ok(), "found without reading");
        assert!(!open(0).unwrap().is_verified);
        open(u64::MAX).unwrap_err();
        for line in [
            &["info", "a.vxg"][..],
            &["convert", "a.vxg", "b.ply"],
            &["convert", "a.vxg", "b.vxg"],
        ] {
            let assert = run(folder.path(), line).code(4);
            let told = stderr_of(&assert);
            assert!(told.contains("a.vxg: section"), "{told}");
        }
    }
    assert!(!folder.path().join("b.ply").exists());
}
