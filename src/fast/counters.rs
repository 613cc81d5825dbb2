//! The counts of a frame: what was worked on, and what was skipped.

use crate::project::Stats;

/// Counts of a frame, or of a band of it.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Counters {
    /// Nodes whose children were looked at.
    pub(super) nodes: u64,
    /// Nodes of which two or four levels were taken in one step.
    pub(super) bricks: u64,
    /// Squares of their windows, and of solids', in which something was open.
    pub(super) squares: u64,
    /// Samples tested against the parts of a brick.
    pub(super) samples_tested: u64,
    /// Voxels drawn one by one.
    pub(super) solids: u64,
    /// Samples drawn.
    pub(super) samples_drawn: u64,
    /// Voxels that samples took, under the rule that blends.
    pub(super) samples_blended: u64,
    /// Samples that the exact rule decided, once for each voxel.
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
    /// Nodes with children that level of detail took for a solid, outside of bricks.
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
        let records = self.nodes + self.bricks;
        let mut stats = vec![("records", records)];
        stats.extend(self.fields());
        stats
    }

    fn fields(&self) -> [(&'static str, u64); 15] {
        [
            ("nodes", self.nodes),
            ("bricks", self.bricks),
            ("squares", self.squares),
            ("samples_tested", self.samples_tested),
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

    fn fields_mut(&mut self) -> [&mut u64; 15] {
        [
            &mut self.nodes,
            &mut self.bricks,
            &mut self.squares,
            &mut self.samples_tested,
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
