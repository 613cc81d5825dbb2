//! What a limit of time, of bytes or of building leaves: the best method of each family.

use serde::Serialize;

use super::measure::{Distance, Facts, MeshMethods, Outcome};
use crate::report::{Cell, Table};

/// What is limited: its name with a unit, and the limits.
type Criterion = (&'static str, &'static [f64], fn(&Facts, &Outcome) -> f64);

/// Times of a frame, bytes that it is made of, times to build.
const CRITERIA: [Criterion; 3] = [
    (
        "ms a frame",
        &[0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
        |_, outcome| outcome.thread.as_ref().unwrap_or(&outcome.wall).median_ms,
    ),
    (
        "kB of a frame",
        &[
            4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 4096.0, 16384.0,
        ],
        |_, outcome| outcome.read_bytes as f64 / 1024.0,
    ),
    ("s to build", &[0.0, 0.1, 1.0, 10.0, 100.0], |facts, _| {
        facts.build_ms / 1e3
    }),
];

/// The best of a family within a limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// What is limited.
    pub criterion: &'static str,
    /// To how much.
    pub limit: f64,
    /// Of which methods.
    pub family: &'static str,
    /// The one with the least error.
    pub method: String,
    /// Decibel against the reference; infinite numbers are written as `null`.
    pub psnr: f64,
    /// Mean FLIP.
    pub flip: f64,
}

/// For each criterion, limit and family the method of the highest PSNR.
#[must_use]
pub fn answers(facts: &[Facts], distance: &Distance) -> Vec<Answer> {
    let mut answers = Vec::new();
    for (criterion, limits, of) in CRITERIA {
        for &limit in limits {
            for family in families(distance) {
                let rows = distance.rows.iter().zip(facts);
                let able = rows.filter_map(|(row, facts)| {
                    let outcome = row.outcome.as_ref().ok()?;
                    let is_within = row.family == family && of(facts, outcome) <= limit;
                    is_within.then_some((facts, outcome.picture))
                });
                let best = able.min_by(|(_, a), (_, b)| a.rms_linear.total_cmp(&b.rms_linear));
                answers.extend(best.map(|(facts, picture)| Answer {
                    criterion,
                    limit,
                    family,
                    method: facts.label.clone(),
                    psnr: picture.psnr_linear,
                    flip: picture.flip,
                }));
            }
        }
    }
    answers
}

/// A hybrid, and the best of what it is made of in no more bytes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rivals {
    /// Which hybrid.
    pub method: String,
    /// Bytes that its frame is made of.
    pub read_bytes: u64,
    /// Decibel.
    pub psnr: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// The best decimated mesh, or the whole one, if any takes no more bytes.
    pub triangles: Option<Answer>,
    /// The best far voxels, if any take no more bytes.
    pub far: Option<Answer>,
    /// PSNR above that of the better of both.
    pub ahead: Option<f64>,
}

/// Each hybrid beside its parts in no more bytes, with any number of samples.
#[must_use]
pub fn rivals(facts: &[Facts], distance: &Distance) -> Vec<Rivals> {
    let outcomes = || {
        let rows = distance.rows.iter().zip(facts);
        rows.filter_map(|(row, facts)| Some((row.family, facts, row.outcome.as_ref().ok()?)))
    };
    let hybrids = outcomes().filter(|(family, ..)| *family == "hybrid");
    let rivals = hybrids.map(|(_, facts, hybrid)| {
        let best = |families: &[&str]| {
            let able = outcomes().filter(|(family, _, outcome)| {
                families.contains(family) && outcome.read_bytes <= hybrid.read_bytes
            });
            let error = |outcome: &Outcome| outcome.picture.rms_linear;
            let best = able.min_by(|(.., a), (.., b)| error(a).total_cmp(&error(b)));
            best.map(|(family, facts, outcome)| Answer {
                criterion: "kB of a frame",
                limit: hybrid.read_bytes as f64 / 1024.0,
                family,
                method: facts.label.clone(),
                psnr: outcome.picture.psnr_linear,
                flip: outcome.picture.flip,
            })
        };
        let (triangles, far) = (best(&["triangles", "decimated"]), best(&["far voxels"]));
        let psnr = |answer: &Option<Answer>| answer.as_ref().map(|answer| answer.psnr);
        let better = [psnr(&triangles), psnr(&far)].into_iter().flatten();
        let better = better.reduce(f64::max);
        Rivals {
            method: facts.label.clone(),
            read_bytes: hybrid.read_bytes,
            psnr: hybrid.picture.psnr_linear,
            flip: hybrid.picture.flip,
            ahead: better.map(|better| hybrid.picture.psnr_linear - better),
            triangles,
            far,
        }
    });
    rivals.collect()
}

/// The families, in the order of their methods.
fn families(distance: &Distance) -> Vec<&'static str> {
    let mut families: Vec<&'static str> = distance.rows.iter().map(|row| row.family).collect();
    families.dedup();
    families
}

/// A table for each criterion: a row for each limit, a column for each family.
#[must_use]
pub fn tables(mesh: &MeshMethods, distance: &Distance) -> Vec<Table> {
    let answers = answers(&mesh.facts, distance);
    let families = families(distance);
    let (width, height) = distance.size;
    let table = |(criterion, limits, _): &Criterion| {
        let title = format!(
            "{}, {width} x {height} pixels: best of each family at equal {criterion} (PSNR in \
             decibel, FLIP, method)",
            mesh.mesh
        );
        let columns: Vec<&'static str> =
            std::iter::once("at most").chain(families.clone()).collect();
        let mut table = Table::new(title, &columns);
        for limit in *limits {
            let of = |family: &&str| {
                let answer = answers.iter().find(|answer| {
                    (answer.criterion, answer.limit, answer.family) == (criterion, *limit, family)
                });
                answer.map_or(Cell::None, |answer| {
                    let Answer {
                        psnr, flip, method, ..
                    } = answer;
                    Cell::Text(format!("{psnr:.1}, {flip:.3}: {method}"))
                })
            };
            let cells: Vec<Cell> = families.iter().map(of).collect();
            if cells.iter().any(|cell| *cell != Cell::None) {
                let limit = Cell::Text(format!("{limit} {criterion}"));
                table
                    .rows
                    .push(std::iter::once(limit).chain(cells).collect());
            }
        }
        table
    };
    CRITERIA.iter().map(table).collect()
}
