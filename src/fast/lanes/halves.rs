//! Vectors of two halves, for instruction sets of 128 bits.

use super::super::*;

#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Pair<V>(pub(super) V, pub(super) V);

macro_rules! by_half {
    ($($name:ident($($other:ident),*);)*) => {$(
        #[inline(always)]
        fn $name(self $(, $other: Self)*) -> Self {
            Self(self.0.$name($($other.0),*), self.1.$name($($other.1),*))
        }
    )*};
}

macro_rules! pairs {
    ($($half:literal of $whole:literal),*) => {$(
        impl<V: Lanes<$half>> Lanes<$whole> for Pair<V> {
            type Isa = V::Isa;
            type Lane = V::Lane;
            #[inline(always)]
            fn load(isa: V::Isa, values: &[V::Lane; $whole]) -> Self {
                let (halves, _) = values.as_chunks();
                Self(V::load(isa, &halves[0]), V::load(isa, &halves[1]))
            }
            #[inline(always)]
            fn splat(isa: V::Isa, value: V::Lane) -> Self {
                let half = V::splat(isa, value);
                Self(half, half)
            }
        }
    )*};
}
pairs!(2 of 4, 4 of 8, 8 of 16);

macro_rules! floats {
    ($($half:literal of $whole:literal),*) => {$(
        impl<V: Floats<$half>> Floats<$whole> for Pair<V> {
            by_half! {
                add(other);
                sub(other);
                mul(other);
                div(other);
                fma(by, plus);
                fms(by, less);
                fnma(by, from);
                max(other);
                min(other);
                abs();
                floor();
                ceil();
            }
        }
    )*};
}
floats!(2 of 4, 4 of 8);

impl<V: Tests<4>> Tests<8> for Pair<V> {
    by_half! {
        reciprocal();
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> u8 {
        self.0.at_most(other.0) | self.1.at_most(other.1) << 4
    }
    #[inline(always)]
    fn whole(self) -> [i32; 8] {
        both(self.0.whole(), self.1.whole())
    }
    #[inline(always)]
    fn indices<const M: usize>(self) -> [u32; 8] {
        both(self.0.indices::<M>(), self.1.indices::<M>())
    }
}

#[inline(always)]
fn both<T: Copy>([a, b, c, d]: [T; 4], [e, f, g, h]: [T; 4]) -> [T; 8] {
    [a, b, c, d, e, f, g, h]
}

impl<V: Shorts<8>> Shorts<16> for Pair<V> {
    by_half! {
        add(other);
        mul(other);
        abs();
        max_unsigned(other);
    }
    #[inline(always)]
    fn below(self, next: Self, limit: Self) -> u32 {
        self.0.below(next.0, limit.0) | self.1.below(next.1, limit.1) << 16
    }
}

impl<V: Masks<2>> Masks<4> for Pair<V> {
    by_half! {
        and(other);
    }
    #[inline(always)]
    fn zeros(self) -> u32 {
        self.0.zeros() | self.1.zeros() << 2
    }
}
