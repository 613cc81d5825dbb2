//! The light hardware beside the ray caster, at uncertain prices.
//!
//! A price is its figure times a factor whose logarithm is normally distributed. The table's `[spread]` has its standard
//! deviation, and a range `[low, high]` of a row is its 90 % interval. Factors are *shared*: both designs pay the same
//! price for the same operation, at all widths. An operation whose price is derived from another's also has that one's
//! factor. So a high price of outer memory is high for both. Prices are drawn [`DRAWS`] times from a fixed seed.

use std::collections::BTreeMap;

use hwmodel::cost::{Breakdown, Cost, CostTable, Fit, Line};
use hwmodel::cycles::CycleReport;
use serde::{Deserialize, Serialize};

use super::area::DesignArea;
use super::cost::{FrameCost, Prices};
use shiftvox::split_mix::SplitMix;

pub const DRAWS: usize = 4000;
/// A normal variable lies within this many standard deviations of its mean in 90 % of all cases.
const NINETY: f64 = 1.6449;

pub type Design<'a> = (&'a FrameCost, &'a DesignArea, &'a CycleReport);

/// The light hardware's share of the ray caster's figure.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Verdict {
    /// The probability that the light hardware needs less, of the draws.
    pub p_light_less: f64,
    /// The median of the ratio.
    pub median: f64,
    /// 90 % of the ratios lie between `low` and `high`.
    pub low: f64,
    pub high: f64,
    /// The price that moves the ratio most.
    pub decides: String,
    /// By which factor the ratio changes when that price grows by one standard deviation.
    pub moves: f64,
    /// The median of that price times this factor makes both equal at the medians of all others; none does if it is
    /// absent.
    pub turns_at: Option<f64>,
    /// Of the frame's energy: the same for the price of outer memory.
    pub outer_turns_at: Option<f64>,
}

/// One figure of both designs.
#[derive(Debug, Clone, Serialize)]
pub struct ComparedLine {
    pub what: &'static str,
    pub unit: &'static str,
    pub light: f64,
    pub ray_caster: f64,
    /// The first over the second.
    pub ratio: Option<f64>,
    /// None where prices do not matter.
    #[serde(flatten)]
    pub verdict: Option<Verdict>,
}

type Parts = fn(&FrameCost) -> Vec<&Breakdown>;

/// Both designs, figure by figure.
pub fn lines(light: Design<'_>, ray_caster: Design<'_>, prices: &Prices) -> Vec<ComparedLine> {
    let both = [light, ray_caster];
    let energies = |parts: Parts| both.map(|(cost, ..)| parts(cost));
    let line = |what, unit, [light, ray_caster]: [f64; 2]| ComparedLine {
        what,
        unit,
        light,
        ray_caster,
        ratio: (ray_caster > 0.0).then_some(light / ray_caster),
        verdict: None,
    };
    let priced = |what, unit, factor: f64, bills: [Vec<&Breakdown>; 2], of: Priced| {
        let totals = [&bills[0], &bills[1]].map(|bill| total(bill) * factor);
        ComparedLine {
            verdict: Some(verdict(&bills, of, &prices.table)),
            ..line(what, unit, totals)
        }
    };
    let micro = 1e-6;
    let bits = both.map(|(cost, ..)| cost.traffic.bits() as f64);
    let area = both.map(|(_, area, _)| area.parts().to_vec());
    let energy = Priced::Energy;
    let part = |what, of: Parts| priced(what, "uJ", micro, energies(of), energy);
    let mut lines = vec![
        part("energy of operations", |of| vec![&of.operations]),
        part("energy of memories on the chip", |of| vec![&of.on_chip]),
        part("energy of leakage", |of| vec![&of.leakage]),
        part("energy of the clock", |of| vec![&of.clock]),
        part("energy on the chip", |of| of.chip().to_vec()),
        part("energy of outer memory", |of| vec![&of.outer]),
        part("energy of the frame", |of| of.parts().to_vec()),
    ];
    if let Some(ComparedLine { verdict, .. }) = lines.last_mut() {
        *verdict = Some(of_energy(light.0, ray_caster.0, &prices.table));
    }
    lines.push(line(
        "cycles",
        "",
        both.map(|(.., cycles)| cycles.cycles as f64),
    ));
    let power = |(cost, _, cycles): Design<'_>| cost.total() * cycles.frames_per_second / 1e12;
    lines.push(line("power at its own speed", "W", both.map(power)));
    lines.push(line(
        "traffic to outer memory",
        "MB a frame",
        bits.map(|bits| bits / 8e6),
    ));
    lines.push(priced("area", "NAND2", 1.0, area, Priced::Area(prices)));
    lines
}

