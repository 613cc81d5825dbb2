//! R8 by lines in Plücker coordinates: the lines of a square's samples against the parts of a node (`spec/fast.md`,
//! section 2).
//!
//! `P` is the node centre's clip vector, `e_k` are a voxel's edges, `q` is the sample. A ray has the direction
//! `v_k = (e_k+1 x e_k+2) q` and the moment `m_j = (P x e_j) q` about the centre. Their only error is the rounding of
//! `f32`. Axes are mirrored so that lines run upwards (`v_k >= 0`). The unit of length is the side of a part.

use super::constants::Constants;
use super::directions::{LINE_ERROR, Samples};
use super::lanes::{F32x4, Floats, Isa};
use super::orders::along;
use super::projection::Projection;
use super::strips::{
    BLIND, CELLS, CELLS_PER_WIDTH, MIDDLE, MOST_ERROR, SHARE_STEPS, SHARES, Strips,
};

/// Relative rounding of a centre's column in `f64` over [`LINE_ERROR`]: 2^-50 over 2^-20.
pub(super) const CENTRE_ERROR: f32 = 1.0 / (1 << 30) as f32;
/// Largest distance of a part's centre from the node's, sides of a part.
pub(super) const FARTHEST: f32 = 8.0;

/// By octant: signs of the direction's components, and of products of two of them.
static SIGNS: [[[f32; 4]; 2]; 8] = {
    let mut table = [[[0.0; 4]; 2]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut j = 0;
        while j < 3 {
            if octant >> (2 - j) & 1 == 1 {
                table[octant][0][j] = -0.0;
            }
            if octant >> (2 - (j + 1) % 3) & 1 != octant >> (2 - (j + 2) % 3) & 1 {
                table[octant][1][j] = -0.0;
            }
            j += 1;
        }
        octant += 1;
    }
    table
};

