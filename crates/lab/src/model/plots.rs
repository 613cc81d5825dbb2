//! Plots of a report.

use hwmodel::OpClass;

use super::report::Report;
use crate::report::plot::{Chart, Panel, Point, Series};

pub fn panels(report: &Report) -> Vec<Panel> {
    vec![roofline(report)]
}

/// Operations per cycle over operations per byte of outer memory.
fn roofline(report: &Report) -> Panel {
    let (cycles, hardware) = (&report.simulated.cycles, &report.hardware);
    let stages = cycles.stages.iter().map(|of| of.stage);
    let units = stages.flat_map(|stage| OpClass::ALL.map(|class| hardware.unit(stage, class)));
    let units: u64 = units.flatten().map(|unit| u64::from(unit.count)).sum();
    let peak = (units * u64::from(hardware.lanes)) as f64;
    let cache = &hardware.node_cache;
    let bytes_per_cycle = f64::from(cache.misses) * f64::from(cache.line_bytes)
        / f64::from(cache.hit_latency + cache.miss_latency).max(1.0);
    let by_class = report.operations.iter();
    let by_class = by_class.filter(|of| of.class != OpClass::Shift);
    let operations = by_class.map(|of| of.times).sum::<u64>() as f64;
    // Spilled records are written and read.
    let lines = cycles.node_cache.bytes_in + cycles.attribute_cache.bytes_in;
    let bytes = (lines + cycles.stack.spilled_bits / 4).max(1) as f64;
    let (x, y) = (operations / bytes, operations / cycles.cycles.max(1) as f64);
    let corner = peak / bytes_per_cycle.max(f64::MIN_POSITIVE);
    let (left, right) = (x.min(corner) / 10.0, x.max(corner) * 10.0);
    let line = |name: &str, points: [(f64, f64); 2]| Series {
        dots: false,
        ..Series::curve(name, points)
    };
    let this = Point {
        x,
        y,
        label: Some(format!("{y:.1} of {peak:.0}")),
    };
    Panel::Chart(Chart::growth(
        "Roofline",
        "operations per byte from outer memory",
        "operations per cycle",
        vec![
            line("all units at work", [(corner, peak), (right, peak)]),
            line(
                "node misses at the highest rate",
                [(left, left * bytes_per_cycle), (corner, peak)],
            ),
            Series::dots("this frame", vec![this]),
        ],
    ))
}
