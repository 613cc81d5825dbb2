//! `bench time`: engines and their variants, scenes, sizes and numbers of threads become rows.

use std::collections::HashMap;

use super::candidate::{Candidate, Family};
use super::harness::{BenchError, Contender, Harness};
use super::power_law::PowerLaw;
use crate::measure::{CoverageError, count_differing};
use crate::model::frame;
use crate::report::plot::{Chart, RowPlot};
use crate::report::{Cell, Row, Table};
use shiftvox::graph::Graph;
use shiftvox::project::{Camera, FrameSetup, SetupOptions};

/// The variant of an engine with all of its techniques.
pub const EVERYTHING_ON: &str = "everything on";

#[derive(Debug)]
pub struct Subject {
    pub name: String,
    pub graph: Graph,
    /// The camera; its size in pixels is replaced.
    pub camera: Camera,
}

impl Subject {
    pub fn setup(
        &self,
        size: (u32, u32),
        options: &SetupOptions,
    ) -> Result<FrameSetup, BenchError> {
        let camera = self.camera.of_size(size.0, size.1);
        let graph = &self.graph;
        let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, options)?;
        Ok(setup)
    }
}

#[derive(Debug, Clone, Copy)]
pub struct TimePlan<'p> {
    /// Sizes of the picture, pixels across and down.
    pub sizes: &'p [(u32, u32)],
    /// Thread counts, each 1 or more. Engines that use one thread are measured on one.
    pub threads: &'p [usize],
    pub options: SetupOptions,
    pub families: &'p [Family],
}

/// Measures all contenders on all subjects in one race: a row for each. If sizes or subjects vary,
/// the rows have the exponents of time and of work, in pixels or voxels.
pub fn measure(
    subjects: &[Subject],
    plan: &TimePlan<'_>,
    harness: &mut Harness<'_>,
) -> Result<Vec<Row>, BenchError> {
    let mut contenders: Vec<Contender<'_>> = Vec::new();
    let mut rows: Vec<Row> = Vec::new();
    // Of each contender the place of its exact picture.
    let mut exact_of = Vec::new();
    let mut exact: Vec<Vec<[i32; 4]>> = Vec::new();
    for subject in subjects {
        for &size in plan.sizes {
            let setup = subject.setup(size, &plan.options)?;
            let frame = frame::exact(&subject.graph.view(), &setup);
            exact.push(frame.map_err(BenchError::of_exact_rays)?.voxel);
            for family in plan.families {
                let whole = &family.whole;
                let threads = if whole.parallel { plan.threads } else { &[1] };
                let variants = family.variants.iter().map(Some);
                for variant in std::iter::once(None).chain(variants) {
                    let mut options = plan.options;
                    let (name, about, make) = match variant {
                        None => (EVERYTHING_ON, whole.about, whole.make),
                        Some(variant) => {
                            (variant.adjust)(&mut options);
                            let make = variant.make.unwrap_or(whole.make);
                            (variant.name, variant.about, make)
                        }
                    };
                    let setup = subject.setup(size, &options)?;
                    for &threads in threads {
                        contenders.push(Contender {
                            name: format!("{}, {}, {name}", subject.name, whole.name),
                            graph: &subject.graph,
                            setup: setup.clone(),
                            threads,
                            engine: make(threads),
                        });
                        let mut row = head(subject, size, whole, name, threads);
                        row.put("about", about);
                        rows.push(row);
                        exact_of.push(exact.len() - 1);
                    }
                }
            }
        }
    }
    // Engines with everything on come before their variants.
    let mut whole = Vec::new();
    let measured = harness.race(&mut contenders, &mut |place, frame| {
        let row = &mut rows[place];
        if row.text("variant") == EVERYTHING_ON {
            whole.clone_from(&frame.voxel);
        }
        row.put("changed", count_differing(&frame.voxel, &whole));
        let error = CoverageError::between(&frame.voxel, &exact[exact_of[place]]);
        row.put("extra", error.extra);
        row.put("missing", error.missing);
        row.put("wrong_voxel", error.wrong_voxel);
        row.put("covered", error.covered);
    })?;
    let mut whole_ms = HashMap::new();
    for (row, (times, counters)) in rows.iter_mut().zip(measured) {
        times.put(row);
        let ms = times.best().median_ms;
        let alike = ["scene", "size", "engine", "threads"].map(|name| row.text(name));
        if row.text("variant") == EVERYTHING_ON {
            whole_ms.insert(alike.clone(), ms.max(f64::MIN_POSITIVE));
        }
        let ratio = whole_ms.get(&alike).map(|whole| ms / whole);
        row.put("time_ratio", ratio.map(|ratio| Cell::Number(ratio, 2)));
        let work_unit = row.text("work_unit");
        for (name, count) in counters {
            if name == work_unit {
                row.put("work", count);
            }
            if *row.get(name) == Cell::None {
                row.put(name, count);
            }
        }
    }
    if plan.sizes.len() > 1 {
        rows.chunk_by_mut(|a, b| a.get("scene") == b.get("scene"))
            .for_each(|rows| add_exponents(rows, "pixels"));
    } else if subjects.len() > 1 {
        add_exponents(&mut rows, "voxels");
    }
    Ok(rows)
}

