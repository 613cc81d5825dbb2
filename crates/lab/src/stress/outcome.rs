//! The outcome of a case: the end of its frame, and the checks that failed.

use serde::Serialize;

use super::vertex::Worst;
use crate::measure::CoverageError;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// A frame ends within a bound on records.
    Ends,
    /// A frame whose set-up guarantees that it cannot overflow does not.
    Headroom,
    /// Under `exact` the picture is the oracle's, at every level of detail.
    Exact,
    /// Under `exact` no sample that is covered without level of detail is missing.
    Missing,
    /// A closed surface has no holes under `exact`. Under the other rules this holds at tolerance 0 to 1/64, if no record met
    /// the level bound.
    Holes,
    /// No sample shows a voxel behind the oracle's.
    Order,
    /// A visible voxel is before the eye and at its sample.
    Place,
    /// Vertices are the specification's, bit for bit.
    Specification,
    /// Vertices are within the bounds on their error.
    Bound,
    /// The fast engine draws the same bits.
    Engines,
}

impl Check {
    pub(super) const ALL: [Self; 10] = [
        Self::Ends,
        Self::Headroom,
        Self::Exact,
        Self::Missing,
        Self::Holes,
        Self::Order,
        Self::Place,
        Self::Specification,
        Self::Bound,
        Self::Engines,
    ];

    pub fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    pub check: Check,
    pub detail: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    Drawn,
    /// With an overflow: operation, stage, level and record.
    Trapped(String),
    /// Before it began: the format does not hold the view.
    Refused(String),
    /// Given up: `any` and `center` take solids apart, down to the level bound
    /// or a thousandth of a voxel across the near plane, which ends, but not soon.
    CutOff,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    pub end: End,
    pub failures: Vec<Failure>,
    pub records: u64,
    /// Samples inside a closed surface, as the oracle sees it.
    pub inside: u64,
    /// Samples among them that show nothing, or a voxel behind the surface.
    pub holes: u64,
    /// Samples that show a voxel that the oracle's voxel occludes.
    pub order: u64,
    /// The picture against the oracle's, without level of detail.
    pub coverage: CoverageError,
    pub worst: [Worst; 3],
}

impl Outcome {
    pub(super) fn new(end: End, records: u64) -> Self {
        Self {
            end,
            failures: Vec::new(),
            records,
            inside: 0,
            holes: 0,
            order: 0,
            coverage: CoverageError::default(),
            worst: Default::default(),
        }
    }

    pub(super) fn fail(&mut self, check: Check, detail: impl Into<String>) {
        let detail = detail.into();
        self.failures.push(Failure { check, detail });
    }
}
