//! Shifts that need a shifter. A line that always shifts by one place is wires.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{BuildHasherDefault, Hasher};
use std::panic::Location;

use crate::{OpClass, Probe, Stage, StageLevel};

/// A probe of the places by which every line shifts.
///
/// ```
/// use hwmodel::shifts::ShiftProbe;
/// use hwmodel::{Datapath, Format, Overflow, Stage};
///
/// let draw = Stage::new(0, "draw");
/// let mut probe = ShiftProbe::new();
/// let mut dp = Datapath::new(Format::new(24, 8)?, Overflow::Trap, &mut probe);
/// dp.stage(draw);
/// for level in [1, 2] {
///     dp.begin_record(0, level);
///     for times in [1, 2, 3] {
///         let word = dp.load(times);
///         dp.shl(word, 1); // always 1: wires
///         dp.shr(word, 4); // always 4
///         dp.shl(word, level + 1); // by level
///         dp.shr(word, times as u32); // by operation
///         dp.midpoint(word, word); // a sum, and a shift by 1
///     }
/// }
/// // Three lines need a shifter, six times each.
/// assert_eq!(probe.variable(), [((draw, 24), 18)].into());
/// # Ok::<(), hwmodel::FormatError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ShiftProbe {
    seen: HashMap<SiteKey, Seen, BuildHasherDefault<NumberHasher>>,
    in_turn: Option<Stage>,
    beside: bool,
}

/// Fast for keys of an address and numbers below 256 after it.
#[derive(Debug, Clone, Copy, Default)]
struct NumberHasher(u64);

impl Hasher for NumberHasher {
    #[inline]
    fn write_usize(&mut self, number: usize) {
        self.0 = self.0.rotate_left(8) ^ number as u64;
    }

    #[inline]
    fn write_u32(&mut self, number: u32) {
        self.write_usize(number as usize);
    }

    #[inline]
    fn write_u8(&mut self, number: u8) {
        self.write_usize(number.into());
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u8(byte));
    }

    #[inline]
    fn finish(&self) -> u64 {
        // 2^64 over the golden ratio.
        let product = u128::from(self.0) * 0x9e37_79b9_7f4a_7c15;
        // Both ends of the hash are used: for the table's index and for the tag.
        (product >> 64) as u64 ^ product as u64
    }
}

type Site = &'static Location<'static>;

/// Address of a line, its stage, the stage in whose steps it is done, and the width of its operand.
type SiteKey = (usize, Stage, Stage, u32);

#[derive(Debug, Clone, Copy)]
struct Seen {
    at: Site,
    times: u64,
    /// Whether it shifted by other than one place.
    is_variable: bool,
}

impl ShiftProbe {
    /// A probe without records.
    pub fn new() -> Self {
        Self::default()
    }

    /// Shifts that need a shifter, by stage and width.
    pub fn variable(&self) -> BTreeMap<(Stage, u32), u64> {
        self.sums(|stage, _| stage)
    }

    /// As [`variable`](Self::variable), by the stage in whose steps they are done.
    pub fn variable_in_steps(&self) -> BTreeMap<(Stage, u32), u64> {
        self.sums(|_, step| step)
    }

    fn sums(&self, stage_of: fn(Stage, Stage) -> Stage) -> BTreeMap<(Stage, u32), u64> {
        // A line of generic code has several addresses.
        let line = |&(_, stage, _, bits): &SiteKey, at: Site| {
            (at.file(), at.line(), at.column(), stage, bits)
        };
        let variable = self.seen.iter().filter(|(_, seen)| seen.is_variable);
        let variable: BTreeSet<_> = variable.map(|(key, seen)| line(key, seen.at)).collect();
        let mut sums = BTreeMap::new();
        for (key, seen) in &self.seen {
            if variable.contains(&line(key, seen.at)) {
                let &(_, stage, step, bits) = key;
                *sums.entry((stage_of(stage, step), bits)).or_default() += seen.times;
            }
        }
        sums
    }
}

impl Probe for ShiftProbe {
    #[inline]
    fn op(&mut self, _: OpClass, _: u32, place: StageLevel, _: u32) {
        if !self.beside {
            self.in_turn = Some(place.stage);
        }
    }

    #[inline]
    fn beside(&mut self, begins: bool) {
        self.beside = begins;
    }

    fn shift(&mut self, bits: u32, places: u32, place: StageLevel, site: Site) {
        let step = match self.in_turn {
            Some(stage) if self.beside => stage,
            _ => place.stage,
        };
        let address = std::ptr::from_ref(site) as usize;
        let seen = self.seen.entry((address, place.stage, step, bits));
        let seen = seen.or_insert(Seen {
            at: site,
            times: 0,
            is_variable: false,
        });
        seen.times += 1;
        seen.is_variable |= places != 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Datapath, Format, Overflow};

    #[test]
    fn work_beside_a_stage_is_in_its_steps() {
        let mut probe = ShiftProbe::new();
        let format = Format::new(24, 8).unwrap();
        let mut dp = Datapath::new(format, Overflow::Trap, &mut probe);
        let word = dp.load(1);
        let [pool, child_box, push] = [0, 1, 2].map(|number| Stage::new(number, "test"));
        for stage in [child_box, push] {
            dp.stage(stage);
            dp.add(word, word);
            dp.beside(pool, |dp| dp.shl(word, 2));
        }
        dp.shl(word, 3);
        let of = |stage, times| ((stage, 24), times);
        let by_stage = [of(pool, 2), of(push, 1)];
        assert_eq!(probe.variable(), BTreeMap::from(by_stage));
        let in_steps = [of(child_box, 1), of(push, 2)];
        assert_eq!(probe.variable_in_steps(), BTreeMap::from(in_steps));
    }
}
