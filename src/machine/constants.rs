//! The frame's constants as machine words. The only module of the machine that multiplies, on the host.

use hwmodel::{Datapath, NoProbe, Overflow, Probe, WideWord, Word};

use crate::graph::{GraphView, NodeLayout};
use crate::project::FrameSetup;
use crate::project::options::{OutlineRule, ShiftSum};
use crate::project::vector::cross; // host: for a constant of the frame

/// Comparison of a clip-space box with a bisector of the quadtree.
#[derive(Debug, Clone)]
pub(super) enum Margin {
    /// Half-open boxes.
    Plain,
    /// Closed boxes, widened by `2^-shift` samples on each side.
    Grow(i32),
    /// Closed boxes, narrowed by half a sample on each side, under the rules that draw outlines: a quadrant counts if the
    /// box contains a sample point of it.
    Gap,
}

/// Units of the last place: rounded midpoints cannot separate closer vertices.
const LEAST_SIZE: i64 = 4;

/// Records across the near plane are dropped if they span less than its depth, shifted right by this.
const NEAR_CROSSING_SHIFT: u32 = 6;

#[derive(Debug, Clone, Copy)]
pub(super) struct BlendEye {
    /// Places by which coordinates are shifted right.
    pub(super) shift: u32,
    /// The eye in object space, rounded down, shifted.
    pub(super) at: [Word; 3],
}

#[derive(Debug)]
pub(super) struct Constants {
    pub(super) outline: OutlineRule,
    pub(super) blend_eye: Option<BlendEye>,
    pub(super) levels: u32,
    /// Octree level of the finest voxels.
    pub(super) depth: u32,
    /// Levels below them to which a solid may be subdivided.
    pub(super) sub_levels: u32,
    /// The deepest level of a record.
    pub(super) level_bound: u32,
    pub(super) screen_frac: u32,
    /// Places to the left, then right, from half samples to screen positions.
    pub(super) half_sample_places: [u32; 2],
    pub(super) finite_tolerance: bool,
    pub(super) margin: Margin,
    /// As [`Margin::Grow`], for the picture's edges.
    pub(super) grow: Option<i32>,
    /// Samples that a voxel drawn at its centre may span.
    pub(super) size_limit: ShiftSum,
    /// Samples up to which a node is drawn as a solid.
    pub(super) lod_limit: Option<ShiftSum>,
    /// `size_limit` and `lod_limit` in screen units, at least [`LEAST_SIZE`].
    pub(super) size_limit_screen: Word,
    pub(super) lod_limit_screen: Word,
    pub(super) least_size_screen: Word,
    pub(super) near: Word,
    pub(super) near_crossing: Word,
    /// Whether the view is so wide that boxes about the picture's middle need a size of their own.
    pub(super) is_wide: bool,
    /// By level, least depth for the change to screen space.
    pub(super) screen_depth: Vec<Option<Word>>,
    /// By level, least depth of a solid by level of detail.
    pub(super) lod_depth: Vec<Option<Word>>,
    /// The eye, units of `2^-sub_levels` finest voxels, rounded down and up, at most just beyond the object.
    pub(super) eye_floor: [Word; 3],
    pub(super) eye_ceil: [Word; 3],
    /// Whether the edges' clip vectors have a positive determinant.
    pub(super) positive: bool,
    /// `a` and `b` of the planes perpendicular to the three axes.
    pub(super) axis_ab: [[WideWord; 2]; 3],
    /// Their `c` at the root of the quadtree.
    pub(super) axis_c: [WideWord; 3],
    /// The root's planes through its lowest corner, by edge direction.
    pub(super) edge_planes: [[WideWord; 3]; 3],
    /// Clip vector of the root's lowest corner (X, Y, W).
    pub(super) origin: [Word; 3],
    /// Clip vectors of the root's edges: by coordinate, then by axis.
    pub(super) edges: [[Word; 3]; 3],
}