/// The verdict on the energy of a frame.
pub fn of_energy(light: &FrameCost, ray_caster: &FrameCost, table: &CostTable) -> Verdict {
    let both = [light, ray_caster];
    let on_chip = both.map(FrameCost::chip_total);
    let outer = both.map(|of| of.outer.total);
    Verdict {
        outer_turns_at: equal_at(outer, on_chip),
        ..verdict(&both.map(|of| of.parts().to_vec()), Priced::Energy, table)
    }
}

/// The factor of a price at which both designs need the same: from the totals at that price and at all others.
fn equal_at(at_price: [f64; 2], others: [f64; 2]) -> Option<f64> {
    let factor = (others[1] - others[0]) / (at_price[0] - at_price[1]);
    (factor.is_finite() && factor > 0.0).then_some(factor)
}

fn total(bill: &[&Breakdown]) -> f64 {
    bill.iter().map(|part| part.total).sum()
}

#[derive(Debug, Clone, Copy)]
enum Priced<'a> {
    Energy,
    Area(&'a Prices),
}

impl Priced<'_> {
    /// The figure of an operation from which another one's is derived.
    fn of_leader(self, leader: &str, line: &Line, table: &CostTable) -> Option<Cost> {
        match self {
            // A memory's price is for its size, which its row states.
            Self::Energy if leader.starts_with("sram") => Some(Cost {
                derived: false,
                ..line.each.clone()
            }),
            Self::Energy => table.energy(leader, line.width).ok(),
            Self::Area(prices) => table.area(leader, line.width, prices.goal).ok(),
        }
    }
}

/// Factors of prices: name, and standard deviation of the logarithm.
#[derive(Debug, Default)]
struct Factors {
    numbers: BTreeMap<String, usize>,
    deviations: Vec<f64>,
}

impl Factors {
    fn number(&mut self, name: String, deviation: f64) -> usize {
        *self.numbers.entry(name).or_insert_with(|| {
            self.deviations.push(deviation);
            self.deviations.len() - 1
        })
    }

    /// The factors of a line's price.
    fn of_line(&mut self, line: &Line, priced: Priced<'_>, table: &CostTable) -> Vec<usize> {
        let spread = table.spread();
        let mut found = Vec::new();
        let leader = table.follows(&line.operation);
        let own = match leader {
            Some(_) if line.each.derived => spread.derived.ln(),
            Some(_) => spread.stated.ln(),
            None => deviation(&line.each, table),
        };
        if own > 0.0 {
            found.push(self.number(line.operation.clone(), own));
        }
        if line.each.fit == Fit::Extrapolated {
            let name = format!("{}, beyond the rows", line.operation);
            found.push(self.number(name, spread.extrapolated.ln()));
        }
        if let Some(leader) = leader
            && let Some(cost) = priced.of_leader(leader, line, table)
        {
            found.push(self.number(leader.to_owned(), deviation(&cost, table)));
        }
        found
    }
}

/// Of a price that is derived from no other operation's.
fn deviation(cost: &Cost, table: &CostTable) -> f64 {
    if 0.0 < cost.low && cost.low < cost.high {
        return (cost.high / cost.low).ln() / (2.0 * NINETY);
    }
    match cost.derived {
        true => table.spread().derived.ln(),
        false => table.spread().stated.ln(),
    }
}

