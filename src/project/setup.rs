//! The host's part of a frame, which multiplies and divides: a camera and a placed object become the integers from which
//! every engine starts, so *exact* means exact for them. Rules: `SPEC.md`, "Frame set-up".
//!
//! A point `u` of the object (finest voxels, `0..=2^depth` per side) has the clip vector
//! `(X, Y, W) = origin_clip + sum u_k edge_clip[k]` in units of `2^-clip_frac` finest voxels of depth. `X / W` and `Y / W`
//! are fractions of the image root: the square of `2^levels` samples whose top left corner is the picture's. Sample
//! `(i, j)` is at `((2i + 1) / 2^(levels + 1), (2j + 1) / 2^(levels + 1))`.

use hwmodel::{Format, FormatError};

use super::camera::{Camera, CameraError};
use super::options::{
    MAX_CLIP_FRAC, SetupOptions, ShiftSum, detail_limit, grow_shift, size_limit, split_fraction,
};
use super::reach::{Eye, Quantised, Reach};
use super::real_view::{Levels, RealView};
use crate::graph::{MAX_DEPTH, Placement};

/// Default fraction bits of screen positions, if the format has room.
const DEFAULT_SCREEN_FRAC: u32 = 16;
/// Boxes widened by more samples may leave their words.
const MOST_TOLERANCE_WITH_HEADROOM: f64 = 4.0;
const SCREEN_HEADROOM_BITS: u32 = 5;
/// Samples by which a picture with parallel rays is moved to the left and up. Where samples lie on borders of voxels, as
/// at one voxel per pixel, the converging rays would see both sides.
const ORTHO_SHIFT: f64 = 1.0 / 32.0;

/// Why a frame cannot be set up.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// The camera cannot see.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// Bits and fraction make no word.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The object is deeper than coordinates reach.
    #[error("the object has {0} levels, more than {MAX_DEPTH}")]
    Depth(u32),
    /// The camera is too far away, or its view too narrow.
    #[error(
        "the camera is too far from the object, or its view too narrow, for 64-bit coordinates"
    )]
    OutOfRange,
    /// After quantisation the view has no volume.
    #[error(
        "with {bits} bits and {frac} fraction bits the view collapses to a plane: \
         use more bits, or a camera nearer to the object"
    )]
    Collapsed {
        /// Bits of a word.
        bits: u32,
        /// Fraction bits of clip vectors.
        frac: u32,
    },
    /// A tolerance of a rule that has none.
    #[error(
        "a tolerance of {0} samples does not go with exact or alpha coverage, whose picture is \
         defined at every sample and approximates nothing: leave it at 0, or take the rule any or \
         center"
    )]
    Tolerance(f64),
    /// A setting outside its range.
    #[error("{name} must be {range}, not {value}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Allowed values.
        range: &'static str,
        /// The value.
        value: f64,
    },
}

/// All integers from which an engine starts.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSetup {
    pub options: SetupOptions,
    /// Samples across; the picture's width times the samples per pixel and axis.
    pub width: u32,
    pub height: u32,
    /// Levels of the image quadtree: its root has `2^levels` samples a side.
    pub levels: u32,
    /// Levels of the object: its root has `2^depth` finest voxels a side.
    pub depth: u32,
    /// Word format; its fraction is that of screen positions.
    pub format: Format,
    /// Fraction bits of clip vectors.
    pub clip_frac: u32,
    /// Clip vector `(X, Y, W)` of the object's lowest corner.
    pub origin_clip: [i64; 3],
    /// Clip vectors of a finest voxel's edges along x, y, z.
    pub edge_clip: [[i64; 3]; 3],
    /// Whether `edge_clip` as columns has a positive determinant; otherwise it is negative.
    pub positive: bool,
    /// Levels below a finest voxel to which a solid may be subdivided.
    pub sub_levels: u32,
    /// The eye in object coordinates, units of `2^-sub_levels` voxels, rounded down.
    pub eye_floor: [i64; 3],
    pub eye_ceil: [i64; 3],
    /// Least depth `W` at which `any` and `center` draw.
    pub near: i64,
    /// Least depth `W` of a record that may change to screen space, by octree level. `i64::MAX` where none may.
    pub screen_depth: Vec<i64>,
    /// Least depth `W` of a clip-space node with children that level of detail makes a solid, by octree level. `i64::MAX`
    /// where it makes none.
    pub lod_depth: Vec<i64>,
    /// Whether no word of the frame can overflow.
    pub has_headroom: bool,
    /// The tolerance rounded up to a power of two, by which clip-space boxes are widened in tests against the quadtree, as
    /// a shift to the right (0 = one sample).
    pub grow_shift: Option<i32>,
    /// Size, in samples, up to which a record may be drawn at one sample.
    pub size_limit: ShiftSum,
    /// Size, in samples, up to which a node with children becomes a solid. `None`: only leaves are drawn.
    pub lod_limit: Option<ShiftSum>,
    pub placement: Placement,
    /// Of parallel rays: the camera's eye in object coordinates, from which depth counts.
    pub ortho_eye: Option<[f64; 3]>,
}

