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
    /// The one with the least error; `None`: none keeps to the limit.
    pub method: Option<String>,
    /// Decibel against the reference; infinite numbers are written as `null`.
    pub psnr: Option<f64>,
    /// Mean FLIP.
    pub flip: Option<f64>,
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
                answers.push(Answer {
                    criterion,
                    limit,
                    family,
                    method: best.map(|(facts, _)| facts.label.clone()),
                    psnr: best.map(|(_, picture)| picture.psnr_linear),
                    flip: best.map(|(_, picture)| picture.flip),
                });
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
    /// The best mesh, decimated or not, if any takes no more bytes; and its PSNR.
    pub triangles: Option<String>,
    /// See `triangles`.
    pub triangles_psnr: Option<f64>,
    /// The best far voxels, if any take no more bytes; and their PSNR.
    pub far: Option<String>,
    /// See `far`.
    pub far_psnr: Option<f64>,
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
            best.map(|(_, facts, outcome)| (facts.label.clone(), outcome.picture.psnr_linear))
        };
        let (triangles, far) = (best(&["triangles", "decimated"]), best(&["far voxels"]));
        let (triangles, triangles_psnr) = triangles.unzip();
        let (far, far_psnr) = far.unzip();
        let better = [triangles_psnr, far_psnr].into_iter().flatten();
        let better = better.reduce(f64::max);
        Rivals {
            method: facts.label.clone(),
            read_bytes: hybrid.read_bytes,
            psnr: hybrid.picture.psnr_linear,
            flip: hybrid.picture.flip,
            ahead: better.map(|better| hybrid.picture.psnr_linear - better),
            triangles,
            triangles_psnr,
            far,
            far_psnr,
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
                let of = answer.and_then(|answer| {
                    let method = answer.method.as_ref()?;
                    Some((answer.psnr?, answer.flip?, method))
                });
                of.map_or(Cell::None, |(psnr, flip, method)| {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Summary;
    use crate::error::{PictureError, Reference};
    use crate::measure::{CoverageBias, ShareError};
    use crate::methods::MethodAtDistance;

    fn error(rms: f64) -> PictureError {
        PictureError {
            rms_linear: rms,
            psnr_linear: -20.0 * libm::log10(rms),
            ssim: 1.0,
            flip: rms,
            coverage: CoverageBias {
                all: ShareError::default(),
                thin: ShareError::default(),
            },
        }
    }

    /// A method's label and family, its bytes, build time and error; times are 1, 2, 3 ms.
    fn distance(methods: &[(&str, &'static str, u64, f64, f64)]) -> (Vec<Facts>, Distance) {
        let facts = methods.iter().map(|(label, _, _, build_ms, _)| Facts {
            label: (*label).to_owned(),
            bytes: 1 << 20,
            build_ms: *build_ms,
        });
        let row = |(number, method): (usize, &(&str, &'static str, u64, f64, f64))| {
            let (label, family, read_bytes, _, rms) = *method;
            MethodAtDistance {
                method: label.to_owned(),
                family,
                outcome: Ok(Outcome {
                    wall: Summary::of(&[number as f64 + 1.0]),
                    thread: None,
                    picture: error(rms),
                    flicker: None,
                    pop: None,
                    counters: Vec::new(),
                    read_bytes,
                    remark: None,
                }),
            }
        };
        let distance = Distance {
            size: (1, 1),
            distance_world: 1.0,
            noise_floor: error(0.001),
            rows: methods.iter().enumerate().map(row).collect(),
            reference: Reference {
                width: 1,
                height: 1,
                rgba: Vec::new(),
                shares: Vec::new(),
            },
            pictures: Vec::new(),
        };
        (facts.collect(), distance)
    }

    #[test]
    fn the_best_within_each_limit_is_found() {
        let (facts, distance) = distance(&[
            ("few", "decimated", 3000, 50.0, 0.1),
            ("many", "decimated", 30_000, 50.0, 0.01),
            ("far", "far voxels", 9000, 5000.0, 0.05),
        ]);
        let answers = answers(&facts, &distance);
        let find = |criterion: &str, limit: f64, family: &str| {
            let is = |a: &&Answer| (a.criterion, a.limit, a.family) == (criterion, limit, family);
            answers.iter().find(is).and_then(|a| a.method.as_deref())
        };
        assert_eq!(find("kB of a frame", 4.0, "decimated"), Some("few"));
        assert_eq!(find("kB of a frame", 8.0, "far voxels"), None);
        assert_eq!(find("kB of a frame", 32.0, "decimated"), Some("many"));
        assert_eq!(find("ms a frame", 1.0, "decimated"), Some("few"));
        assert_eq!(find("ms a frame", 3.0, "decimated"), Some("many"));
        assert_eq!(find("s to build", 1.0, "far voxels"), None);
        assert_eq!(find("s to build", 10.0, "far voxels"), Some("far"));
    }

    #[test]
    fn rivals_take_no_more_bytes() {
        let (facts, distance) = distance(&[
            ("few", "decimated", 3000, 0.0, 0.1),
            ("many", "decimated", 30_000, 0.0, 0.01),
            ("far", "far voxels", 9000, 0.0, 0.05),
            ("both", "hybrid", 10_000, 0.0, 0.025),
        ]);
        let rivals = rivals(&facts, &distance);
        assert_eq!(rivals.len(), 1);
        assert_eq!(rivals[0].triangles.as_deref(), Some("few"));
        assert_eq!(rivals[0].far.as_deref(), Some("far"));
        // Half of the error.
        assert!((rivals[0].ahead.unwrap() - 6.02).abs() < 0.01);
    }
}
