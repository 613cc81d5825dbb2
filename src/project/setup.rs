//! The host's part of a frame: a camera and a placed object become the
//! integers that every engine starts from.
//!
//! Here, and only here, is multiplied and divided. The result is quantised
//! once; machine, fast engine, oracle and hardware see the same integers, so
//! *exact* means exact for them. Rules: `SPEC.md`, "Frame set-up".
//!
//! Coordinates. A point `u` of the object (finest voxels, `0..=2^depth` a
//! side) has the clip vector `(X, Y, W) = origin_clip + sum u_k edge_clip[k]`
//! in units of `2^-clip_frac` finest voxels of depth. `X / W` and `Y / W` are
//! fractions of the image root: the square of `2^levels` samples whose top
//! left corner is the picture's. Sample `(i, j)` is at
//! `((2i + 1) / 2^(levels + 1), (2j + 1) / 2^(levels + 1))`.

use glam::DVec3;
use hwmodel::{Format, FormatError};
use serde::{Deserialize, Serialize};

use super::camera::{Axes, Camera, CameraError};
use super::depths;
use crate::graph::{MAX_DEPTH, Placement};

/// Most fraction bits of a clip vector; more would not be seen.
const MAX_CLIP_FRAC: u32 = 30;
/// Most levels below a finest voxel.
const MAX_SUB_LEVELS: u32 = 24;
/// Fraction bits of screen positions, unless the format or the user says otherwise.
const DEFAULT_SCREEN_FRAC: u32 = 16;
/// Boxes widened by more samples than this may leave their words.
const MOST_TOLERANCE_WITH_HEADROOM: f64 = 4.0;
/// Bits of a word beyond a screen position's fraction and the levels of the
/// image: sign, guard, and sums of eight vertices.
const SCREEN_HEADROOM_BITS: u32 = 5;
/// The same for an infinite tolerance under `exact`: positions may be twelve
/// pictures away, and eight of them are added.
const FAR_SCREEN_HEADROOM_BITS: u32 = 8;
/// Records whose box leaves the picture by more than this part of it do not
/// change to screen space (as a shift: 2^-3).
pub const SCREEN_GUARD_SHIFT: u32 = 3;

/// How a record holds its projected vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CageKind {
    /// Eight corners in Morton order (the paper).
    Corners,
    /// One corner and three edge vectors.
    #[default]
    Frame,
}

/// Which pixels a voxel draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Coverage {
    /// The pixel in which its whole box lies (the paper).
    Any,
    /// The pixel that holds its centre, once it is no larger than a pixel.
    Center,
    /// Every pixel whose centre lies inside its silhouette.
    #[default]
    Exact,
    /// As `Exact`, each voxel with its opacity, blended front to back.
    Alpha,
}

impl Coverage {
    /// Whether voxels are drawn by their silhouettes.
    #[inline]
    #[must_use]
    pub const fn draws_outlines(self) -> bool {
        matches!(self, Self::Exact | Self::Alpha)
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
    /// space to screen space: 0 never, infinity at once.
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
        Self {
            bits: 64,
            frac: None,
            cage: CageKind::default(),
            tolerance_px: 1.0 / 8.0,
            coverage: Coverage::default(),
            lod_px: 1.0,
            aa_log2: 0,
        }
    }
}

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
    /// Camera and object are out of all proportion.
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
    /// A setting outside its range.
    #[error("{name} must be {range}, not {value}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// What it may be.
        range: &'static str,
        /// What it was.
        value: f64,
    },
}

