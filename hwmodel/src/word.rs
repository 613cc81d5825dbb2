//! Words.

/// One machine word, in units of the last place of its [`Format`](crate::Format).
///
/// It has no operators: [`Datapath`](crate::Datapath) does, checks and reports every operation.
///
/// ```compile_fail,E0369
/// let a = hwmodel::Word::from_host(6);
/// let _ = a * a; // a word cannot be multiplied
/// ```
/// ```compile_fail,E0369
/// let a = hwmodel::Word::from_host(6);
/// let _ = a / a; // nor divided
/// ```
/// ```compile_fail,E0369
/// let a = hwmodel::Word::from_host(6);
/// let _ = a < a; // nor compared where no probe sees it
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(transparent)]
pub struct Word(pub(crate) i64);

/// A word of the wide format, which cannot be mixed with a [`Word`].
///
/// ```compile_fail,E0308
/// let mut dp = hwmodel::Datapath::new(
///     hwmodel::Format::new(32, 8).unwrap(),
///     hwmodel::Overflow::Trap,
///     hwmodel::NoProbe,
/// );
/// let position = hwmodel::Word::from_host(6);
/// let plane = hwmodel::WideWord::from_host(6);
/// let _ = dp.add(position, plane);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(transparent)]
pub struct WideWord(pub(crate) i64);

mod sealed {
    #[expect(unnameable_types, reason = "a sealed trait")]
    pub trait Raw: Copy {
        const WIDE: bool;
        fn raw(self) -> i64;
        fn from_raw(raw: i64) -> Self;
    }
}
pub(crate) use sealed::Raw;

/// A number of few bits, 0 or more: a weight or a colour. Its operations give the number of bits.
///
/// ```compile_fail,E0369
/// let a = hwmodel::Narrow::from_host(6);
/// let _ = a * a; // a narrow number cannot be multiplied
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(transparent)]
pub struct Narrow(pub(crate) u32);

macro_rules! of_host {
    ($($type:ident($number:ty))+) => {$(
        impl $type {
            /// Zero.
            pub const ZERO: Self = Self(0);

            /// From the host's set-up or from a memory.
            pub const fn from_host(value: $number) -> Self {
                Self(value)
            }

            /// For the host or for a memory.
            pub const fn to_host(self) -> $number {
                self.0
            }
        }
    )+};
}

of_host! { Word(i64) WideWord(i64) Narrow(u32) }

/// The numbers that the datapath works on.
pub trait Number: Raw {}

macro_rules! numbers {
    ($($type:ident $is_wide:literal)+) => {$(
        impl Raw for $type {
            const WIDE: bool = $is_wide;
            #[inline(always)]
            fn raw(self) -> i64 {
                self.0
            }
            #[inline(always)]
            fn from_raw(raw: i64) -> Self {
                Self(raw)
            }
        }
        impl Number for $type {}
    )+};
}

numbers! { Word false WideWord true }
