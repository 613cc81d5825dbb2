//! `.tvx` files: round trips, truncation, damage, contents that make no sense.

use std::fs;

use shiftvox::graph::Silent;
use shiftvox::scene::{FileKind, detect};
use shiftvox_mesh::textured::record::{CLEAR, NEVER};
use shiftvox_mesh::textured::store::encode;
use shiftvox_mesh::textured::{
    BuildError, BuildOptions, Element, TexturedData, TexturedError, TexturedFile, build,
};
use shiftvox_mesh::{Mesh, Surface, Triangle};

use super::scenes::{balls, file_of, mesh_of};
use super::shared::on_threads;

fn small() -> TexturedData {
    let options = BuildOptions {
        grids: vec![4, 2],
        texels: 2,
        element: Element::Cube,
    };
    let mesh = mesh_of(&[
        [[0.0, 0.0, 0.0], [4.0, 0.0, 1.0], [0.0, 4.0, 2.0]],
        [[4.0, 4.0, 4.0], [4.0, 0.0, 1.0], [0.0, 4.0, 2.0]],
        [[0.5, 0.5, 3.5], [0.7, 0.5, 3.5], [0.6, 0.9, 0.2]],
    ]);
    build(&mesh.unwrap(), &options, &Silent).unwrap()
}

#[test]
fn files_hold_what_was_built() {
    let data = small();
    let file = file_of(&data);
    file.verify().unwrap();
    assert_eq!(file.bounds(), (data.low, data.high));
    assert_eq!(file.primitives(), data.primitives);
    assert_eq!(file.grids(), 2);
    for (number, built) in data.grids.iter().enumerate() {
        let grid = file.grid(number);
        assert_eq!(grid.voxels(), built.voxels);
        assert_eq!(grid.cell_grid().cells(), built.cells);
        assert_eq!(grid.projected(), [built.projected, built.projected_afresh]);
        for texture in 0..grid.textures() {
            let at = texture as usize * 4;
            assert_eq!(grid.texture(texture as u32), &built.textures[at..at + 4]);
        }
    }
    assert_eq!([data.grids[0].cells, data.grids[1].cells], [2, 4]);
    // Mapped as well as held.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tvx");
    fs::write(&path, encode(&data).unwrap()).unwrap();
    let mapped = TexturedFile::open(&path).unwrap();
    assert_eq!(mapped.len(), fs::metadata(&path).unwrap().len());
    mapped.verify().unwrap();
    fs::write(&path, b"").unwrap();
    assert!(TexturedFile::open(&path).is_err());
    assert!(TexturedFile::open(folder.path()).is_err());
    assert!(TexturedFile::open(&folder.path().join("none.tvx")).is_err());
}