impl Constants {
    pub(super) fn load<P: Probe>(dp: &mut Datapath<P>, setup: &FrameSetup) -> Self {
        let options = &setup.options;
        let outline = options.coverage.outline_rule();
        let scale = setup.sub_levels;
        let (origin_clip, edge_clip) = (setup.origin_clip, setup.edge_clip);
        let mut word = |value: i64, shift: u32| dp.load(i128::from(value) << shift);
        let origin = origin_clip.map(|c| word(c, scale));
        let edges =
            [0, 1, 2].map(|c| [0, 1, 2].map(|k| word(edge_clip[k][c], scale + setup.depth)));
        let depths = |depths: &[i64]| -> Vec<Option<Word>> {
            let depth = |&w: &i64| {
                let scaled = i128::from(w) << scale;
                let reachable = w != i64::MAX && scaled <= i128::from(setup.format.max());
                reachable.then(|| Word::from_host(scaled as i64))
            };
            depths.iter().map(depth).collect()
        };
        // All eyes beyond the object compare equally.
        let beyond = (1i64 << (setup.depth + setup.sub_levels)) + 1;
        let eye = |eye: [i64; 3]| eye.map(|c| Word::from_host(c.clamp(-1, beyond)));
        let screen_frac = setup.format.frac();
        let screen_limit = |limit: &ShiftSum| {
            let units = libm::floor(libm::ldexp(limit.value(), screen_frac as i32));
            Word::from_host((units as i64).max(LEAST_SIZE))
        };
        let near = word(setup.near, scale);
        let near_crossing = near.to_host() >> NEAR_CROSSING_SHIFT; // host: a constant of the frame

        let mut axis_ab = [[WideWord::ZERO; 2]; 3];
        let mut axis_c = [WideWord::ZERO; 3];
        let mut edge_planes = [[WideWord::ZERO; 3]; 3];
        if outline.has_planes() {
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3); // host: an index
                let mut plane = |a: [i64; 3], b: [i64; 3]| {
                    cross(a.map(i128::from), b.map(i128::from)).map(|c| dp.load_wide(c)) // host: a constant of the frame
                };
                let [a, b, c] = plane(edge_clip[i], edge_clip[j]);
                axis_ab[k] = [a, b];
                axis_c[k] = c;
                edge_planes[k] = plane(origin_clip, edge_clip[k]);
            }
        }
        Self {
            outline,
            blend_eye: options.coverage.blends().then(|| {
                let eye = setup.opacity_eye();
                let at = eye.at.map(|c| dp.load(c));
                BlendEye {
                    shift: eye.shift,
                    at,
                }
            }),
            levels: setup.levels,
            depth: setup.depth,
            sub_levels: setup.sub_levels,
            level_bound: setup.level_bound(),
            screen_frac,
            half_sample_places: [screen_frac.saturating_sub(1), u32::from(screen_frac == 0)],
            finite_tolerance: options.tolerance_px.is_finite(),
            margin: match (outline, setup.grow_shift) {
                (OutlineRule::Silhouette, _) => Margin::Gap,
                (OutlineRule::Box | OutlineRule::Centre, Some(shift)) => Margin::Grow(shift),
                (OutlineRule::Box | OutlineRule::Centre, None) => Margin::Plain,
            },
            grow: setup.grow_shift,
            size_limit: setup.size_limit.clone(),
            lod_limit: setup.lod_limit.clone(),
            size_limit_screen: screen_limit(&setup.size_limit),
            lod_limit_screen: setup
                .lod_limit
                .as_ref()
                .map_or(Word::from_host(LEAST_SIZE), screen_limit),
            least_size_screen: Word::from_host(LEAST_SIZE),
            near,
            near_crossing: Word::from_host(near_crossing),
            is_wide: is_wide(setup),
            screen_depth: depths(&setup.screen_depth),
            lod_depth: depths(&setup.lod_depth),
            eye_floor: eye(setup.eye_floor),
            eye_ceil: eye(setup.eye_ceil),
            positive: setup.positive,
            axis_ab,
            axis_c,
            edge_planes,
            origin,
            edges,
        }
    }
}