fn head(
    subject: &Subject,
    (width, height): (u32, u32),
    whole: &Candidate,
    variant: &'static str,
    threads: usize,
) -> Row {
    let mut row = Row::default();
    row.put("scene", subject.name.as_str());
    row.put("voxels", subject.graph.voxels);
    row.put("size", format!("{width}x{height}"));
    row.put("width", u64::from(width));
    row.put("height", u64::from(height));
    row.put("pixels", u64::from(width) * u64::from(height));
    row.put("engine", whole.name);
    row.put("variant", variant);
    row.put("threads", threads as u64);
    let mut contender = whole.name.to_owned();
    if variant != EVERYTHING_ON {
        contender += &format!(", {variant}");
    }
    if threads > 1 {
        contender += &format!(", {threads} threads");
    }
    row.put("contender", contender);
    row.put("work_unit", whole.work);
    row
}

/// Fits time and work of each contender to powers of `growing`.
fn add_exponents(rows: &mut [Row], growing: &'static str) {
    let contenders: Vec<String> = rows.iter().map(|row| row.text("contender")).collect();
    for (place, contender) in contenders.iter().enumerate() {
        let law = |y: &str| {
            let of = rows
                .iter()
                .zip(&contenders)
                .filter(|(_, c)| *c == contender);
            PowerLaw::fit(of.map(|(row, _)| (row.number(growing), row.number(y))))
        };
        let (time, work) = (law("ms"), law("work"));
        let row = &mut rows[place];
        row.put("growing", growing);
        row.put("exponent", time.map(|law| Cell::ratio(law.exponent)));
        row.put("work_exponent", work.map(|law| Cell::ratio(law.exponent)));
        let r_squared = work.and_then(|law| law.r_squared);
        row.put("work_r_squared", r_squared.map(|r| Cell::Number(r, 4)));
    }
}

pub fn table(title: &str, rows: &[Row]) -> Table {
    const COLUMNS: &str = "scene size engine variant threads cpu_ms wall_ms wall_deviation_ms time_ratio exponent \
        voxels work work_unit work_exponent changed extra missing wrong_voxel";
    Table::select(title, rows, COLUMNS).condensed()
}

/// Plots of scans with error bars, one per scene or per kind of scene whose depth varies.
pub fn charts(rows: &[Row]) -> Vec<Chart> {
    let is_one_plot = |a: &Row, b: &Row| {
        a.get("scene") == b.get("scene") || *a.get("growing") == Cell::from("voxels")
    };
    let chart = |rows: &[Row]| {
        let growing = rows.first()?.text("growing");
        let title = match growing.as_str() {
            "voxels" => rows[0].text("size"),
            _ => rows[0].text("scene"),
        };
        let plot = RowPlot {
            title: &title,
            x: (&growing, &growing),
            y: ("ms", "ms per frame"),
            series: "contender",
            deviation: Some("deviation_ms"),
            ..RowPlot::default()
        };
        plot.chart(rows)
    };
    rows.chunk_by(is_one_plot).filter_map(chart).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_each_contender() {
        let row = |(contender, side): (&str, u64)| {
            let mut row = Row::default();
            row.put("contender", contender);
            row.put("pixels", side * side);
            row.put("ms", if contender == "a" { side * side } else { 7 });
            row.put("work", side);
            row
        };
        let mut rows = [("a", 64), ("b", 64), ("a", 128), ("b", 128), ("a", 256)].map(row);
        add_exponents(&mut rows, "pixels");
        // Two points are on any law.
        let found = rows.map(|row| {
            let of = |name: &str| row.text(name);
            [of("exponent"), of("work_exponent"), of("work_r_squared")]
        });
        let (a, b) = (["1.000", "0.500", "1.0000"], ["0.000", "0.500", ""]);
        assert_eq!(found, [a, b, a, b, a]);
    }
}
