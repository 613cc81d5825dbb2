//! Values of flags.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use shiftvox::project::camera::MAX_SIDE;

/// Reads a point or a direction: `x,y,z`.
pub(super) fn point(text: &str) -> Result<DVec3, String> {
    let parts = text.split(',').map(|part| part.trim().parse::<f64>());
    let parts: Vec<f64> = parts
        .collect::<Result<_, _>>()
        .map_err(|e| format!("{e}; expected three numbers x,y,z"))?;
    match parts[..] {
        [x, y, z] if parts.iter().all(|p| p.is_finite()) => Ok(DVec3::new(x, y, z)),
        [_, _, _] => Err("expected finite numbers".to_owned()),
        _ => Err(format!(
            "expected three numbers x,y,z, found {}",
            parts.len()
        )),
    }
}

/// Size of a picture in pixels: `512`, or `640x360`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Size {
    pub(crate) fn square(side: u32) -> Self {
        Self {
            width: side,
            height: side,
        }
    }

    pub(crate) fn pair(self) -> (u32, u32) {
        (self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |part: &str| {
            let side = part.trim().parse().ok();
            side.filter(|side| (1..=MAX_SIDE).contains(side))
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

/// Reads pixels, 0 or more, or `inf`.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|&value: &f64| value >= 0.0);
    value.ok_or_else(|| "expected pixels, 0 or more, or inf".to_owned())
}

/// Reads an amount of memory: bytes, or with `K`, `M`, `G` or `T` for powers of 1024.
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    let upper = text.trim().to_ascii_uppercase();
    let amount = upper.strip_suffix("IB").or(upper.strip_suffix('B'));
    let amount = amount.unwrap_or(&upper);
    let units = [('K', 10), ('M', 20), ('G', 30), ('T', 40)].into_iter();
    let mut found = units.filter_map(|(unit, shift)| Some((amount.strip_suffix(unit)?, shift)));
    let (digits, shift) = found.next().unwrap_or((amount, 0));
    let number = digits
        .parse::<f64>()
        .ok()
        .filter(|_| !digits.contains(['E', '+']));
    let bytes = number.map(|number| number * (1u64 << shift) as f64);
    // Exact below 2^53, which is more than any machine has.
    match bytes.filter(|bytes| (0.0..9e15).contains(bytes)) {
        Some(bytes) => Ok(bytes as u64),
        None => Err(format!(
            "expected an amount of memory such as 512M or 2G, not `{text}`"
        )),
    }
}