/// The recorded input of a frame: all integers that an engine starts from.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSetup {
    /// What was asked for.
    pub options: SetupOptions,
    /// Samples across; the picture's width times the samples per pixel and axis.
    pub width: u32,
    /// Samples down.
    pub height: u32,
    /// Levels of the image quadtree: its root has `2^levels` samples a side.
    pub levels: u32,
    /// Levels of the object: its root has `2^depth` finest voxels a side.
    pub depth: u32,
    /// Word format; its fraction is the one of screen positions.
    pub format: Format,
    /// Fraction bits of clip vectors.
    pub clip_frac: u32,
    /// Clip vector `(X, Y, W)` of the object's lowest corner.
    pub origin_clip: [i64; 3],
    /// Clip vectors of a finest voxel's edges along x, y, z.
    pub edge_clip: [[i64; 3]; 3],
    /// Whether `edge_clip` as columns has a positive determinant (else negative).
    pub positive: bool,
    /// Levels below a finest voxel to which a solid may be subdivided.
    pub sub_levels: u32,
    /// The eye in object coordinates, units of `2^-sub_levels` voxels, rounded down.
    pub eye_floor: [i64; 3],
    /// The same, rounded up.
    pub eye_ceil: [i64; 3],
    /// Least depth `W` at which `any` and `center` draw (`exact` draws all
    /// that is before the eye), units of `2^-clip_frac` voxels.
    pub near: i64,
    /// By octree level, least depth `W` of a record that may change to screen
    /// space; `i64::MAX`: none may.
    pub screen_depth: Vec<i64>,
    /// By octree level, least depth `W` of a clip-space node with children that
    /// level of detail takes for a solid; `i64::MAX`: none is.
    pub lod_depth: Vec<i64>,
    /// Fraction bits of strips beyond those that their levels need.
    pub strip_guard: u32,
    /// By how much strips and boxes of a lattice are wider than the voxels: as
    /// a shift to the right of what a step of a sample along both axes adds;
    /// `None`: nothing.
    pub strip_slack: Option<u32>,
    /// Whether no word of a frame with these integers can overflow.
    pub has_headroom: bool,
    /// What a clip-space box is widened by when it is tested against the
    /// quadtree, in samples, as a shift to the right (0 = one sample): the
    /// tolerance, rounded up to a power of two; `None`: nothing.
    pub grow_shift: Option<i32>,
    /// Size, in samples, up to which a record may be drawn at one sample.
    pub size_limit: ShiftSum,
    /// Size, in samples, up to which a node with children is taken for a
    /// solid; `None`: only leaves are drawn.
    pub lod_limit: Option<ShiftSum>,
    /// Where the object lies, to name voxels and depths.
    pub placement: Placement,
}

impl FrameSetup {
    /// Quantises a camera's view of a placed object of `2^depth` voxels a side.
    ///
    /// # Errors
    /// When the camera cannot see, the format is none, or a setting is out of its range.
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
        let root_px_log2 = root_log2(camera.width, camera.height);
        let levels = root_px_log2 + options.aa_log2;
        let view = View::new(camera, &axes, placement, root_px_log2);

        let format = {
            let room = options.bits.saturating_sub(levels + SCREEN_HEADROOM_BITS);
            let frac = options.frac.unwrap_or(DEFAULT_SCREEN_FRAC.min(room));
            Format::new(options.bits, frac)?
        };
        let (clip_frac, sub_levels) = match options.frac {
            Some(frac) => split_fraction(frac, MAX_CLIP_FRAC, options.coverage),
            None => view.widest_fraction(depth, format, options.coverage),
        };
        let sub_levels = sub_levels.min((options.bits - 2).saturating_sub(depth));
        let (origin_clip, edge_clip) = view.quantise(clip_frac).ok_or(SetupError::OutOfRange)?;
        let reach = reach(&origin_clip, &edge_clip, depth).ok_or(SetupError::OutOfRange)?;
        let finite = options.tolerance_px.is_finite();
        let has_headroom = reach.fits(format, sub_levels)
            && (!finite || options.tolerance_px <= MOST_TOLERANCE_WITH_HEADROOM)
            && levels + format.frac() + screen_headroom_bits(options) <= options.bits;

