//! Scaling by a constant without a multiplier.

use hwmodel::{Datapath, Probe, Word};

/// `a / 2^places`, rounded down; `a * 2^-places` for negative `places`.
#[inline]
pub(super) fn shift<P: Probe>(dp: &mut Datapath<P>, a: Word, places: i32) -> Word {
    if places >= 0 {
        dp.shr(a, places as u32)
    } else {
        dp.shl(a, places.unsigned_abs())
    }
}

/// `a / 2^places`, one unit larger where places are lost: rounding a negative `a` (behind the eye) down would narrow the
/// box.
pub(super) fn margin<P: Probe>(dp: &mut Datapath<P>, a: Word, places: i32) -> Word {
    let part = shift(dp, a, places);
    if places > 0 {
        dp.add(part, Word::from_host(1))
    } else {
        part
    }
}

/// The sum of `a / 2^(places + extra)` over the places in `shifts`, each part rounded down.
pub(super) fn sum_of_shifts<P: Probe>(
    dp: &mut Datapath<P>,
    a: Word,
    shifts: &[i32],
    extra: i32,
) -> Word {
    let mut sum = Word::ZERO;
    for (i, &places) in shifts.iter().enumerate() {
        let part = shift(dp, a, places + extra);
        sum = if i == 0 { part } else { dp.add(sum, part) };
    }
    sum
}
