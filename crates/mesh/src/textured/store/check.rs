//! Whether a grid makes sense: every field of every voxel, every entry of every list.

use glam::DVec3;

use super::format::GridEntry;
use crate::textured::CellGrid;
use crate::textured::build::bounds;
use crate::textured::levels::surfels;
use crate::textured::record::{CLEAR, NEVER, Primitive, VoxelRecord};

pub(super) fn check_entry(entry: &GridEntry) -> Result<(), &'static str> {
    let cells = u64::from(entry.cells).saturating_pow(3);
    let rules = [
        (
            CellGrid::is_possible(entry.cells, entry.texels),
            "an even number of cells up to 128, and texels up to 64",
        ),
        (entry.element <= 1, "a structuring element, 0 or 1"),
        (entry.spare == 0, "zero in the spare field"),
        (entry.voxels > 0, "voxels"),
        (entry.voxels <= cells, "no more voxels than cells"),
        (
            entry.listed < u64::from(NEVER) && entry.textures < u64::from(CLEAR),
            "fewer than 2^32 listed primitives and sub-textures",
        ),
    ];
    let broken = rules.into_iter().find(|(holds, _)| !holds);
    broken.map_or(Ok(()), |(_, expected)| Err(expected))
}

/// Checks voxels and lists against each other and the number of primitives. Errors: section, record, expected value.
pub(super) fn check(
    entry: &GridEntry,
    voxels: &[VoxelRecord],
    lists: &[u32],
    primitives: usize,
) -> Result<(), (&'static str, usize, String)> {
    let fault = |section, record, expected: &str| Err((section, record, expected.to_owned()));
    let cells = entry.cells as u16;
    let place = |v: &VoxelRecord| (v.depth, v.cell[2], v.cell[1], v.cell[0]);
    let mut is_listed = vec![false; primitives];
    for (number, voxel) in voxels.iter().enumerate() {
        if voxel.cell.iter().any(|&c| c >= cells) || voxel.depth >= cells {
            return fault("voxels", number, "a cell and a depth within the grid");
        }
        if number > 0 && place(&voxels[number - 1]) >= place(voxel) {
            return fault("voxels", number, "voxels by rising depth and cell");
        }
        let next = voxels.get(number + 1);
        let end = next.map_or(lists.len(), |v| v.first as usize);
        let begin = voxel.first as usize;
        if begin >= end || end > lists.len() || number == 0 && begin != 0 {
            return fault("voxels", number, "a list after that of the voxel before");
        }
        for (at, &primitive) in lists[begin..end].iter().enumerate() {
            let is_rising = at == 0 || lists[begin + at - 1] < primitive;
            if primitive as usize >= primitives || !is_rising {
                return fault("lists", begin + at, "primitives in rising order");
            }
            is_listed[primitive as usize] = true;
        }
    }
    if let Some(missing) = is_listed.iter().position(|listed| !listed) {
        let expected = format!("primitive {missing} in a list");
        return fault("lists", lists.len(), &expected);
    }
    let mut is_surfel = vec![[false; 3]; voxels.len()];
    for surfel in surfels(voxels, entry.cells) {
        is_surfel[surfel.voxel as usize][usize::from(surfel.axis)] = true;
    }
    let is_sound = |number: usize| {
        let mut faces = voxels[number].textures.iter().zip(is_surfel[number]);
        faces.all(|(&texture, is_surfel)| match is_surfel {
            true => texture == CLEAR || u64::from(texture) < entry.textures,
            false => texture == NEVER,
        })
    };
    match (0..voxels.len()).find(|&number| !is_sound(number)) {
        Some(number) => fault("voxels", number, "a sub-texture for each shown face"),
        None => Ok(()),
    }
}

/// Checks the primitives, and that the box is no larger than they are. Errors: record, expected value.
pub(super) fn check_primitives(
    primitives: &[Primitive],
    (low, high): (DVec3, DVec3),
) -> Result<(), (usize, &'static str)> {
    let is_sound =
        |p: &Primitive| p.spare == 0 && p.corners.as_flattened().iter().all(|c| c.is_finite());
    if let Some(number) = primitives.iter().position(|p| !is_sound(p)) {
        return Err((number, "finite corners, and zero in the spare field"));
    }
    // The box is that of the corners before they were rounded to single precision, which keeps their order.
    let rounded = |corner: DVec3| corner.as_vec3().as_dvec3();
    if bounds(primitives) != (rounded(low), rounded(high)) {
        return Err((0, "primitives that fill the box of the header"));
    }
    Ok(())
}
