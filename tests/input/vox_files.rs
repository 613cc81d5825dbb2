//! Real `.vox` files: counts, positions, palettes, twins, and agreement with `dot_vox`.

#![allow(clippy::unwrap_used, reason = "test helpers may panic")]

use std::collections::BTreeSet;

use crate::input_support::{Plain, VoxFile, read, read_plain, shared, shipped};
use dot_vox::{DotVoxData, Rotation, SceneNode};
use shiftvox::graph::Silent;
use shiftvox::scene::{OutOfBounds, ReadOptions, SceneError, read_voxels};

/// Files of VoxelShop and their voxels.
const VOXELSHOP: [(&str, u64); 5] = [
    ("black", 14_208),
    ("castle", 2_628),
    ("church", 10_182),
    ("clock", 1_728),
    ("dragon", 40_265),
];

/// Stored voxels, voxels that are passed on, different indices, models, nodes.
fn counts(bytes: &[u8]) -> [u64; 5] {
    let (_, info) = read(bytes, &ReadOptions::default()).unwrap();
    let indices: BTreeSet<_> = read_plain(bytes).iter().map(|v| v.0).collect();
    let distinct = indices.len() as u64;
    let [models, nodes] = [info.models, info.nodes].map(u64::from);
    [info.stored_voxels, info.voxels, distinct, models, nodes]
}

#[test]
fn real_files_have_their_voxels_and_agree_with_dot_vox() {
    let tree = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/tree.vox");
    for (name, bytes, expected) in [
        ("sphere", shipped("sphere.vox"), [2_103, 2_103, 2_103, 1, 0]),
        ("axes", shipped("axes.vox"), [4_372, 12_452, 12_452, 4, 28]),
        (
            "extended",
            shipped("extended.vox"),
            [4_854, 4_854, 4_854, 6, 14],
        ),
        (
            "tree",
            std::fs::read(tree).unwrap(),
            [428_739, 804_872, 768_068, 2, 8],
        ),
    ] {
        assert_eq!(counts(&bytes), expected, "{name}");
        agree(name, &bytes);
    }
}

/// Compares a file with what `dot_vox` reads.
fn agree(name: &str, bytes: &[u8]) {
    let data = dot_vox::load_bytes(bytes).unwrap();
    assert!(read_plain(bytes) == by_dot_vox(&data), "{name}");
    let (_, info) = read(bytes, &ReadOptions::default()).unwrap();
    let palette = data.palette.iter().take(255);
    let palette: Vec<[u8; 4]> = palette.map(|c| [c.r, c.g, c.b, c.a]).collect();
    assert_eq!(info.palette, palette, "{name}");
    assert_eq!(info.nodes as usize, data.scenes.len(), "{name}");
}

/// Voxels outside `SIZE` are where the twin, which fits its `SIZE`, has them.
#[test]
#[ignore = "needs the files of SHIFTVOX_DATA"]
fn voxelshop_files_equal_their_twins() {
    let at_origin = |bytes: &[u8]| {
        let mut voxels = read_plain(bytes);
        for axis in 0..3 {
            let low = voxels.iter().map(|(index, _)| index[axis]).min().unwrap();
            voxels.iter_mut().for_each(|(index, _)| index[axis] -= low);
        }
        voxels.sort_unstable();
        voxels
    };
    for (name, voxels) in VOXELSHOP {
        let [wrapped, twin] = ["bb", "size"]
            .map(|folder| shared(&format!("vox/voxelshop/fit_to_{folder}/{name}.vox")));
        for bytes in [&wrapped, &twin] {
            assert_eq!(counts(bytes), [voxels, voxels, voxels, 1, 0], "{name}");
        }
        assert_eq!(at_origin(&wrapped), at_origin(&twin), "{name}");
        agree(name, &twin);
    }
}