/// The middle of a price's distribution over its figure: of a range the root of the product of its ends.
fn middle(cost: &Cost) -> f64 {
    match 0.0 < cost.low && cost.low < cost.high {
        true => (cost.low * cost.high).sqrt() / cost.value,
        false => 1.0,
    }
}

/// An amount and the factors that it has.
type Term = (f64, Vec<usize>);

fn sum(terms: &[Term], factors: &[f64]) -> f64 {
    let of = |(amount, of): &Term| {
        of.iter()
            .fold(*amount, |product, &at| product * factors[at])
    };
    terms.iter().map(of).sum()
}

fn verdict(bills: &[Vec<&Breakdown>; 2], priced: Priced<'_>, table: &CostTable) -> Verdict {
    let mut factors = Factors::default();
    let terms: [Vec<Term>; 2] = [&bills[0], &bills[1]].map(|bill| {
        // Lines with the same factors are one term.
        let mut terms = BTreeMap::<Vec<usize>, f64>::new();
        for line in bill.iter().flat_map(|part| &part.lines) {
            let of = factors.of_line(line, priced, table);
            *terms.entry(of).or_default() += line.total * middle(&line.each);
        }
        terms.into_iter().map(|(of, amount)| (amount, of)).collect()
    });
    let deviations = &factors.deviations;
    let ratio_at = |drawn: &[f64]| sum(&terms[0], drawn) / sum(&terms[1], drawn);
    let mut dice = SplitMix::new(SEED);
    let mut drawn = vec![1.0; deviations.len()];
    let mut ratios: Vec<f64> = (0..DRAWS)
        .map(|_| {
            for (factor, deviation) in drawn.iter_mut().zip(deviations) {
                *factor = libm::exp(deviation * normal(&mut dice));
            }
            ratio_at(&drawn)
        })
        .collect();
    ratios.sort_unstable_by(f64::total_cmp);
    // A tie is half of each.
    let less: f64 = ratios
        .iter()
        .map(|&ratio| match ratio.total_cmp(&1.0) {
            std::cmp::Ordering::Less => 1.0,
            std::cmp::Ordering::Equal => 0.5,
            std::cmp::Ordering::Greater => 0.0,
        })
        .sum();
    let at = |share: f64| ratios[(share * (DRAWS - 1) as f64).round() as usize];
    // One price at a time.
    let figure = ratio_at(&vec![1.0; deviations.len()]);
    let moved = factors.numbers.iter().map(|(name, &number)| {
        let mut one = vec![1.0; deviations.len()];
        one[number] = deviations[number].exp();
        (ratio_at(&one) / figure, name, number)
    });
    let size = |moves: f64| moves.ln().abs();
    let decides = moved.max_by(|a, b| size(a.0).total_cmp(&size(b.0)));
    let (moves, name, number) = decides
        .map_or((1.0, String::new(), None), |(moves, name, number)| {
            (moves, name.clone(), Some(number))
        });
    let turns_at = number.and_then(|number| {
        let [light, rival] = [0, 1].map(|of: usize| {
            let with = terms[of].iter().filter(|(_, of)| of.contains(&number));
            let with: f64 = with.map(|(amount, _)| amount).sum();
            let all: f64 = terms[of].iter().map(|(amount, _)| amount).sum();
            (with, all - with)
        });
        equal_at([light.0, rival.0], [light.1, rival.1])
    });
    Verdict {
        p_light_less: less / DRAWS as f64,
        median: at(0.5),
        low: at(0.05),
        high: at(0.95),
        decides: name,
        moves,
        turns_at,
        outer_turns_at: None,
    }
}

const SEED: u64 = 1;