#[derive(Debug, Clone, Copy)]
pub(super) struct Lines<I: Isa> {
    direction: [I::F32x4; 3],
    moment: [I::F32x4; 3],
    pub(super) strips: [&'static Strips; 3],
    /// 1 / (v_n + v_l) in the middle; 0 of blind functions.
    inverse: I::F32x4,
    pub(super) error: f32,
    pub(super) rounding: f32,
    pub(super) has_blind: bool,
    /// Distance from an outline below which a sample is doubtful.
    doubt: I::F32x4,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct InUnits<I: Isa> {
    moment: [I::F32x4; 3],
    next: [I::F32x4; 3],
    last: [I::F32x4; 3],
}

impl<I: Isa> InUnits<I> {
    #[inline(always)]
    pub(super) fn about(&self, isa: I, offset: &Offset) -> [I::F32x4; 3] {
        let [next, last] = [isa.four(&offset.next), isa.four(&offset.last)];
        let mut values = self.moment;
        for (i, value) in values.iter_mut().enumerate() {
            *value = last.fma(self.next[i], value.sub(next.mul(self.last[i])));
        }
        values
    }

    /// The largest value about any part in a square of a size.
    #[inline(always)]
    pub(super) fn reach(&self, isa: I, size: [I::F32x4; 2]) -> f32 {
        let most = [0, 1, 2].map(|i| {
            let shift = self.next[i].abs().add(self.last[i].abs());
            shift.fma(isa.splat(1.5), self.moment[i].abs())
        });
        greatest(most[1].fma(size[0], most[2].fma(size[1], most[0])))
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Line<I: Isa> {
    next: I::F32x4,
    last: I::F32x4,
    moment: I::F32x4,
    width: I::F32x4,
}

#[inline(always)]
fn greatest<F: F32x4>(four: F) -> f32 {
    four.max(four.next()).max(four.last()).values()[0]
}

impl<I: Isa> Lines<I> {
    #[inline(always)]
    pub(super) fn new(
        isa: I,
        constants: &Constants,
        projection: &Projection<I>,
        samples: &Samples<'_, I>,
    ) -> Self {
        let (square, directions, octant) = (samples.square, &samples.directions, samples.octant);
        let [turn, pair] = SIGNS[usize::from(octant & 7)].map(|signs| isa.four(&signs));
        let zero = isa.splat(0.0);
        let half_across = isa.splat((square.right - square.left) as f32 * 0.5);
        let half_down = isa.splat((square.bottom - square.top) as f32 * 0.5);
        let columns = isa.four(&constants.direction_lanes[0]).flip(turn);
        let rows = isa.four(&constants.direction_lanes[1]).flip(turn);
        let middle = directions.middle.flip(turn);
        let first = middle.sub(columns.fma(half_across, rows.mul(half_down)));
        let middle = middle.max(zero);
        let (next, last) = (middle.next(), middle.last());
        let width = next.add(last);
        let inverse = isa.splat(1.0).div(width.max(isa.splat(f32::MIN_POSITIVE)));
        let spread = directions.spread.next().add(directions.spread.last());
        let spread = if directions.is_mixed {
            spread.add(spread)
        } else {
            spread
        };
        let step_x = projection.step[0].flip(pair);
        let step_y = projection.step[1].flip(pair);
        let from = [
            (f64::from(square.left) - projection.centre[0]) as f32,
            (f64::from(square.top) - projection.centre[1]) as f32,
        ];
        let moment = step_x.fma(isa.splat(from[0]), step_y.mul(isa.splat(from[1])));
        let unsure = projection
            .centre
            .map(|c| (c.abs() as f32 + 1.0) * CENTRE_ERROR);
        let reach_x = isa.splat(from[0].abs() + (square.right - square.left) as f32 + unsure[0]);
        let reach_y = isa.splat(from[1].abs() + (square.bottom - square.top) as f32 + unsure[1]);
        let size = step_x.abs().fma(reach_x, step_y.abs().mul(reach_y));
        let direction_size = directions.size.next().add(directions.size.last());
        let doubt = direction_size
            .fma(isa.splat(FARTHEST), size)
            .mul(isa.splat(LINE_ERROR))
            // Above 0: a value of 0 is never certain.
            .max(isa.splat(f32::MIN_POSITIVE));
        let rounding = doubt.mul(inverse);
        let error = spread.mul(inverse).fma(isa.splat(2.0), rounding);
        let half_step = isa.splat(0.5);
        let shares = last
            .mul(inverse)
            .fma(isa.splat(SHARE_STEPS), half_step)
            .indices::<SHARES>();
        let mut strips = [0, 1, 2].map(|j| Strips::of(0, j, shares[j]));
        let mut sees = [1.0; 4];
        let mut has_blind = false;
        let mut most = MOST_ERROR[0];
        if isa.splat(most).sub(error).signs() & 7 != 0 {
            most = MOST_ERROR[MOST_ERROR.len() - 1];
            for (j, error) in error.values().into_iter().enumerate().take(3) {
                if let Some(class) = MOST_ERROR.iter().position(|&most| error <= most) {
                    strips[j] = Strips::of(class, j, shares[j]);
                } else {
                    strips[j] = &BLIND;
                    sees[j] = 0.0;
                    has_blind = true;
                }
            }
        }
        let inverse = if has_blind {
            inverse.mul(isa.four(&sees))
        } else {
            inverse
        };
        Self {
            direction: [first, columns, rows],
            moment: [moment, step_x, step_y],
            strips,
            inverse,
            error: greatest(error).min(most),
            rounding: greatest(rounding),
            has_blind,
            doubt,
        }
    }

    #[inline(always)]
    pub(super) fn in_widths(&self) -> [I::F32x4; 3] {
        self.moment.map(|moment| moment.mul(self.inverse))
    }

    #[inline(always)]
    pub(super) fn in_units(&self, isa: I, units_per_width: f32) -> InUnits<I> {
        let unit = self.inverse.mul(isa.splat(units_per_width));
        InUnits {
            moment: self.moment.map(|moment| moment.mul(unit)),
            next: self.direction.map(|direction| direction.next().mul(unit)),
            last: self.direction.map(|direction| direction.last().mul(unit)),
        }
    }

    #[inline(always)]
    pub(super) fn in_cells(&self, isa: I, widths_per_part: f32) -> [I::F32x4; 3] {
        let unit = self
            .inverse
            .mul(isa.splat(CELLS_PER_WIDTH * widths_per_part));
        let [first, step_x, step_y] = self.moment;
        [
            first.fma(unit, isa.splat(MIDDLE)),
            step_x.mul(unit),
            step_y.mul(unit),
        ]
    }

    #[inline(always)]
    pub(super) fn line(&self, isa: I, [x, y]: &[f32; 2]) -> Line<I> {
        let (x, y) = (isa.splat(*x), isa.splat(*y));
        let at = |[first, step_x, step_y]: &[I::F32x4; 3]| step_x.fma(x, step_y.fma(y, *first));
        let direction = at(&self.direction);
        let (next, last) = (direction.next(), direction.last());
        Line {
            next,
            last,
            moment: at(&self.moment),
            width: next.add(last),
        }
    }

    /// For [`Line::block_cells`].
    #[inline(always)]
    pub(super) fn line_in_cells(&self, isa: I, line: &Line<I>) -> Line<I> {
        let unit = self.inverse.mul(isa.splat(CELLS_PER_WIDTH));
        Line {
            next: line.next.mul(unit),
            last: line.last.mul(unit),
            moment: line.moment.fma(unit, isa.splat(MIDDLE)),
            ..*line
        }
    }

    /// Whether a line certainly meets a part, and whether it may. Different: in doubt.
    #[inline(always)]
    pub(super) fn are_inside(&self, isa: I, line: &Line<I>, offset: &Offset) -> [bool; 2] {
        let from_centre = line.moment.sub(line.shift(isa, offset));
        let outside = line.width.fnma(isa.splat(0.5), from_centre.abs());
        [
            outside.add(self.doubt).signs() & 7 == 7,
            outside.sub(self.doubt).signs() & 7 == 7,
        ]
    }
}

impl<I: Isa> Line<I> {
    #[inline(always)]
    fn shift(&self, isa: I, offset: &Offset) -> I::F32x4 {
        let [next, last] = [isa.four(&offset.next), isa.four(&offset.last)];
        next.fms(self.last, last.mul(self.next))
    }

    #[inline(always)]
    pub(super) fn about(&self, isa: I, block: &Offset) -> Self {
        Self {
            moment: self.moment.sub(self.shift(isa, block)),
            ..*self
        }
    }

    /// Of a line in cells, those about a block.
    #[inline(always)]
    pub(super) fn block_cells(&self, isa: I, block: &Offset) -> [usize; 3] {
        let [next, last] = [isa.four(&block.next), isa.four(&block.last)];
        let cells = next.fnma(self.last, last.fma(self.next, self.moment));
        cells.indices::<CELLS>()
    }
}

/// Offset of a part's centre from its node's, in sides of a part: by function j, along the next axis and the last one.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Offset {
    pub(super) next: [f32; 4],
    pub(super) last: [f32; 4],
}

/// Of parts. The last is of none.
pub(super) static OFFSETS: [Offset; 65] = offsets(1.0);

/// Of blocks, which are four parts wide.
pub(super) static BLOCKS: [Offset; 65] = offsets(4.0);

const fn offsets(side: f32) -> [Offset; 65] {
    let mut table = [Offset {
        next: [0.0; 4],
        last: [0.0; 4],
    }; 65];
    let mut part = 0;
    while part < 64 {
        let mut j = 0;
        while j < 3 {
            table[part].next[j] = (along(part, (j + 1) % 3) as f32 - 1.5) * side;
            table[part].last[j] = (along(part, (j + 2) % 3) as f32 - 1.5) * side;
            j += 1;
        }
        part += 1;
    }
    table
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::fast::constants::Constants;
    use crate::fast::directions::Directions;
    use crate::fast::lanes::Scalar;
    use crate::fast::proof::lines_in_floats;
    use crate::fast::window::Window;
    use crate::graph::Placement;
    use crate::project::{Camera, FrameSetup, SetupOptions};
    use crate::split_mix::SplitMix;
    use glam::DVec3;

    /// A node of a random view, before the eye, of an object of 64 voxels a side.
    pub(in crate::fast) struct Node {
        setup: FrameSetup,
        pub(in crate::fast) constants: Constants,
        pub(in crate::fast) level: usize,
        pub(in crate::fast) min: [f64; 3],
        pub(in crate::fast) centre: [f64; 3],
    }

    impl Node {
        pub(in crate::fast) fn random(dice: &mut SplitMix, least_level: usize) -> Self {
            let mut nodes = std::iter::repeat_with(|| Self::before_the_eye(dice, least_level));
            nodes.find_map(|node| node).unwrap()
        }

        fn before_the_eye(dice: &mut SplitMix, least_level: usize) -> Option<Self> {
            let mut point =
                |size: f64| DVec3::from([(); 3].map(|()| dice.unit() - 0.5)) * size + 32.0;
            let (eye, target) = (point(300.0), point(80.0));
            let fov_degrees = 0.5 + 150.0 * dice.unit() * dice.unit();
            let camera = Camera::looking(eye, target, fov_degrees, (400, 300));
            let placement = Placement::default();
            let setup = FrameSetup::new(&camera, &placement, 6, &SetupOptions::default()).ok()?;
            let constants = Constants::new(&setup).ok()?;
            let level = least_level + dice.below(4 - least_level as u64) as usize;
            let side = constants.levels[level].side as u64;
            let mut node = Self {
                min: [(); 3].map(|()| (dice.below(64) / side * side) as f64),
                centre: [0.0; 3],
                setup,
                constants,
                level,
            };
            node.centre = node.clip(node.min.map(|c| c + side as f64 / 2.0));
            let half_depth = node.constants.levels[level].half_depth;
            (node.centre[2] > half_depth).then_some(node)
        }

        /// The clip vector of a point of the object.
        pub(in crate::fast) fn clip(&self, at: [f64; 3]) -> [f64; 3] {
            [0, 1, 2].map(|c| {
                let along = |k: usize| self.setup.edge_clip[k][c] as f64 * at[k];
                self.setup.origin_clip[c] as f64 + along(0) + along(1) + along(2)
            })
        }
    }

    /// The worst of `|f - truth| / doubt`; the truth is computed in `f64`.
    #[test]
    fn values_are_within_a_bound_that_is_of_use() {
        let mut dice = SplitMix::new(7);
        let (mut worst, mut checked) = (0f64, 0);
        while checked < 200_000 {
            let node = Node::random(&mut dice, 1);
            let (constants, centre) = (&node.constants, node.centre);
            let level = &constants.levels[node.level];
            let side = f64::from(level.side) / 4.0;
            let projection = Projection::new(Scalar, constants, level, centre, 4.0);
            let [left, top] = [0, 1].map(|i| {
                let spread = (dice.unit() - 0.5) * 16.0;
                (projection.centre[i] + spread).clamp(0.0, 280.0) as i32
            });
            let square = Window::of([left, top, left + 7, top + 7]);
            let directions = Directions::of(Scalar, constants, &square);
            let is_far = |i: usize| (f64::from([left, top][i]) - projection.centre[i]).abs() > 40.0;
            if is_far(0) || is_far(1) || directions.is_mixed {
                continue;
            }
            let samples = Samples {
                square: &square,
                open: u64::MAX,
                directions,
                octant: directions.octant,
            };
            let lines = Lines::new(Scalar, constants, &projection, &samples);
            let middle = centre[2] / 2.0;
            let p = DVec3::new(
                centre[0] * constants.root_samples - middle,
                centre[1] * constants.root_samples - middle,
                centre[2],
            );
            let turned = |k: usize| directions.octant >> (2 - k) & 1 == 1;
            for sample in [0, 7, 20, 63] {
                let [x, y] = [sample & 7, sample >> 3];
                let line = lines.line(Scalar, &[x as f32, y as f32]);
                let q = DVec3::new(f64::from(left + x), f64::from(top + y), 1.0);
                let v = constants.direction.map(|d| DVec3::from(d).dot(q).abs());
                for offset in [0, 21, 42, 63].map(|part: usize| &OFFSETS[part]) {
                    if checked < 1000 {
                        let (at, offsets) = ([x, y], [&OFFSETS[sample as usize], offset]);
                        assert_that_the_script_agrees(
                            constants,
                            &projection,
                            &samples,
                            &lines,
                            at,
                            offsets,
                        );
                    }
                    let value = line.moment.sub(line.shift(Scalar, offset));
                    for j in 0..3 {
                        let (n, l) = ((j + 1) % 3, (j + 2) % 3);
                        let turn = if turned(n) == turned(l) { 1.0 } else { -1.0 };
                        let dot = p.cross(DVec3::from(constants.edge[j])).dot(q);
                        let shift =
                            f64::from(offset.next[j]) * v[l] - f64::from(offset.last[j]) * v[n];
                        let truth = dot * constants.scale / side * turn - shift;
                        let error = (f64::from(value[j]) - truth).abs();
                        worst = worst.max(error / f64::from(lines.doubt[j]));
                        checked += 1;
                    }
                }
            }
        }
        assert!(worst < 1.0 && worst > 0.01, "{worst}");
    }

    /// Compares a line against a part of a block with the expressions that Gappa checks, bit by bit.
    fn assert_that_the_script_agrees(
        constants: &Constants,
        projection: &Projection<Scalar>,
        samples: &Samples<'_, Scalar>,
        lines: &Lines<Scalar>,
        [i, j]: [i32; 2],
        [block, part]: [&Offset; 2],
    ) {
        let (square, centre) = (samples.square, projection.centre);
        let sign = |k: usize| 1.0 - 2.0 * f32::from(samples.octant >> (2 - k) & 1);
        let line = lines.line(Scalar, &[i as f32, j as f32]);
        let about = line.about(Scalar, &BLOCKS[(8 * j + i) as usize]);
        let from_centre = about.moment.sub(about.shift(Scalar, part));
        let sides = [
            [square.left, square.right, i],
            [square.top, square.bottom, j],
        ];
        let names = "al bl cl an bn cn x h i right sx fx ox across ax y k j bottom sy fy oy down ay un ul pn pl";
        let mut are_inside = [true; 2];
        for axis in 0..3 {
            let (n, l) = ((axis + 1) % 3, (axis + 2) % 3);
            let directions =
                [l, n].map(|k| constants.direction_lanes.map(|lanes| lanes[k] * sign(k)));
            let [columns, rows] = [0, 1].map(|c| {
                let slope = projection.step[c][axis] * sign(n) * sign(l);
                let [first, last, at] = sides[c].map(|x| x as f32);
                let from = (f64::from(first) - centre[c]) as f32;
                let (width, centre) = (last - first, centre[c].abs() as f32 + 1.0);
                let half = width / 2.0;
                [
                    first + half,
                    half,
                    at,
                    last + 1.0,
                    slope,
                    from,
                    at,
                    width,
                    centre,
                ]
            });
            let offsets = [block, part].map(|at| [at.next[axis], at.last[axis]]);
            let places = [
                directions.as_flattened(),
                &columns,
                &rows,
                offsets.as_flattened(),
            ];
            let inputs = names.split(' ').zip(places.concat());
            let signed = lines_in_floats(inputs.clone());
            let sizes = lines_in_floats(inputs.map(|(name, value)| (name, value.abs())));
            for (of, name, value) in [
                (&signed, "vn", line.next[axis]),
                (&signed, "vl", line.last[axis]),
                (&signed, "m", line.moment[axis]),
                (&signed, "f", from_centre[axis]),
                (&signed, "sum", line.width[axis]),
                (&sizes, "spread", samples.directions.spread[l]),
                (&sizes, "doubt", lines.doubt[axis]),
            ] {
                assert_eq!(of[name], value, "{name}");
            }
            let outside = signed["f"].abs() - signed["half"];
            are_inside[0] &= outside + sizes["doubt"] < 0.0;
            are_inside[1] &= outside - sizes["doubt"] < 0.0;
        }
        assert_eq!(lines.are_inside(Scalar, &about, part), are_inside);
    }
}
