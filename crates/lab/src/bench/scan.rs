//! A range of values to measure: `size=64..4096*2`.

use std::str::FromStr;

const MAX_VALUES: usize = 1000;

/// The values of a parameter: `NAME=FROM..TO*FACTOR` or `NAME=FROM..TO+STEP`, both ends included.
/// `TO` itself is a value only if the steps lead there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    name: String,
    values: Vec<u32>,
}

impl Scan {
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The values, in increasing order. There is at least one.
    pub fn values(&self) -> Vec<u32> {
        self.values.clone()
    }
}

impl FromStr for Scan {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |why: &str| {
            format!("{why}; expected NAME=FROM..TO*FACTOR or +STEP, such as size=64..4096*2")
        };
        let number = |part: &str| {
            let number = part.trim().parse::<u32>();
            number.map_err(|e| wrong(&format!("`{part}`: {e}")))
        };
        let (name, range) = text.split_once('=').ok_or_else(|| wrong("no `=`"))?;
        let (from, rest) = range.split_once("..").ok_or_else(|| wrong("no `..`"))?;
        let sign = rest.find(['*', '+']);
        let sign = sign.ok_or_else(|| wrong("no `*` or `+` after the range"))?;
        let (to, step) = (&rest[..sign], &rest[sign + 1..]);
        let (name, from, to, step) = (name.trim(), number(from)?, number(to)?, number(step)?);
        let is_factor = rest[sign..].starts_with('*');
        if name.is_empty() {
            return Err(wrong("no name"));
        }
        if from == 0 || to < from {
            return Err(wrong("the range must rise from 1 or more"));
        }
        if step < 1 + u32::from(is_factor) {
            return Err(wrong("a factor must be 2 or more, a step 1 or more"));
        }
        let next = |&value: &u32| {
            let next = match is_factor {
                true => value.checked_mul(step),
                false => value.checked_add(step),
            };
            next.filter(|&next| next <= to)
        };
        let values = std::iter::successors(Some(from), next).take(MAX_VALUES + 1);
        let values: Vec<u32> = values.collect();
        if values.len() > MAX_VALUES {
            return Err(format!("a scan has at most {MAX_VALUES} values"));
        }
        let name = name.to_owned();
        Ok(Self { name, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_factor_and_by_step() {
        let cases: [(&str, &[u32]); 6] = [
            ("size=64..1024*2", &[64, 128, 256, 512, 1024]),
            ("size=100..1000*3", &[100, 300, 900]),
            ("depth=5..7+1", &[5, 6, 7]),
            ("x=5..8+2", &[5, 7]),
            ("x=7..7*2", &[7]),
            // The next value would not fit 32 bits.
            ("x=3000000000..4294967295*2", &[3_000_000_000]),
        ];
        for (text, values) in cases {
            assert_eq!(text.parse::<Scan>().unwrap().values(), values, "{text}");
        }
        let wrong = "size 64..128*2 =1..2*2 size=64 size=64.. size=64..128 size=64..128*1 size=64..128*0 \
            size=64..128+0 size=128..64*2 size=0..64*2 size=a..64*2 size=-1..64*2 x=1..1000000+1 \
            size=1..99999999999*2";
        for wrong in wrong.split_whitespace().chain([""]) {
            assert!(wrong.parse::<Scan>().is_err(), "{wrong}");
        }
    }
}
