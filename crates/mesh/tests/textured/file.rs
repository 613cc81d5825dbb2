//! Refused contents of `.tvx` files, and refused options.

use shiftvox::graph::Silent;
use shiftvox_mesh::Instances;
use shiftvox_mesh::far::record::Paint;
use shiftvox_mesh::textured::record::{CLEAR, NEVER};
use shiftvox_mesh::textured::store::encode;
use shiftvox_mesh::textured::{
    BuildError, BuildOptions, Element, TexturedData, TexturedError, TexturedFile, build,
};

use super::scenes::{balls, file_of, mesh_of, options, rectangle};

fn small() -> TexturedData {
    let mesh = mesh_of(&[
        [[0.0, 0.0, 0.0], [4.0, 0.0, 1.0], [0.0, 4.0, 2.0]],
        [[4.0, 4.0, 4.0], [4.0, 0.0, 1.0], [0.0, 4.0, 2.0]],
        [[0.5, 0.5, 3.5], [0.7, 0.5, 3.5], [0.6, 0.9, 0.2]],
    ]);
    build(&mesh.unwrap(), &options(&[4, 2], 2, Element::Cube), &Silent).unwrap()
}

fn is_refused(bytes: &[u8]) -> bool {
    match TexturedFile::from_bytes(bytes).and_then(|file| file.verify()) {
        Ok(()) => false,
        Err(TexturedError::Malformed { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

/// The first sub-texture of a face with a number below another.
fn face(data: &mut TexturedData, below: u32) -> &mut u32 {
    let faces = data.grids[0].voxels.iter_mut();
    let mut faces = faces.flat_map(|v| &mut v.textures);
    faces.find(|texture| **texture < below).unwrap()
}

#[test]
fn inconsistent_contents_are_refused() {
    type Harm = fn(&mut TexturedData);
    let harms: [Harm; 20] = [
        // Primitives: missing, falling, in no list, no number, and a larger box.
        |d| d.grids[0].lists[0] = 99,
        |d| d.grids[1].lists.reverse(),
        |d| d.primitives.extend_from_within(..1),
        |d| d.primitives[0].corners[1][2] = f32::NAN,
        |d| d.high.x += 1.0,
        // Voxels: outside, twice, out of order, of another depth, with lists that end or begin late.
        |d| d.grids[1].voxels[0].cell[2] = 4,
        |d| d.grids[1].voxels[1] = d.grids[1].voxels[0],
        |d| d.grids[1].voxels.swap(0, 1),
        |d| d.grids[1].voxels.last_mut().unwrap().depth += 1,
        |d| d.grids[0].voxels[1].first = u32::MAX,
        |d| d.grids[0].voxels[0].first = 1,
        // A sub-texture that is missing, or none. A texel that is half transparent, or without a normal.
        |d| *face(d, CLEAR) = 1000,
        |d| *face(d, NEVER) = NEVER,
        |d| d.grids[0].textures[0].opacity = 7,
        |d| {
            let mut texels = d.grids[0].textures.iter_mut();
            texels.find(|t| t.opacity == 255).unwrap().normal = 0;
        },
        // A paint too few, and one with a texture that is missing.
        |d| d.paints = vec![Paint::NONE; 2],
        |d| {
            let texture = 0;
            d.paints = vec![
                Paint {
                    texture,
                    ..Paint::NONE
                };
                3
            ];
        },
        // Grids: odd, from fine to coarse, none.
        |d| d.grids[1].cells = 5,
        |d| d.grids.reverse(),
        |d| d.grids.clear(),
    ];
    for (number, harm) in harms.into_iter().enumerate() {
        let mut data = small();
        harm(&mut data);
        assert!(is_refused(&encode(&data).unwrap()), "{number}");
    }
}

#[test]
fn invalid_options_are_refused() {
    let mesh = balls();
    let grid = |cells, texels| BuildError::Grid { cells, texels };
    for (grids, texels, error) in [
        (&[0][..], 16, grid(0, 16)),
        (&[130], 16, grid(130, 16)),
        (&[4], 0, grid(4, 0)),
        (&[4], 65, grid(4, 65)),
        (&[], 4, BuildError::Grids),
    ] {
        let refused = build(&mesh, &options(grids, texels, Element::Cube), &Silent);
        assert_eq!(refused.err(), Some(error));
    }
    let far = mesh_of(&rectangle(0.0, [1e6; 2], [1e6 + 4.0; 2])).unwrap();
    let refused = build(&far, &BuildOptions::default(), &Silent);
    assert!(matches!(refused, Err(BuildError::FarAway { .. })));
    let nothing = Instances::new(mesh, Vec::new());
    let refused = build(&nothing, &BuildOptions::default(), &Silent);
    assert_eq!(refused.err(), Some(BuildError::Empty));
}

#[test]
fn flat_and_distant_meshes_are_built() {
    for (at, size) in [(0.0, 1.0), (1e4, 4.0), (-1e30, 1e29), (0.0, 1e-30)] {
        let mesh = mesh_of(&rectangle(at, [at; 2], [at + size; 2])).unwrap();
        let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
        file.verify().unwrap();
        let row = file.grid(0).levels().row(0);
        // The sheet lies on the middle plane, in cells on both sides of it.
        assert_eq!((row.voxels, row.surfels), (512, 256), "{at} {size}");
    }
}
