//! Any bytes as `.obj` with `.mtl`, `.ply` or `.stl`: a mesh or an error, and voxels of a small mesh.
#![no_main]

use std::io;

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox_mesh::voxelize::{Grid, voxelize};
use shiftvox_mesh::{Beside, LoadOptions, MeshFormat, read};

/// Every other file is the rest of the input.
struct Rest<'a>(&'a [u8]);

impl Beside for Rest<'_> {
    fn read(&self, _name: &str) -> io::Result<Vec<u8>> {
        Ok(self.0.to_vec())
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let (format, before): (_, &[u8]) = match choice % 4 {
        0 => (MeshFormat::Obj, b"mtllib a\n"),
        1 => (MeshFormat::Ply, b"ply\n"),
        2 => (MeshFormat::Stl, b"solid "),
        _ => (MeshFormat::Stl, b""),
    };
    // A line of one `%` ends the mesh and begins the material library.
    let cut = rest.windows(3).position(|w| w == b"\n%\n").unwrap_or(rest.len());
    let library = rest.get(cut + 3..).unwrap_or_default();
    let file = [before, &rest[..cut]].concat();
    if let Ok(mesh) = read(&file, format, "fuzz", &Rest(library), &LoadOptions::default(), &Silent) {
        assert!(mesh.triangles().iter().flatten().all(|&i| (i as usize) < mesh.positions().len()));
        if let Ok(grid) = Grid::around(&mesh, 3) {
            let mut count = 0;
            let report = voxelize(&mesh, &grid, &mut |_| count += 1, &Silent);
            assert!(count > 0 && report.voxels == count);
        }
    }
});