        let eye = Eye::solve(&origin_clip, &edge_clip, sub_levels)
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
        let strip_guard = depths::strip_guard(options.tolerance_px);
        let strip_slack = depths::strip_slack(options.tolerance_px);
        Ok(Self {
            options: *options,
            width: camera.width << options.aa_log2,
            height: camera.height << options.aa_log2,
            levels,
            depth,
            format,
            clip_frac,
            origin_clip,
            edge_clip,
            positive: eye.positive,
            sub_levels,
            eye_floor: eye.floor,
            eye_ceil: eye.ceil,
            near,
            screen_depth: view.screen_depths(&levels_of, options, format.frac(), strip_guard),
            lod_depth: view.lod_depths(&levels_of, options),
            strip_guard,
            strip_slack,
            has_headroom,
            grow_shift: grow_shift(options),
            size_limit: size_limit(options, 1.0).unwrap_or_default(),
            lod_limit: detail_limit(options),
            placement: *placement,
        })
    }

    /// The deepest level of a record: the finest voxels' level and the
    /// levels to which a solid may be subdivided.
    #[must_use]
    pub fn level_bound(&self) -> u32 {
        self.depth + self.sub_levels
    }

    /// Largest magnitude of a coordinate of a clip vector in the object.
    #[must_use]
    pub fn position_reach(&self) -> Option<i128> {
        reach(&self.origin_clip, &self.edge_clip, self.depth).map(|reach| reach.position)
    }

    /// By octree level, least depth `W` of a record whose lattice, under the
    /// exact rule, deviates from its projection by at most so many samples.
    #[must_use]
    pub fn lattice_depths(&self, deviation_px: f64) -> Vec<i64> {
        let unit = libm::ldexp(1.0, -(self.clip_frac as i32));
        let edges = depths::Edges {
            edge: self
                .edge_clip
                .map(|e| DVec3::from_array(e.map(|c| c as f64 * unit))),
            root_samples: libm::ldexp(1.0, self.levels as i32),
        };
        let levels = Levels {
            depth: self.depth,
            bound: self.depth,
            clip_frac: self.clip_frac,
            near: 1,
        };
        let allowed = deviation_px - self.lattice_rounding();
        if allowed <= 0.0 {
            return vec![i64::MAX; self.depth as usize + 1];
        }
        levels.scaled(edges.screen_depth(Coverage::Exact, allowed))
    }

    /// Most, in samples, by which rounding moves an outline of such a lattice.
    #[must_use]
    pub fn lattice_rounding(&self) -> f64 {
        depths::rounding(Coverage::Exact, self.format.frac(), self.strip_guard)
    }

    /// World depth of one unit of `W`.
    #[must_use]
    pub fn depth_unit_world(&self) -> f64 {
        self.placement.voxel_size / (1u64 << self.clip_frac) as f64
    }
}

/// Shares `total` fraction bits of a position between the precision of the
/// view (at most `most`) and exact halving below the finest voxels, which
/// only the rules that subdivide solids have a use for.
fn split_fraction(total: u32, most: u32, coverage: Coverage) -> (u32, u32) {
    if coverage.draws_outlines() {
        return (total.min(most), 0);
    }
    let clip_frac = most.min(total - total / 3);
    (clip_frac, (total - clip_frac).min(MAX_SUB_LEVELS))
}

/// `ceil(log2)` of the longer side of a picture.
#[must_use]
pub fn root_log2(width: u32, height: u32) -> u32 {
    width.max(height).next_power_of_two().trailing_zeros()
}

/// Bits of a word beyond a screen position's, with which no sum of positions overflows.
fn screen_headroom_bits(options: &SetupOptions) -> u32 {
    if options.tolerance_px.is_infinite() && options.coverage.draws_outlines() {
        FAR_SCREEN_HEADROOM_BITS
    } else {
        SCREEN_HEADROOM_BITS
    }
}

