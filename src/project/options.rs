//! What a frame is drawn with: words, cage, drawing rule, level of detail, samples; and the
//! numbers that follow from these settings alone.

use serde::{Deserialize, Serialize};

/// Most fraction bits of a clip vector; more would not be seen.
pub(super) const MAX_CLIP_FRAC: u32 = 30;
/// Most levels below a finest voxel.
pub(super) const MAX_SUB_LEVELS: u32 = 24;
/// Records whose box leaves the picture by more than this part of it do not
/// change to screen space (as a shift: 2^-3).
pub const SCREEN_GUARD_SHIFT: u32 = 3;

/// How a record holds its projected vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum CageKind {
    /// Eight corners (the image-order paper).
    ///
    /// In Morton order.
    Corners,
    /// One corner and three edges.
    #[default]
    Frame,
}

impl CageKind {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Corners, Self::Frame];

    /// Its name in settings and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corners => "corners",
            Self::Frame => "frame",
        }
    }
}

/// Which samples a voxel covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Coverage {
    /// Every sample that its box overlaps (the image-order paper).
    ///
    /// Nodes are subdivided until their box lies within one sample, or they can be divided no
    /// further. Covers more than there is.
    Any,
    /// The sample that holds its centre.
    ///
    /// Larger voxels are split until they are no larger than a sample.
    Center,
    /// Every sample whose centre lies inside its outline.
    #[default]
    Exact,
    /// As `Exact`, each voxel with its six opacities, blended front to back.
    #[cfg_attr(
        feature = "clap",
        value(
            help = "As exact, each voxel with its six opacities (--opacities), blended front to \
             back"
        )
    )]
    Alpha,
}

impl Coverage {
    /// All rules.
    pub const ALL: [Self; 4] = [Self::Any, Self::Center, Self::Exact, Self::Alpha];

    /// The rules that do not blend, the most accurate first.
    pub const UNBLENDED: [Self; 3] = {
        let (mut rules, mut found, mut left) = ([Self::Any; 3], 0, Self::ALL.len());
        while left > 0 {
            left -= 1;
            if !Self::ALL[left].blends() {
                rules[found] = Self::ALL[left];
                found += 1;
            }
        }
        assert!(found == rules.len(), "the array's length is their number");
        rules
    };

    /// Its name in settings and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Any => "any",
            Self::Center => "center",
            Self::Exact => "exact",
            Self::Alpha => "alpha",
        }
    }

    /// How the samples of a voxel are found, apart from blending.
    #[inline]
    #[must_use]
    pub const fn outline_rule(self) -> OutlineRule {
        match self {
            Self::Any => OutlineRule::Box,
            Self::Center => OutlineRule::Centre,
            Self::Exact | Self::Alpha => OutlineRule::Silhouette,
        }
    }

    /// Whether voxels are blended at the samples that they cover.
    #[inline]
    #[must_use]
    pub const fn blends(self) -> bool {
        match self {
            Self::Any | Self::Center | Self::Exact => false,
            Self::Alpha => true,
        }
    }

    /// Whether voxels are drawn by their silhouettes.
    #[inline]
    #[must_use]
    pub const fn draws_outlines(self) -> bool {
        self.outline_rule().has_planes()
    }

    /// The tolerance, samples, where none is given. What draws outlines never
    /// changes to screen space and has no other than 0.
    #[inline]
    #[must_use]
    pub const fn default_tolerance(self) -> f64 {
        match self {
            Self::Any | Self::Center => 1.0 / 8.0,
            Self::Exact | Self::Alpha => 0.0,
        }
    }

    /// The size, pixels, up to which nodes are drawn as one voxel, where none is given. A pixel is
    /// the paper's, and right for opacities, which are means; of outlines those of half a pixel are
    /// the largest that cost no accuracy to speak of (`docs/error.md`).
    #[inline]
    #[must_use]
    pub const fn default_lod(self) -> f64 {
        match self {
            Self::Any | Self::Center | Self::Alpha => 1.0,
            Self::Exact => 0.5,
        }
    }
}

