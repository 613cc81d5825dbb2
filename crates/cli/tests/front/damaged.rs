//! Damaged files, whose faults only readers of all bytes find.

use std::fs;

use shiftvox::graph::{Silent, vxg};
use shiftvox::scene::{NoMeshes, OpenOptions, Source, open_source};
use xxhash_rust::xxh3::xxh3_64;

use crate::program::Folder;

/// Writes a number into a header of so many bytes, whose last eight are its checksum.
fn patched(bytes: &[u8], header: usize, at: usize, number: [u8; 8]) -> Vec<u8> {
    let mut bytes = bytes.to_owned();
    bytes[at..at + 8].copy_from_slice(&number);
    let sum = xxh3_64(&bytes[..header - 8]).to_le_bytes();
    bytes[header - 8..header].copy_from_slice(&sum);
    bytes
}

#[test]
fn a_place_that_cannot_be_drawn_is_the_files_fault() {
    let folder = Folder::new();
    folder.put(
        "sheet.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n",
    );
    // Voxel size, origin, and both corners of the mesh; origins and sizes of the others.
    let formats: [(&str, usize, &[usize]); 3] = [
        ("vxg", 512, &[88, 64, 448, 480]),
        ("far", 128, &[48, 56]),
        ("tvx", 128, &[32, 64]),
    ];
    for (ending, header, fields) in formats {
        let name = format!("sheet.{ending}");
        folder.run(&format!("convert sheet.obj {name}"), 0);
        let sound = folder.get(&name);
        let odd = [1e120, f64::NAN, f64::INFINITY];
        for (at, odd) in fields.iter().flat_map(|at| odd.map(|odd| (at, odd))) {
            folder.put(&name, patched(&sound, header, *at, f64::to_le_bytes(odd)));
            for line in ["render --size 16 --hash", "info"] {
                let [_, told] = folder.run(&format!("{line} {name}"), 4);
                let place = told.contains(&name) && told.contains("header, byte");
                assert!(place, "{line} {name} {at} {odd}: {told}");
            }
        }
    }
}

#[test]
fn who_reads_all_of_a_graph_checks_all_of_it_at_any_size() {
    let folder = Folder::new();
    folder.run("generate gen:menger,depth=2 -o a.vxg", 0);
    let (path, sound) = (folder.at("a.vxg"), folder.get("a.vxg"));
    let open = |verify_up_to| {
        let options = OpenOptions {
            verify_up_to,
            ..OpenOptions::default()
        };
        open_source(Source::find(&path).unwrap(), &options, &NoMeshes, &Silent)
    };
    assert!(open(sound.len() as u64).unwrap().is_verified);
    assert!(!open(sound.len() as u64 - 1).unwrap().is_verified);
    // A damaged byte of the last section, and a count that is not that of the voxels, under a right checksum.
    let mut damaged = sound.clone();
    damaged[sound.len() - 1] ^= 1;
    for bytes in [damaged, patched(&sound, 512, 32, 401u64.to_le_bytes())] {
        fs::write(&path, bytes).unwrap();
        assert!(vxg::open(&path).is_ok(), "found without reading");
        assert!(!open(0).unwrap().is_verified);
        open(u64::MAX).unwrap_err();
        for line in ["info a.vxg", "convert a.vxg b.ply", "convert a.vxg b.vxg"] {
            let [_, told] = folder.run(line, 4);
            assert!(told.contains("a.vxg: section"), "{told}");
        }
    }
    assert_eq!(folder.names(), ["a.vxg"]);
}