fn check_settings(options: &SetupOptions) -> Result<(), SetupError> {
    let bad = |name, range, value| Err(SetupError::Setting { name, range, value });
    if options.tolerance_px.is_nan() || options.tolerance_px < 0.0 {
        return bad("tolerance", "0 pixels or more", options.tolerance_px);
    }
    // Beyond any picture, and within any word: more is what `inf` is for.
    if options.tolerance_px.is_finite() && options.tolerance_px > 4096.0 {
        return bad(
            "tolerance",
            "0 to 4096 pixels, or inf",
            options.tolerance_px,
        );
    }
    if !(0.0..=4096.0).contains(&options.lod_px) {
        return bad("level of detail", "0 to 4096 pixels", options.lod_px);
    }
    if options.aa_log2 > 2 {
        let samples = f64::from(1u32 << options.aa_log2.min(31));
        return bad("samples per axis", "1, 2 or 4", samples);
    }
    Ok(())
}

/// The tolerance, rounded up to `2^-shift` samples.
fn grow_shift(options: &SetupOptions) -> Option<i32> {
    let tolerance = options.tolerance_px;
    (tolerance > 0.0 && tolerance.is_finite()).then(|| -(libm::ceil(libm::log2(tolerance)) as i32))
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
        let kept = libm::floor(libm::ldexp(value, SHIFT_SUM_BITS - 1 - leading)) as u32;
        Self(
            (0..SHIFT_SUM_BITS)
                .filter(|place| kept >> (SHIFT_SUM_BITS - 1 - place) & 1 != 0)
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
        self.0.iter().map(|&s| libm::ldexp(1.0, -s)).sum()
    }
}

/// A size in samples, less its share of twice the tolerance, so that
/// neighbours that deviate by the tolerance leave no pinhole; `None` for 0.
fn size_limit(options: &SetupOptions, samples: f64) -> Option<ShiftSum> {
    let finite = options.tolerance_px.is_finite();
    let tolerance = if finite { options.tolerance_px } else { 0.0 };
    // Never below an eighth: with coarser tolerances the user has chosen holes.
    let share = (1.0 - 2.0 * tolerance).max(0.125);
    (samples > 0.0).then(|| ShiftSum::floor(samples * share))
}

/// The size of a node that level of detail takes for a solid; `None` for 0.
/// Under `exact`, where a solid is drawn at every sample of its silhouette and
/// not at one, it needs no share for pinholes.
fn detail_limit(options: &SetupOptions) -> Option<ShiftSum> {
    if options.coverage.draws_outlines() {
        return (options.lod_px > 0.0).then(|| ShiftSum::floor(options.lod_px));
    }
    size_limit(options, options.lod_px)
}

/// The view of the object in real numbers.
struct View {
    /// Clip vectors of a voxel's edges.
    edge: [DVec3; 3],
    /// The eye in object coordinates, voxels.
    eye: DVec3,
    /// Pixels of the image root, as a power of two.
    root_px_log2: u32,
}

impl View {
    fn new(camera: &Camera, axes: &Axes, placement: &Placement, root_px_log2: u32) -> Self {
        let root_px = f64::from(1u32 << root_px_log2);
        let centre_x = f64::from(camera.width) / 2.0;
        let centre_y = f64::from(camera.height) / 2.0;
        let x = (axes.right * axes.focal_px + axes.forward * centre_x) / root_px;
        let y = (axes.up * -axes.focal_px + axes.forward * centre_y) / root_px;
        let w = axes.forward;
        let origin = placement.origin_index;
        let eye = (camera.eye - DVec3::from_array(placement.world_origin)) / placement.voxel_size
            - DVec3::new(origin[0] as f64, origin[1] as f64, origin[2] as f64);
        Self {
            edge: [0, 1, 2].map(|k| DVec3::new(x[k], y[k], w[k])),
            eye,
            root_px_log2,
        }
    }