/// A model of VoxelShop's kind: bytes outside `SIZE` mean numbers below 0.
#[test]
fn voxels_outside_the_size_by_every_rule() {
    let file = VoxFile::new().model(
        [20, 20, 90],
        &[[0, 19, 88, 1], [203, 72, 0, 1], [238, 0, 5, 1]],
    );
    let by = |oob| {
        let options = ReadOptions {
            oob,
            ..ReadOptions::default()
        };
        read(&file.bytes(), &options).map(|(_, info)| (info.voxels, info.outside_size, info.bounds))
    };
    let bounds = |low, high| Some((low, high));
    let expected = [
        (OutOfBounds::Wrap, (3, 2, bounds([-53, 0, 0], [0, 72, 88]))),
        (OutOfBounds::Keep, (3, 2, bounds([0, 0, 0], [238, 72, 88]))),
        (OutOfBounds::Drop, (1, 2, bounds([0, 19, 88], [0, 19, 88]))),
    ];
    for (oob, expected) in expected {
        assert_eq!(by(oob).unwrap(), expected, "{oob:?}");
    }
    let refused = by(OutOfBounds::Error).unwrap_err().to_string();
    assert!(
        refused.contains("SIZE [20, 20, 90]") && refused.contains("wrap, keep or drop"),
        "{refused}"
    );
}

#[test]
fn an_unknown_file_is_refused_by_its_first_bytes() {
    let error = read(b"DOOD is not a voxel", &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, SceneError::Unknown { .. }));
    let text = error.to_string();
    assert!(
        text.contains("test: not a known scene file: it begins with \"DOOD"),
        "{text}"
    );
}

#[test]
fn a_file_reads_as_its_bytes_do() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/axes.vox");
    let mut voxels = Vec::new();
    let mut sink = |v: shiftvox::graph::Voxel| voxels.push((v.index, v.color));
    read_voxels(&path, &ReadOptions::default(), &mut sink, &Silent).unwrap();
    assert_eq!(voxels, read_plain(&shipped("axes.vox")));
}

#[test]
fn a_missing_file_is_no_fault_of_its_content() {
    let path = std::path::Path::new("/nowhere/at all.vox");
    let error = read_voxels(path, &ReadOptions::default(), &mut |_| (), &Silent).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("/nowhere/at all.vox: cannot open the file: ")
    );
    assert!(matches!(error, SceneError::Io { .. }));
}

/// All voxels of a file as `dot_vox` and floating point place them.
fn by_dot_vox(data: &DotVoxData) -> Vec<Plain> {
    let mut voxels = Vec::new();
    if data.scenes.is_empty() {
        for model in &data.models {
            for v in &model.voxels {
                let c = data.palette[usize::from(v.i)];
                voxels.push(([v.x, v.y, v.z].map(i32::from), [c.r, c.g, c.b]));
            }
        }
    } else {
        walk(data, 0, Rotation::IDENTITY, [0.0; 3], &mut voxels);
    }
    voxels
}

fn turn(rotation: Rotation, v: [f32; 3]) -> [f32; 3] {
    let columns = rotation.to_cols_array_2d();
    [0, 1, 2].map(|row| (0..3).map(|column| columns[column][row] * v[column]).sum())
}

fn walk(data: &DotVoxData, node: u32, rotation: Rotation, at: [f32; 3], out: &mut Vec<Plain>) {
    match &data.scenes[node as usize] {
        SceneNode::Transform { frames, child, .. } => {
            let frame = &frames[0];
            let moved = frame
                .position()
                .map_or([0.0; 3], |p| [p.x as f32, p.y as f32, p.z as f32]);
            let moved = turn(rotation, moved);
            let inner = frame.orientation().unwrap_or(Rotation::IDENTITY);
            let at = [0, 1, 2].map(|a| at[a] + moved[a]);
            walk(data, *child, rotation * inner, at, out);
        }
        SceneNode::Group { children, .. } => {
            for child in children {
                walk(data, *child, rotation, at, out);
            }
        }
        SceneNode::Shape { models, .. } => {
            let model = &data.models[models[0].model_id as usize];
            let pivot = [model.size.x / 2, model.size.y / 2, model.size.z / 2];
            for v in &model.voxels {
                let p = [v.x, v.y, v.z];
                let p = [0, 1, 2].map(|a| f32::from(p[a]) + 0.5 - pivot[a] as f32);
                let p = turn(rotation, p);
                let c = data.palette[usize::from(v.i)];
                let index = [0, 1, 2].map(|a| (p[a] + at[a]).floor() as i32);
                out.push((index, [c.r, c.g, c.b]));
            }
        }
    }
}
