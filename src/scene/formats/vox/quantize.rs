//! A palette for any number of colours: all of them if they fit, else by median cut.
//!
//! The order of the colours does not matter, so equal scenes give equal files.

use std::collections::BTreeMap;

pub(super) const MAX_COLORS: usize = 255;

type Counted = ([u8; 3], u64);

/// A palette of at most [`MAX_COLORS`], and the 1-based index of every colour of `histogram`.
pub(super) fn palette(histogram: &BTreeMap<[u8; 3], u64>) -> (Vec<[u8; 3]>, BTreeMap<[u8; 3], u8>) {
    let mut boxes = vec![
        histogram
            .iter()
            .map(|(c, n)| (*c, *n))
            .collect::<Vec<Counted>>(),
    ];
    if histogram.len() <= MAX_COLORS {
        boxes = boxes
            .remove(0)
            .into_iter()
            .map(|counted| vec![counted])
            .collect();
    } else {
        while boxes.len() < MAX_COLORS {
            let Some(widest) = (0..boxes.len()).rev().max_by_key(|i| width(&boxes[*i]).0) else {
                break;
            };
            let upper = split(&mut boxes[widest]);
            boxes.push(upper);
        }
    }
    let mut means: Vec<([u8; 3], Vec<Counted>)> = boxes
        .into_iter()
        .map(|colors| (mean(&colors), colors))
        .collect();
    means.sort_unstable();
    let mut index_of = BTreeMap::new();
    for (i, (_, colors)) in means.iter().enumerate() {
        for (color, _) in colors {
            index_of.insert(*color, (i + 1) as u8);
        }
    }
    (means.into_iter().map(|(mean, _)| mean).collect(), index_of)
}

fn width(colors: &[Counted]) -> (u8, usize) {
    let ranges = (0..3).map(|channel| {
        let values = colors.iter().map(|(color, _)| color[channel]);
        let low = values.clone().min().unwrap_or(0);
        (values.max().unwrap_or(0) - low, channel)
    });
    ranges.max().unwrap_or((0, 0))
}

/// Takes the upper half, by number of voxels, out of a box of at least two colours.
fn split(colors: &mut Vec<Counted>) -> Vec<Counted> {
    let (_, channel) = width(colors);
    colors.sort_unstable_by_key(|(color, _)| (color[channel], *color));
    let total: u128 = colors.iter().map(|(_, n)| u128::from(*n)).sum();
    let mut below = 0u128;
    let mut at = colors.len() / 2;
    for (i, (_, n)) in colors.iter().enumerate() {
        below += u128::from(*n);
        if 2 * below >= total {
            at = i + 1;
            break;
        }
    }
    let last = colors.len().saturating_sub(1).max(1);
    colors.split_off(at.clamp(1, last))
}

fn mean(colors: &[Counted]) -> [u8; 3] {
    let total: u128 = colors
        .iter()
        .map(|(_, n)| u128::from(*n))
        .sum::<u128>()
        .max(1);
    std::array::from_fn(|channel| {
        let sum: u128 = colors
            .iter()
            .map(|(color, n)| u128::from(color[channel]) * u128::from(*n))
            .sum();
        ((sum + total / 2) / total) as u8
    })
}
