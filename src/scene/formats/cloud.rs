//! Points of a cloud to voxels.
//!
//! With `--voxel-size` a point fills the voxel that contains it. Without, coordinates are voxel indices. If one is not
//! whole, the rest of the file is only measured, so that the error can suggest a size.

use crate::graph::PackedNormal;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem};
use crate::scene::numbers::Number;
use crate::scene::{ReadOptions, SceneInfo};

/// Voxels along the longest side for the size that an error suggests.
const SUGGESTED_SIDE: f64 = 256.0;

pub(super) struct Cloud {
    size: Option<f64>,
    left_out: u64,
    odd: Option<Box<Fault>>,
    low: [f64; 3],
    high: [f64; 3],
}

impl Cloud {
    pub(super) fn new(options: &ReadOptions) -> Self {
        Self {
            size: options.voxel_size,
            left_out: 0,
            odd: None,
            low: [f64::INFINITY; 3],
            high: [f64::NEG_INFINITY; 3],
        }
    }

    /// `place` returns the part of the file and the byte offset, of the point or of one of its coordinates.
    pub(super) fn point(
        &mut self,
        position: [Number; 3],
        color: [u8; 3],
        normal: Option<PackedNormal>,
        place: impl Fn(Option<usize>) -> (String, u64),
        emitter: &mut Emitter<'_>,
    ) -> Result<(), Problem> {
        let mut index = [0; 3];
        if let Some(size) = self.size {
            let position = position.map(Number::real);
            if !position.iter().all(|x| x.is_finite()) {
                self.left_out += 1;
                return Ok(());
            }
            index = position.map(|x| (x / size).floor() as i64);
        } else {
            for axis in 0..3 {
                let real = position[axis].real();
                if real.is_finite() {
                    self.low[axis] = self.low[axis].min(real);
                    self.high[axis] = self.high[axis].max(real);
                }
                match position[axis].whole() {
                    Some(whole) => index[axis] = whole,
                    None if self.odd.is_none() => {
                        let (part, offset) = place(Some(axis));
                        let expected = "a whole number, the voxel's index";
                        let found = position[axis].to_string();
                        self.odd = Some(Fault::new(part, offset, expected, found, ""));
                    }
                    None => {}
                }
            }
            if self.odd.is_some() {
                return Ok(());
            }
        }
        emitter.voxel(index, color, normal, || place(None))
    }

    pub(super) fn finish(self, info: &mut SceneInfo) -> Result<(), Problem> {
        if let Some(mut fault) = self.odd {
            let extents = (0..3).map(|axis| self.high[axis] - self.low[axis]);
            let extent = extents.fold(0.0, f64::max);
            let size = format!("{:.0e}", extent / SUGGESTED_SIDE).parse::<f64>();
            fault.advice = match size {
                Ok(size) if size > 0.0 && size.is_finite() => format!(
                    "positions that are not voxel indices need a voxel's size: --voxel-size {size} gives \
                    about {SUGGESTED_SIDE} voxels along the longest side"
                ),
                _ => "give the voxel's size by --voxel-size".to_owned(),
            };
            return Err(fault.into());
        }
        if self.left_out > 0 {
            info.warnings.push(format!(
                "{} points whose coordinates are infinite or not numbers were left out",
                self.left_out
            ));
        }
        info.voxel_size = self.size;
        Ok(())
    }
}
