//! What a sweep found: outcomes, added up by scene, word width and rule.

use std::collections::BTreeMap;

use serde::Serialize;

use super::case::Case;
use super::outcome::{Check, End, Outcome};
use super::vertex::Worst;

/// What outcomes are added up by.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Key {
    /// Place of the scene in the plan.
    pub scene: usize,
    /// Word width.
    pub bits: u32,
    /// Place of the rule in [`Coverage::UNBLENDED`](shiftvox::project::Coverage::UNBLENDED).
    pub coverage: usize,
    /// Place of the tolerance in [`super::TOLERANCES`].
    pub tolerance: usize,
}

/// Outcomes added up.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tally {
    /// Cases.
    pub cases: u64,
    /// Those with a picture.
    pub drawn: u64,
    /// Those that an overflow ended, with its place.
    pub trapped: u64,
    /// Those that the set-up refused.
    pub refused: u64,
    /// Those given up after the most records: [`End::CutOff`].
    pub cut_off: u64,
    /// Those that did not keep what they must.
    pub failed: u64,
    /// Most records of a frame.
    pub most_records: u64,
    /// Samples inside closed surfaces.
    pub inside: u64,
    /// Holes among them.
    pub holes: u64,
    /// Samples that show what is hidden.
    pub order: u64,
    /// Samples that the oracle covers.
    pub covered: u64,
    /// Samples covered that should not be.
    pub extra: u64,
    /// Samples not covered that should be.
    pub missing: u64,
}

impl Tally {
    fn note(&mut self, outcome: &Outcome) {
        self.cases += 1;
        match outcome.end {
            End::Drawn => self.drawn += 1,
            End::Trapped(_) => self.trapped += 1,
            End::Refused(_) => self.refused += 1,
            End::CutOff => self.cut_off += 1,
        }
        self.failed += u64::from(!outcome.failures.is_empty());
        self.most_records = self.most_records.max(outcome.records);
        self.inside += outcome.inside;
        self.holes += outcome.holes;
        self.order += outcome.order;
        self.covered += outcome.coverage.covered;
        self.extra += outcome.coverage.extra;
        self.missing += outcome.coverage.missing;
    }

    /// Both together.
    pub fn merge(&mut self, other: &Self) {
        self.cases += other.cases;
        self.drawn += other.drawn;
        self.trapped += other.trapped;
        self.refused += other.refused;
        self.cut_off += other.cut_off;
        self.failed += other.failed;
        self.most_records = self.most_records.max(other.most_records);
        self.inside += other.inside;
        self.holes += other.holes;
        self.order += other.order;
        self.covered += other.covered;
        self.extra += other.extra;
        self.missing += other.missing;
    }
}

/// A case that did not keep what it must.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failed {
    /// What it did not keep.
    pub check: Check,
    /// Where and how.
    pub detail: String,
    /// The case, for `--case`.
    pub case: String,
    /// A smaller one that fails too, where it was searched for.
    pub minimal: Option<String>,
    /// The smaller one's details.
    pub minimal_detail: Option<String>,
    /// A command that draws its picture, where `render` can.
    pub render: Option<String>,
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Outcomes by scene, width and rule.
    pub tallies: BTreeMap<Key, Tally>,
    /// Worst vertices by [`super::Hold`] and word width.
    pub worst: BTreeMap<(usize, u32), Worst>,
    /// Outcomes by viewpoint.
    pub viewpoints: BTreeMap<&'static str, Tally>,
    /// Traps by place, records left out.
    pub traps: BTreeMap<String, u64>,
    /// Refusals by reason.
    pub refusals: BTreeMap<String, u64>,
    /// Failures by check.
    pub failures: BTreeMap<Check, u64>,
    /// Some of the failures, those that were shrunk first.
    pub failed: Vec<Failed>,
}

/// Failures that are reported in full, of each check in each job.
const TOLD: usize = 3;

impl Findings {
    /// All together.
    #[must_use]
    pub fn total(&self) -> Tally {
        let mut total = Tally::default();
        for tally in self.tallies.values() {
            total.merge(tally);
        }
        total
    }

    pub(super) fn note(
        &mut self,
        key: Key,
        viewpoint: &'static str,
        case: &Case,
        outcome: &Outcome,
    ) {
        for (hold, worst) in outcome.worst.iter().enumerate() {
            if worst.vertices > 0 {
                self.worst.entry((hold, key.bits)).or_default().merge(worst);
            }
        }
        self.tallies.entry(key).or_default().note(outcome);
        self.viewpoints.entry(viewpoint).or_default().note(outcome);
        match &outcome.end {
            End::Drawn | End::CutOff => {}
            End::Trapped(trap) => {
                // Without the record, which is another in every case.
                let place = trap.split(", record").next().unwrap_or(trap);
                let place = place.split_once("overflowed in ").map_or(place, |p| p.1);
                let place = place.split(", octree").next().unwrap_or(place);
                let place = place.replace(" (stage", ", stage");
                *self.traps.entry(place).or_default() += 1;
            }
            End::Refused(reason) => *self.refusals.entry(reason.clone()).or_default() += 1,
        }
        for failure in &outcome.failures {
            let count = self.failures.entry(failure.check).or_default();
            *count += 1;
            if *count as usize <= TOLD {
                self.failed.push(Failed {
                    check: failure.check,
                    detail: failure.detail.clone(),
                    case: case.to_string(),
                    minimal: None,
                    minimal_detail: None,
                    render: None,
                });
            }
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        for (key, worst) in other.worst {
            self.worst.entry(key).or_default().merge(&worst);
        }
        for (key, tally) in other.tallies {
            self.tallies.entry(key).or_default().merge(&tally);
        }
        for (name, tally) in other.viewpoints {
            self.viewpoints.entry(name).or_default().merge(&tally);
        }
        for (to, from) in [
            (&mut self.traps, other.traps),
            (&mut self.refusals, other.refusals),
        ] {
            for (place, count) in from {
                *to.entry(place).or_default() += count;
            }
        }
        for (check, count) in other.failures {
            *self.failures.entry(check).or_default() += count;
        }
        self.failed.extend(other.failed);
    }
}
