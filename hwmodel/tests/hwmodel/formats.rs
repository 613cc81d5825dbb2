//! Word formats: what is one, what it holds, and the wide one beside it.

use crate::common::{greatest, least, widths};
use hwmodel::{Format, FormatError, MAX_BITS, MIN_BITS};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error, MapDeserializer};

#[test]
fn formats_have_16_to_64_bits_with_a_bit_beside_sign_and_fraction() {
    assert_eq!((MIN_BITS, MAX_BITS), (16, 64));
    for bits in (0..200).chain([u32::MAX]) {
        for frac in (0..200).chain([u32::MAX]) {
            let expected = if !(16..=64).contains(&bits) {
                Err(FormatError::Bits(bits))
            } else if frac > bits - 2 {
                Err(FormatError::Frac { bits, frac })
            } else {
                Ok((bits, frac))
            };
            let found = Format::new(bits, frac).map(|f| (f.bits(), f.frac()));
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn errors_say_the_range() {
    assert_eq!(
        Format::new(8, 0).unwrap_err().to_string(),
        "a word has 16 to 64 bits, not 8"
    );
    assert_eq!(
        Format::new(16, 15).unwrap_err().to_string(),
        "a word of 16 bits holds at most 14 fraction bits, not 15"
    );
}

#[test]
fn a_format_holds_what_two_s_complement_does() {
    for bits in widths() {
        let format = Format::new(bits, 3).unwrap();
        assert_eq!(i128::from(format.min()), least(bits));
        assert_eq!(i128::from(format.max()), greatest(bits));
        for end in [least(bits), -1, 0, 1, greatest(bits)] {
            for value in [end - 1, end, end + 1] {
                let Ok(given) = i64::try_from(value) else {
                    continue;
                };
                let expected = (least(bits)..=greatest(bits)).contains(&value);
                assert_eq!(format.holds(given), expected, "{given} in {bits} bits");
            }
        }
    }
}

#[test]
fn the_wide_format_has_twice_the_bits_up_to_64() {
    for bits in widths() {
        for frac in [0, 7, bits - 2] {
            let wide = Format::new(bits, frac).unwrap().wide();
            assert_eq!((wide.bits(), wide.frac()), ((2 * bits).min(64), frac));
        }
    }
}

/// A format read from a file is held to the same rules.
#[test]
fn what_is_no_format_cannot_be_read() {
    let read = |bits: u32, frac: u32| {
        let fields = [("bits", bits), ("frac", frac)];
        let fields: MapDeserializer<'_, _, Error> =
            MapDeserializer::new(fields.into_iter().map(|(k, v)| (k, v.into_deserializer())));
        Format::deserialize(fields)
    };
    assert_eq!(read(32, 8).unwrap(), Format::new(32, 8).unwrap());
    for (bits, frac) in [(0, 0), (15, 3), (65, 8), (u32::MAX, 0), (16, 15)] {
        let error = read(bits, frac).unwrap_err().to_string();
        assert_eq!(error, Format::new(bits, frac).unwrap_err().to_string());
    }
}
