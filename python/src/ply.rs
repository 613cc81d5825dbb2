//! Meshes from arrays, as a file that the library reads.

use pyo3::prelude::*;

use crate::Error;

pub(crate) fn ply(
    positions: &[[f64; 3]],
    colors: &[[u8; 3]],
    triangles: &[[i64; 3]],
) -> PyResult<Vec<u8>> {
    if triangles.is_empty() {
        return Err(Error::new_err("triangles: there are none"));
    }
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n\
         property list uchar uint vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    for (position, color) in positions.iter().zip(colors) {
        bytes.extend(position.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(color);
    }
    for (number, triangle) in triangles.iter().enumerate() {
        bytes.push(3);
        for &corner in triangle {
            let is_there = usize::try_from(corner).is_ok_and(|c| c < positions.len());
            let corner = u32::try_from(corner).ok().filter(|_| is_there);
            let corner = corner.ok_or_else(|| {
                Error::new_err(format!(
                    "triangles: row {number} has a corner that is no row of positions"
                ))
            })?;
            bytes.extend(corner.to_le_bytes());
        }
    }
    Ok(bytes)
}
