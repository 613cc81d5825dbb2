//! The machine's counters: their fields, names and descriptions. A new one is a row here and a line where the event
//! occurs.

use crate::project::Stats;

#[derive(Debug, Clone, Copy)]
pub struct CounterInfo {
    /// Name in statistics, and field in the machine.
    pub name: &'static str,
    /// The counted things.
    pub unit: &'static str,
    /// The counted event.
    pub meaning: &'static str,
    /// The files of `src/machine` that count.
    pub counted_in: &'static [&'static str],
}

macro_rules! counters {
    ($($name:ident: $unit:literal, [$($file:literal),*], $meaning:literal;)*) => {
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

        /// All counters, in the order of a frame's statistics.
        pub const COUNTERS: &[CounterInfo] = &[$(CounterInfo {
            name: stringify!($name),
            unit: $unit,
            meaning: $meaning,
            counted_in: &[$($file),*],
        },)*];
    };
}

counters! {
    records: "records", ["record_loop.rs", "parents.rs"],
        "records that had their turn";
    subdivided: "records", ["children.rs", "parents.rs"],
        "records that were neither drawn nor dropped, so that their children were made";
    already_full: "records", ["record_loop.rs", "parents.rs"],
        "records dropped when they left the stack, because their quadtree node was full by then";
    hidden_across_bisectors: "records", ["decide.rs"],
        "records dropped instead of subdivided, because every sample that they may cover was full";
    absent_children: "children", ["children.rs"],
        "octants of a subdivided record in which its octree node has no child";
    behind_eye: "children", ["push.rs"],
        "children wholly behind the eye, or before the near plane where the rule has one";
    rejected_by_quadtree: "children", ["push.rs"],
        "children that overlap no open quadrant in the search for their quadtree node";
    changed_to_screen: "records", ["decide.rs"],
        "records whose vertices were divided by their depths";
    at_level_bound: "records", ["verdict.rs"],
        "records drawn because they could not be subdivided any further";
    solids_drawn: "records", ["decide.rs"],
        "solids whose silhouette was to be drawn";
    samples_drawn: "samples", ["canvas.rs"],
        "samples that were given a node and a voxel to show";
    samples_already_drawn: "samples", ["canvas.rs"],
        "samples that a record would have drawn, but that were full";
    deepest_stack: "entries", ["push.rs", "parents.rs"],
        "most entries on the stack at once";
    overflows: "results", ["state.rs"],
        "results that did not fit their word";
    samples_blended: "samples", ["canvas.rs"],
        "voxels blended into samples, under the rule alpha";
}
