//! Buffers of a picture as colours.

use std::ops::Range;

use shiftvox::drawing::Buffers;
use shiftvox::picture::npy::Values;
use shiftvox::picture::{Buffer, Rows};
use shiftvox_lab::model::heat;

use crate::error::CliError;

const NOTHING: [u8; 4] = [24, 26, 30, 255];

pub(super) type Painted = (Vec<[u8; 4]>, Option<Range<f64>>);

pub(super) fn colors(buffers: &Buffers<'_>, buffer: Buffer) -> Result<Painted, CliError> {
    let rows = 0..buffers.size().1;
    let values = buffers.rows(buffer, rows)?;
    Ok(match (buffer, values) {
        (Buffer::Records, Values::F32(records)) => {
            let (colors, most) = heat::colors(&records);
            (colors, Some(0.0..f64::from(most)))
        }
        (Buffer::Depth, Values::F32(depths)) => depth(&depths),
        (Buffer::Normal, Values::F32(normals)) => (
            normals.as_chunks::<3>().0.iter().map(normal).collect(),
            None,
        ),
        (Buffer::Voxel, Values::I32(voxels)) => level(voxels.as_chunks::<4>().0),
        _ => return Err(CliError::usage("a page does not show this buffer")),
    })
}

fn depth(depths: &[f32]) -> (Vec<[u8; 4]>, Option<Range<f64>>) {
    let seen = || depths.iter().copied().filter(|depth| depth.is_finite());
    let (near, far) = (
        seen().fold(f32::INFINITY, f32::min),
        seen().fold(0.0, f32::max),
    );
    let span = (far - near).max(f32::MIN_POSITIVE);
    let color = |&depth: &f32| {
        if !depth.is_finite() {
            return NOTHING;
        }
        let grey = (255.0 - 200.0 * (depth - near) / span) as u8;
        [grey, grey, grey, 255]
    };
    let ends = near.is_finite().then(|| f64::from(near)..f64::from(far));
    (depths.iter().map(color).collect(), ends)
}

/// A direction's coordinates as red, green and blue, -1 dark and 1 bright.
fn normal(normal: &[f32; 3]) -> [u8; 4] {
    if *normal == [0.0; 3] {
        return NOTHING;
    }
    let [red, green, blue] = normal.map(|at| (127.5 + 127.5 * at) as u8);
    [red, green, blue, 255]
}

const LEVELS: [[u8; 4]; 8] = [
    [230, 97, 1, 255],
    [94, 60, 153, 255],
    [253, 184, 99, 255],
    [27, 120, 55, 255],
    [178, 171, 210, 255],
    [166, 219, 160, 255],
    [215, 48, 39, 255],
    [69, 117, 180, 255],
];

fn level(voxels: &[[i32; 4]]) -> (Vec<[u8; 4]>, Option<Range<f64>>) {
    let color = |voxel: &[i32; 4]| match usize::try_from(voxel[3]) {
        Ok(level) => LEVELS[level % LEVELS.len()],
        Err(_) => NOTHING,
    };
    let seen = || {
        voxels
            .iter()
            .map(|voxel| voxel[3])
            .filter(|&level| level >= 0)
    };
    let ends = seen().min().zip(seen().max());
    (
        voxels.iter().map(color).collect(),
        ends.map(|(low, high)| f64::from(low)..f64::from(high)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_bright_and_nothing_is_dark() {
        let (colors, ends) = depth(&[f32::INFINITY, 2.0, 4.0]);
        assert_eq!(colors, [NOTHING, [255; 4], [55, 55, 55, 255]]);
        assert_eq!(ends, Some(2.0..4.0));
        assert_eq!(depth(&[f32::INFINITY]).1, None);
        assert_eq!(normal(&[0.0, 0.0, 1.0]), [127, 127, 255, 255]);
        let (colors, ends) = level(&[[0, 0, 0, -1], [0, 0, 0, 3], [0, 0, 0, 4]]);
        assert_eq!(colors, [NOTHING, LEVELS[3], LEVELS[4]]);
        assert_eq!(ends, Some(3.0..4.0));
    }
}
