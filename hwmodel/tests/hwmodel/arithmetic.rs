//! Every operation of the datapath against 128-bit integers: all widths, both
//! types of number, all policies.
//!
//! Each check runs on all pairs of edge cases for every width from 16 to 64,
//! and on random pairs.

use crate::common::*;
use hwmodel::{Datapath, NoProbe, Overflow, WideWord, Word};
use proptest::prelude::*;

/// Runs one operation on a fresh datapath, and compares the word, the number
/// of overflows and whether it trapped with what `exact` should come to.
#[track_caller]
fn check<T: Host>(what: &str, bits: u32, exact: i128, run: impl Fn(&mut Datapath<NoProbe>) -> T) {
    for policy in POLICIES {
        let mut dp = datapath(bits, policy);
        let found = run(&mut dp).value();
        let (expected, overflowed) = fit(exact, T::bits(dp.format()), policy);
        let context = format!("{what}, {bits}-bit format, {policy:?}");
        assert_eq!(found, expected, "{context}");
        assert_eq!(
            dp.overflows(),
            u64::from(overflowed),
            "{context}: overflows"
        );
        let trapped = overflowed && policy == Overflow::Trap;
        assert_eq!(dp.trap().is_some(), trapped, "{context}: trap");
    }
}

/// Runs one yes-or-no operation.
#[track_caller]
fn check_bit(what: &str, bits: u32, expected: bool, run: impl Fn(&mut Datapath<NoProbe>) -> bool) {
    let mut dp = datapath(bits, Overflow::Trap);
    assert_eq!(run(&mut dp), expected, "{what}, {bits}-bit format");
    assert_eq!(dp.overflows(), 0);
}

/// Shifts worth testing: none, the width, and far beyond.
const PLACES: [u32; 18] = [
    0,
    1,
    2,
    7,
    14,
    15,
    16,
    17,
    30,
    31,
    32,
    33,
    62,
    63,
    64,
    65,
    200,
    u32::MAX,
];

/// `a * 2^places` for any `places`: 64 of them shift every bit of a word out.
fn doubled(a: i64, places: u32) -> i128 {
    i128::from(a) << places.min(64)
}

/// `a / 2^places`, rounded down.
fn halved(a: i64, places: u32) -> i128 {
    i128::from(a).div_euclid(1i128 << places.min(64))
}

fn one_number<T: Host>(bits: u32, a: i64) {
    let x = T::of(a);
    let exact = i128::from(a);
    check(&format!("-({a})"), bits, -exact, |dp| dp.neg(x));
    for places in PLACES {
        check(&format!("{a} >> {places}"), bits, halved(a, places), |dp| {
            dp.shr(x, places)
        });
        check(
            &format!("{a} << {places}"),
            bits,
            doubled(a, places),
            |dp| dp.shl(x, places),
        );
        let bit = halved(a, places).rem_euclid(2) == 1;
        check_bit(&format!("bit {places} of {a}"), bits, bit, |dp| {
            dp.bit(x, places)
        });
    }
    check_bit("negative", bits, a < 0, |dp| dp.is_negative(x));
    check_bit("positive", bits, a > 0, |dp| dp.is_positive(x));
    check_bit("zero", bits, a == 0, |dp| dp.is_zero(x));
}

fn two_numbers<T: Host>(bits: u32, a: i64, b: i64) {
    let (x, y) = (T::of(a), T::of(b));
    let (ea, eb) = (i128::from(a), i128::from(b));
    check(&format!("{a} + {b}"), bits, ea + eb, |dp| dp.add(x, y));
    check(&format!("{a} - {b}"), bits, ea - eb, |dp| dp.sub(x, y));
    check(
        &format!("midpoint of {a} and {b}"),
        bits,
        (ea + eb).div_euclid(2),
        |dp| dp.midpoint(x, y),
    );
    check("min", bits, ea.min(eb), |dp| dp.min(x, y));
    check("max", bits, ea.max(eb), |dp| dp.max(x, y));
    check("select 1", bits, ea, |dp| dp.select(true, x, y));
    check("select 0", bits, eb, |dp| dp.select(false, x, y));
    check_bit(&format!("{a} < {b}"), bits, a < b, |dp| dp.lt(x, y));
    check_bit(&format!("{a} <= {b}"), bits, a <= b, |dp| dp.le(x, y));
    check_bit(&format!("{a} == {b}"), bits, a == b, |dp| dp.equal(x, y));
}

/// Operations that only words have.
fn words_only(bits: u32, a: i64) {
    let x = Word::of(a);
    let exact = i128::from(a);
    for bit in [false, true] {
        let shifted = 2 * exact + i128::from(bit);
        check(&format!("{a} << 1 | {bit}"), bits, shifted, |dp| {
            dp.shift_in(x, bit)
        });
    }
}

#[test]
fn edge_cases_of_words() {
    for bits in widths() {
        for a in edge_cases(bits) {
            one_number::<Word>(bits, a);
            words_only(bits, a);
            for b in edge_cases(bits) {
                two_numbers::<Word>(bits, a, b);
            }
        }
    }
}

#[test]
fn edge_cases_of_wide_words() {
    for bits in widths() {
        let wide = (2 * bits).min(64);
        for a in edge_cases(wide) {
            one_number::<WideWord>(bits, a);
            for b in edge_cases(wide) {
                two_numbers::<WideWord>(bits, a, b);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_words((bits, a, b) in any_pair(), places in 0..70u32) {
        one_number::<Word>(bits, a);
        words_only(bits, a);
        two_numbers::<Word>(bits, a, b);
        check("shl", bits, doubled(a, places), |dp| dp.shl(Word::of(a), places));
        check("shr", bits, halved(a, places), |dp| dp.shr(Word::of(a), places));
    }

    #[test]
    fn random_wide_words((bits, a, b) in any_wide_pair(), places in 0..70u32) {
        one_number::<WideWord>(bits, a);
        two_numbers::<WideWord>(bits, a, b);
        check("shl", bits, doubled(a, places), |dp| dp.shl(WideWord::of(a), places));
        check("shr", bits, halved(a, places), |dp| dp.shr(WideWord::of(a), places));
    }

    /// The host may load any 64-bit number. One that does not fit overflows.
    #[test]
    fn loads(bits in widths(), value in any::<i64>(), less in 0..64u32) {
        let value = value >> less;
        check("load", bits, i128::from(value), |dp| dp.load(value));
        check("wide load", bits, i128::from(value), |dp| dp.load_wide(value));
    }

    #[test]
    fn short_vectors(a in any::<u8>(), b in any::<u8>(), width in 1..8u32) {
        let mut dp = datapath(32, Overflow::Trap);
        prop_assert_eq!(dp.and_bits(width, a, b), a & b);
        prop_assert_eq!(dp.or_bits(width, a, b), a | b);
        prop_assert_eq!(dp.xor_bits(width, a, b), a ^ b);
    }
}

/// Loads at the ends of each format, where one more is one too many.
#[test]
fn loads_at_the_ends() {
    for bits in widths() {
        for wide in [false, true] {
            let width = if wide { (2 * bits).min(64) } else { bits };
            for end in [least(width), greatest(width)] {
                for value in [end - 1, end, end + 1] {
                    let Ok(given) = i64::try_from(value) else {
                        continue;
                    };
                    if wide {
                        check("wide load", bits, value, |dp| dp.load_wide(given));
                    } else {
                        check("load", bits, value, |dp| dp.load(given));
                    }
                }
            }
        }
    }
}
