//! `bench scaling`: how time grows with pixels and with voxels.

use serde::Serialize;

use super::measure::Timing;
use super::power_law::PowerLaw;
use crate::report::plot::{Chart, Panel, Series};
use crate::report::{Cell, Table};

/// The image-order paper's Table I, on its machine and with its scene: pixels a side of a
/// square picture, and milliseconds as it prints them.
pub const PAPER_TABLE_I: [(u32, &str); 5] = [
    (64, "<1"),
    (128, "20"),
    (256, "110"),
    (512, "462"),
    (1024, "1772"),
];

/// The image-order paper's time for a square picture, as it prints it, milliseconds.
#[must_use]
pub fn paper_ms(width: u32, height: u32) -> Option<&'static str> {
    let found = PAPER_TABLE_I
        .iter()
        .find(|&&(side, _)| (width, height) == (side, side));
    found.map(|&(_, time)| time)
}

/// What grows in a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Growing {
    /// The picture, of one scene.
    Pixels,
    /// The scene, in pictures of one size.
    Voxels,
}

impl Growing {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pixels => "pixels",
            Self::Voxels => "voxels",
        }
    }

    /// How large it is.
    #[must_use]
    pub fn of(self, timing: &Timing) -> f64 {
        match self {
            Self::Pixels => timing.pixels() as f64,
            Self::Voxels => timing.voxels as f64,
        }
    }
}

/// Times of one engine while one thing grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// What grows.
    pub growing: Growing,
    /// The scene, or the kind of scene.
    pub series: String,
    /// The engine.
    pub engine: &'static str,
    /// Threads that it had.
    pub threads: usize,
    /// The times, by growing size.
    pub points: Vec<Timing>,
    /// Law of the time, milliseconds.
    pub time_law: Option<PowerLaw>,
    /// Law of the engine's work, which does not depend on the machine.
    pub work_law: Option<PowerLaw>,
}

impl Growth {
    /// The series of some times, one for each engine and thread count, in the order in which they
    /// come.
    #[must_use]
    pub fn collect(growing: Growing, series: &str, timings: Vec<Timing>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for timing in timings {
            let same = |g: &&mut Self| g.engine == timing.engine && g.threads == timing.threads;
            if let Some(growth) = all.iter_mut().find(same) {
                growth.points.push(timing);
            } else {
                all.push(Self {
                    growing,
                    series: series.to_owned(),
                    engine: timing.engine,
                    threads: timing.threads,
                    points: vec![timing],
                    time_law: None,
                    work_law: None,
                });
            }
        }
        for growth in &mut all {
            let law = |y: &dyn Fn(&Timing) -> f64| {
                let points = growth.points.iter();
                let points: Vec<_> = points.map(|t| (growing.of(t), y(t))).collect();
                PowerLaw::fit(&points)
            };
            let time_law = law(&Timing::best_median_ms);
            let work_law = law(&|t| t.work.unwrap_or(0) as f64);
            (growth.time_law, growth.work_law) = (time_law, work_law);
        }
        all
    }
}

/// All times; `exponent` is the growth from the row before.
#[must_use]
pub fn points_table(growths: &[Growth]) -> Table {
    let columns = "growing scene engine threads size pixels voxels median_ms min_ms deviation_ms \
        thread_median_ms exponent work work_unit paper_table_1_ms";
    let mut table = Table::of("Growth of a frame's time", columns);
    for growth in growths {
        let mut before: Option<&Timing> = None;
        for timing in &growth.points {
            let x = |t: &Timing| growth.growing.of(t);
            let step = before.and_then(|before| {
                let ends = [before, timing].map(|t| (x(t), t.best_median_ms()));
                PowerLaw::fit(&ends)
            });
            let paper =
                paper_ms(timing.width, timing.height).filter(|_| growth.growing == Growing::Pixels);
            table.rows.push(vec![
                growth.growing.name().into(),
                Cell::Text(timing.scene.clone()),
                timing.engine.into(),
                (timing.threads as u64).into(),
                Cell::Text(timing.size()),
                timing.pixels().into(),
                timing.voxels.into(),
                Cell::ms(timing.wall.median_ms),
                Cell::ms(timing.wall.min_ms),
                Cell::ms(timing.wall.deviation_ms),
                timing.thread.map_or(Cell::None, |t| Cell::ms(t.median_ms)),
                step.map_or(Cell::None, |law| Cell::ratio(law.exponent)),
                timing.work.into(),
                timing.work_unit.into(),
                paper.into(),
            ]);
            before = Some(timing);
        }
    }
    table
}

