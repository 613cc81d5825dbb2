//! Inputs for the blocks of the stage *blend* (see `directed.rs`).

use hwmodel::{Datapath, Narrow, Probe, Word};

use super::inputs::{Inputs, SPARE};
use crate::frame::Blend;
use crate::graph::Opacity;
use crate::machine::alpha::BlendColor;
use crate::machine::cage::CageCoordinate;
use crate::machine::constants::BlendEye;
use crate::machine::state::State;
use crate::project::{ALL_LEFT, OPAQUE_ENOUGH, SHARES};

/// A voxel of random opacities, seen along non-negative ways from an eye beside its centre, towards zero; `shift`: of the
/// eye.
fn blend_voxel<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
    (ways, shift): ([Word; 3], u32),
) {
    let mut cube = inputs.cube(0);
    let dp = &mut state.dp;
    for k in 0..3 {
        if inputs.flag() {
            // Otherwise the whole range: an odd sum loses its half.
            cube.max[k] = cube.min[k];
        }
    }
    let centre: [Word; 3] = std::array::from_fn(|k| dp.midpoint(cube.min[k], cube.max[k]));
    let eye = BlendEye {
        shift,
        at: std::array::from_fn(|k| {
            let centre = dp.shr(centre[k], shift);
            towards_zero(dp, centre, ways[k])
        }),
    };
    // Any side of each voxel, also with the eye in its centre.
    let eye_floor = std::array::from_fn(|k| {
        let step = Word::from_host(inputs.number(1) & 1);
        towards_zero(dp, centre[k], step)
    });
    // Full, almost full, half, or random.
    let mut side = || match inputs.dice.below(6) {
        0..=2 => 15,
        3 => [14, 8, 7][inputs.dice.below(3) as usize],
        _ => inputs.dice.below(16) as u8,
    };
    let opacity = Opacity::new(std::array::from_fn(|_| [side(), side()]));
    BlendColor::of_voxel(dp, &eye, &eye_floor, &cube, opacity, [0; 3]);
}

fn towards_zero<P: Probe>(dp: &mut Datapath<P>, from: Word, by: Word) -> Word {
    match dp.is_negative(from) {
        true => dp.add(from, by),
        false => dp.sub(from, by),
    }
}

/// All shares of the three sides: ways whose sum is 16 are shares; and ties of two, of 32.
pub(super) fn all_shares<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
) {
    for x in 0..=SHARES {
        for y in 0..=SHARES - x {
            let ways = [x, y, SHARES - x - y].map(Word::from_host);
            blend_voxel(state, inputs, (ways, 0));
        }
    }
    for x in 0..=2 * SHARES {
        let ways = [x, 2 * SHARES - x, 0].map(Word::from_host);
        blend_voxel(state, inputs, (ways, 0));
    }
}

/// Blending: ways with ties of their shares or of any size, and partly transparent samples.
pub(super) fn blending<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
) {
    let bits = if inputs.flag() {
        6
    } else {
        inputs.bits - SPARE
    };
    let ways = std::array::from_fn(|_| {
        let way = Word::from_host(inputs.number(bits));
        let back = state.dp.neg(way);
        state.dp.max(way, back)
    });
    let shift = inputs.level(3);
    blend_voxel(state, inputs, (ways, shift));

    let all = u64::from(ALL_LEFT);
    let left = match inputs.flag() {
        true => all,
        false => inputs.dice.below(all + 1),
    };
    // Leaves a sample just open or just full; opaque; random.
    let enough = left.saturating_sub(u64::from(OPAQUE_ENOUGH)) * all / left.max(1);
    let weight = match inputs.dice.below(4) {
        0 => inputs.dice.below(all + 1),
        1 => all,
        _ => (enough + inputs.dice.below(3)).min(all),
    };
    let light = [(); 3].map(|()| match inputs.dice.below(3) {
        0 => u64::from(u16::MAX),
        _ => inputs.dice.below(1 << 16),
    });
    // A sample's light is at most its share.
    let most = (all - left) * u64::from(u16::MAX);
    let sums = [(); 3].map(|()| match inputs.dice.below(3) {
        0 => most,
        _ => inputs.dice.below(most + 1),
    });
    let color = BlendColor {
        weight: Narrow::from_host(weight as u32),
        light: light.map(|channel| Narrow::from_host(channel as u32)),
    };
    let mut sample = Blend {
        left: left as u16,
        light: sums.map(|sum| sum as u32),
    };
    color.add_to(&mut state.dp, 0, &mut sample);
}
