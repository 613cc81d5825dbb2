//! Writes small seed files for the targets `far` and `tvx` into corpus/; run in fuzz/.
//!
//! The program builds each from a few triangles. A first byte selects what the target does with it, in at most 4 kB.

#[allow(dead_code)]
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod sealed;

use std::error::Error;
use std::fs;

use shiftvox_mesh::far::view::Opacity;
use shiftvox::graph::Silent;
use shiftvox_mesh::{LoadOptions, Mesh, MeshFormat, Nothing, read};
use shiftvox_mesh::{far, textured};

/// Two squares and a thin spike.
const OBJ: &str = "v 0 0 0\nv 4 0 1\nv 4 4 2\nv 0 4 1\nv 1 1 5\nv 1.2 1 5\nv 3 3 9\nv 0 0 3\nv 4 0 3\nv 4 4 3\nv 0 4 3\n\
                   f 1 2 3 4\nf 5 6 7\nf 8 9 10 11\n";

fn mesh(obj: &str) -> Result<Mesh, Box<dyn Error>> {
    Ok(read(obj.as_bytes(), MeshFormat::Obj, "seed", &Nothing, &LoadOptions::default(), &Silent)?)
}

fn store(target: &str, name: &str, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
    assert!(bytes.len() < 4096, "{target} {name}: {} bytes", bytes.len());
    println!("{target} {name}: {} bytes", bytes.len());
    fs::create_dir_all(format!("corpus/{target}"))?;
    for choice in [0u8, 1, 2, 6, 10, 74] {
        fs::write(format!("corpus/{target}/{name}_{choice}"), [&[choice], bytes].concat())?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = mesh(OBJ)?;
    for (name, grid, leaf_triangles, opacity) in [
        ("leaf", 4, 1000, Opacity::Six),
        ("six", 4, 3, Opacity::Six),
        ("one", 5, 4, Opacity::Scalar),
        ("none", 3, 2, Opacity::None),
    ] {
        let options = far::BuildOptions {
            grid,
            leaf_triangles,
            opacity,
            ..far::BuildOptions::default()
        };
        let data = far::build(&mesh, &options, &Silent)?;
        let bytes = far::store::encode(&data)?;
        // Sealing does not change a correct file.
        assert_eq!(sealed::far(bytes.clone(), true).as_ref(), Some(&bytes));
        store("far", name, &bytes)?;
    }
    for (name, grids, texels, element) in [
        ("one", vec![2], 1, textured::Element::Sides),
        ("two", vec![2, 4], 2, textured::Element::Cube),
        ("fine", vec![4], 1, textured::Element::Sides),
    ] {
        let options = textured::BuildOptions { grids, texels, element };
        let data = textured::build(&mesh, &options, &Silent)?;
        let bytes = textured::store::encode(&data)?;
        assert_eq!(sealed::tvx(bytes.clone(), true).as_ref(), Some(&bytes));
        store("tvx", name, &bytes)?;
    }
    Ok(())
}
