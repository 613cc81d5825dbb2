//! Writes a PLY cloud: binary, little endian, one vertex per voxel.

use std::io::{self, Seek, SeekFrom, Write};

use crate::graph::{PackedNormal, Voxel};

const COUNT_DIGITS: usize = 20;

/// Writes voxels in the given order and returns their number. With `normals`, `float` normals follow, zero for none.
/// The count is written into the header last, so `out` must be at its beginning.
pub fn write_ply<W: Write + Seek>(
    out: &mut W,
    voxels: impl IntoIterator<Item = Voxel>,
    normals: bool,
) -> io::Result<u64> {
    let begin = b"ply\nformat binary_little_endian 1.0\ncomment voxel indices: a vertex (i, j, k) is the cell from i to i + 1 along each axis\n";
    out.write_all(begin)?;
    out.write_all(&count_lines(0))?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property int {axis}")?;
    }
    for channel in ["red", "green", "blue"] {
        writeln!(out, "property uchar {channel}")?;
    }
    if normals {
        for axis in ["nx", "ny", "nz"] {
            writeln!(out, "property float {axis}")?;
        }
    }
    out.write_all(b"end_header\n")?;
    let mut count = 0u64;
    for voxel in voxels {
        let mut row = [0u8; 27];
        for axis in 0..3 {
            row[4 * axis..][..4].copy_from_slice(&voxel.index[axis].to_le_bytes());
        }
        row[12..15].copy_from_slice(&voxel.color);
        let mut length = 15;
        if normals {
            let normal = voxel
                .normal
                .and_then(PackedNormal::decode)
                .unwrap_or_default();
            for axis in 0..3 {
                row[15 + 4 * axis..][..4].copy_from_slice(&(normal[axis] as f32).to_le_bytes());
            }
            length = 27;
        }
        out.write_all(&row[..length])?;
        count += 1;
    }
    out.seek(SeekFrom::Start(begin.len() as u64))?;
    out.write_all(&count_lines(count))?;
    out.seek(SeekFrom::End(0))?;
    out.flush()?;
    Ok(count)
}

fn count_lines(count: u64) -> Vec<u8> {
    let count = count.to_string();
    let filler = "-".repeat(COUNT_DIGITS - count.len());
    format!("element vertex {count}\ncomment {filler}-\n").into_bytes()
}
