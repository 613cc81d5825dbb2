//! Values of flags, with messages that say what was expected.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use shiftvox::project::camera::MAX_SIDE;

/// A point or a direction: `x,y,z`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point(pub DVec3);

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<f64> = text
            .split(',')
            .map(|part| part.trim().parse::<f64>())
            .collect::<Result<_, _>>()
            .map_err(|e| format!("{e}; expected three numbers x,y,z"))?;
        match parts[..] {
            [x, y, z] if parts.iter().all(|p| p.is_finite()) => Ok(Self(DVec3::new(x, y, z))),
            [_, _, _] => Err("expected finite numbers".to_owned()),
            _ => Err(format!(
                "expected three numbers x,y,z, found {}",
                parts.len()
            )),
        }
    }
}

/// Shortest decimals that read back as the same point.
impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Adding zero turns -0 into 0.
        let p = self.0 + DVec3::ZERO;
        write!(f, "{},{},{}", p.x, p.y, p.z)
    }
}

/// Size of a picture in pixels: `512`, or `640x360`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |part: &str| {
            part.trim()
                .parse::<u32>()
                .ok()
                .filter(|side| (1..=MAX_SIDE).contains(side))
                .ok_or_else(|| {
                    format!("expected 512 or 640x360, with 1 to {MAX_SIDE} pixels a side")
                })
        };
        let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, text));
        Ok(Self {
            width: side(width)?,
            height: side(height)?,
        })
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// A number of pixels, 0 or more, or `inf`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance(pub f64);

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(value) if value >= 0.0 => Ok(Self(value)),
            _ => Err("expected pixels, 0 or more, or inf".to_owned()),
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Numbers of threads: `2`, or `1,2,4`. 0 means all processors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ThreadCounts(pub Vec<u16>);

impl ThreadCounts {
    /// The numbers, 0 resolved, each once and in order.
    #[must_use]
    pub fn resolved(&self) -> Vec<usize> {
        let all = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let count = |&count: &u16| if count == 0 { all() } else { count.into() };
        let mut counts: Vec<usize> = self.0.iter().map(count).collect();
        counts.sort_unstable();
        counts.dedup();
        counts
    }
}

impl FromStr for ThreadCounts {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let count = |part: &str| {
            let count = part
                .trim()
                .parse()
                .ok()
                .filter(|&count: &u16| count <= 1024);
            count.ok_or_else(|| "expected a number of threads, 0 to 1024".to_owned())
        };
        text.split(',')
            .map(count)
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

/// An amount of memory: bytes, or with `K`, `M`, `G` or `T` for powers of 1024.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Bytes.
    pub bytes: u64,
}

/// Least memory that an external build keeps to.
const LEAST_MEMORY: u64 = 64 << 20;

/// How much of a file's data may be in memory: as [`Memory`], any amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DataBudget {
    /// Bytes.
    pub bytes: u64,
}

impl FromStr for DataBudget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        bytes_of(text).map(|bytes| Self { bytes })
    }
}

impl FromStr for Memory {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bytes = bytes_of(text)?;
        if bytes < LEAST_MEMORY {
            return Err("building takes 64M at the least".to_owned());
        }
        Ok(Self { bytes })
    }
}

/// Bytes in words: `512M`, `2G`.
fn bytes_of(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let upper = text.to_ascii_uppercase();
    let amount = upper.strip_suffix("IB").or(upper.strip_suffix('B'));
    let amount = amount.unwrap_or(&upper);
    let units = [('K', 10), ('M', 20), ('G', 30), ('T', 40)].into_iter();
    let mut found = units.filter_map(|(unit, shift)| Some((amount.strip_suffix(unit)?, shift)));
    let (digits, shift) = found.next().unwrap_or((amount, 0));
    let wrong = || format!("expected an amount of memory such as 512M or 2G, not `{text}`");
    let number: f64 = digits.parse().map_err(|_| wrong())?;
    let bytes = number * (1u64 << shift) as f64;
    // Exact below 2^53, which is more than any machine has.
    if !(0.0..9e15).contains(&bytes) || digits.contains(['E', '+']) {
        return Err(wrong());
    }
    Ok(bytes as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wrong values, with bars between them.
    fn rejects<T: FromStr>(wrong: &str) {
        for wrong in wrong.split('|') {
            assert!(wrong.parse::<T>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn values_are_read_and_wrong_ones_rejected() {
        let size = |width, height| Ok(Size { width, height });
        assert_eq!("512".parse::<Size>(), size(512, 512));
        assert_eq!("640x360".parse::<Size>(), size(640, 360));
        rejects::<Size>("0|640x|x3|-4|99999|3x4x5|1.5");
        for text in ["1,2,3", "-0.5,1e-9,1638.4"] {
            let point: Point = text.parse().unwrap();
            assert_eq!(point.to_string().parse::<Point>(), Ok(point));
        }
        rejects::<Point>("1,2|1,2,3,4|a,b,c|nan,0,0|inf,0,0|");
        assert_eq!("4".parse(), Ok(ThreadCounts(vec![4])));
        assert_eq!("1, 2,0".parse(), Ok(ThreadCounts(vec![1, 2, 0])));
        rejects::<ThreadCounts>("|1,|-1|1025|two");
        assert_eq!("inf".parse(), Ok(Tolerance(f64::INFINITY)));
        assert_eq!("0.0625".parse(), Ok(Tolerance(0.0625)));
        rejects::<Tolerance>("-1|nan|x");
        for (text, bytes) in [
            ("1G", 1 << 30),
            ("512M", 512 << 20),
            ("512MiB", 512 << 20),
            ("1.5g", 3 << 29),
            ("2T", 2 << 40),
            ("65536k", 64 << 20),
            ("67108864", 64 << 20),
            ("67108864B", 64 << 20),
        ] {
            assert_eq!(text.parse(), Ok(Memory { bytes }), "{text}");
        }
        rejects::<Memory>("|G|-1G|nan|inf|1e30|1X|63M|0|9999999T|1 0G");
    }
}