impl FrameSetup {
    /// Quantises a camera's view of a placed object of `2^depth` voxels a side.
    pub fn new(
        camera: &Camera,
        placement: &Placement,
        depth: u32,
        options: &SetupOptions,
    ) -> Result<Self, SetupError> {
        let axes = camera.axes()?;
        check_settings(options)?;
        if depth > MAX_DEPTH {
            return Err(SetupError::Depth(depth));
        }
        let longer = camera.width.max(camera.height);
        let root_px_log2 = longer.next_power_of_two().trailing_zeros();
        let levels = root_px_log2 + options.aa_log2;
        let format = {
            let room = options.bits.saturating_sub(levels + SCREEN_HEADROOM_BITS);
            let frac = options.frac.unwrap_or(DEFAULT_SCREEN_FRAC.min(room));
            Format::new(options.bits, frac)?
        };
        let shift = ORTHO_SHIFT / f64::from(1u32 << options.aa_log2);
        let view_from = |distance: f64| {
            let view = RealView::new(camera, &axes, placement, root_px_log2, distance, shift);
            let (clip_frac, sub_levels) = match options.frac {
                Some(frac) => split_fraction(frac, MAX_CLIP_FRAC, options.coverage),
                None => view.widest_fraction(depth, format, options.coverage),
            };
            let sub_levels = sub_levels.min((options.bits - 2).saturating_sub(depth));
            (view, clip_frac, sub_levels)
        };
        let (real_view, clip_frac, sub_levels) = match camera.ortho {
            None => view_from(0.0),
            // Parallel rays are those of a distant eye. If words have room, they converge over the object by at most a 64th
            // of a sample, under `any` and `center` by a quarter.
            Some(_) => {
                let share = if options.coverage.draws_outlines() {
                    6
                } else {
                    2
                };
                let fits = |(view, clip_frac, sub_levels): &(RealView, u32, u32)| {
                    let quantised = view.quantise(*clip_frac);
                    let reach = quantised.and_then(|quantised| Reach::of(&quantised, depth));
                    *clip_frac > 0 && reach.is_some_and(|reach| reach.fits(format, *sub_levels))
                };
                let distances = (0..=depth + levels + share).rev();
                let mut views = distances.map(|log2| view_from(libm::ldexp(1.0, log2 as i32)));
                views.find(fits).ok_or(SetupError::OutOfRange)?
            }
        };
        let quantised = real_view
            .quantise(clip_frac)
            .ok_or(SetupError::OutOfRange)?;
        let reach = Reach::of(&quantised, depth).ok_or(SetupError::OutOfRange)?;
        let tolerance = options.tolerance_px;
        let has_headroom = reach.fits(format, sub_levels)
            && (!tolerance.is_finite() || tolerance <= MOST_TOLERANCE_WITH_HEADROOM)
            && (options.coverage.draws_outlines()
                || levels + format.frac() + SCREEN_HEADROOM_BITS <= options.bits);

        let eye = Eye::solve(&quantised, sub_levels)
            .ok_or(SetupError::OutOfRange)?
            .ok_or(SetupError::Collapsed {
                bits: options.bits,
                frac: clip_frac,
            })?;

        let near = 1i64 << clip_frac.saturating_sub(4);
        let levels_of = Levels {
            depth,
            bound: depth + sub_levels,
            clip_frac,
            near,
        };
        let screen_depth = real_view.screen_depths(&levels_of, options, format.frac());
        let lod_depth = real_view.lod_depths(&levels_of, options);
        Ok(Self {
            options: *options,
            width: camera.width << options.aa_log2,
            height: camera.height << options.aa_log2,
            levels,
            depth,
            format,
            clip_frac,
            origin_clip: quantised.origin,
            edge_clip: quantised.edge,
            positive: eye.positive,
            sub_levels,
            eye_floor: eye.floor,
            eye_ceil: eye.ceil,
            near,
            screen_depth,
            lod_depth,
            has_headroom,
            grow_shift: grow_shift(tolerance),
            size_limit: size_limit(options, 1.0).unwrap_or_default(),
            lod_limit: detail_limit(options),
            placement: *placement,
            ortho_eye: camera.ortho.map(|_| placement.in_voxels(camera.eye)),
        })
    }

    pub fn level_bound(&self) -> u32 {
        self.depth + self.sub_levels
    }

    pub fn without_detail(&self) -> Self {
        let mut whole = self.clone();
        whole.options.lod_px = 0.0;
        whole.lod_depth.fill(i64::MAX);
        whole.lod_limit = None;
        whole
    }

    pub fn position_reach(&self) -> Option<i128> {
        let quantised = Quantised {
            origin: self.origin_clip,
            edge: self.edge_clip,
        };
        Reach::of(&quantised, self.depth).map(|reach| reach.position)
    }

    pub fn depth_unit_world(&self) -> f64 {
        self.placement.voxel_size / (1u64 << self.clip_frac) as f64
    }
}

fn check_settings(options: &SetupOptions) -> Result<(), SetupError> {
    let (tolerance, lod) = (options.tolerance_px, options.lod_px);
    let samples = f64::from(1u32 << options.aa_log2.min(31));
    let sizes = 0.0..=4096.0;
    let is_size = sizes.contains(&tolerance) || tolerance == f64::INFINITY;
    for (name, range, value, is_valid) in [
        ("tolerance", "0 to 4096 samples, or inf", tolerance, is_size),
        (
            "level of detail",
            "0 to 4096 pixels",
            lod,
            sizes.contains(&lod),
        ),
        ("samples per axis", "1, 2 or 4", samples, samples <= 4.0),
    ] {
        if !is_valid {
            return Err(SetupError::Setting { name, range, value });
        }
    }
    if options.coverage.draws_outlines() && tolerance != 0.0 {
        return Err(SetupError::Tolerance(tolerance));
    }
    Ok(())
}
