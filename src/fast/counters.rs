//! Counts of a frame.

use crate::project::Stats;

macro_rules! counters {
    ($($(#[$meaning:meta])* $field:ident = $name:literal;)*) => {
        #[derive(Debug, Default, Clone, Copy)]
        pub(super) struct Counters {
            $($(#[$meaning])* pub(super) $field: u64,)*
        }

        impl Counters {
            pub(super) fn add(&mut self, other: &Self) {
                $(self.$field += other.$field;)*
            }

            pub(super) fn stats(&self) -> Stats {
                vec![("records", self.nodes + self.bricks), $(($name, self.$field)),*]
            }
        }
    };
}

counters! {
    nodes = "nodes";
    bricks = "bricks";
    squares = "squares";
    samples_tested = "samples_tested";
    solids = "solids_drawn";
    samples_drawn = "samples_drawn";
    samples_blended = "samples_blended";
    exact_samples = "samples_decided_exactly";
    skipped_absent = "skipped_absent_children";
    skipped_behind = "skipped_behind_eye";
    skipped_off_screen = "skipped_off_screen";
    skipped_hidden = "skipped_hidden";
    skipped_full = "skipped_picture_full";
    skipped_detail = "skipped_below_detail";
    tiles_filled = "tiles_filled_whole";
}
