//! The ray caster's arithmetic, so that it can be counted as it is done.

use serde::{Deserialize, Serialize};

/// The kinds of steps of a ray caster's hardware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum FloatStep {
    /// Two `f32` added or subtracted.
    FloatAdd,
    /// Two `f32` multiplied.
    FloatMultiply,
    /// One `f32` divided by another.
    FloatDivide,
    /// Two `f32` compared.
    FloatCompare,
    /// The smaller or larger of two `f32`.
    FloatMinMax,
    /// Two 32-bit integers added or subtracted.
    IntegerAdd,
    /// And, or, exclusive or on at most 32 bits; a sign taken away or turned.
    Logic,
    /// A shift by a number that is not known before, or the place of the first bit.
    Shift,
    /// A node's children read.
    NodeRead,
    /// Colour and normal of a node read.
    AttributeRead,
    /// An entry of the ray's stack read.
    StackRead,
    /// An entry of the ray's stack written.
    StackWrite,
    /// A pixel written.
    PixelWrite,
}

impl FloatStep {
    /// All kinds, in the order of their discriminants.
    pub const ALL: [Self; 13] = [
        Self::FloatAdd,
        Self::FloatMultiply,
        Self::FloatDivide,
        Self::FloatCompare,
        Self::FloatMinMax,
        Self::IntegerAdd,
        Self::Logic,
        Self::Shift,
        Self::NodeRead,
        Self::AttributeRead,
        Self::StackRead,
        Self::StackWrite,
        Self::PixelWrite,
    ];

    /// The kind in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FloatAdd => "float add",
            Self::FloatMultiply => "float multiply",
            Self::FloatDivide => "float divide",
            Self::FloatCompare => "float compare",
            Self::FloatMinMax => "float min/max",
            Self::IntegerAdd => "integer add",
            Self::Logic => "logic",
            Self::Shift => "shift",
            Self::NodeRead => "node read",
            Self::AttributeRead => "attribute read",
            Self::StackRead => "stack read",
            Self::StackWrite => "stack write",
            Self::PixelWrite => "pixel write",
        }
    }
}

pub(super) trait Arithmetic {
    fn count(&mut self, step: FloatStep, times: u32);

    /// Counts `times` dependent steps of the ray's longest chain. Steps that can run in parallel are not in it.
    fn wait(&mut self, step: FloatStep, times: u32);

    fn node(&mut self, word: u64);

    #[inline(always)]
    fn add(&mut self, a: f32, b: f32) -> f32 {
        self.count(FloatStep::FloatAdd, 1);
        a + b
    }

    #[inline(always)]
    fn sub(&mut self, a: f32, b: f32) -> f32 {
        self.count(FloatStep::FloatAdd, 1);
        a - b
    }

    #[inline(always)]
    fn multiply(&mut self, a: f32, b: f32) -> f32 {
        self.count(FloatStep::FloatMultiply, 1);
        a * b
    }

    #[inline(always)]
    fn divide(&mut self, a: f32, b: f32) -> f32 {
        self.count(FloatStep::FloatDivide, 1);
        a / b
    }

    #[inline(always)]
    fn max(&mut self, a: f32, b: f32) -> f32 {
        self.count(FloatStep::FloatMinMax, 1);
        a.max(b)
    }

    #[inline(always)]
    fn min(&mut self, a: f32, b: f32) -> f32 {
        self.count(FloatStep::FloatMinMax, 1);
        a.min(b)
    }

    #[inline(always)]
    fn less(&mut self, a: f32, b: f32) -> bool {
        self.count(FloatStep::FloatCompare, 1);
        a < b
    }

    /// `a b - c`, as two steps.
    #[inline(always)]
    fn times_less(&mut self, a: f32, b: f32, c: f32) -> f32 {
        let product = self.multiply(a, b);
        self.sub(product, c)
    }
}

/// Counts nothing.
pub(super) struct Plain;

impl Arithmetic for Plain {
    #[inline(always)]
    fn count(&mut self, _: FloatStep, _: u32) {}

    #[inline(always)]
    fn wait(&mut self, _: FloatStep, _: u32) {}

    #[inline(always)]
    fn node(&mut self, _: u64) {}
}