#[test]
fn truncated_and_damaged_files_are_refused() {
    let bytes = encode(&small()).unwrap();
    assert_eq!(detect(&bytes, bytes.len() as u64), Some(FileKind::Tvx));
    for length in 0..bytes.len() {
        let error = TexturedFile::from_bytes(&bytes[..length]).unwrap_err();
        let is_placed = matches!(error, TexturedError::Malformed { .. });
        assert!(is_placed, "{length}: {error}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(TexturedFile::from_bytes(&longer).is_err());
    for at in 0..bytes.len() {
        for flip in [1, 0x80] {
            let mut damaged = bytes.clone();
            damaged[at] ^= flip;
            let read = TexturedFile::from_bytes(&damaged).and_then(|file| file.verify());
            let Err(error) = read else {
                panic!("byte {at} is not looked at");
            };
            assert!(error.to_string().contains("byte"), "{error}");
        }
    }
}

/// Damage under checksums that fit: what a program that writes nonsense would write.
#[test]
fn contents_that_make_no_sense_are_refused() {
    type Harm = fn(&mut TexturedData);
    let harms: [(&str, Harm); 17] = [
        ("a primitive that is not there", |d| {
            d.grids[0].lists[0] = 99
        }),
        ("lists that do not rise", |d| d.grids[1].lists.reverse()),
        ("a primitive in no list", |d| {
            let more = d.primitives[0];
            d.primitives.push(more);
        }),
        ("a cell outside", |d| d.grids[1].voxels[0].cell[2] = 4),
        ("a voxel twice", |d| {
            d.grids[1].voxels[1] = d.grids[1].voxels[0]
        }),
        ("voxels out of order", |d| d.grids[1].voxels.swap(0, 1)),
        ("a list beyond the end", |d| {
            d.grids[0].voxels[1].first = u32::MAX;
        }),
        ("a first list that is not the first", |d| {
            d.grids[0].voxels[0].first = 1;
        }),
        ("a sub-texture that is not there", |d| {
            let voxels = d.grids[0].voxels.iter_mut();
            let mut faces = voxels.flat_map(|v| &mut v.textures);
            *faces.find(|t| **t < CLEAR).unwrap() = 1000;
        }),
        ("a face without sub-texture", |d| {
            let voxels = d.grids[0].voxels.iter_mut();
            let mut faces = voxels.flat_map(|v| &mut v.textures);
            *faces.find(|t| **t != NEVER).unwrap() = NEVER;
        }),
        ("a texel half transparent", |d| {
            d.grids[0].textures[0].opacity = 7;
        }),
        ("a texel without normal", |d| {
            let mut texels = d.grids[0].textures.iter_mut();
            texels.find(|t| t.opacity == 255).unwrap().normal = 0;
        }),
        ("another depth", |d| {
            let voxels = &mut d.grids[1].voxels;
            voxels.last_mut().unwrap().depth += 1;
        }),
        ("a corner that is no number", |d| {
            d.primitives[0].corners[1][2] = f32::NAN;
        }),
        ("a larger box", |d| d.high.x += 1.0),
        ("an odd grid", |d| d.grids[1].cells = 5),
        ("grids from fine to coarse", |d| d.grids.reverse()),
    ];
    for (name, harm) in harms {
        let mut data = small();
        harm(&mut data);
        let bytes = encode(&data).unwrap();
        let read = TexturedFile::from_bytes(&bytes).and_then(|file| file.verify());
        assert!(read.is_err(), "{name}");
    }
    let mut empty = small();
    empty.grids.clear();
    assert!(TexturedFile::from_bytes(&encode(&empty).unwrap()).is_err());
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let mesh = balls();
    let options = BuildOptions {
        grids: vec![4, 10, 16],
        texels: 5,
        element: Element::Cube,
    };
    let bytes = [1, 2, 3].map(|threads| {
        on_threads(threads, || {
            encode(&build(&mesh, &options, &Silent).unwrap())
        })
    });
    let [one, two, three] = bytes.map(Result::unwrap);
    assert!(one == two && two == three);
}

/// A surface without triangles.
struct Nothing;

impl Surface for Nothing {
    fn len(&self) -> usize {
        0
    }

    fn corners(&self, _: usize) -> [glam::DVec3; 3] {
        [glam::DVec3::ZERO; 3]
    }

    fn triangle(&self, _: usize) -> Triangle {
        unreachable!("there are none")
    }

    fn bounds(&self) -> (glam::DVec3, glam::DVec3) {
        (glam::DVec3::INFINITY, glam::DVec3::NEG_INFINITY)
    }
}

#[test]
fn what_cannot_be_built() {
    let mesh: Mesh = balls();
    let with = |grids: &[u32], texels: u32| {
        let options = BuildOptions {
            grids: grids.to_vec(),
            texels,
            element: Element::Cube,
        };
        build(&mesh, &options, &Silent).map(|_| ())
    };
    for cells in [0, 1, 3, 15, 130, u32::MAX] {
        assert_eq!(
            with(&[cells], 16),
            Err(BuildError::Grid { cells, texels: 16 })
        );
    }
    for texels in [0, 65, u32::MAX] {
        assert_eq!(
            with(&[4], texels),
            Err(BuildError::Grid { cells: 4, texels })
        );
    }
    assert!(with(&[128], 64).is_err());
    assert_eq!(with(&[], 4), Err(BuildError::Grids));
    assert_eq!(with(&[4, 4], 4), Err(BuildError::Grids));
    let nothing = build(&Nothing, &BuildOptions::default(), &Silent);
    assert_eq!(nothing.unwrap_err(), BuildError::Empty);
}

#[test]
fn flat_and_far_off_meshes_are_built() {
    let sheet = |at: f32, size: f32| {
        let far = at + size;
        let corners = [[at, at, at], [far, at, at], [far, far, at], [at, far, at]];
        mesh_of(&[
            [corners[0], corners[1], corners[2]],
            [corners[0], corners[2], corners[3]],
        ])
    };
    for (at, size) in [(0.0, 1.0), (1e6, 4.0), (-1e30, 1e29), (0.0, 1e-30)] {
        let data = build(&sheet(at, size).unwrap(), &BuildOptions::default(), &Silent).unwrap();
        let file = file_of(&data);
        file.verify().unwrap();
        let rows = file.grid(0).levels().rows();
        // The sheet lies on the middle plane, in cells on both sides of it.
        assert_eq!(rows[0].voxels, 512, "{at} {size}");
        assert_eq!(rows[0].surfels, 256);
    }
}
