//! Values of flags, with messages that say what was expected.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use crate::project::camera::MAX_SIDE;

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

/// Numbers of threads: `2`, or `1,2,4`; 0 stands for all that the machine has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ThreadCounts(pub Vec<u16>);

impl FromStr for ThreadCounts {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.split(',')
            .map(|part| {
                part.trim()
                    .parse::<u16>()
                    .ok()
                    .filter(|&count| count <= 1024)
                    .ok_or_else(|| "expected a number of threads, 0 to 1024".to_owned())
            })
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        let size = |width, height| Ok(Size { width, height });
        assert_eq!("512".parse::<Size>(), size(512, 512));
        assert_eq!("640x360".parse::<Size>(), size(640, 360));
        for bad in ["0", "640x", "x3", "-4", "99999", "3x4x5", "1.5"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }

    #[test]
    fn points_come_back() {
        for text in ["1,2,3", "-0.5,1e-9,1638.4"] {
            let point: Point = text.parse().unwrap();
            assert_eq!(point.to_string().parse::<Point>(), Ok(point));
        }
        for bad in ["1,2", "1,2,3,4", "a,b,c", "nan,0,0", "inf,0,0", ""] {
            assert!(bad.parse::<Point>().is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_of_threads() {
        assert_eq!("4".parse(), Ok(ThreadCounts(vec![4])));
        assert_eq!("1, 2,0".parse(), Ok(ThreadCounts(vec![1, 2, 0])));
        for bad in ["", "1,", "-1", "1025", "two"] {
            assert!(bad.parse::<ThreadCounts>().is_err(), "{bad}");
        }
    }

    #[test]
    fn tolerances() {
        assert_eq!("inf".parse(), Ok(Tolerance(f64::INFINITY)));
        assert_eq!("0.0625".parse(), Ok(Tolerance(0.0625)));
        for bad in ["-1", "nan", "x"] {
            assert!(bad.parse::<Tolerance>().is_err(), "{bad}");
        }
    }
}
