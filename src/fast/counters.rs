//! What a frame came to: what was worked on, and what was skipped.

use crate::project::Stats;

/// Counts of one frame, or of one band of it.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Counters {
    /// Nodes whose turn came in clip space.
    pub(super) clip_records: u64,
    /// Nodes whose turn came in screen space, above bricks.
    pub(super) screen_records: u64,
    /// Changes to screen space.
    pub(super) changes: u64,
    /// Two levels (64 parts) or one (8 parts) taken in one step.
    pub(super) bricks: u64,
    /// Samples tested against a brick's parts.
    pub(super) brick_samples: u64,
    /// Solids drawn by themselves.
    pub(super) solids: u64,
    /// Samples drawn.
    pub(super) samples_drawn: u64,
    /// Voxels that samples took, under the rule that blends.
    pub(super) samples_blended: u64,
    /// Samples decided by exact planes.
    pub(super) exact_samples: u64,
    /// Children that do not exist.
    pub(super) skipped_absent: u64,
    /// Nodes wholly behind the eye.
    pub(super) skipped_behind: u64,
    /// Nodes beside the picture, or that hold no sample.
    pub(super) skipped_off_screen: u64,
    /// Nodes behind what is drawn.
    pub(super) skipped_hidden: u64,
    /// Nodes whose further children were left because all samples were drawn.
    pub(super) skipped_full: u64,
    /// Nodes with children that level of detail took for a solid in clip space,
    /// and lattices that it ends above the finest voxels.
    pub(super) skipped_detail: u64,
    /// Tiles filled whole by one solid.
    pub(super) tiles_filled: u64,
}

impl Counters {
    /// Adds another band's counts.
    pub(super) fn add(&mut self, other: &Self) {
        let mine = self.fields_mut();
        for (mine, (_, theirs)) in mine.into_iter().zip(other.fields()) {
            *mine += theirs;
        }
    }

    /// Names and counts, in a fixed order.
    pub(super) fn stats(&self) -> Stats {
        let records = self.clip_records + self.screen_records + self.bricks;
        let mut stats = vec![("records", records)];
        stats.extend(self.fields());
        stats
    }

    fn fields(&self) -> [(&'static str, u64); 16] {
        [
            ("clip_records", self.clip_records),
            ("screen_records", self.screen_records),
            ("changed_to_screen", self.changes),
            ("bricks", self.bricks),
            ("brick_samples", self.brick_samples),
            ("solids_drawn", self.solids),
            ("samples_drawn", self.samples_drawn),
            ("samples_blended", self.samples_blended),
            ("samples_decided_exactly", self.exact_samples),
            ("skipped_absent_children", self.skipped_absent),
            ("skipped_behind_eye", self.skipped_behind),
            ("skipped_off_screen", self.skipped_off_screen),
            ("skipped_hidden", self.skipped_hidden),
            ("skipped_picture_full", self.skipped_full),
            ("skipped_below_detail", self.skipped_detail),
            ("tiles_filled_whole", self.tiles_filled),
        ]
    }

    fn fields_mut(&mut self) -> [&mut u64; 16] {
        [
            &mut self.clip_records,
            &mut self.screen_records,
            &mut self.changes,
            &mut self.bricks,
            &mut self.brick_samples,
            &mut self.solids,
            &mut self.samples_drawn,
            &mut self.samples_blended,
            &mut self.exact_samples,
            &mut self.skipped_absent,
            &mut self.skipped_behind,
            &mut self.skipped_off_screen,
            &mut self.skipped_hidden,
            &mut self.skipped_full,
            &mut self.skipped_detail,
            &mut self.tiles_filled,
        ]
    }
}