/// Whether the quadtree's root is more than 16 times as wide as its distance.
fn is_wide(setup: &FrameSetup) -> bool {
    let root = f64::from(1u32 << setup.levels);
    let square = |row: [f64; 3]| row.map(|c| c * c).iter().sum::<f64>(); // host: for a constant of the frame
    let edges = setup.edge_clip.map(|edge| edge.map(|c| c as f64));
    // From the picture's middle, in halves of a root.
    let middle = f64::from(setup.width) / root; // host: for a constant of the frame
    let across = square(edges.map(|[x, _, w]| 2.0 * x - middle * w)); // host: for a constant of the frame
    square(edges.map(|[_, _, w]| w)) > 64.0 * across // host: for a constant of the frame
}
/// The registers of `rtl/machine/frame_constants.v`, then those of planes (`rtl/stage_b/plane_constants.v`), two per
/// constant. A level without a depth has the greatest word.
pub fn frame_registers(setup: &FrameSetup, graph: &GraphView<'_>, layout: &NodeLayout) -> Vec<i64> {
    let mut dp = Datapath::new(setup.format, Overflow::Wrap, NoProbe);
    let c = Constants::load(&mut dp, setup);
    let limits = [&setup.lod_limit, &Some(setup.size_limit.clone())];
    let [lod, sample] = limits.map(|limit| limit.as_ref().map(ShiftSum::value));
    let coarse = lod.is_some_and(|lod| sample.is_some_and(|sample| lod >= sample));
    let has_lod = c.lod_depth.iter().any(Option::is_some);
    let mut registers = vec![0; REGISTERS];
    let mut put =
        |at: usize, values: &[i64]| registers[at..at + values.len()].copy_from_slice(values);
    put(0, &[i64::from(graph.root)]);
    let numbers = [
        c.levels,
        c.depth,
        c.level_bound,
        c.sub_levels,
        setup.width,
        setup.height,
    ];
    put(1, &numbers.map(i64::from));
    let is_leaf = graph.mask(graph.root) == 0;
    let bricks = layout.bricks();
    let flags = [coarse, has_lod, c.positive, is_leaf, !bricks.is_empty()];
    let flags = (0..).zip(flags).map(|(at, flag)| i64::from(flag) << at);
    put(7, &[flags.sum()]);
    let sizes = [c.size_limit_screen, c.lod_limit_screen, c.least_size_screen];
    put(8, &[c.near, c.near_crossing].map(Word::to_host)); // host: a register of rtl/
    put(10, &sizes.map(Word::to_host)); // host: a register of rtl/
    put(16, &c.origin.map(Word::to_host)); // host: a register of rtl/
    put(19, &c.edges.map(|edges| edges.map(Word::to_host)).concat()); // host: a register of rtl/
    put(13, &c.eye_ceil.map(Word::to_host)); // host: a register of rtl/
    put(28, &c.eye_floor.map(Word::to_host)); // host: a register of rtl/
    put(31, &[i64::from(bricks.start)]);
    let depths = c.lod_depth.iter().take(REGISTERS - LEVEL_REGISTERS);
    let depths = depths.map(|depth| depth.map_or(setup.format.max(), Word::to_host)); // host: a register of rtl/
    put(LEVEL_REGISTERS, &depths.collect::<Vec<_>>());
    if c.outline.has_planes() {
        let across = c.axis_ab.iter().zip(&c.axis_c);
        let across = across.flat_map(|(&[a, b], &c)| [a, b, c]);
        for number in across.chain(c.edge_planes.concat()) {
            let number = number.to_host(); // host: a register of rtl/
            registers.extend([number, number >> setup.format.bits().min(63)]);
        }
    }
    registers
}

const REGISTERS: usize = 128;
const LEVEL_REGISTERS: usize = 64;