    /// Integers of `2^-frac` voxels, if they fit 64 bits with room.
    ///
    /// The origin is made from the rounded edges, so that the eye stays where
    /// the camera has it and only the view's shape is rounded.
    fn quantise(&self, frac: u32) -> Option<([i64; 3], [[i64; 3]; 3])> {
        let scale = (1u64 << frac) as f64;
        let mut edge = [[0i64; 3]; 3];
        for (to, from) in edge.iter_mut().zip(&self.edge) {
            for (c, value) in to.iter_mut().enumerate() {
                *value = to_i64(from[c] * scale)?;
            }
        }
        let mut origin = [0i64; 3];
        for (c, value) in origin.iter_mut().enumerate() {
            let sum: f64 = (0..3).map(|k| edge[k][c] as f64 * self.eye[k]).sum();
            *value = to_i64(-sum)?;
        }
        Some((origin, edge))
    }

    /// The most fraction bits, and levels below a finest voxel, with which
    /// positions fit a word and silhouette planes a wide word, with headroom
    /// (bisector tests take `2X - W`, the divide `X + 4W` and `8W`).
    fn widest_fraction(&self, depth: u32, format: Format, coverage: Coverage) -> (u32, u32) {
        let fits = |frac: u32, shift: u32, plane_too: bool| {
            self.quantise(frac)
                .and_then(|(origin, edge)| reach(&origin, &edge, depth))
                .is_some_and(|reach| {
                    reach.position_fits(format, shift) && (!plane_too || reach.plane_fits(format))
                })
        };
        let plane_frac = (0..=MAX_CLIP_FRAC).rev().find(|&f| fits(f, 0, true));
        let Some(plane_frac) = plane_frac else {
            return (0, 0);
        };
        let room = (0..=MAX_SUB_LEVELS)
            .rev()
            .find(|&shift| fits(plane_frac, shift, false))
            .unwrap_or(0);
        split_fraction(plane_frac + room, plane_frac, coverage)
    }
}

/// The octree levels of a frame, and the unit of its depths.
struct Levels {
    /// Level of the finest voxels.
    depth: u32,
    /// Deepest level of a record.
    bound: u32,
    clip_frac: u32,
    /// Least of all depths below.
    near: i64,
}

impl Levels {
    /// By level, the depth that is `unit` for a finest voxel, in clip units, rounded up.
    fn scaled(&self, unit: f64) -> Vec<i64> {
        let at = |level: u32| {
            // A record's side in voxels, exact in f64.
            let side = libm::ldexp(unit, self.depth as i32 - level as i32);
            let depth = libm::ceil(libm::ldexp(side, self.clip_frac as i32));
            to_i64(depth).map_or(i64::MAX, |w| w.max(self.near))
        };
        (0..=self.bound).map(at).collect()
    }
}

impl View {
    fn edges(&self, options: &SetupOptions) -> depths::Edges {
        depths::Edges {
            edge: self.edge,
            root_samples: f64::from(1u32 << (self.root_px_log2 + options.aa_log2)),
        }
    }

    /// Least `W`, by level, at which a record deviates from its screen-space
    /// cage by at most the tolerance: `SPEC.md`, "The change to screen space".
    fn screen_depths(
        &self,
        levels: &Levels,
        options: &SetupOptions,
        screen_frac: u32,
        strip_guard: u32,
    ) -> Vec<i64> {
        if options.tolerance_px.is_infinite() {
            return vec![levels.near; levels.bound as usize + 1];
        }
        let rounding = depths::rounding(options.coverage, screen_frac, strip_guard);
        // The slack takes its part of the tolerance: all that is drawn lies
        // within that of the voxels.
        let slack = match depths::strip_slack(options.tolerance_px) {
            Some(places) if options.coverage.draws_outlines() => libm::ldexp(1.0, -(places as i32)),
            _ => 0.0,
        };
        let allowed = (options.tolerance_px - rounding - slack) * (1.0 - 1e-6);
        if options.tolerance_px == 0.0 || allowed <= 0.0 {
            return vec![i64::MAX; levels.bound as usize + 1];
        }
        levels.scaled(self.edges(options).screen_depth(options.coverage, allowed))
    }