/// A standard normal number: the sum of twelve uniform ones, less 6 (at most 6 in magnitude).
fn normal(dice: &mut SplitMix) -> f64 {
    (0..12).fold(-6.0, |sum, _| sum + dice.unit())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bill(table: &CostTable, lines: &[(&str, u32, u64)]) -> Breakdown {
        let mut sum = Breakdown::default();
        for &(operation, width, times) in lines {
            let each = table.energy(operation, width).unwrap();
            sum.push(operation, operation, width, times, each);
        }
        sum
    }

    fn cost(operations: Breakdown, outer: Breakdown) -> FrameCost {
        FrameCost {
            operations,
            outer,
            ..FrameCost::default()
        }
    }

    /// Numbers of adders and words of outer memory, in pJ: 0.1 and 1950.
    fn between(light: [u64; 2], ray_caster: [u64; 2]) -> Verdict {
        let table = CostTable::load_shipped().unwrap();
        let [light, ray_caster] = [light, ray_caster].map(|[adds, reads]| {
            let operations = bill(&table, &[("add", 32, adds)]);
            cost(operations, bill(&table, &[("dram_read", 64, reads)]))
        });
        of_energy(&light, &ray_caster, &table)
    }

    #[test]
    fn a_shared_price_does_not_make_a_verdict_uncertain() {
        // Half of each: the ratio is 0.5 at all prices.
        let half = between([10_000, 1], [20_000, 2]);
        let ratios = [half.low, half.median, half.high];
        assert!(
            ratios.iter().all(|ratio| (ratio - 0.5).abs() < 1e-12),
            "{half:?}"
        );
        assert_eq!(half.p_light_less, 1.0);
        assert_eq!(between([20_000, 2], [10_000, 1]).p_light_less, 0.0);
    }

    #[test]
    fn one_uncertain_price_by_hand() {
        // Adders alone against outer memory alone: 1,838 pJ, the middle of a range from 1,300 to 2,600.
        let found = between([18_385, 0], [0, 1]);
        assert!((found.p_light_less - 0.5).abs() < 0.03, "{found:?}");
        assert!((found.median - 1.0).abs() < 0.02, "{found:?}");
        // Deviations of logarithms: ln(1.15) of a stated row, and ln 2 over 3.29 of a range from 1,300 to 2,600. The
        // ratio's is the root of the sum of squares, 0.253; of its logarithms 90 % lie within 1.645 of those.
        let end = (1.6449f64 * (0.1398f64.powi(2) + 0.2107f64.powi(2)).sqrt()).exp();
        assert!((found.high / end - 1.0).abs() < 0.03, "{found:?}, {end}");
        assert!((found.low * end - 1.0).abs() < 0.03, "{found:?}, {end}");
        assert_eq!(found.decides, "dram_read");
        assert!((found.turns_at.unwrap() - 1.0).abs() < 1e-3, "{found:?}");
        // Twice the adders and half the words: equal where a word costs twice as much.
        assert_eq!(between([39_000, 1], [0, 2]).outer_turns_at, Some(2.0));
        assert_eq!(between([39_000, 2], [0, 1]).outer_turns_at, None);
    }

    #[test]
    fn derived_prices_follow_their_leader() {
        let table = CostTable::load_shipped().unwrap();
        let verdict = |light: &str, rival: &str| {
            let bills = [light, rival].map(|operation| bill(&table, &[(operation, 32, 1)]));
            verdict(&[vec![&bills[0]], vec![&bills[1]]], Priced::Energy, &table)
        };
        // The adder's own factor cancels, the other's remains: ln(1.3).
        let found = verdict("sub", "add");
        let width = (found.high / found.low).ln() / (2.0 * NINETY);
        assert!((width / 1.3f64.ln() - 1.0).abs() < 0.03, "{found:?}");
        // Without a common leader, both factors remain.
        let found = verdict("add", "multiply");
        let width = (found.high / found.low).ln() / (2.0 * NINETY);
        assert!(
            (width / (2f64.sqrt() * 1.15f64.ln()) - 1.0).abs() < 0.03,
            "{found:?}"
        );
    }
}
