//! The tables of a sweep.

use crate::model::tables::TableSpec;

/// The tables of [`Findings::document`](super::Findings::document) for a terminal.
pub const TABLES: [TableSpec; 6] = [
    TableSpec {
        title: "By scene",
        rows: "scenes",
        columns: "scene frames=cases drawn trapped refused cut_off failed most_records",
    },
    TableSpec {
        title: "By rule: holes in closed surfaces, order, coverage against the oracle",
        rows: "rules",
        columns: "coverage tolerance_px frames_drawn=drawn samples_inside_closed=inside holes holes_must_be_0 order \
                  covered extra missing failed",
    },
    TableSpec {
        title: "Vertex error, pixels: the worst in the picture beside its bound; the largest quotient of both anywhere",
        rows: "vertices",
        columns: "held_in bits vertices=worst.vertices error_px=worst.error_px::9 bound_px=worst.bound_px::9 \
                  largest_quotient=worst.tightest::3",
    },
    TableSpec {
        title: "Checks",
        rows: "checks",
        columns: "check failures",
    },
    TableSpec {
        title: "Traps, by operation and stage",
        rows: "traps",
        columns: "what frames",
    },
    TableSpec {
        title: "Views that set-up refused",
        rows: "refusals",
        columns: "what frames",
    },
];
