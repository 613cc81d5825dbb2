//! Settings of a frame, and numbers that follow only from them.

use serde::{Deserialize, Serialize};

/// Most fraction bits of a clip vector; more would be invisible.
pub(super) const MAX_CLIP_FRAC: u32 = 30;
/// Most levels below a finest voxel.
pub(super) const MAX_SUB_LEVELS: u32 = 24;
/// Records whose box leaves the picture by more than `2^-3` of it do not change to screen space.
pub const SCREEN_GUARD_SHIFT: u32 = 3;

hwmodel::named! {
    /// Representation of a record's projected vertices.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    #[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
    pub enum CageKind {
        /// Eight corners (the image-order paper).
        Corners = "corners",
        /// One corner and three edges.
        #[default]
        Frame = "frame",
    }
}

hwmodel::named! {
    /// The rule by which a voxel covers samples.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    #[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
    pub enum Coverage {
        /// Every sample that its box overlaps (the image-order paper).
        ///
        /// Nodes are subdivided until their box lies within one sample, or they can be divided no
        /// further. Covers more than there is.
        Any = "any",
        /// The sample that holds its centre.
        ///
        /// Larger voxels are split until they are no larger than a sample.
        Center = "center",
        /// Every sample whose centre lies inside its outline.
        #[default]
        Exact = "exact",
        /// As `Exact`, each voxel with its six opacities, blended front to back.
        #[cfg_attr(
            feature = "clap",
            value(
                help = "As exact, each voxel with its six opacities (--opacities), blended front to \
                 back"
            )
        )]
        Alpha = "alpha",
    }
}

impl Coverage {
    /// The rules that do not blend, the most accurate first.
    pub const UNBLENDED: [Self; 3] = [Self::Exact, Self::Center, Self::Any];

    #[inline]
    pub const fn outline_rule(self) -> OutlineRule {
        match self {
            Self::Any => OutlineRule::Box,
            Self::Center => OutlineRule::Centre,
            Self::Exact | Self::Alpha => OutlineRule::Silhouette,
        }
    }

    /// Whether voxels are blended at their samples.
    #[inline]
    pub const fn blends(self) -> bool {
        match self {
            Self::Any | Self::Center | Self::Exact => false,
            Self::Alpha => true,
        }
    }

    #[inline]
    pub const fn draws_outlines(self) -> bool {
        self.outline_rule().has_planes()
    }

    /// The default tolerance, samples. Rules that draw outlines allow only 0.
    #[inline]
    pub const fn default_tolerance(self) -> f64 {
        match self {
            Self::Any | Self::Center => 1.0 / 8.0,
            Self::Exact | Self::Alpha => 0.0,
        }
    }

    /// The default size, pixels, up to which nodes are drawn as one voxel: the paper's pixel, or for outlines the largest
    /// without a relevant error (`docs/error.md`).
    #[inline]
    pub const fn default_lod(self) -> f64 {
        match self {
            Self::Any | Self::Center => 1.0,
            Self::Exact | Self::Alpha => 0.5,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutlineRule {
    Box,
    Centre,
    Silhouette,
}

impl OutlineRule {
    #[inline]
    pub const fn has_planes(self) -> bool {
        match self {
            Self::Box | Self::Centre => false,
            Self::Silhouette => true,
        }
    }
}

/// Settings of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SetupOptions {
    /// Width of a machine word, bits (16..=64).
    pub bits: u32,
    /// Fraction bits of clip depths (voxels) and of screen positions (pixels). `None`: as many as the frame has room for.
    pub frac: Option<u32>,
    pub cage: CageKind,
    /// Largest deviation, in samples, at which a record may change to screen space: 0 never, infinity always.
    pub tolerance_px: f64,
    pub coverage: Coverage,
    /// Nodes of at most this many pixels are drawn as one voxel. 0: only leaves.
    pub lod_px: f64,
    /// Logarithm of the samples per pixel and axis: 0, 1 or 2.
    pub aa_log2: u32,
}

impl Default for SetupOptions {
    fn default() -> Self {
        Self::of(Coverage::default())
    }
}

impl SetupOptions {
    pub fn of(coverage: Coverage) -> Self {
        Self {
            bits: 64,
            frac: None,
            cage: CageKind::default(),
            tolerance_px: coverage.default_tolerance(),
            coverage,
            lod_px: coverage.default_lod(),
            aa_log2: 0,
        }
    }

    /// The image-order paper's settings: eight corners per record, screen space at once, [`Coverage::Any`].
    pub fn paper() -> Self {
        Self {
            cage: CageKind::Corners,
            tolerance_px: f64::INFINITY,
            ..Self::of(Coverage::Any)
        }
    }
}

/// Divides `total` fraction bits of a position between the view (at most `most`) and exact halving below the finest
/// voxels, which only rules that subdivide solids need.
pub(super) fn split_fraction(total: u32, most: u32, coverage: Coverage) -> (u32, u32) {
    if coverage.draws_outlines() {
        return (total.min(most), 0);
    }
    let clip_frac = most.min(total - total / 3);
    (clip_frac, (total - clip_frac).min(MAX_SUB_LEVELS))
}

/// The tolerance, rounded up to `2^-shift` samples.
pub(super) fn grow_shift(tolerance: f64) -> Option<i32> {
    let is_approximate = tolerance > 0.0 && tolerance.is_finite();
    is_approximate.then(|| -(libm::ceil(libm::log2(tolerance)) as i32))
}

/// A constant factor as a sum of powers of two, each given by places of a shift to the right, or to the left if negative.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ShiftSum(Vec<i32>);

const SHIFT_SUM_BITS: i32 = 5;

impl ShiftSum {
    /// The largest sum of at most five neighbouring powers of two that is not above `value`.
    pub fn floor(value: f64) -> Self {
        if value <= 0.0 {
            return Self::default();
        }
        let leading = libm::floor(libm::log2(value)) as i32;
        let kept = libm::floor(libm::ldexp(value, SHIFT_SUM_BITS - 1 - leading)) as i64;
        Self(
            (0..SHIFT_SUM_BITS)
                .filter(|place| (kept >> (SHIFT_SUM_BITS - 1 - place) as u32) & 1 != 0)
                .map(|place| place - leading)
                .collect(),
        )
    }

    pub fn shifts(&self) -> &[i32] {
        &self.0
    }

    pub fn value(&self) -> f64 {
        let powers = self.0.iter().map(|&shift| libm::ldexp(1.0, -shift));
        powers.fold(0.0, |sum, power| sum + power)
    }
}

/// A size in samples, less its share of twice the tolerance, so that deviating neighbours leave no pinhole.
pub(super) fn size_limit(options: &SetupOptions, samples: f64) -> Option<ShiftSum> {
    let tolerance = Some(options.tolerance_px).filter(|t| t.is_finite());
    // At least an eighth: the user of a coarser tolerance accepts holes.
    let share = (1.0 - tolerance.unwrap_or(0.0) * 2.0).max(0.125);
    (samples > 0.0).then(|| ShiftSum::floor(samples * share))
}

/// The size up to which level of detail makes a node a solid. Outlines need no share for pinholes.
pub(super) fn detail_limit(options: &SetupOptions) -> Option<ShiftSum> {
    if options.coverage.draws_outlines() {
        return (options.lod_px > 0.0).then(|| ShiftSum::floor(options.lod_px));
    }
    size_limit(options, options.lod_px)
}
