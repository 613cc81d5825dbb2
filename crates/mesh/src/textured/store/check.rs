//! Whether a grid makes sense: every field of every voxel, every entry of every list.

use super::format::GridEntry;
use crate::textured::CellGrid;
use crate::textured::levels::surfels;
use crate::textured::record::{CLEAR, NEVER, Primitive, VoxelRecord};

/// A fault: the part of the grid, the number of the record, and the expected value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) part: Part,
    pub(super) record: usize,
    pub(super) expected: String,
}

/// A part of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Voxels,
    Lists,
}

/// Checks a grid's entry, before any of the grid is read.
pub(super) fn check_entry(entry: &GridEntry) -> Result<(), &'static str> {
    let ensure = |holds: bool, expected| if holds { Ok(()) } else { Err(expected) };
    let is_possible = CellGrid::is_possible(entry.cells, entry.texels);
    ensure(
        is_possible,
        "an even number of cells up to 128, and texels up to 64",
    )?;
    ensure(entry.element <= 1, "a structuring element, 0 or 1")?;
    ensure(entry.spare == 0, "zero in the spare field")?;
    let cells = u64::from(entry.cells).pow(3);
    ensure(entry.voxels > 0, "voxels")?;
    ensure(entry.voxels <= cells, "no more voxels than cells")?;
    let is_numbered = entry.listed < u64::from(NEVER) && entry.textures < u64::from(CLEAR);
    ensure(
        is_numbered,
        "fewer than 2^32 listed primitives and sub-textures",
    )
}

/// Checks voxels and lists against each other and the number of primitives.
pub(super) fn check(
    entry: &GridEntry,
    voxels: &[VoxelRecord],
    lists: &[u32],
    primitives: usize,
) -> Result<(), Fault> {
    let fault = |part, record, expected: &str| {
        Err(Fault {
            part,
            record,
            expected: expected.to_owned(),
        })
    };
    let cells = entry.cells as u16;
    let place = |v: &VoxelRecord| (v.depth, v.cell[2], v.cell[1], v.cell[0]);
    let mut is_listed = vec![false; primitives];
    for (number, voxel) in voxels.iter().enumerate() {
        if voxel.cell.iter().any(|&c| c >= cells) || voxel.depth >= cells {
            return fault(Part::Voxels, number, "a cell and a depth within the grid");
        }
        if number > 0 && place(&voxels[number - 1]) >= place(voxel) {
            return fault(Part::Voxels, number, "voxels by rising depth and cell");
        }
        let end = voxels
            .get(number + 1)
            .map_or(lists.len(), |v| v.first as usize);
        let begin = voxel.first as usize;
        if begin >= end || end > lists.len() || number == 0 && begin != 0 {
            return fault(
                Part::Voxels,
                number,
                "a list after that of the voxel before",
            );
        }
        for (at, &primitive) in lists[begin..end].iter().enumerate() {
            let is_rising = at == 0 || lists[begin + at - 1] < primitive;
            if primitive as usize >= primitives || !is_rising {
                return fault(Part::Lists, begin + at, "primitives in rising order");
            }
            is_listed[primitive as usize] = true;
        }
    }
    if let Some(missing) = is_listed.iter().position(|listed| !listed) {
        let expected = format!("primitive {missing} in a list");
        return fault(Part::Lists, lists.len(), &expected);
    }
    let mut is_surfel = vec![[false; 3]; voxels.len()];
    for surfel in surfels(voxels, entry.cells) {
        is_surfel[surfel.voxel as usize][usize::from(surfel.axis)] = true;
    }
    for (number, (voxel, is_surfel)) in voxels.iter().zip(&is_surfel).enumerate() {
        for (&texture, is_surfel) in voxel.textures.iter().zip(is_surfel) {
            let is_sound = if *is_surfel {
                texture == CLEAR || u64::from(texture) < entry.textures
            } else {
                texture == NEVER
            };
            if !is_sound {
                return fault(
                    Part::Voxels,
                    number,
                    "a sub-texture for each face that is shown",
                );
            }
        }
    }
    Ok(())
}

/// Checks the primitives: within the box, which is no larger than they are.
pub(super) fn check_primitives(
    primitives: &[Primitive],
    low: glam::DVec3,
    high: glam::DVec3,
) -> Result<(), (usize, &'static str)> {
    for (number, primitive) in primitives.iter().enumerate() {
        let is_finite = primitive.corners.iter().flatten().all(|c| c.is_finite());
        if !is_finite || primitive.spare != 0 {
            return Err((number, "finite corners, and zero in the spare field"));
        }
    }
    // The box is that of the corners before they were rounded to single precision, which keeps their order.
    let rounded = [low, high].map(|corner| corner.as_vec3().as_dvec3());
    if crate::textured::build::bounds(primitives) != (rounded[0], rounded[1]) {
        return Err((0, "primitives that fill the box of the header"));
    }
    Ok(())
}
