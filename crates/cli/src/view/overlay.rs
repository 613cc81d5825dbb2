//! Buffers of a picture as colours, and their legends.

use std::collections::BTreeSet;

use shiftvox::drawing::Buffers;
use shiftvox::picture::npy::Values;
use shiftvox::picture::{Buffer, Rows};

use crate::error::CliError;

const NOTHING: [u8; 4] = [24, 26, 30, 255];

/// Colours of pixels, and of some values by their names.
pub(super) type Painted = (Vec<[u8; 4]>, Vec<(String, [u8; 4])>);

pub(super) fn colors(buffers: &Buffers<'_>, buffer: Buffer) -> Result<Painted, CliError> {
    let rows = 0..buffers.size().1;
    let values = buffers.rows(buffer, rows)?;
    Ok(match (buffer, values) {
        (Buffer::Records, Values::F32(records)) => {
            let (colors, most) = heat(&records);
            // The scale is logarithmic.
            let values = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| (1.0 + most).powf(share) - 1.0);
            let name = |value: f32| format!("{value:.1}");
            (colors, named(&values, heat(&values).0, name))
        }
        (Buffer::Depth, Values::F32(depths)) => depth(&depths),
        (Buffer::Normal, Values::F32(normals)) => (
            normals.as_chunks::<3>().0.iter().map(normal).collect(),
            AXES.map(|(name, axis)| (name.to_owned(), normal(&axis)))
                .to_vec(),
        ),
        (Buffer::Voxel, Values::I32(voxels)) => level(voxels.as_chunks::<4>().0),
        _ => return Err(CliError::usage("a page does not show this buffer")),
    })
}

fn named<T: Copy>(
    values: &[T],
    colors: Vec<[u8; 4]>,
    name: impl Fn(T) -> String,
) -> Vec<(String, [u8; 4])> {
    values
        .iter()
        .map(|&value| name(value))
        .zip(colors)
        .collect()
}

/// Colours from little to much: dark violet, blue, green, yellow.
const HEAT: [[f32; 3]; 5] = [
    [68.0, 1.0, 84.0],
    [59.0, 82.0, 139.0],
    [33.0, 145.0, 140.0],
    [94.0, 201.0, 98.0],
    [253.0, 231.0, 37.0],
];

/// Records by sample, as colours on a logarithmic scale, and the greatest
/// number. A record counts 1, spread evenly over its quadtree node's samples.
fn heat(records: &[f32]) -> (Vec<[u8; 4]>, f32) {
    let most = records.iter().copied().fold(0.0f32, f32::max);
    let scale = libm::log1pf(most).max(f32::MIN_POSITIVE);
    let pixels = records
        .iter()
        .map(|&count| heat_color(libm::log1pf(count) / scale));
    (pixels.collect(), most)
}

fn heat_color(share: f32) -> [u8; 4] {
    let place = share.clamp(0.0, 1.0) * (HEAT.len() - 1) as f32;
    let first = (place as usize).min(HEAT.len() - 2);
    let along = place - first as f32;
    let [r, g, b] = std::array::from_fn(|k| {
        let (from, to) = (HEAT[first][k], HEAT[first + 1][k]);
        libm::roundf(from + (to - from) * along) as u8
    });
    [r, g, b, 255]
}

const AXES: [(&str, [f32; 3]); 6] = [
    ("+x", [1.0, 0.0, 0.0]),
    ("-x", [-1.0, 0.0, 0.0]),
    ("+y", [0.0, 1.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("+z", [0.0, 0.0, 1.0]),
    ("-z", [0.0, 0.0, -1.0]),
];

fn depth(depths: &[f32]) -> Painted {
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
    let mut values = [0.0, 0.25, 0.5, 0.75, 1.0]
        .map(|share| near + share * (far - near))
        .to_vec();
    values.retain(|value| value.is_finite());
    let legend = values.iter().map(color).collect();
    let digits = 3usize.saturating_sub(libm::log10f(far.max(1.0)) as usize);
    (
        depths.iter().map(color).collect(),
        named(&values, legend, |value| format!("{value:.digits$}")),
    )
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

fn level(voxels: &[[i32; 4]]) -> Painted {
    let color = |&[_, _, _, level]: &[i32; 4]| match usize::try_from(level) {
        Ok(level) => LEVELS[level % LEVELS.len()],
        Err(_) => NOTHING,
    };
    let seen: BTreeSet<i32> = voxels.iter().map(|voxel| voxel[3]).collect();
    let seen = seen.into_iter().filter(|&level| level >= 0);
    (
        voxels.iter().map(color).collect(),
        seen.map(|level| (format!("level {level}"), color(&[0, 0, 0, level])))
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_is_dark_and_most_is_bright() {
        let (pixels, most) = heat(&[0.0, 3.0, 15.0]);
        // Half of the way: log 4 is half of log 16.
        let expected = [[68, 1, 84, 255], [33, 145, 140, 255], [253, 231, 37, 255]];
        assert_eq!((&pixels[..], most), (&expected[..], 15.0));
    }

    #[test]
    fn near_is_bright_and_nothing_is_dark() {
        let (colors, legend) = depth(&[f32::INFINITY, 2.0, 4.0]);
        assert_eq!(colors, [NOTHING, [255; 4], [55, 55, 55, 255]]);
        assert_eq!(legend[0], ("2.000".to_owned(), [255; 4]));
        assert_eq!(legend[4], ("4.000".to_owned(), [55, 55, 55, 255]));
        assert_eq!(depth(&[f32::INFINITY]).1, []);
        assert_eq!(normal(&[0.0, 0.0, 1.0]), [127, 127, 255, 255]);
        let (colors, legend) = level(&[[0, 0, 0, -1], [0, 0, 0, 3], [0, 0, 0, 4]]);
        assert_eq!(colors, [NOTHING, LEVELS[3], LEVELS[4]]);
        assert_eq!(
            legend,
            [
                ("level 3".to_owned(), LEVELS[3]),
                ("level 4".to_owned(), LEVELS[4])
            ]
        );
    }
}
