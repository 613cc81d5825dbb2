//! Both designs line by line: energy, power, bandwidth, area, each with its range.
//!
//! Power is energy times frames per second, so it is dynamic power. Leakage is not in it, because the tables have no source
//! for it. Clock tree and wires are not in it either.

use serde::Serialize;

use super::area::DesignArea;
use super::cost::FrameCost;
use super::range::{Range, Winner};

#[derive(Debug, Clone, Copy)]
pub struct Design<'a> {
    pub cost: &'a FrameCost,
    pub area: &'a DesignArea,
    pub cycles: u64,
    pub frames_per_second: f64,
}

#[derive(Debug, Clone, Serialize)]
pub struct ComparedLine {
    pub what: &'static str,
    pub unit: &'static str,
    pub light: Range,
    pub ray_caster: Range,
    pub overlap: bool,
    /// The design with less, if they do not overlap.
    pub less: Winner,
}

impl Design<'_> {
    /// Its figures, with names and units. `slower`: frames per second of the slower design.
    fn figures(&self, slower: f64) -> [(&'static str, &'static str, Range); 10] {
        let micro = |part| Range::from(part).times(1e-6);
        let energy = self.cost.total();
        let bits = self.cost.traffic.bits() as f64;
        let one = |value: f64| Range::new((value, value, value));
        let rate = self.frames_per_second;
        [
            ("energy of operations", "uJ", micro(&self.cost.operations)),
            (
                "energy of memories on the chip",
                "uJ",
                micro(&self.cost.on_chip),
            ),
            ("energy of outer memory", "uJ", micro(&self.cost.outer)),
            ("energy of the frame", "uJ", energy.times(1e-6)),
            (
                "power at its own speed, without leakage",
                "W",
                energy.times(rate / 1e12),
            ),
            (
                "power at the slower one's speed, without leakage",
                "W",
                energy.times(slower / 1e12),
            ),
            ("traffic to outer memory", "MB a frame", one(bits / 8e6)),
            ("bandwidth at its own speed", "GB/s", one(bits / 8e9 * rate)),
            (
                "bandwidth",
                "bits a cycle",
                one(bits / self.cycles.max(1) as f64),
            ),
            ("area", "NAND2", self.area.range()),
        ]
    }
}

/// The lines. The ray caster's cycles are a lower bound, so its power and bandwidth at its own speed are upper bounds.
pub fn lines(light: Design<'_>, ray_caster: Design<'_>) -> Vec<ComparedLine> {
    let slower = light.frames_per_second.min(ray_caster.frames_per_second);
    let pairs = light
        .figures(slower)
        .into_iter()
        .zip(ray_caster.figures(slower));
    pairs
        .map(|((what, unit, light), (.., ray_caster))| {
            let less = Winner::by_ranges(light, ray_caster);
            ComparedLine {
                what,
                unit,
                light,
                ray_caster,
                overlap: less == Winner::Neither,
                less,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwmodel::cost::Breakdown;

    use crate::model::cost::OuterTraffic;

    #[test]
    fn by_hand() {
        let cost = |picojoules: f64, node_bits: u64| FrameCost {
            operations: Breakdown {
                total: picojoules,
                low: picojoules / 2.0,
                high: picojoules * 2.0,
                ..Breakdown::default()
            },
            on_chip: Breakdown::default(),
            outer: Breakdown::default(),
            traffic: OuterTraffic {
                node_bits,
                ..OuterTraffic::default()
            },
        };
        let area = DesignArea {
            total: 5.0,
            low: 5.0,
            high: 5.0,
            ..DesignArea::default()
        };
        let costs = [cost(1e9, 8_000_000), cost(1e10, 800_000)];
        let design = |at: usize, cycles, frames_per_second| Design {
            cost: &costs[at],
            area: &area,
            cycles,
            frames_per_second,
        };
        let lines = lines(design(0, 4_000_000, 50.0), design(1, 2_000_000, 100.0));
        // A millijoule fifty times per second is 50 mW; ten of them a hundred times are 1 W. A megabyte fifty times per
        // second; two bits per cycle. Energies differ tenfold, and their ranges fourfold either way.
        for (what, figures, less) in [
            ("power at its own", [0.05, 1.0, 0.5], Winner::Light),
            (
                "power at the slower one's",
                [0.05, 0.5, 0.25],
                Winner::Light,
            ),
            (
                "bandwidth at its own",
                [0.05, 0.01, 0.01],
                Winner::RayCaster,
            ),
            ("bandwidth", [2.0, 0.4, 0.4], Winner::RayCaster),
            ("energy of the frame", [1e3, 1e4, 5e3], Winner::Light),
            ("area", [5.0; 3], Winner::Neither),
        ] {
            let mut named = lines
                .iter()
                .filter(|line| line.what.split(" speed").next() == Some(what));
            let line = named.next().unwrap();
            let found = [line.light.value, line.ray_caster.value, line.ray_caster.low];
            for (found, expected) in found.into_iter().zip(figures) {
                assert!((found - expected).abs() < 1e-9 * expected, "{line:?}");
            }
            assert_eq!(
                (line.less, line.overlap),
                (less, less == Winner::Neither),
                "{line:?}"
            );
        }
    }
}
