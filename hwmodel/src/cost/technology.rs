//! Energy in another process and at another voltage.
//!
//! *Switching*. Stillmaker and Baas simulated the same circuits in predictive models of each process, and fitted a
//! parabola of the supply voltage (Integration 58, 2017, table 5, high-performance models; REFERENCES.md). A price is
//! multiplied by the parabola's value over that at 45 nm and 0.9 V, where the shipped prices are. They have no 28 nm.
//! Its logarithm is taken between those of 32 and 20 nm, in proportion to the logarithm of the size.
//!
//! *Leakage*. The off-current of a micrometre of transistor is the same in all processes, as in the ITRS's targets for
//! high-performance logic, and widths shrink with the process. So a gate's leakage follows the size times the voltage.
//! This is an assumption; off-currents also grow with the voltage and tenfold with heat.
//!
//! *Outer memory*. It is another chip, and keeps its price.

use serde::{Deserialize, Serialize};

use super::CostError;

/// A process and its supply voltage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Technology {
    /// 45, 28, 16 or 7.
    pub nm: u32,
    /// 0.5 to 1.1.
    pub volts: f64,
}

impl Default for Technology {
    /// That of the shipped prices.
    fn default() -> Self {
        Self { nm: 45, volts: 0.9 }
    }
}

/// Coefficients of the voltage's square, the voltage, and one.
const PARABOLAS: [(u32, [f64; 3]); 5] = [
    (45, [1.018, -0.3107, 0.1539]),
    (32, [0.8367, -0.4341, 0.1701]),
    (20, [0.373, -0.1582, 0.04104]),
    (16, [0.2958, -0.1241, 0.03024]),
    (7, [0.1776, -0.09097, 0.02447]),
];
const SIZES: [u32; 4] = [45, 28, 16, 7];
/// Of the fits' use here; below it, transistors hardly switch.
const VOLTS: std::ops::RangeInclusive<f64> = 0.5..=1.1;

impl Technology {
    /// Energy of switching, over that of the shipped prices.
    pub fn switching(self) -> f64 {
        self.energy() / Self::default().energy()
    }

    /// Leakage, over that of the shipped prices.
    pub fn leakage(self) -> f64 {
        let shipped = Self::default();
        f64::from(self.nm) * self.volts / (f64::from(shipped.nm) * shipped.volts)
    }

    fn energy(self) -> f64 {
        let of = |nm: u32| {
            let found = PARABOLAS.iter().find(|(size, _)| *size == nm);
            let [square, linear, constant] = found.map_or([f64::NAN; 3], |(_, of)| *of);
            (square * self.volts + linear) * self.volts + constant
        };
        match self.nm {
            28 => {
                let part = (28.0f64 / 20.0).ln() / (32.0f64 / 20.0).ln();
                of(20) * (of(32) / of(20)).powf(part)
            }
            nm => of(nm),
        }
    }

    /// The factor of an operation's shipped energy.
    pub(super) fn factor(self, operation: &str) -> f64 {
        match operation {
            "dram_read" | "dram_write" => 1.0,
            "logic_leakage" | "sram_leakage" => self.leakage(),
            _ => self.switching(),
        }
    }

    pub(super) fn check(self, file: &str) -> Result<(), CostError> {
        let wrong = |key: &str, value: String, range: &str| {
            let message = format!("{file}: technology.{key} is {value}; it must be {range}");
            Err(CostError(message))
        };
        if !SIZES.contains(&self.nm) {
            return wrong("nm", self.nm.to_string(), "45, 28, 16 or 7");
        }
        if !VOLTS.contains(&self.volts) {
            return wrong("volts", format!("{:?}", self.volts), "0.5 to 1.1");
        }
        Ok(())
    }

    /// The factors in words.
    pub fn sentence(self) -> String {
        let Self { nm, volts } = self;
        if self == Self::default() {
            return format!("{nm} nm, {volts} V");
        }
        format!(
            "{nm} nm, {volts} V: switching takes {:.3} times the energy at 45 nm and 0.9 V (Stillmaker and Baas, \
             Integration 58, 2017{}), leakage {:.3} times (size times voltage, an assumption), outer memory the same",
            self.switching(),
            if nm == 28 {
                ", between 32 and 20 nm"
            } else {
                ""
            },
            self.leakage()
        )
    }
}
