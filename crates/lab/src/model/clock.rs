//! The delay of the units against the hardware's clock.
//!
//! A unit of latency `l` is a pipeline of `l + 1` steps of one period each, into which its gates' delay must fit. The check
//! is optimistic: delays are without wires, flip-flops and earlier units of the same step, and a tree of units is checked
//! as one unit. A unit that misses the clock here misses it in hardware; the converse does not hold.

use hwmodel::cost::{CostError, unit_of};
use hwmodel::cycles::Hardware;
use hwmodel::{OpClass, Stage};
use serde::Serialize;

use super::cost::Prices;

#[derive(Debug, Clone, Serialize)]
pub struct UnitDelay {
    pub stage: Stage,
    pub class: OpClass,
    pub width: u32,
    pub delay_ps: f64,
    /// Steps of its pipeline: latency and one.
    pub depth: u32,
    pub depth_needed: u32,
    pub rows: String,
    pub source: String,
}

impl UnitDelay {
    pub fn meets(&self) -> bool {
        self.depth >= self.depth_needed
    }
}

/// All units that a frame uses against the clock.
#[derive(Debug, Clone, Serialize)]
pub struct ClockCheck {
    pub period_ps: f64,
    pub fastest_mhz: f64,
    pub units: Vec<UnitDelay>,
}

impl ClockCheck {
    pub fn misses(&self) -> impl Iterator<Item = &UnitDelay> {
        self.units.iter().filter(|unit| !unit.meets())
    }

    pub fn sentence(&self) -> String {
        let period = self.period_ps / 1e3;
        let told = |unit: &UnitDelay| {
            let (class, stage) = (unit.class.name(), unit.stage.name());
            let UnitDelay {
                width,
                depth,
                depth_needed,
                ..
            } = unit;
            let delay = unit.delay_ps / 1e3;
            format!(
                "{class} of {width} bits in {stage} ({delay:.2} ns in {depth} x {period:.2} ns; a pipeline {depth_needed} \
                 deep would)"
            )
        };
        let missing: Vec<String> = self.misses().map(told).collect();
        if missing.is_empty() {
            format!(
                "no unit's gates are too slow for {period:.2} ns; wires and flip-flops are not in it"
            )
        } else {
            format!("too slow, even without wires: {}", missing.join("; "))
        }
    }
}

/// Compares units that a frame uses with the clock.
pub fn check(
    used: impl IntoIterator<Item = (Stage, OpClass)>,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<ClockCheck, CostError> {
    let period_ps = 1e6 / hardware.clock_mhz;
    let mut units = Vec::new();
    let mut longest_step = 0.0f64;
    for (stage, class) in used {
        let Some(unit) = hardware.unit(stage, class) else {
            continue;
        };
        let delay = prices
            .table
            .delay(unit_of(class), unit.width, prices.goal)?;
        let depth = unit.latency.saturating_add(1);
        longest_step = longest_step.max(delay.high / f64::from(depth));
        units.push(UnitDelay {
            stage,
            class,
            width: unit.width,
            delay_ps: delay.high,
            depth,
            depth_needed: (delay.high / period_ps).ceil().max(1.0) as u32,
            rows: delay.rows,
            source: delay.source,
        });
    }
    Ok(ClockCheck {
        period_ps,
        fastest_mhz: if longest_step > 0.0 {
            1e6 / longest_step
        } else {
            f64::INFINITY
        },
        units,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use shiftvox::machine::RecordStage;

    /// In the table, an adder of 32 bits takes 4680.73 ps. Shifts are wires.
    #[test]
    fn adders_by_hand() {
        // Between two rows.
        let wide = 4680.73 + (6558.27 - 4680.73) / 16.0;
        for (clock_mhz, latency, width, delay_ps, needed) in [
            (200.0, 0, 32, 4680.73, 1),
            // Three steps of 2 ns hold it, two do not.
            (500.0, 1, 32, 4680.73, 3),
            (500.0, 2, 32, 4680.73, 3),
            (500.0, 2, 33, wide, 3),
        ] {
            let mut hardware = Hardware::preset("paper").unwrap();
            hardware.clock_mhz = clock_mhz;
            hardware.stages.clear();
            let add = hardware.units.get_mut(&OpClass::Add).unwrap();
            (add.latency, add.width) = (latency, width);
            let used =
                [OpClass::Add, OpClass::Shift].map(|class| (RecordStage::Centre.into(), class));
            let check = check(used, &hardware, &Prices::shipped().unwrap()).unwrap();
            let [unit] = &check.units[..] else {
                panic!("{check:?}");
            };
            assert!((unit.delay_ps - delay_ps).abs() < 1e-9, "{unit:?}");
            let depth = latency + 1;
            assert_eq!((unit.depth, unit.depth_needed), (depth, needed));
            assert_eq!(check.misses().count(), usize::from(depth < needed));
            let says_slow = check
                .sentence()
                .contains("add of 32 bits in centre (4.68 ns");
            assert_eq!(says_slow, depth < needed, "{}", check.sentence());
            let fastest = f64::from(depth) * 1e6 / delay_ps;
            assert!((check.fastest_mhz - fastest).abs() < 1e-9, "{check:?}");
        }
    }
}
