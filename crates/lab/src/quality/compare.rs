//! Comparisons of the methods of one scene and camera.

use crate::report::plot::dominates;
use crate::report::{Cell, Row};

/// Less by a smaller part than this is not worth mentioning.
const WORTH_MENTIONING: f64 = 0.01;

/// Adds the column `beaten_by`. A method beats another of its family if it has no more work, no more
/// wrong samples and no greater error, and one of these is less by a hundredth or more. Of several,
/// the one with the least work is named.
pub(super) fn add_beaten_by(rows: &mut [Row]) {
    let standing = |row: &Row| {
        let samples = row.get("wrong_share").number();
        let error = row.number("rms_linear");
        [row.number("work"), samples.unwrap_or(f64::INFINITY), error]
    };
    let standings: Vec<[f64; 3]> = rows.iter().map(standing).collect();
    let winner = |place: usize| {
        let own = standings[place];
        let better = rows.iter().zip(&standings).filter(|(row, other)| {
            let is_clear = |(q, p): (&f64, &f64)| *q < p * (1.0 - WORTH_MENTIONING);
            row.get("family") == rows[place].get("family")
                && other.iter().zip(&own).any(is_clear)
                && dominates(other, &own)
        });
        let best = better.min_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
        best.map(|(row, _)| row.get("method").clone())
    };
    let winners: Vec<Option<Cell>> = (0..rows.len()).map(winner).collect();
    for (row, winner) in rows.iter_mut().zip(winners) {
        row.put("beaten_by", winner);
    }
}

/// The row with the least error among those of some families within a limit.
fn best<'r>(rows: &'r [Row], families: &[&str], column: &str, limit: f64) -> Option<&'r Row> {
    let able = rows.iter().filter(|row| {
        families.contains(&row.text("family").as_str()) && row.number(column) <= limit
    });
    able.min_by(|a, b| a.number("rms_linear").total_cmp(&b.number("rms_linear")))
}

/// Adds to each hybrid the best of its parts in no more bytes, with any number of samples:
/// `rival_triangles`, `rival_far`, their PSNR, and `ahead`, its PSNR above that of the better one.
pub(super) fn add_rivals(rows: &mut [Row]) {
    for place in 0..rows.len() {
        if rows[place].text("family") != "hybrid" {
            continue;
        }
        let bytes = rows[place].number("read_bytes");
        let mut better = f64::NEG_INFINITY;
        for (name, psnr, families) in [
            (
                "rival_triangles",
                "rival_triangles_psnr",
                &["triangles", "decimated"][..],
            ),
            ("rival_far", "rival_far_psnr", &["far voxels"]),
        ] {
            let Some(rival) = best(rows, families, "read_bytes", bytes) else {
                continue;
            };
            better = better.max(rival.number("psnr"));
            let (method, value) = (rival.get("method").clone(), rival.get("psnr").clone());
            rows[place].put(name, method);
            rows[place].put(psnr, value);
        }
        if better.is_finite() {
            let ahead = rows[place].number("psnr") - better;
            rows[place].put("ahead", Cell::Number(ahead, 1));
        }
    }
}

