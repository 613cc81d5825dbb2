//! The machine's counters. A new one is a row here and a line where the event occurs.

use crate::project::Stats;

macro_rules! counters {
    ($($name:ident: $meaning:literal;)*) => {
        #[derive(Debug, Default)]
        pub(super) struct Counts {
            $(#[doc = $meaning] pub(super) $name: u64,)*
        }

        impl Counts {
            /// All counts by name, in the order of the table.
            pub(super) fn stats(&self) -> Stats {
                vec![$((stringify!($name), self.$name),)*]
            }
        }
    };
}

counters! {
    records: "records that had their turn";
    subdivided: "records that were neither drawn nor dropped, so that their children were made";
    already_full: "records dropped when they left the stack, because their quadtree node was full by then";
    hidden_across_bisectors:
        "records dropped instead of subdivided, because every sample that they may cover was full";
    absent_children: "octants of a subdivided record in which its octree node has no child";
    behind_eye: "children wholly behind the eye, or before the near plane where the rule has one";
    rejected_by_quadtree: "children that overlap no open quadrant in the search for their quadtree node";
    changed_to_screen: "records whose vertices were divided by their depths";
    at_level_bound: "records drawn because they could not be subdivided any further";
    solids_drawn: "solids whose silhouette was to be drawn";
    samples_drawn: "samples that were given a node and a voxel to show";
    samples_already_drawn: "samples that a record would have drawn, but that were full";
    deepest_stack: "most entries on the stack at once";
    overflows: "results that did not fit their word";
    samples_blended: "voxels blended into samples, under the rule alpha";
}
