//! The same frame on different numbers of lanes.

use serde::Serialize;

use super::hardware::Hardware;
use super::report::CycleReport;

/// Numbers of lanes of the usual table.
pub const LANES: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];

/// One row of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScalingRow {
    /// Number of lanes.
    pub lanes: u32,
    /// Cycles of the frame.
    pub cycles: u64,
    /// The first row's cycles divided by this one's.
    pub speedup: f64,
    /// `speedup` divided by the lanes relative to the first row's: 1 is perfect.
    pub efficiency: f64,
    /// Records that had their turn; more than serially, where one begins before its occluder is drawn.
    pub records: u64,
    /// Work divided by span.
    pub parallelism: f64,
    /// The limiting resource.
    pub bottleneck: String,
}

/// Runs a frame for each number of lanes; all else is as in `hardware`.
///
/// # Errors
/// Those of `run`.
pub fn scaling<E>(
    hardware: &Hardware,
    lanes: &[u32],
    mut run: impl FnMut(&Hardware) -> Result<CycleReport, E>,
) -> Result<Vec<ScalingRow>, E> {
    let mut rows: Vec<ScalingRow> = Vec::with_capacity(lanes.len());
    for &lanes in lanes {
        let report = run(&Hardware {
            lanes,
            ..hardware.clone()
        })?;
        let (first_lanes, first_cycles) = rows
            .first()
            .map_or((lanes, report.cycles), |row| (row.lanes, row.cycles));
        let speedup = first_cycles as f64 / report.cycles.max(1) as f64;
        rows.push(ScalingRow {
            lanes,
            cycles: report.cycles,
            speedup,
            efficiency: speedup * f64::from(first_lanes) / f64::from(lanes),
            records: report.records,
            parallelism: report.parallelism,
            bottleneck: report.bottleneck.sentence,
        });
    }
    Ok(rows)
}
