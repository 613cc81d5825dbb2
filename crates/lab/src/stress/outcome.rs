//! What a case came to: how its frame ended, and which checks failed.

use serde::Serialize;

use super::vertex::Worst;
use crate::measure::CoverageError;

/// What every frame must keep.
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
    /// A closed surface has no holes: under `exact`; under the other rules at
    /// tolerance 0 to 1/64 where no record met the level bound.
    Holes,
    /// Nothing is seen that lies behind what the oracle sees.
    Order,
    /// What is seen is before the eye and at its sample.
    Place,
    /// Vertices are the specification's, bit for bit.
    Specification,
    /// Vertices are within the bounds on their error.
    Bound,
    /// The fast engine draws the same bits.
    Engines,
}

impl Check {
    /// All, in order.
    pub const ALL: [Self; 10] = [
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

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ends => "ends",
            Self::Headroom => "headroom",
            Self::Exact => "exact",
            Self::Missing => "missing",
            Self::Holes => "holes",
            Self::Order => "order",
            Self::Place => "place",
            Self::Specification => "specification",
            Self::Bound => "bound",
            Self::Engines => "engines",
        }
    }

    /// The details.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Ends => "a frame ends within a bound on records",
            Self::Headroom => "a frame whose set-up promises that no word overflows does not trap",
            Self::Exact => {
                "exact: the oracle's picture, sample by sample, at every level of detail"
            }
            Self::Missing => "exact: no sample that is covered without level of detail is missing",
            Self::Holes => {
                "a closed surface has no holes: under exact, and at tolerance 0 to 1/64 where no \
                 record met the level bound"
            }
            Self::Order => "nothing is seen that the oracle's voxel hides",
            Self::Place => {
                "what is seen is before the eye and no more than the rule allows from its sample"
            }
            Self::Specification => "vertices are the specification's, bit for bit",
            Self::Bound => "vertices are within the bounds on their error",
            Self::Engines => "the fast engine draws the machine's bits",
        }
    }
}

/// Something that must not be.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    /// What was not kept.
    pub check: Check,
    /// Where and how.
    pub detail: String,
}

/// How a frame ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// With a picture.
    Drawn,
    /// With an overflow: operation, stage, level and record.
    Trapped(String),
    /// Before it began: the format does not hold the view.
    Refused(String),
    /// Given up: `any` and `center` take solids apart, down to the level bound
    /// or a thousandth of a voxel across the near plane, which ends, but not soon.
    CutOff,
}

/// What a case came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// What must not be.
    pub failures: Vec<Failure>,
    /// Records that had their turn.
    pub records: u64,
    /// Samples inside a closed surface, as the oracle sees it.
    pub inside: u64,
    /// Those of them that show nothing, or something behind the surface.
    pub holes: u64,
    /// Samples that show what the oracle's voxel hides.
    pub order: u64,
    /// The picture against the oracle's, without level of detail.
    pub coverage: CoverageError,
    /// Vertices, by [`super::Hold`].
    pub worst: [Worst; 3],
}

impl Outcome {
    pub(super) fn new(end: End) -> Self {
        Self {
            end,
            failures: Vec::new(),
            records: 0,
            inside: 0,
            holes: 0,
            order: 0,
            coverage: CoverageError::default(),
            worst: Default::default(),
        }
    }

    pub(super) fn fail(&mut self, check: Check, detail: impl Into<String>) {
        self.failures.push(Failure {
            check,
            detail: detail.into(),
        });
    }

    /// Whether this was not kept.
    #[must_use]
    pub fn fails(&self, check: Check) -> bool {
        self.failures.iter().any(|failure| failure.check == check)
    }
}
