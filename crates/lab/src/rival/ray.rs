//! The arithmetic of one ray: adders, shifts by constants, and signs.

use hwmodel::{Datapath, OpClass, Probe, Word};

use super::LEVEL_BITS;

/// A sign bit is a wire.
fn is_negative<P: Probe>(dp: &Datapath<P>, word: Word) -> bool {
    dp.bit(word, 63)
}

/// How a ray came into its cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entry {
    /// It begins there.
    Eye,
    /// By the lower plane of an axis.
    Plane(usize),
}

/// A ray in a cell, with axes mirrored so that the ray rises along each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    /// Of each axis, whether it is mirrored: bit `4 >> k`.
    pub(super) mirror: u8,
    /// The cell's lowest corner, in voxels.
    pub(super) low: [u32; 3],
    /// The cell's side is `2^size` voxels.
    pub(super) size: u32,
    entry: Entry,
    /// The eye in voxels, rounded down.
    eye: [i64; 3],
    /// Components of the direction times the cell's side.
    across: [Word; 3],
    /// Of each axis and the next: negative if the cell ends earlier along this one. See [the parent module](super).
    earlier: [Word; 3],
}

impl Ray {
    /// A ray in the object's cube of side `2^depth`; none if it misses it. The direction, and its moments.
    pub(super) fn enter<P: Probe>(
        dp: &mut Datapath<P>,
        (direction, moments): ([Word; 3], [Word; 3]),
        eyes: &[[i64; 2]; 3],
        depth: u32,
    ) -> Option<Self> {
        let mut mirror = 0;
        let mut across = direction;
        for k in 0..3 {
            if is_negative(dp, direction[k]) {
                mirror |= 4 >> k;
                across[k] = dp.neg(direction[k]);
            }
        }
        let across = across.map(|of| dp.shl(of, depth));
        let is_mirrored = |k: usize| mirror & (4 >> k) != 0;
        let earlier = [0, 1, 2].map(|k| {
            let next = (k + 1) % 3;
            let moment = moments[k];
            match (is_mirrored(k), is_mirrored(next)) {
                (false, false) => {
                    let sides = dp.sub(across[next], across[k]);
                    dp.sub(sides, moment)
                }
                (true, false) => dp.sub(moment, across[k]),
                (false, true) => dp.add(across[next], moment),
                (true, true) => dp.neg(moment),
            }
        });
        let mut ray = Self {
            mirror,
            low: [0; 3],
            size: depth,
            entry: Entry::Eye,
            eye: [0, 1, 2].map(|k| eyes[k][usize::from(is_mirrored(k))]),
            across,
            earlier,
        };
        // Beyond the cube along an axis: constants of the frame.
        if ray.eye.iter().any(|&eye| eye >= 1 << depth) {
            return None;
        }
        for k in 0..3 {
            if ray.eye[k] < 0 && !ray.enters_by(dp, k) {
                return None;
            }
        }
        Some(ray)
    }

    /// Whether a ray from below the lower plane of an axis passes it before it leaves the cube. If that is later than for
    /// the axes before, it enters the cube there.
    fn enters_by<P: Probe>(&mut self, dp: &mut Datapath<P>, k: usize) -> bool {
        let mut is_last = true;
        for other in [(k + 1) % 3, (k + 2) % 3] {
            // The lower plane of this axis against the upper plane of the other.
            let is_next = other == (k + 1) % 3;
            let between = match is_next {
                true => dp.sub(self.earlier[k], self.across[other]),
                false => dp.add(self.earlier[other], self.across[other]),
            };
            if is_negative(dp, between) != is_next {
                return false;
            }
            // Against its lower plane: later than that of an axis before.
            if self.entry == Entry::Plane(other) {
                let later = match is_next {
                    true => dp.add(between, self.across[k]),
                    false => dp.sub(self.across[k], between),
                };
                is_last = !is_negative(dp, later);
            }
        }
        if is_last {
            self.entry = Entry::Plane(k);
        }
        true
    }

    /// Into the part of the cell where the ray comes in, of half its side.
    pub(super) fn descend<P: Probe>(&mut self, dp: &mut Datapath<P>) {
        let half = self.across.map(|of| dp.shr(of, 1));
        dp.control(OpClass::Sub, LEVEL_BITS);
        self.size -= 1;
        let middle = 1 << self.size;
        let is_low = |dp: &mut Datapath<P>, k: usize| match self.entry {
            Entry::Eye => {
                let plane = dp.load(self.low[k] + middle);
                let eye = dp.load(self.eye[k]);
                dp.lt(eye, plane)
            }
            Entry::Plane(at) if at == k => true,
            // The lower plane of its entry against the middle of this axis.
            // Operands by the axis of the entry, one of two.
            Entry::Plane(at) if k == (at + 1) % 3 => {
                dp.select(true, half[at], half[at]);
                dp.select(true, half[at], half[at]);
                let lower = dp.sub(self.earlier[at], self.across[k]);
                let passed = dp.add(lower, half[at]);
                is_negative(dp, passed)
            }
            Entry::Plane(at) => {
                dp.select(true, half[at], half[at]);
                dp.select(true, half[at], half[at]);
                let lower = dp.add(self.earlier[k], self.across[k]);
                let passed = dp.sub(half[at], lower);
                is_negative(dp, passed)
            }
        };
        let low = [0, 1, 2].map(|k| is_low(dp, k));
        self.across = half;
        for (k, is_low) in low.into_iter().enumerate() {
            if is_low {
                self.move_upper(dp, k, false);
            } else {
                self.low[k] |= middle;
            }
        }
    }

    /// Moves the plane at which the cell ends along an axis by its side, up or down.
    fn move_upper<P: Probe>(&mut self, dp: &mut Datapath<P>, k: usize, up: bool) {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        // Each sum adds or subtracts one of two components.
        let [of_next, of_last] = [self.across[next], self.across[last]];
        let of_next = dp.select(true, of_next, self.across[k]);
        let of_last = dp.select(false, self.across[k], of_last);
        if up {
            self.earlier[k] = dp.add(self.earlier[k], of_next);
            self.earlier[last] = dp.sub(self.earlier[last], of_last);
        } else {
            self.earlier[k] = dp.sub(self.earlier[k], of_next);
            self.earlier[last] = dp.add(self.earlier[last], of_last);
        }
    }

    /// On to the next cell of the largest side that holds no other part of the last one: false where the ray leaves the
    /// cube.
    pub(super) fn advance<P: Probe>(&mut self, dp: &mut Datapath<P>, depth: u32) -> bool {
        // The axis along which the cell ends first, from three signs.
        let signs = self.earlier.map(|of| is_negative(dp, of));
        dp.and_bits(3, 0, 0);
        dp.and_bits(3, 0, 0);
        let axis = match signs {
            [true, _, false] => 0,
            [false, true, _] => 1,
            _ => 2,
        };
        while self.low[axis] >> self.size & 1 != 0 {
            // It ends there with its parent.
            for k in 0..3 {
                let bit = 1 << self.size;
                if self.low[k] & bit == 0 {
                    self.move_upper(dp, k, true);
                }
                self.low[k] &= !bit;
            }
            self.across = self.across.map(|of| dp.shl(of, 1));
            self.size += 1;
            dp.control(OpClass::Add, LEVEL_BITS);
            dp.control(OpClass::Compare, LEVEL_BITS);
            if self.size == depth {
                return false;
            }
        }
        self.move_upper(dp, axis, true);
        self.low[axis] |= 1 << self.size;
        self.entry = Entry::Plane(axis);
        true
    }
}
