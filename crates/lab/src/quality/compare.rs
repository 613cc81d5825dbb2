//! Comparisons of the methods of one scene and camera.

use crate::report::plot::dominates;
use crate::report::{Cell, Row};

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
            let able = rows.iter().filter(|row| {
                families.contains(&row.text("family").as_str()) && row.number("read_bytes") <= bytes
            });
            let error = |row: &Row| row.number("rms_linear");
            let Some(rival) = able.min_by(|a, b| error(a).total_cmp(&error(b))) else {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn rows<const N: usize>(methods: [(&str, &str, u64, f64); N]) -> [Row; N] {
        methods.map(|(name, family, bytes, rms)| {
            let mut row = Row::default();
            row.put("method", name);
            row.put("family", family);
            row.put("read_bytes", bytes);
            row.put("work", bytes);
            row.put("rms_linear", Cell::ratio(rms));
            row.put("psnr", Cell::Number(-20.0 * libm::log10(rms), 1));
            row
        })
    }

    #[test]
    fn rivals_take_no_more_bytes() {
        let mut rows = rows([
            ("few", "decimated", 3000, 0.1),
            ("many", "decimated", 30_000, 0.01),
            ("far", "far voxels", 9000, 0.05),
            ("both", "hybrid", 10_000, 0.025),
        ]);
        add_rivals(&mut rows);
        // Half of the error is 6.02 decibels.
        let found = ["rival_triangles", "rival_far", "ahead"].map(|name| rows[3].text(name));
        assert_eq!(found, ["few", "far", "6.0"]);
        assert_eq!(rows[0].get("ahead"), &Cell::None);
    }

    #[test]
    fn a_method_is_beaten_within_its_family_and_clearly() {
        let mut rows = rows([
            ("a", "voxels", 100, 0.1),
            ("b", "voxels", 100, 0.2),
            ("c", "voxels", 100, 0.1001),
            ("d", "far voxels", 900, 0.9),
        ]);
        add_beaten_by(&mut rows);
        assert_eq!(rows.map(|row| row.text("beaten_by")), ["", "a", "", ""]);
    }
}
