//! The image-order paper's Table I, its claims and its Figure 5, beside this program's figures:
//! a list of measurements in TOML (`reproduce.toml`).

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;
use serde::Deserialize;

use crate::bench::{
    BenchError, EVERYTHING_ON, Family, Harness, PowerLaw, Subject, TimePlan, measure,
};
use crate::model::frame::{self, Counted};
use crate::report::plot::{Chart, RowPlot, Series};
use crate::report::{Cell, Row, Table};
use shiftvox::picture::{self, Background, Shading, resolve};
use shiftvox::project::SetupOptions;

/// The paper's Table I, on its machine and with its scene: pixels a side of a square picture, and
/// milliseconds as it prints them.
const PAPER_TABLE_I: [(u32, &str); 5] = [
    (64, "<1"),
    (128, "20"),
    (256, "110"),
    (512, "462"),
    (1024, "1772"),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Settings {
    /// The paper's: eight corners, screen space at once, coverage `any`.
    Paper,
    Default,
}

impl Settings {
    fn options(self) -> SetupOptions {
        match self {
            Self::Paper => SetupOptions::paper(),
            Self::Default => SetupOptions::default(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    pub table: String,
    pub settings: Settings,
    pub engines: Vec<String>,
    /// Techniques that are switched off in turn, by name.
    #[serde(default)]
    pub variants: Vec<String>,
    /// Files, generators, or `bundled`.
    pub scenes: Vec<String>,
    /// Sides of square pictures, pixels.
    pub sizes: Vec<u32>,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct List {
    pub run: Vec<Run>,
}

impl List {
    pub const PAPER: &'static str = include_str!("reproduce.toml");

    /// All scenes, each once, in order.
    pub fn scenes(&self) -> Vec<&str> {
        let mut all: Vec<&str> = Vec::new();
        for name in self.run.iter().flat_map(|run| &run.scenes) {
            if !all.contains(&name.as_str()) {
                all.push(name);
            }
        }
        all
    }
}

/// Times of a run, with the paper's beside them. `subjects`: those of the run.
///
/// Rows of the machine with everything on have the hash of the picture, the operations and the
/// covered pixels. These are the same on every computer.
pub fn rows(
    run: &Run,
    subjects: &[Subject],
    families: &[Family],
    harness: &mut Harness<'_>,
) -> Result<Vec<Row>, BenchError> {
    let sizes: Vec<(u32, u32)> = run.sizes.iter().map(|&side| (side, side)).collect();
    let plan = TimePlan {
        sizes: &sizes,
        threads: &[1],
        options: run.settings.options(),
        families,
    };
    let mut rows = measure(subjects, &plan, harness)?;
    let settings = match run.settings {
        Settings::Paper => "paper",
        Settings::Default => "default",
    };
    let paper_law = PowerLaw::fit(paper_points());
    for row in &mut rows {
        row.put("table", run.table.as_str());
        row.put("settings", settings);
        let contender = format!("{}, {settings} settings", row.text("contender"));
        row.put("contender", contender);
        let side = row.number("width");
        let found = PAPER_TABLE_I.iter().find(|(of, _)| f64::from(*of) == side);
        if let Some((_, ms)) = found.filter(|_| row.text("growing") == "pixels") {
            row.put("paper_ms", *ms);
            let quotient = ms.parse::<f64>().ok().map(|ms| ms / row.number("ms"));
            row.put("paper_over_ours", quotient.map(|q| Cell::Number(q, 2)));
            let exponent = paper_law.map(|law| Cell::ratio(law.exponent));
            row.put("paper_exponent", exponent);
        }
        let is_whole = row.text("variant") == EVERYTHING_ON;
        let subject = subjects.iter().find(|s| s.name == row.text("scene"));
        if let Some(subject) = subject.filter(|_| is_whole && row.text("engine") == "machine") {
            count(row, subject, run.settings.options())?;
        }
    }
    Ok(rows)
}

fn count(row: &mut Row, subject: &Subject, options: SetupOptions) -> Result<(), BenchError> {
    let side = row.number("width") as u32;
    let setup = subject.setup((side, side), &options)?;
    let graph = &subject.graph;
    let counted = frame::count(graph, &setup, Organisation::default(), Overflow::Trap);
    let Counted { frame, counter, .. } = counted.map_err(|source| BenchError::Engine {
        who: subject.name.clone(),
        source,
    })?;
    let shading = (Shading::Lambert, Background::default());
    let picture = resolve(&frame, graph, &setup, shading.0, shading.1)?;
    let covered = frame.drawn() as u64;
    row.put("covered_pixels", covered);
    let us = row.number("ms") * 1e3 / covered.max(1) as f64;
    row.put("us_per_covered_pixel", Cell::Number(us, 2));
    row.put("operations", counter.ops());
    row.put("hash", picture::hash(&picture));
    Ok(())
}

/// The paper's Table I as points, without its first row, which is no number.
fn paper_points() -> impl Iterator<Item = (f64, f64)> {
    let points = PAPER_TABLE_I.iter();
    points.filter_map(|&(side, ms)| Some((f64::from(side * side), ms.parse().ok()?)))
}

pub fn table(title: &str, rows: &[Row]) -> Table {
    const COLUMNS: &str = "scene size settings engine variant ms paper_ms paper_over_ours time_ratio voxels work \
        operations covered_pixels us_per_covered_pixel exponent paper_exponent changed hash";
    Table::select(title, rows, COLUMNS).condensed()
}

/// A plot of the rows of one table: time by pixels (the paper's Figure 5) or by voxels. Of techniques that are switched
/// off there is none.
pub fn chart(title: &str, rows: &[Row]) -> Option<Chart> {
    let growing = rows.first()?.text("growing");
    if rows.iter().any(|row| row.text("variant") != EVERYTHING_ON) {
        return None;
    }
    let plot = RowPlot {
        title,
        x: (&growing, &growing),
        y: ("ms", "ms per frame"),
        series: "contender",
        deviation: Some("deviation_ms"),
        front: None,
        level: None,
    };
    let mut chart = plot.chart(rows)?;
    if growing == "pixels" {
        chart
            .series
            .push(Series::curve("the paper", paper_points()));
    }
    Some(chart)
}
