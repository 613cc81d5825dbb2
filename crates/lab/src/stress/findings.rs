//! The results of a sweep: outcomes, added up by scene, word width and rule.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};

use super::case::Case;
use super::check::STRICT_TOLERANCE;
use super::outcome::{Check, End, Outcome};
use super::sweep::{SweepPlan, TOLERANCES};
use super::vertex::{Hold, Worst};
use shiftvox::project::Coverage;

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Key {
    pub scene: usize,
    pub bits: u32,
    /// Place of the rule in [`Coverage::UNBLENDED`].
    pub coverage: usize,
    /// Place of the tolerance in [`TOLERANCES`].
    pub tolerance: usize,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tally {
    pub cases: u64,
    pub drawn: u64,
    pub trapped: u64,
    pub refused: u64,
    /// Cases given up after the most records: [`End::CutOff`].
    pub cut_off: u64,
    pub failed: u64,
    pub most_records: u64,
    /// Samples inside closed surfaces.
    pub inside: u64,
    pub holes: u64,
    pub order: u64,
    pub covered: u64,
    /// False positives.
    pub extra: u64,
    /// False negatives.
    pub missing: u64,
}

impl Tally {
    fn of(outcome: &Outcome) -> Self {
        let mut tally = Self {
            cases: 1,
            failed: u64::from(!outcome.failures.is_empty()),
            most_records: outcome.records,
            inside: outcome.inside,
            holes: outcome.holes,
            order: outcome.order,
            covered: outcome.coverage.covered,
            extra: outcome.coverage.extra,
            missing: outcome.coverage.missing,
            ..Self::default()
        };
        *match outcome.end {
            End::Drawn => &mut tally.drawn,
            End::Trapped(_) => &mut tally.trapped,
            End::Refused(_) => &mut tally.refused,
            End::CutOff => &mut tally.cut_off,
        } = 1;
        tally
    }

    fn merge(&mut self, other: &Self) {
        self.cases += other.cases;
        self.drawn += other.drawn;
        self.trapped += other.trapped;
        self.refused += other.refused;
        self.cut_off += other.cut_off;
        self.failed += other.failed;
        self.inside += other.inside;
        self.holes += other.holes;
        self.order += other.order;
        self.covered += other.covered;
        self.extra += other.extra;
        self.missing += other.missing;
        self.most_records = self.most_records.max(other.most_records);
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failed {
    pub check: Check,
    pub detail: String,
    pub case: String,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    pub tallies: BTreeMap<Key, Tally>,
    /// Worst vertices by [`Hold`] and word width.
    pub worst: BTreeMap<(Hold, u32), Worst>,
    pub traps: BTreeMap<String, u64>,
    pub refusals: BTreeMap<String, u64>,
    pub failures: BTreeMap<Check, u64>,
    /// Some of the failures, by check.
    pub failed: Vec<Failed>,
}

const TOLD: u64 = 3;

impl Findings {
    pub fn total(&self) -> Tally {
        self.sum(|_| true)
    }

    fn sum(&self, wanted: impl Fn(&Key) -> bool) -> Tally {
        let mut sum = Tally::default();
        for (_, tally) in self.tallies.iter().filter(|(key, _)| wanted(key)) {
            sum.merge(tally);
        }
        sum
    }

    pub(super) fn note(&mut self, key: Key, case: &Case, outcome: &Outcome) {
        for (hold, worst) in Hold::ALL.into_iter().zip(&outcome.worst) {
            if worst.vertices > 0 {
                self.worst.entry((hold, key.bits)).or_default().merge(worst);
            }
        }
        let tally = Tally::of(outcome);
        self.tallies.entry(key).or_default().merge(&tally);
        match &outcome.end {
            End::Drawn | End::CutOff => {}
            End::Trapped(trap) => *self.traps.entry(place_of(trap)).or_default() += 1,
            End::Refused(reason) => *self.refusals.entry(reason.clone()).or_default() += 1,
        }
        for failure in &outcome.failures {
            let count = self.failures.entry(failure.check).or_default();
            *count += 1;
            if *count <= TOLD {
                self.failed.push(Failed {
                    check: failure.check,
                    detail: failure.detail.clone(),
                    case: case.to_string(),
                });
            }
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        fn add<K: Ord, V: Default>(
            to: &mut BTreeMap<K, V>,
            from: BTreeMap<K, V>,
            merge: impl Fn(&mut V, &V),
        ) {
            for (key, value) in from {
                merge(to.entry(key).or_default(), &value);
            }
        }
        let count = |to: &mut u64, from: &u64| *to += from;
        add(&mut self.worst, other.worst, Worst::merge);
        add(&mut self.tallies, other.tallies, Tally::merge);
        add(&mut self.traps, other.traps, count);
        add(&mut self.refusals, other.refusals, count);
        add(&mut self.failures, other.failures, count);
        self.failed.extend(other.failed);
    }

    /// The results as JSON: all rows, and sums by scene, rule, word width, and check.
    pub fn document(&self, plan: &SweepPlan) -> Value {
        let named = |fields: Value, tally: &Tally| {
            let mut row = json!(tally);
            for (key, value) in fields.as_object().into_iter().flatten() {
                row[key] = value.clone();
            }
            row
        };
        let rule = |coverage: usize, tolerance: usize| {
            let (rule, px) = (Coverage::UNBLENDED[coverage], TOLERANCES[tolerance]);
            let must_be_0 = match (rule.draws_outlines(), px <= STRICT_TOLERANCE) {
                (true, _) => "yes",
                (_, true) => "except at the level bound",
                _ => "no",
            };
            json!({
                "coverage": rule.name(),
                "tolerance_px": if px.is_finite() { json!(px) } else { json!("inf") },
                "holes_must_be_0": must_be_0,
            })
        };
        let results = self.tallies.iter().map(|(key, tally)| {
            let mut fields = rule(key.coverage, key.tolerance);
            fields["scene"] = json!(plan.scenes[key.scene].to_string());
            fields["bits"] = json!(key.bits);
            named(fields, tally)
        });
        let scenes = plan.scenes.iter().enumerate().map(|(at, scene)| {
            let tally = self.sum(|key| key.scene == at);
            named(json!({ "scene": scene.to_string() }), &tally)
        });
        let places = (0..Coverage::UNBLENDED.len())
            .flat_map(|coverage| (0..TOLERANCES.len()).map(move |tolerance| (coverage, tolerance)));
        let rules = places.filter_map(|(coverage, tolerance)| {
            let is_rule = |key: &Key| (key.coverage, key.tolerance) == (coverage, tolerance);
            let tally = self.sum(is_rule);
            (tally.cases > 0).then(|| named(rule(coverage, tolerance), &tally))
        });
        let mut vertices: Vec<Value> = Vec::new();
        for hold in Hold::ALL {
            let mut all = Worst::default();
            let worst = self.worst.iter().filter(|((of, _), _)| *of == hold);
            for ((_, bits), worst) in worst {
                all.merge(worst);
                vertices.push(json!({ "held_in": hold.name(), "bits": bits, "worst": worst }));
            }
            if all.vertices > 0 {
                vertices.push(json!({ "held_in": hold.name(), "bits": "all", "worst": all }));
            }
        }
        let checks = Check::ALL.map(|check| {
            let failures = self.failures.get(&check).copied().unwrap_or(0);
            json!({ "check": check, "failures": failures })
        });
        let counts = |of: &BTreeMap<String, u64>| -> Value {
            let count = |(what, frames)| json!({ "what": what, "frames": frames });
            of.iter().map(count).collect()
        };
        json!({
            "seed": plan.seed,
            "total": self.total(),
            "checks": checks,
            "failed": self.failed,
            "traps": counts(&self.traps),
            "refusals": counts(&self.refusals),
            "scenes": scenes.collect::<Vec<_>>(),
            "rules": rules.collect::<Vec<_>>(),
            "vertices": vertices,
            "results": results.collect::<Vec<_>>(),
        })
    }
}

fn place_of(trap: &str) -> String {
    let place = trap.split(", record").next().unwrap_or(trap);
    let place = place.split_once("overflowed in ").map_or(place, |p| p.1);
    let place = place.split(", octree").next().unwrap_or(place);
    place.replace(" (stage", ", stage")
}
