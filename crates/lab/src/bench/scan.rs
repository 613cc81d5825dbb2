//! A range of values to measure: `size=64..4096*2`.

use std::fmt;
use std::str::FromStr;

/// Most values of a scan.
const MAX_VALUES: usize = 1000;

/// How a scan goes from a value to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Plus(u32),
    Times(u32),
}

/// A parameter's values: `NAME=FROM..TO*FACTOR` or `NAME=FROM..TO+STEP`, both
/// ends included. `TO` itself is a value only if the steps lead there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    name: String,
    from: u32,
    to: u32,
    step: Step,
}

impl Scan {
    /// A scan by factors; `factor` is at least 2.
    #[must_use]
    pub fn by_factor(name: &str, from: u32, to: u32, factor: u32) -> Self {
        Self {
            name: name.to_owned(),
            from,
            to,
            step: Step::Times(factor.max(2)),
        }
    }

    /// The parameter.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The values, growing; there is at least one.
    #[must_use]
    pub fn values(&self) -> Vec<u32> {
        let next = |&value: &u32| {
            match self.step {
                Step::Plus(step) => value.checked_add(step),
                Step::Times(factor) => value.checked_mul(factor),
            }
            .filter(|&next| next <= self.to)
        };
        std::iter::successors(Some(self.from), next).collect()
    }
}

impl FromStr for Scan {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |why: &str| {
            format!("{why}; expected NAME=FROM..TO*FACTOR or +STEP, such as size=64..4096*2")
        };
        let number = |part: &str| {
            part.trim()
                .parse::<u32>()
                .map_err(|e| wrong(&format!("`{part}`: {e}")))
        };
        let (name, range) = text.split_once('=').ok_or_else(|| wrong("no `=`"))?;
        let (from, rest) = range.split_once("..").ok_or_else(|| wrong("no `..`"))?;
        let (to, step, times) = if let Some((to, factor)) = rest.split_once('*') {
            (to, factor, true)
        } else if let Some((to, step)) = rest.split_once('+') {
            (to, step, false)
        } else {
            return Err(wrong("no `*` or `+` after the range"));
        };
        let (name, from, to, step) = (name.trim(), number(from)?, number(to)?, number(step)?);
        if name.is_empty() {
            return Err(wrong("no name"));
        }
        if from == 0 || to < from {
            return Err(wrong("the range must rise from 1 or more"));
        }
        let step = match (times, step) {
            (true, 0 | 1) => return Err(wrong("a factor must be 2 or more")),
            (false, 0) => return Err(wrong("a step must be 1 or more")),
            (true, factor) => Step::Times(factor),
            (false, step) => {
                if (to - from) / step >= MAX_VALUES as u32 {
                    return Err(format!("a scan has at most {MAX_VALUES} values"));
                }
                Step::Plus(step)
            }
        };
        Ok(Self {
            name: name.to_owned(),
            from,
            to,
            step,
        })
    }
}

impl fmt::Display for Scan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sign, step) = match self.step {
            Step::Plus(step) => ('+', step),
            Step::Times(factor) => ('*', factor),
        };
        write!(f, "{}={}..{}{sign}{step}", self.name, self.from, self.to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<u32> {
        text.parse::<Scan>().unwrap().values()
    }

    #[test]
    fn values_by_factor_and_by_step() {
        assert_eq!(
            values("size=64..4096*2"),
            [64, 128, 256, 512, 1024, 2048, 4096]
        );
        assert_eq!(values("size=100..1000*3"), [100, 300, 900]);
        assert_eq!(values("depth=5..7+1"), [5, 6, 7]);
        assert_eq!(values("x=5..8+2"), [5, 7]);
        assert_eq!(values("x=7..7*2"), [7]);
        // The next value would not fit 32 bits.
        assert_eq!(values("x=3000000000..4294967295*2"), [3_000_000_000]);
    }

    #[test]
    fn a_scan_is_written_as_it_is_read() {
        for text in ["size=64..4096*2", "depth=5..12+1"] {
            assert_eq!(text.parse::<Scan>().unwrap().to_string(), text);
        }
        assert_eq!(
            Scan::by_factor("size", 64, 256, 2),
            "size=64..256*2".parse().unwrap()
        );
    }

    #[test]
    fn nonsense_is_refused() {
        for bad in [
            "",
            "size",
            "64..128*2",
            "=1..2*2",
            "size=64",
            "size=64..",
            "size=64..128",
            "size=64..128*1",
            "size=64..128*0",
            "size=64..128+0",
            "size=128..64*2",
            "size=0..64*2",
            "size=a..64*2",
            "size=-1..64*2",
            "x=1..1000000+1",
            "size=1..99999999999*2",
        ] {
            assert!(bad.parse::<Scan>().is_err(), "{bad}");
        }
    }
}
