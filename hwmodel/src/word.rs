//! The machine word: a number that can be added, shifted and compared, and
//! can neither be multiplied nor divided.

/// One machine word, in units of the last place of its [`Format`](crate::Format).
///
/// It has no operators at all: every operation is a call on a
/// [`Datapath`](crate::Datapath), which checks the width and reports to a probe.
/// There is no multiplication and no division to call:
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
/// let _ = a % a; // nor reduced
/// ```
/// ```compile_fail,E0369
/// let a = hwmodel::Word::from_host(6);
/// let _ = a < a; // nor compared where no probe sees it
/// ```
/// ```compile_fail,E0599
/// let mut dp = hwmodel::Datapath::new(
///     hwmodel::Format::new(32, 8).unwrap(),
///     hwmodel::Overflow::Trap,
///     hwmodel::NoProbe,
/// );
/// let a = hwmodel::Word::from_host(6);
/// let _ = dp.mul(a, a); // the datapath has no multiplier either
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(transparent)]
pub struct Word(pub(crate) i64);

impl Word {
    /// Zero.
    pub const ZERO: Self = Self(0);

    /// A word that the host prepared before the frame: a frame constant.
    #[must_use]
    pub const fn from_host(value: i64) -> Self {
        Self(value)
    }

    /// The word's value for the host, after the machine is done with it.
    #[must_use]
    pub const fn to_host(self) -> i64 {
        self.0
    }
}

/// A word of the wide format, which holds the coefficients of silhouette
/// planes: products of two positions need twice the bits. It cannot be mixed
/// with a [`Word`].
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

impl WideWord {
    /// Zero.
    pub const ZERO: Self = Self(0);

    /// A wide word that the host prepared before the frame.
    #[must_use]
    pub const fn from_host(value: i64) -> Self {
        Self(value)
    }

    /// The word's value for the host, after the machine is done with it.
    #[must_use]
    pub const fn to_host(self) -> i64 {
        self.0
    }
}

mod sealed {
    /// Raw access that only the datapath has.
    #[expect(unnameable_types, reason = "a sealed trait")]
    pub trait Raw: Copy {
        const WIDE: bool;
        fn raw(self) -> i64;
        fn from_raw(raw: i64) -> Self;
    }
}
pub(crate) use sealed::Raw;

/// A number of few bits, 0 or more: a weight or a colour. Like a [`Word`] it has no operators: what
/// is done with it is a call on a [`Datapath`](crate::Datapath) that names the bits.
///
/// ```compile_fail,E0369
/// let a = hwmodel::Narrow::from_host(6);
/// let _ = a * a; // a narrow number cannot be multiplied
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(transparent)]
pub struct Narrow(pub(crate) u32);

impl Narrow {
    /// Zero.
    pub const ZERO: Self = Self(0);

    /// A number that the host prepared, or that comes from a memory.
    #[must_use]
    pub const fn from_host(value: u32) -> Self {
        Self(value)
    }

    /// The number's value for the host, or for a memory.
    #[must_use]
    pub const fn to_host(self) -> u32 {
        self.0
    }
}

/// [`Word`] or [`WideWord`]: what the datapath works on.
pub trait Number: Raw {}

impl Raw for Word {
    const WIDE: bool = false;
    #[inline(always)]
    fn raw(self) -> i64 {
        self.0
    }
    #[inline(always)]
    fn from_raw(raw: i64) -> Self {
        Self(raw)
    }
}
impl Number for Word {}

impl Raw for WideWord {
    const WIDE: bool = true;
    #[inline(always)]
    fn raw(self) -> i64 {
        self.0
    }
    #[inline(always)]
    fn from_raw(raw: i64) -> Self {
        Self(raw)
    }
}
impl Number for WideWord {}
