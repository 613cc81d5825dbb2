//! The last step of every reader of voxels: limits, bounds and progress, then the caller's sink.

use super::fault::{Fault, Problem};
use super::{ReadOptions, SceneInfo};
use crate::graph::{PackedNormal, Progress, Voxel};

/// Extent, in voxels, that a scene must stay below along every axis.
pub const MAX_EXTENT: i64 = 1 << 21;

const PROGRESS_STEP: u64 = 1 << 16;

pub(super) struct Emitter<'a> {
    sink: &'a mut dyn FnMut(Voxel),
    progress: &'a dyn Progress,
    count: u64,
    pub(super) options: &'a ReadOptions,
    pub(super) info: SceneInfo,
    low: [i32; 3],
    high: [i32; 3],
}

impl<'a> Emitter<'a> {
    pub(super) fn new(
        sink: &'a mut dyn FnMut(Voxel),
        options: &'a ReadOptions,
        progress: &'a dyn Progress,
    ) -> Self {
        Self {
            sink,
            progress,
            count: 0,
            options,
            info: SceneInfo::default(),
            low: [i32::MAX; 3],
            high: [i32::MIN; 3],
        }
    }

    /// Passes one voxel on. `place` returns the part of the file that it comes from, and its byte offset.
    #[inline]
    pub(super) fn voxel(
        &mut self,
        index: [i64; 3],
        color: [u8; 3],
        normal: Option<PackedNormal>,
        place: impl Fn() -> (String, u64),
    ) -> Result<(), Problem> {
        let mut narrow = [0i32; 3];
        for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
            let Ok(i) = i32::try_from(index[axis]) else {
                let expected = "voxel indices that fit 32 bits with sign".to_owned();
                let found = format!("{name} = {}", index[axis]);
                return limit(
                    place(),
                    expected,
                    found,
                    "move the scene towards the origin",
                );
            };
            narrow[axis] = i;
            if (self.low[axis]..=self.high[axis]).contains(&i) {
                continue;
            }
            let low = self.low[axis].min(i);
            let high = self.high[axis].max(i);
            let extent = i64::from(high) - i64::from(low) + 1;
            if extent >= MAX_EXTENT {
                let expected = format!("an extent below {MAX_EXTENT} voxels along each axis");
                let found = format!("at least {extent} along {name}");
                let advice = "look for stray voxels far from the rest, or split the scene";
                return limit(place(), expected, found, advice);
            }
            self.low[axis] = low;
            self.high[axis] = high;
        }
        if self.count >= self.options.most_voxels {
            return Err(self.too_many(self.count + 1));
        }
        (self.sink)(Voxel {
            index: narrow,
            color,
            normal,
        });
        self.count += 1;
        if self.count.is_multiple_of(PROGRESS_STEP) {
            self.progress.advance(PROGRESS_STEP);
        }
        Ok(())
    }

    /// Fails if so many further voxels exceed the limit: for readers that know their number in advance.
    pub(super) fn expect(&self, voxels: u64) -> Result<(), Problem> {
        match self.count.saturating_add(voxels) {
            all if all > self.options.most_voxels => Err(self.too_many(all)),
            _ => Ok(()),
        }
    }

    #[cold]
    fn too_many(&self, voxels: u64) -> Problem {
        Problem::TooMany {
            voxels,
            most: self.options.most_voxels,
        }
    }

    pub(super) fn finish(self) -> SceneInfo {
        self.progress.advance(self.count % PROGRESS_STEP);
        self.info
    }
}

#[cold]
fn limit(
    (part, offset): (String, u64),
    expected: String,
    found: String,
    advice: &str,
) -> Result<(), Problem> {
    Err(Problem::Limit(Fault::new(
        part, offset, expected, found, advice,
    )))
}
