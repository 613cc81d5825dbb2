//! An `.obj` with its `.mtl`, a `.ply` or an `.stl`: a mesh or an error, and voxels of a small mesh.

use shiftvox::graph::Silent;
use shiftvox_mesh::voxelize::{Grid, voxelize};
use shiftvox_mesh::{ColorSpace, MeshFormat, read};

pub(crate) fn run(format: MeshFormat, before: &[u8], bytes: &[u8]) {
    // A line of one `%` ends the mesh and begins the material library.
    let cut = bytes.windows(3).position(|w| w == b"\n%\n").unwrap_or(bytes.len());
    let library = bytes.get(cut + 3..).unwrap_or_default();
    let file = [before, &bytes[..cut]].concat();
    // Every other file is the library.
    let beside = |_: &str| Ok(library.to_vec());
    if let Ok(mesh) = read(&file, format, "fuzz", &beside, ColorSpace::default(), &Silent) {
        assert!(mesh.triangles().iter().flatten().all(|&i| (i as usize) < mesh.positions().len()));
        if let Ok(grid) = Grid::around(&mesh, 3) {
            let mut count = 0;
            let report = voxelize(&mesh, &grid, false, &mut |_| count += 1, &Silent);
            assert!(count > 0 && report.voxels == count);
        }
    }
}
