//! How far the places of each shift vary. A shift that is always by one place is wires; others need a shifter.

use std::collections::BTreeMap;
use std::panic::Location;

use serde::{Deserialize, Serialize};

use crate::hash::NumberMap;
use crate::{OpClass, Operand, Probe, Stage, StageLevel};

named! {
    /// How far the places of a shift vary.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum ShiftKind {
        /// Always by one place: wires.
        Wires = "wires",
        /// The same in all of a frame.
        Frame = "one a frame",
        /// The same at every octree level.
        Level = "one a level",
        /// Different from operation to operation.
        Operation = "one an operation",
    }
}

/// A line of the machine that shifts, in one stage and width.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct ShiftSite {
    /// File and line, or `midpoint` for the halving of a sum.
    pub site: String,
    pub stage: Stage,
    /// Width of the operand.
    pub bits: u32,
    pub times: u64,
    /// Fewest places.
    pub least: u32,
    /// Most places.
    pub most: u32,
    pub kind: ShiftKind,
    /// `times` by the stage in whose steps they are done.
    #[serde(skip)]
    pub in_steps: BTreeMap<Stage, u64>,
}

#[derive(Debug, Clone, Copy)]
struct Seen {
    times: u64,
    least: u32,
    most: u32,
}

impl Seen {
    fn add(&mut self, other: Self) {
        self.times += other.times;
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
    }
}

/// A probe of the places by which every line shifts.
///
/// ```
/// use hwmodel::shifts::{ShiftKind, ShiftProbe};
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
///         dp.shl(word, 1); // always 1
///         dp.shr(word, 4); // always 4
///         dp.shl(word, level + 1); // by level
///         dp.shr(word, times as u32); // by operation
///         dp.midpoint(word, word); // a sum, and a shift by 1
///     }
/// }
/// let kinds: Vec<ShiftKind> = probe.sites().iter().map(|site| site.kind).collect();
/// use ShiftKind::{Frame, Level, Operation, Wires};
/// assert_eq!(kinds, [Wires, Frame, Level, Operation, Wires]);
/// // Three kinds need a shifter, six times each.
/// assert_eq!(probe.variable(), [((draw, 24), 18)].into());
/// # Ok::<(), hwmodel::FormatError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ShiftProbe {
    seen: NumberMap<SiteKey, (Site, Seen)>,
    halvings: BTreeMap<(Stage, u32), u64>,
    in_turn: Option<Stage>,
    beside: bool,
}

type Site = &'static Location<'static>;
type SiteKey = (usize, Stage, Stage, u32, u32);

impl ShiftProbe {
    /// A probe without records.
    pub fn new() -> Self {
        Self::default()
    }

    /// Every line that shifted, by file, line, stage and width; halvings last.
    pub fn sites(&self) -> Vec<ShiftSite> {
        #[derive(Default)]
        struct Levels {
            in_steps: BTreeMap<Stage, u64>,
            of_level: BTreeMap<u32, Seen>,
        }
        let mut by_site = BTreeMap::<(&str, u32, u32, Stage, u32), Levels>::new();
        for (&(_, stage, step, bits, level), &(at, seen)) in &self.seen {
            let key = (at.file(), at.line(), at.column(), stage, bits);
            let site = by_site.entry(key).or_default();
            *site.in_steps.entry(step).or_default() += seen.times;
            site.of_level
                .entry(level)
                .and_modify(|all| all.add(seen))
                .or_insert(seen);
        }
        let site = |((file, line, _, stage, bits), site): (_, Levels)| {
            let levels = site.of_level;
            let least = levels.values().map(|seen| seen.least).min().unwrap_or(0);
            let most = levels.values().map(|seen| seen.most).max().unwrap_or(0);
            let kind = if levels.values().any(|seen| seen.least < seen.most) {
                ShiftKind::Operation
            } else if least < most {
                ShiftKind::Level
            } else if most == 1 {
                ShiftKind::Wires
            } else {
                // No line of the machine shifts by 0 in every frame.
                ShiftKind::Frame
            };
            ShiftSite {
                site: format!("{file}:{line}"),
                stage,
                bits,
                times: levels.values().map(|seen| seen.times).sum(),
                least,
                most,
                kind,
                in_steps: site.in_steps,
            }
        };
        let halving = |(&(stage, bits), &times): (&(Stage, u32), &u64)| ShiftSite {
            site: "midpoint".to_owned(),
            stage,
            bits,
            times,
            least: 1,
            most: 1,
            kind: ShiftKind::Wires,
            in_steps: BTreeMap::new(),
        };
        let sites = by_site.into_iter().map(site);
        sites.chain(self.halvings.iter().map(halving)).collect()
    }

    /// Shifts that need a shifter, by stage and width.
    pub fn variable(&self) -> BTreeMap<(Stage, u32), u64> {
        self.sums(|site| BTreeMap::from([(site.stage, site.times)]))
    }

    /// As [`variable`](Self::variable), by the stage in whose steps they are done.
    pub fn variable_in_steps(&self) -> BTreeMap<(Stage, u32), u64> {
        self.sums(|site| site.in_steps.clone())
    }

    fn sums(
        &self,
        stages: impl Fn(&ShiftSite) -> BTreeMap<Stage, u64>,
    ) -> BTreeMap<(Stage, u32), u64> {
        let mut sums = BTreeMap::new();
        let sites = self.sites().into_iter();
        for site in sites.filter(|site| site.kind != ShiftKind::Wires) {
            for (stage, times) in stages(&site) {
                *sums.entry((stage, site.bits)).or_default() += times;
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

    #[inline]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        self.op(class, bits, place, 1);
        // Only the datapath's halving of sums has this width.
        if class == OpClass::Shift && matches!(operand, Operand::Carry | Operand::WideCarry) {
            *self.halvings.entry((place.stage, bits)).or_default() += 1;
        }
    }

    fn shift(&mut self, bits: u32, places: u32, place: StageLevel, site: Site) {
        let step = match self.in_turn {
            Some(stage) if self.beside => stage,
            _ => place.stage,
        };
        let address = std::ptr::from_ref(site) as usize;
        let now = Seen {
            times: 1,
            least: places,
            most: places,
        };
        self.seen
            .entry((address, place.stage, step, bits, place.level))
            .and_modify(|(_, seen)| seen.add(now))
            .or_insert((site, now));
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
