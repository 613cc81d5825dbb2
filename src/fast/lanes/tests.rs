//! The processor's set against [`Scalar`], on lanes of small numbers, whose results no set rounds.

use super::*;
use crate::split_mix::SplitMix;

struct Numbers(SplitMix);

impl Numbers {
    /// Multiples of a half from -1000 to 1000.
    fn floats<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| (self.0.below(4001) as f32 - 2000.0) / 2.0)
    }

    fn bits<T, const N: usize>(&mut self, of: impl Fn(u64) -> T) -> [T; N] {
        std::array::from_fn(|_| of(self.0.bits()))
    }
}

fn eight<F: Tests<8>>(of: F) -> String {
    // Through whole numbers of halves.
    format!(
        "{:?} {:?} {:?}",
        of.whole(),
        of.indices::<128>(),
        of.add(of).whole()
    )
}

/// The results of all operations, of lanes drawn from a seed.
fn results<I: Isa>(isa: I, seed: u64) -> String {
    let mut numbers = Numbers(SplitMix::new(seed));
    let [a, b, c] = [(); 3].map(|()| isa.four(&numbers.floats()));
    let mut fours = vec![
        a,
        a.add(b),
        a.sub(b),
        a.mul(b),
        a.div(isa.splat(4.0)),
        a.fma(b, c),
        a.fms(b, c),
        a.fnma(b, c),
        a.max(b),
        a.min(b),
        a.abs(),
        a.floor(),
        a.ceil(),
        a.flip(isa.splat(-0.0)),
        a.next(),
        a.last(),
        a.sums(b),
    ];
    let [wide, other] = [(); 2].map(|()| numbers.floats::<4>().map(f64::from));
    let [wide, other] = [wide, other].map(|lanes| I::F64x4::load(isa, &lanes));
    fours.push(isa.narrow(wide.mul(other).add(wide).max(other)));
    let mut text = String::new();
    for four in fours {
        text += &format!(
            "{:?} {} {:?} {:?}\n",
            four.values(),
            four.signs(),
            four.indices::<64>(),
            four.whole()
        );
    }
    let (low, high) = (isa.join(a, b), isa.join(b, c));
    for of in [
        low.add(high),
        low.fma(high, low),
        low.max(high),
        low.floor(),
        isa.broadcast::<0>(a),
        isa.broadcast::<2>(a),
    ] {
        text += &format!("{} {}\n", eight(of), of.at_most(high));
    }
    let inverse = low.abs().add(I::F32x8::splat(isa, 1.0));
    let one = inverse
        .mul(inverse.reciprocal())
        .sub(I::F32x8::splat(isa, 1.0))
        .abs();
    text += &format!("{}\n", one.at_most(I::F32x8::splat(isa, 1.0 / 2048.0)));
    let [p, q] = [(); 2].map(|()| I::I16x16::load(isa, &numbers.bits(|bits| bits as i16)));
    for of in [
        p,
        p.add(q),
        p.mul(q),
        p.abs(),
        p.max_unsigned(q),
        isa.broadcast_rounded::<1>(a),
    ] {
        text += &format!("{:x}\n", of.below(q, I::I16x16::splat(isa, seed as i16)));
        text += &format!("{:x}\n", q.below(p, of));
    }
    let masks = I::U64x4::load(isa, &numbers.bits(|bits| bits & 3));
    text += &format!("{:x}\n", masks.and(I::U64x4::splat(isa, seed & 3)).zeros());
    let parts = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    text += &format!("{:x}\n", isa.turned(parts, seed as u8 & 7));
    text += &format!(
        "{:x?}\n",
        isa.expand(seed.wrapping_mul(0x0123_4567_89ab_cdef), seed as u8)
    );
    let mut entries = [7; 96];
    let mask = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let values = std::array::from_fn::<_, 71, _>(|i| i as u32);
    isa.store_masked(&mut entries, 11, mask, &values, 9);
    isa.store_masked(&mut entries, 11, mask.rotate_left(7), &[9; 8], 0);
    text + &format!("{entries:?}")
}

#[test]
fn vectors_are_those_of_plain_rust() {
    let Some(vector) = Vector::detect() else {
        return;
    };
    for seed in 0..2000 {
        assert_eq!(results(vector, seed), results(Scalar, seed), "{seed}");
    }
}