    /// Least `W`, by level, at which a node with children is no larger than
    /// the level of detail, wherever in the picture.
    fn lod_depths(&self, levels: &Levels, options: &SetupOptions) -> Vec<i64> {
        match detail_limit(options) {
            Some(limit) => levels.scaled(self.edges(options).detail_depth(limit.value())),
            None => vec![i64::MAX; levels.bound as usize + 1],
        }
    }
}

/// A rounded f64 that fits 62 bits.
fn to_i64(value: f64) -> Option<i64> {
    let rounded = libm::round(value);
    (rounded.abs() < (1u64 << 62) as f64).then_some(rounded as i64)
}

/// Largest magnitudes that a frame meets.
struct Reach {
    /// Of a coordinate of a clip vector.
    position: i128,
    /// Of a silhouette plane: the sum of its three coefficients.
    plane: i128,
}

impl Reach {
    /// Whether positions leave headroom (bisector tests take `2X - W`, the
    /// guard `8X + W`, the divide `X + 4W` and `8W`).
    fn position_fits(&self, format: Format, shift: u32) -> bool {
        self.position << shift <= i128::from(format.max()) / 16
    }

    fn plane_fits(&self, format: Format) -> bool {
        self.plane <= i128::from(format.wide().max()) / 8
    }

    fn fits(&self, format: Format, sub_levels: u32) -> bool {
        self.position_fits(format, sub_levels) && self.plane_fits(format)
    }
}

/// The reach over the object's eight corners; intermediate vertices lie between.
/// `None` where it does not fit 127 bits.
fn reach(origin: &[i64; 3], edge: &[[i64; 3]; 3], depth: u32) -> Option<Reach> {
    let mut reach = Reach {
        position: 0,
        plane: 0,
    };
    for corner in 0..8u32 {
        let mut at = origin.map(i128::from);
        for (k, step) in edge.iter().enumerate() {
            if corner >> (2 - k) & 1 == 1 {
                for c in 0..3 {
                    at[c] += i128::from(step[c]) << depth;
                }
            }
        }
        for c in at {
            reach.position = reach.position.max(c.abs());
        }
        if reach.position > 1 << 62 {
            return None;
        }
        for step in edge {
            let plane = cross(&at, &step.map(i128::from));
            let sum = plane.iter().map(|c| c.abs()).sum::<i128>();
            reach.plane = reach.plane.max(sum);
        }
    }
    Some(reach)
}

fn cross(a: &[i128; 3], b: &[i128; 3]) -> [i128; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The eye of the quantised view, exactly: where the clip vector is zero.
struct Eye {
    floor: [i64; 3],
    ceil: [i64; 3],
    positive: bool,
}

impl Eye {
    /// Solves `origin + sum u_k edge_k = 0` by Cramer's rule, in units of
    /// `2^-sub_levels`. `None`: beyond 127 bits; `Some(None)`: no volume.
    fn solve(origin: &[i64; 3], edge: &[[i64; 3]; 3], sub_levels: u32) -> Option<Option<Self>> {
        let edge = edge.map(|e| e.map(i128::from));
        let minus_origin = origin.map(|c| -i128::from(c));
        let determinant = |m: &[[i128; 3]; 3]| -> Option<i128> {
            let minor = cross(&m[1], &m[2]);
            (0..3).try_fold(0i128, |sum, c| {
                m[0][c].checked_mul(minor[c])?.checked_add(sum)
            })
        };
        let whole = determinant(&edge)?;
        if whole == 0 {
            return Some(None);
        }
        let mut floor = [0; 3];
        let mut ceil = [0; 3];
        for k in 0..3 {
            let mut replaced = edge;
            replaced[k] = minus_origin;
            let part = determinant(&replaced)?.checked_mul(1i128 << sub_levels)?;
            let (part, whole) = (part * whole.signum(), whole.abs());
            floor[k] = i64::try_from(part.div_euclid(whole)).ok()?;
            ceil[k] = floor[k] + i64::from(part.rem_euclid(whole) != 0);
        }
        Some(Some(Self {
            floor,
            ceil,
            positive: whole > 0,
        }))
    }
}
