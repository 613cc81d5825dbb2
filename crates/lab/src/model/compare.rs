//! Both designs line by line, each figure with its range: energy, power,
//! bandwidth, area; and whether the ranges overlap.
//!
//! Power is energy times frames a second: of what switches. Leakage is not in it, for
//! the tables have no source for it; nor are clock tree and wires.

use serde::Serialize;

use super::area::DesignArea;
use super::cost::FrameCost;
use super::range::{Range, Winner};

/// A design and what a frame takes on it.
#[derive(Debug, Clone, Copy)]
pub struct Design<'a> {
    /// Energy and traffic.
    pub cost: &'a FrameCost,
    /// Area.
    pub area: &'a DesignArea,
    /// Cycles of a frame.
    pub cycles: u64,
    /// Frames a second.
    pub frames_per_second: f64,
}

/// A figure of both designs.
#[derive(Debug, Clone, Serialize)]
pub struct ComparedLine {
    /// What it is.
    pub what: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Of the light hardware.
    pub light: Range,
    /// Of the ray caster.
    pub ray_caster: Range,
    /// Whether the ranges overlap.
    pub overlap: bool,
    /// Who has less, if they do not.
    pub less: Winner,
}

/// Picojoules in a microjoule.
const PJ_IN_UJ: f64 = 1e6;
/// Picojoules in a joule.
const PJ_IN_J: f64 = 1e12;

/// The lines. Of the ray caster, cycles are the fewest possible and frames a second the most, so
/// that its power and bandwidth at its own speed are the most, too.
#[must_use]
pub fn lines(light: Design<'_>, ray_caster: Design<'_>) -> Vec<ComparedLine> {
    let slower = light.frames_per_second.min(ray_caster.frames_per_second);
    let energy = |of: Design<'_>| Range::new(of.cost.total()).times(1.0 / PJ_IN_UJ);
    let watts = |of: Design<'_>, rate: f64| Range::new(of.cost.total()).times(rate / PJ_IN_J);
    let bits = |of: Design<'_>| of.cost.traffic.bits() as f64;
    let one = |value: f64| Range::new((value, value, value));
    type Of<'f> = Box<dyn Fn(Design<'_>) -> Range + 'f>;
    let lines: [(&str, &str, Of<'_>); 10] = [
        (
            "energy of operations",
            "uJ",
            Box::new(|of| Range::from(&of.cost.operations).times(1.0 / PJ_IN_UJ)),
        ),
        (
            "energy of memories on the chip",
            "uJ",
            Box::new(|of| Range::from(&of.cost.on_chip).times(1.0 / PJ_IN_UJ)),
        ),
        (
            "energy of outer memory",
            "uJ",
            Box::new(|of| Range::from(&of.cost.outer).times(1.0 / PJ_IN_UJ)),
        ),
        ("energy of the frame", "uJ", Box::new(energy)),
        (
            "power at its own speed, without leakage",
            "W",
            Box::new(|of| watts(of, of.frames_per_second)),
        ),
        (
            "power at the slower one's speed, without leakage",
            "W",
            Box::new(move |of| watts(of, slower)),
        ),
        (
            "traffic to outer memory",
            "MB a frame",
            Box::new(|of| one(bits(of) / 8e6)),
        ),
        (
            "bandwidth at its own speed",
            "GB/s",
            Box::new(|of| one(bits(of) / 8e9 * of.frames_per_second)),
        ),
        (
            "bandwidth",
            "bits a cycle",
            Box::new(|of| one(bits(of) / of.cycles.max(1) as f64)),
        ),
        ("area", "NAND2", Box::new(|of| of.area.range())),
    ];
    let line = |(what, unit, of): (&'static str, &'static str, Of<'_>)| {
        let (light, ray_caster) = (of(light), of(ray_caster));
        let less = Winner::by_ranges(light, ray_caster);
        ComparedLine {
            what,
            unit,
            light,
            ray_caster,
            overlap: less == Winner::Neither,
            less,
        }
    };
    lines.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use hwmodel::cost::Breakdown;

    use super::*;
    use crate::model::cost::OuterTraffic;

    fn cost(picojoules: f64, node_bits: u64) -> FrameCost {
        let operations = Breakdown {
            total: picojoules,
            low: picojoules / 2.0,
            high: picojoules * 2.0,
            ..Breakdown::default()
        };
        FrameCost {
            operations,
            on_chip: Breakdown::default(),
            outer: Breakdown::default(),
            traffic: OuterTraffic {
                node_bits,
                ..OuterTraffic::default()
            },
        }
    }

    #[test]
    fn by_hand() {
        let (a, b) = (cost(1e9, 8_000_000), cost(1e10, 800_000));
        let area = |total: f64| DesignArea {
            total,
            low: total,
            high: total,
            ..DesignArea::default()
        };
        let areas = (area(5.0), area(5.0));
        let light = Design {
            cost: &a,
            area: &areas.0,
            cycles: 4_000_000,
            frames_per_second: 50.0,
        };
        let rays = Design {
            cost: &b,
            area: &areas.1,
            cycles: 2_000_000,
            frames_per_second: 100.0,
        };
        let lines = lines(light, rays);
        let of = |what: &str, unit: &str| {
            let found = lines
                .iter()
                .find(|line| line.what == what && line.unit == unit);
            found.unwrap().clone()
        };
        // A millijoule fifty times a second is 50 mW; ten of them a hundred times 1 W.
        let power = of("power at its own speed, without leakage", "W");
        assert!((power.light.value - 0.05).abs() < 1e-12);
        assert!((power.ray_caster.value - 1.0).abs() < 1e-12);
        assert!((power.ray_caster.low - 0.5).abs() < 1e-12);
        assert_eq!((power.less, power.overlap), (Winner::Light, false));
        let slower = of("power at the slower one's speed, without leakage", "W");
        assert!((slower.ray_caster.value - 0.5).abs() < 1e-12);
        // A megabyte fifty times a second; two bits a cycle.
        let bandwidth = of("bandwidth at its own speed", "GB/s");
        assert!((bandwidth.light.value - 0.05).abs() < 1e-12);
        assert!((of("bandwidth", "bits a cycle").light.value - 2.0).abs() < 1e-12);
        assert_eq!(bandwidth.less, Winner::RayCaster);
        // Energies differ tenfold, and their ranges fourfold either way.
        assert_eq!(of("energy of the frame", "uJ").less, Winner::Light);
        assert!(of("area", "NAND2").overlap);
    }
}