/// How the samples that a voxel covers are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutlineRule {
    /// Those that the voxel's box overlaps.
    Box,
    /// The one that holds the voxel's centre.
    Centre,
    /// Those whose centres lie within the voxel's silhouette.
    Silhouette,
}

impl OutlineRule {
    /// Whether silhouette planes are needed to find the samples.
    #[inline]
    #[must_use]
    pub const fn has_planes(self) -> bool {
        match self {
            Self::Box | Self::Centre => false,
            Self::Silhouette => true,
        }
    }
}

/// What a frame is drawn with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SetupOptions {
    /// Width of a machine word, bits (16..=64).
    pub bits: u32,
    /// Fraction bits of clip depths (voxels) and of screen positions (pixels);
    /// `None`: as many as the frame leaves room for.
    pub frac: Option<u32>,
    /// How a record holds its vertices.
    pub cage: CageKind,
    /// Largest deviation, in samples, at which a record may change from clip
    /// space to screen space: 0 never, infinity at once. Of `any` and
    /// `center` alone: the other rules take 0.
    pub tolerance_px: f64,
    /// Drawing rule.
    pub coverage: Coverage,
    /// Nodes of at most this many pixels are drawn as one voxel; 0: only leaves.
    pub lod_px: f64,
    /// Samples per pixel and axis, as a power of two: 0, 1 or 2.
    pub aa_log2: u32,
}

impl Default for SetupOptions {
    fn default() -> Self {
        Self::of(Coverage::default())
    }
}

impl SetupOptions {
    /// The default settings of a drawing rule.
    #[must_use]
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

    /// The image-order paper's settings: eight corners a record, screen space at once,
    /// [`Coverage::Any`].
    #[must_use]
    pub fn paper() -> Self {
        Self {
            cage: CageKind::Corners,
            tolerance_px: f64::INFINITY,
            ..Self::of(Coverage::Any)
        }
    }
}

/// Shares `total` fraction bits of a position between the precision of the
/// view (at most `most`) and exact halving below the finest voxels, which
/// only the rules that subdivide solids have a use for.
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

/// A constant factor as a sum of powers of two: `x` times it is a sum of
/// shifted copies of `x`, one shift to the right each (negative: to the left).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ShiftSum(Vec<i32>);

/// Significant bits of a [`ShiftSum`].
const SHIFT_SUM_BITS: i32 = 5;

impl ShiftSum {
    /// The largest sum of at most five neighbouring powers of two that is not above `value`.
    #[must_use]
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

    /// The shifts to the right, growing.
    #[must_use]
    pub fn shifts(&self) -> &[i32] {
        &self.0
    }

    /// The factor.
    #[must_use]
    pub fn value(&self) -> f64 {
        let powers = self.0.iter().map(|&shift| libm::ldexp(1.0, -shift));
        powers.fold(0.0, |sum, power| sum + power)
    }
}

/// A size in samples, less its share of twice the tolerance, so that
/// neighbours that deviate by the tolerance leave no pinhole; `None` for 0.
/// The rules that draw outlines have no tolerance to take a share of.
pub(super) fn size_limit(options: &SetupOptions, samples: f64) -> Option<ShiftSum> {
    let tolerance = Some(options.tolerance_px).filter(|t| t.is_finite());
    // Never below an eighth: with coarser tolerances the user has chosen holes.
    let share = (1.0 - tolerance.unwrap_or(0.0) * 2.0).max(0.125);
    (samples > 0.0).then(|| ShiftSum::floor(samples * share))
}

/// The size of a node that level of detail takes for a solid; `None` for 0.
/// Under `exact`, where a solid is drawn at every sample of its silhouette and
/// not at one, it needs no share for pinholes.
pub(super) fn detail_limit(options: &SetupOptions) -> Option<ShiftSum> {
    if options.coverage.draws_outlines() {
        return (options.lod_px > 0.0).then(|| ShiftSum::floor(options.lod_px));
    }
    size_limit(options, options.lod_px)
}