/// The laws, one row for time and one for work of each series.
#[must_use]
pub fn laws_table(growths: &[Growth]) -> Table {
    let columns = "growing series engine threads of points exponent r_squared worst_ratio";
    let title =
        "Fitted power laws: exponent, share explained, greatest factor between a point and the law";
    let mut table = Table::of(title, columns);
    for growth in growths {
        let unit = growth.points.first().map_or("work", |t| t.work_unit);
        for (of, law) in [("time", growth.time_law), (unit, growth.work_law)] {
            let Some(law) = law else { continue };
            table.rows.push(vec![
                growth.growing.name().into(),
                Cell::Text(growth.series.clone()),
                growth.engine.into(),
                (growth.threads as u64).into(),
                of.into(),
                (law.points as u64).into(),
                Cell::ratio(law.exponent),
                law.r_squared.map_or(Cell::None, |r| Cell::Number(r, 4)),
                Cell::ratio(law.worst_ratio),
            ]);
        }
    }
    table
}

/// Two plots: time by pixels, with the image-order paper's Table I, and time by voxels.
#[must_use]
pub fn panels(growths: &[Growth]) -> Vec<Panel> {
    [Growing::Pixels, Growing::Voxels]
        .into_iter()
        .filter(|&growing| growths.iter().any(|g| g.growing == growing))
        .map(|growing| {
            let of = growths.iter().filter(|g| g.growing == growing);
            let points = of.flat_map(|g| {
                let name = format!("{}, {}", g.series, g.engine);
                let name = match g.threads {
                    1 => name,
                    threads => format!("{name}, {threads} threads"),
                };
                let at = move |t: &Timing| (growing.of(t), t.best_median_ms());
                g.points.iter().map(move |t| (name.clone(), at(t)))
            });
            let mut series = Series::collect(points);
            if growing == Growing::Pixels {
                let paper = PAPER_TABLE_I.iter().filter_map(|&(side, time)| {
                    Some((f64::from(side * side), time.parse::<f64>().ok()?))
                });
                series.push(Series::curve("the paper's Table I", paper));
            }
            let title = format!("Time by {}", growing.name());
            Panel::Chart(Chart::growth(&title, growing.name(), "ms a frame", series))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Summary;

    fn timing(engine: &'static str, side: u32, median_ms: f64, work: u64) -> Timing {
        Timing {
            scene: "s".to_owned(),
            voxels: 8,
            width: side,
            height: side,
            engine,
            threads: 1,
            wall: Summary::of(&[median_ms]),
            thread: None,
            work: Some(work),
            work_unit: "records",
            counters: Vec::new(),
            coverage: None,
        }
    }

    #[test]
    fn series_are_told_apart_and_fitted() {
        let timings = [64u32, 128, 256]
            .into_iter()
            .flat_map(|side| {
                let pixels = f64::from(side * side);
                [
                    timing("a", side, pixels / 1e3, u64::from(side)),
                    timing("b", side, 7.0, 5),
                ]
            })
            .collect();
        let growths = Growth::collect(Growing::Pixels, "s", timings);
        assert_eq!(growths.len(), 2);
        let exponent = |law: Option<PowerLaw>| libm::round(law.unwrap().exponent * 1e6) / 1e6;
        assert_eq!(exponent(growths[0].time_law), 1.0);
        assert_eq!(exponent(growths[0].work_law), 0.5);
        assert_eq!(exponent(growths[1].time_law), 0.0);
        let table = points_table(&growths);
        assert_eq!(table.rows.len(), 6);
        let column = |name| table.columns.iter().position(|c| *c == name).unwrap();
        assert_eq!(table.rows[0][column("exponent")], Cell::None);
        assert_eq!(table.rows[1][column("exponent")].for_people(), "1.000");
        assert_eq!(table.rows[0][column("paper_table_1_ms")].for_people(), "<1");
        assert_eq!(
            table.rows[2][column("paper_table_1_ms")].for_people(),
            "110"
        );
        assert_eq!(laws_table(&growths).rows.len(), 4);
    }

    #[test]
    fn the_paper_has_square_pictures() {
        assert_eq!(paper_ms(1024, 1024), Some("1772"));
        assert_eq!(paper_ms(1024, 512), None);
        assert_eq!(paper_ms(2048, 2048), None);
    }
}
