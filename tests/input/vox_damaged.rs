//! `.vox` files that are wrong, too large or cut short: messages say where, and nothing panics.

use crate::input_support::{VoxFile, message, read, read_damaged, read_plain, shipped};
use crate::vox_written::{THREE, places, two_places};
use shiftvox::scene::ReadOptions;

#[test]
fn messages_say_where_and_what() {
    let good = two_places(&[], &[]).bytes();
    let claims = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        message(&bytes)
    };
    let cases = [
        (
            message(&good[..good.len() - 5]),
            "test: chunk \"MAIN\" at byte 8: expected 0 bytes of content and",
        ),
        (
            message(b"VOX "),
            "test: file header at byte 0: expected \"VOX \" and a version (8 bytes), found \"VOX \"",
        ),
        (
            claims(24, 4_000_000_000),
            "chunk \"SIZE\" at byte 20: expected 4000000000 bytes of content",
        ),
        (
            claims(56, 77),
            "chunk XYZI at byte 56: expected a number of voxels that fits the chunk, at most 1, found 77",
        ),
        (
            message(&VoxFile::new().bytes()),
            "expected at least one model",
        ),
        (
            message(&VoxFile::new().chunk(b"XYZI", &[0; 4]).bytes()),
            "a chunk SIZE before each XYZI",
        ),
        (
            message(&VoxFile::new().chunk(b"SIZE", &[0; 12]).bytes()),
            "a chunk XYZI after each SIZE",
        ),
        (
            message(&VoxFile::new().chunk(b"SIZE", &[0; 8]).bytes()),
            "4 bytes of the size along z, found 0 bytes left",
        ),
        (
            message(&two_places(&[("_r", "3")], &[]).bytes()),
            "chunk nTRN (node 2), attribute _r",
        ),
        (
            message(&two_places(&[("_r", "5")], &[]).bytes()),
            "two different axes of 0, 1, 2, bits 4-6 signs, found 5",
        ),
        (
            message(&two_places(&[("_t", "1 2")], &[]).bytes()),
            "three whole numbers of 32 bits, found \"1 2\"",
        ),
        (
            message(&two_places(&[("_t", "1 2 3 4")], &[]).bytes()),
            "found \"1 2 3 4\"",
        ),
        (
            message(&two_places(&[], &[]).shape(6, &[]).group(6, &[]).bytes()),
            "the id of the chunk nSHP (node 6)",
        ),
    ];
    for (text, part) in cases {
        assert!(text.contains(part), "\n{text}\nlacks\n{part}");
    }
}

#[test]
fn broken_scene_graphs_are_refused() {
    let model = || VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]]);
    let circle = model().transform(0, &[], 1, -1, &[&[]]).group(1, &[0]);
    assert!(message(&circle.bytes()).contains("without circles, found node 0"));
    let itself = model().group(0, &[0]);
    assert!(message(&itself.bytes()).contains("chunk nGRP (node 0)"));
    let orphan = model().transform(0, &[], 7, -1, &[&[]]);
    assert!(message(&orphan.bytes()).contains("a node with id 7"));
    let rootless = model().shape(3, &[(0, &[])]);
    assert!(message(&rootless.bytes()).contains("the root has id 0"));
    let wrong_model = model().shape(0, &[(1, &[])]);
    let text = message(&wrong_model.bytes());
    assert!(
        text.contains("chunk nSHP (node 0) at byte") && text.contains("found model 1"),
        "{text}"
    );
}

#[test]
fn shared_nodes_are_fine_until_they_multiply() {
    let tower = |floors: u32| {
        let mut file = VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]]);
        for floor in 0..floors {
            file = file.group(floor, &[floor + 1, floor + 1]);
        }
        file.shape(floors, &[(0, &[])]).bytes()
    };
    // All at one place, so that they are read once.
    assert_eq!(read_plain(&tower(5)).len(), 1);
    let (_, info) = read(&tower(5), &ReadOptions::default()).unwrap();
    assert_eq!(info.instances, 32);
    let text = message(&tower(40));
    assert!(text.contains("at most 1048576 placed nodes"), "{text}");
}

#[test]
fn far_scenes_are_refused_as_too_large() {
    let at = |first: &str, second: &str| {
        let file = two_places(&[("_t", first)], &[("_t", second)]);
        read(&file.bytes(), &ReadOptions::default()).map(|(voxels, _)| voxels.len())
    };
    assert_eq!(at("-1048575 0 0", "1048575 0 0").unwrap(), 2);
    for (first, second, part) in [
        ("-1048576 0 0", "1048576 0 0", "at least 2097153 along x"),
        ("2147483647 0 0", "0 0 0", "x = 2147483648"),
    ] {
        let error = at(first, second).unwrap_err();
        assert!(
            error.is_limit() && error.to_string().contains(part),
            "{error}"
        );
    }
}

#[test]
fn deep_scenes_do_not_exhaust_the_stack() {
    let mut file = VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]]);
    for id in 0..20_000 {
        file = file.transform(id, &[], id + 1, -1, &[&[("_t", "1 0 0")]]);
    }
    assert_eq!(
        places(&file.shape(20_000, &[(0, &[])]), &ReadOptions::default()),
        [[20_000, 0, 0]]
    );
}

#[test]
fn every_truncation_is_an_error() {
    let file = two_places(&[("_t", "1 2 3")], &[("_r", "17")])
        .layer(0, &[])
        .palette(&THREE)
        .bytes();
    let read = |bytes: &[u8]| read(bytes, &ReadOptions::default());
    assert!(read(&file).is_ok());
    for length in 0..file.len() {
        assert!(read(&file[..length]).is_err(), "{length}");
        // The main chunk is made to fit, so that what it holds is cut and not the chunk itself.
        if length >= 20 {
            let mut bytes = file[..length].to_vec();
            bytes[16..20].copy_from_slice(&(length as u32 - 20).to_le_bytes());
            let _ = read(&bytes);
        }
    }
}

#[test]
fn damage_never_panics() {
    let seeds = [
        two_places(&[("_t", "1 2 3")], &[("_r", "17")])
            .layer(0, &[])
            .palette(&THREE)
            .bytes(),
        shipped("sphere.vox"),
        shipped("extended.vox")[19_676..].to_vec(),
    ];
    let mut seed_of_nodes = VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]]).bytes();
    seed_of_nodes.extend(&seeds[2]);
    let length = seed_of_nodes.len() as u32 - 20;
    seed_of_nodes[16..20].copy_from_slice(&length.to_le_bytes());
    for (file, rounds) in [
        (&seeds[0], 40_000),
        (&seeds[1], 4_000),
        (&seed_of_nodes, 4_000),
    ] {
        read_damaged(file, rounds);
    }
}