/// A criterion: its name with a unit, its column, the column's value at 1, and limits.
type Criterion = (&'static str, &'static str, f64, &'static [f64]);

const CRITERIA: [Criterion; 3] = [
    (
        "ms per frame",
        "ms",
        1.0,
        &[0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
    ),
    (
        "kB per frame",
        "read_bytes",
        1024.0,
        &[
            4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 4096.0, 16384.0,
        ],
    ),
    ("s to build", "build_ms", 1e3, &[0.0, 0.1, 1.0, 10.0, 100.0]),
];

/// The method with the least error of each family at equal time, bytes and time to build. There is a
/// row for each scene, camera, criterion, limit and family that has a method within the limit.
#[must_use]
pub fn answers(rows: &[Row]) -> Vec<Row> {
    let is_together = |a: &Row, b: &Row| {
        ["scene", "size"]
            .iter()
            .all(|name| a.get(name) == b.get(name))
    };
    let mut answers = Vec::new();
    for rows in rows.chunk_by(is_together) {
        let mut families: Vec<String> = rows.iter().map(|row| row.text("family")).collect();
        families.dedup();
        for (criterion, column, unit, limits) in CRITERIA {
            for limit in limits {
                for family in &families {
                    let Some(best) = best(rows, &[family], column, limit * unit) else {
                        continue;
                    };
                    let mut row = Row::default();
                    for name in [
                        "scene", "stem", "size", "height", "family", "method", "psnr", "flip",
                    ] {
                        row.put(name, best.get(name).clone());
                    }
                    row.put("criterion", criterion);
                    row.put("limit", Cell::Number(*limit, 1));
                    answers.push(row);
                }
            }
        }
    }
    answers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of methods with name, family, bytes, time to build and error. Times are 1, 2, 3 ms.
    fn rows(methods: &[(&str, &str, u64, f64, f64)]) -> Vec<Row> {
        let row = |(number, method): (usize, &(&str, &str, u64, f64, f64))| {
            let (name, family, bytes, build_ms, rms) = *method;
            let mut row = Row::default();
            row.put("scene", "s");
            row.put("method", name);
            row.put("family", family);
            row.put("read_bytes", bytes);
            row.put("work", bytes);
            row.put("build_ms", Cell::ms(build_ms));
            row.put("ms", Cell::ms(number as f64 + 1.0));
            row.put("rms_linear", Cell::ratio(rms));
            row.put("psnr", Cell::Number(-20.0 * libm::log10(rms), 1));
            row
        };
        methods.iter().enumerate().map(row).collect()
    }

    #[test]
    fn the_best_within_each_limit_is_found() {
        let rows = rows(&[
            ("few", "decimated", 3000, 50.0, 0.1),
            ("many", "decimated", 30_000, 50.0, 0.01),
            ("far", "far voxels", 9000, 5000.0, 0.05),
        ]);
        let answers = answers(&rows);
        for (criterion, limit, family, expected) in [
            ("kB per frame", 4.0, "decimated", "few"),
            ("kB per frame", 8.0, "far voxels", ""),
            ("kB per frame", 32.0, "decimated", "many"),
            ("ms per frame", 1.0, "decimated", "few"),
            ("ms per frame", 3.0, "decimated", "many"),
            ("s to build", 1.0, "far voxels", ""),
            ("s to build", 10.0, "far voxels", "far"),
        ] {
            let found = answers.iter().find(|row| {
                (row.text("criterion").as_str(), row.text("family").as_str()) == (criterion, family)
                    && row.number("limit") == limit
            });
            let method = found.map_or(String::new(), |row| row.text("method"));
            assert_eq!(method, expected, "{criterion} {limit} {family}");
        }
    }

    #[test]
    fn rivals_take_no_more_bytes() {
        let mut rows = rows(&[
            ("few", "decimated", 3000, 0.0, 0.1),
            ("many", "decimated", 30_000, 0.0, 0.01),
            ("far", "far voxels", 9000, 0.0, 0.05),
            ("both", "hybrid", 10_000, 0.0, 0.025),
        ]);
        add_rivals(&mut rows);
        assert_eq!(rows[3].text("rival_triangles"), "few");
        assert_eq!(rows[3].text("rival_far"), "far");
        // Half of the error.
        assert!((rows[3].number("ahead") - 6.02).abs() < 0.01);
        assert_eq!(rows[0].get("ahead"), &Cell::None);
    }

    #[test]
    fn a_method_is_beaten_within_its_family_and_clearly() {
        let mut rows = rows(&[
            ("a", "voxels", 100, 0.0, 0.1),
            ("b", "voxels", 100, 0.0, 0.2),
            ("c", "voxels", 100, 0.0, 0.1001),
            ("d", "far voxels", 900, 0.0, 0.9),
        ]);
        add_beaten_by(&mut rows);
        let beaten_by: Vec<String> = rows.iter().map(|row| row.text("beaten_by")).collect();
        assert_eq!(beaten_by, ["", "a", "", ""]);
    }
}
