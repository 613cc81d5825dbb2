//! The restoring divide that users build from single steps: bit for bit the
//! floor of the exact quotient.

use crate::common::*;
use hwmodel::{Datapath, NoProbe, Overflow, Word};
use proptest::prelude::*;

/// `floor(numerator * 2^fraction_bits / divisor)`, the machine's way: integer
/// bits by shifted divisors, fraction bits by doubled remainders.
fn quotient(
    dp: &mut Datapath<NoProbe>,
    numerator: i64,
    divisor: i64,
    integer_bits: u32,
    fraction_bits: u32,
) -> (i64, i64) {
    let divisor = Word::of(divisor);
    let mut remainder = Word::of(numerator);
    let mut quotient = Word::ZERO;
    for place in (0..integer_bits).rev() {
        let (rest, bit) = dp.divide_integer_step(remainder, divisor, place);
        remainder = rest;
        quotient = dp.shift_in(quotient, bit);
    }
    for _ in 0..fraction_bits {
        let (rest, bit) = dp.divide_step(remainder, divisor, false);
        assert!(
            (0..divisor.value()).contains(&rest.value()),
            "a remainder lies below its divisor"
        );
        remainder = rest;
        quotient = dp.shift_in(quotient, bit);
    }
    (quotient.value(), remainder.value())
}

/// Numerator, divisor, integer and fraction bits such that the quotient fits a word.
fn check(bits: u32, numerator: i64, divisor: i64, integer_bits: u32, fraction_bits: u32) {
    let mut dp = datapath(bits, Overflow::Trap);
    let (found, rest) = quotient(&mut dp, numerator, divisor, integer_bits, fraction_bits);
    let scaled = i128::from(numerator) << fraction_bits;
    let context =
        format!("{numerator} / {divisor}, {integer_bits} + {fraction_bits} bits, {bits}-bit words");
    assert_eq!(
        i128::from(found),
        scaled.div_euclid(i128::from(divisor)),
        "{context}"
    );
    assert_eq!(
        i128::from(rest),
        scaled.rem_euclid(i128::from(divisor)),
        "{context}"
    );
    assert_eq!(dp.trap(), None, "{context}");
}

#[test]
fn edge_cases_divide() {
    for bits in widths() {
        let positive = |v: &i64| *v > 0;
        for divisor in edge_cases(bits).into_iter().filter(positive) {
            for numerator in edge_cases(bits).into_iter().filter(|v| *v >= 0) {
                // All integer bits that the quotient can have.
                check(bits, numerator, divisor, bits - 1, 0);
                if numerator < divisor {
                    // A proper fraction: a quotient of all fraction bits.
                    check(bits, numerator, divisor, 0, bits - 1);
                }
                if numerator / 16 < divisor {
                    check(bits, numerator, divisor, 4, bits - 5);
                }
            }
        }
    }
}

/// Doubling a remainder as large as a 64-bit word allows needs a 65th bit.
#[test]
fn the_doubled_remainder_has_a_bit_more_than_the_word() {
    let mut dp = datapath(64, Overflow::Trap);
    let divisor = Word::of(i64::MAX);
    let (rest, bit) = dp.divide_step(Word::of(i64::MAX - 1), divisor, true);
    // 2 (2^63 - 2) + 1 = (2^63 - 1) + (2^63 - 2)
    assert_eq!((rest.value(), bit), (i64::MAX - 1, true));
}

/// A divisor shifted out of all reach is never taken away.
#[test]
fn integer_bits_of_any_weight() {
    let mut dp = datapath(64, Overflow::Trap);
    for place in [63, 64, 65, 127, 128, 1000, u32::MAX] {
        for divisor in [1, 2, 3, i64::MAX] {
            for remainder in [0, 1, i64::MAX] {
                let step = dp.divide_integer_step(Word::of(remainder), Word::of(divisor), place);
                assert_eq!(step, (Word::of(remainder), false), "place {place}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_quotients(
        (bits, a, b) in any_pair(),
        integer_bits in 0..63u32,
        fraction_bits in 0..63u32,
    ) {
        let most = i64::try_from(greatest(bits)).expect("64 bits at most");
        let divisor = (b & most).max(1);
        let integer_bits = integer_bits.min(bits - 1);
        let fraction_bits = fraction_bits.min(bits - 1 - integer_bits);
        // The quotient's integer part has to fit its bits.
        let limit = i128::from(divisor) << integer_bits;
        let numerator = i128::from(a & most) % limit;
        let numerator = i64::try_from(numerator).expect("not beyond the word");
        check(bits, numerator, divisor, integer_bits, fraction_bits);
    }

    /// Bits that come in from the right: long division of a two-word number.
    #[test]
    fn bits_from_the_right((bits, high, low) in any_pair(), b in any::<i64>()) {
        let most = i64::try_from(greatest(bits)).expect("64 bits at most");
        let divisor = (b & most).max(1);
        let (high, low) = ((high & most) % divisor, low & most);
        let mut dp = datapath(bits, Overflow::Trap);
        let mut remainder = Word::of(high);
        let mut quotient = Word::ZERO;
        for place in (0..bits - 1).rev() {
            let bit = dp.bit(Word::of(low), place);
            let (rest, bit) = dp.divide_step(remainder, Word::of(divisor), bit);
            remainder = rest;
            quotient = dp.shift_in(quotient, bit);
        }
        let whole = (i128::from(high) << (bits - 1)) + i128::from(low);
        prop_assert_eq!(i128::from(quotient.value()), whole / i128::from(divisor));
        prop_assert_eq!(i128::from(remainder.value()), whole % i128::from(divisor));
        prop_assert_eq!(dp.overflows(), 0);
    }
}
