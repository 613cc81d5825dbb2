//! Directed and random inputs: ends of ranges, ties, and random numbers.

use hwmodel::{Probe, WideWord, Word};

use crate::frame::QuadNode;
use crate::machine::cage::CageCoordinate;
use crate::machine::record::{Clip, Cube, Planes};
use crate::machine::state::State;
use crate::project::FrameSetup;
use crate::split_mix::SplitMix;

/// Bits by which words stay below the ends of the format where they are added, doubled or halved a few times.
pub(super) const SPARE: u32 = 8;

pub(super) struct Inputs {
    pub(super) dice: SplitMix,
    pub(super) bits: u32,
    wide_bits: u32,
}

impl Inputs {
    /// For the blocks of a frame; reproducible.
    pub(super) fn new(setup: &FrameSetup) -> Self {
        Self {
            dice: SplitMix::new(0),
            bits: setup.format.bits(),
            wide_bits: setup.format.wide().bits(),
        }
    }

    /// A number of at most `bits` bits with its sign: an end of the range, near zero, or random.
    pub(super) fn number(&mut self, bits: u32) -> i64 {
        let most = i64::MAX >> (64 - bits);
        let ends = [-most - 1, -most, most, most - 1, -2, -1, 0, 1, 2];
        // Every third is one of these.
        let choice = self.dice.below(27) as usize;
        if let Some(&end) = ends.get(choice) {
            return end;
        }
        // Every number of bits is equally frequent.
        let length = 1 + self.dice.below(u64::from(bits)) as u32;
        (self.dice.bits() as i64) >> (64 - length)
    }

    pub(super) fn word(&mut self, spare: u32) -> Word {
        Word::from_host(self.number(self.bits - spare))
    }

    pub(super) fn words<const N: usize>(&mut self, spare: u32) -> [Word; N] {
        std::array::from_fn(|_| self.word(spare))
    }

    pub(super) fn flag(&mut self) -> bool {
        self.dice.below(2) == 1
    }

    /// -1, 0 or 1.
    pub(super) fn step(&mut self) -> Word {
        Word::from_host(self.dice.below(3) as i64 - 1)
    }

    pub(super) fn level(&mut self, most: u32) -> u32 {
        self.dice.below(u64::from(most) + 1) as u32
    }

    /// A coordinate whose numbers are independent of each other.
    pub(super) fn cage<P: Probe, L: CageCoordinate>(
        &mut self,
        state: &mut State<'_, P, L, ()>,
    ) -> L {
        let any = L::from_frame(&mut state.dp, Word::ZERO, [Word::ZERO; 3]);
        any.map(|_| self.word(SPARE))
    }

    pub(super) fn clip<P: Probe, L: CageCoordinate>(
        &mut self,
        state: &mut State<'_, P, L, ()>,
    ) -> Clip<L> {
        let [x, y, w] = [(); 3].map(|()| self.cage(state));
        let (w_min, _) = w.span(&mut state.dp);
        Clip { x, y, w, w_min }
    }

    /// Planes of small coefficients, which have ties, or of large ones.
    pub(super) fn planes(&mut self) -> Planes {
        let bits = if self.flag() { 2 } else { self.wide_bits >> 1 };
        let mut number = || WideWord::from_host(self.number(bits));
        Planes {
            edge: std::array::from_fn(|_| std::array::from_fn(|_| number())),
            axis_c: std::array::from_fn(|_| number()),
        }
    }

    pub(super) fn cube(&mut self, level: u32) -> Cube {
        Cube {
            min: self.words(0),
            max: self.words(0),
            node: 0,
            level,
            voxel_level: level,
            solid: true,
        }
    }

    pub(super) fn quad(&mut self, levels: u32) -> QuadNode {
        let level = self.level(levels);
        let mut place = || self.dice.below(1 << level) as u32;
        QuadNode {
            level,
            x: place(),
            y: place(),
        }
    }
}
