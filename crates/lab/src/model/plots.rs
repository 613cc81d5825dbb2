//! The model's results as plots.

use hwmodel::OpClass;
use hwmodel::cycles::{Cause, CycleReport, Hardware, ScalingRow};

use super::caches::CacheRow;
use super::cost::FrameCost;
use super::frame::Counted;
use super::range::Range;
use super::rules::Outcome;
use super::sweep::FormatRow;
use super::tables::operations_by_stage;
use crate::report::plot::{Axis, Chart, Panel, Point, Scale, Series, Stack};

fn axis(label: &str, scale: Scale) -> Axis {
    Axis {
        label: label.to_owned(),
        scale,
    }
}

/// Operations by stage, made of their classes.
#[must_use]
pub fn operations(counted: &Counted) -> Panel {
    let stages = operations_by_stage(counted);
    Panel::Stacked {
        title: "Operations by stage (millions)".to_owned(),
        parts: OpClass::ALL.iter().map(|c| c.name().to_owned()).collect(),
        stacks: stages
            .iter()
            .map(|(stage, classes)| Stack {
                name: stage.name().to_owned(),
                values: classes.iter().map(|&n| n as f64 / 1e6).collect(),
            })
            .collect(),
    }
}

/// Where records spend their cycles, by stage.
#[must_use]
pub fn cycles(report: &CycleReport) -> Panel {
    let mut parts = vec!["worked on".to_owned()];
    parts.extend(Cause::ALL.iter().map(|cause| cause.name().to_owned()));
    let stack = |stage: &hwmodel::cycles::StageReport| {
        let mut values = vec![stage.alone as f64 / 1e6];
        values.extend(Cause::ALL.iter().map(|&c| stage.stalls.of(c) as f64 / 1e6));
        Stack {
            name: stage.stage.name().to_owned(),
            values,
        }
    };
    Panel::Stacked {
        title: "Cycles that records spend in each stage, and what they wait for (millions)"
            .to_owned(),
        parts,
        // Stages that the frame does not use have no bar, as they have no row.
        stacks: report
            .stages
            .iter()
            .filter(|stage| stage.visits > 0)
            .map(stack)
            .collect(),
    }
}

/// Energy: what the frame spends on what, and the ray caster.
#[must_use]
pub fn energy(light: &FrameCost, ray_caster: Option<&FrameCost>) -> Panel {
    let stack = |name: &str, cost: &FrameCost| Stack {
        name: name.to_owned(),
        values: [&cost.operations, &cost.on_chip, &cost.outer]
            .map(|part| part.total / 1e6)
            .into(),
    };
    let mut stacks = vec![stack("light hardware", light)];
    stacks.extend(ray_caster.map(|cost| stack("ray caster, 32-bit float", cost)));
    Panel::Stacked {
        title: "Energy of the frame (microjoules)".to_owned(),
        parts: ["operations", "memories on the chip", "outer memory"]
            .map(str::to_owned)
            .into(),
        stacks,
    }
}

/// The roofline: operations a cycle over operations for each byte of outer memory.
#[must_use]
pub fn roofline(counted: &Counted, report: &CycleReport, hardware: &Hardware) -> Panel {
    let units: u64 = report
        .stages
        .iter()
        .flat_map(|stage| {
            OpClass::ALL
                .iter()
                .filter_map(|&c| hardware.unit(stage.stage, c))
        })
        .map(|unit| u64::from(unit.count) * u64::from(hardware.lanes))
        .sum();
    let cache = &hardware.node_cache;
    let bytes_a_cycle = f64::from(cache.misses) * f64::from(cache.line_bytes)
        / f64::from(cache.hit_latency + cache.miss_latency).max(1.0);
    let operations = (counted.counter.ops() - counted.counter.ops_of(OpClass::Shift)) as f64;
    let spilled = report.stack.spilled_bits / 4; // written and read, in bytes
    let lines = report.node_cache.bytes_in + report.attribute_cache.bytes_in;
    let bytes = (lines + spilled).max(1) as f64;
    let (x, y) = (operations / bytes, operations / report.cycles.max(1) as f64);
    let peak = units as f64;
    let corner = peak / bytes_a_cycle.max(f64::MIN_POSITIVE);
    let (left, right) = (x.min(corner) / 10.0, x.max(corner) * 10.0);
    let line = |name: &str, points: Vec<(f64, f64)>| Series {
        dots: false,
        ..Series::curve(name, points)
    };
    Panel::Chart(Chart::growth(
        "Roofline",
        "operations for each byte from outer memory",
        "operations a cycle",
        vec![
            line("all units at work", vec![(corner, peak), (right, peak)]),
            line(
                "node misses as fast as they can be",
                vec![(left, left * bytes_a_cycle), (corner, peak)],
            ),
            Series::dots(
                "this frame",
                vec![Point {
                    x,
                    y,
                    label: Some(format!("{y:.1} of {peak:.0}")),
                }],
            ),
        ],
    ))
}

/// Speed-up over lanes.
#[must_use]
pub fn lanes(rows: &[ScalingRow]) -> Panel {
    let ideal = rows
        .iter()
        .map(|r| (f64::from(r.lanes), f64::from(r.lanes)));
    let measured = rows.iter().map(|r| (f64::from(r.lanes), r.speedup));
    Panel::Chart(Chart::growth(
        "Speed-up over lanes",
        "lanes",
        "times as fast as one lane",
        vec![
            Series::curve("measured", measured),
            Series {
                grey: true,
                dots: false,
                ..Series::curve("in proportion", ideal)
            },
        ],
    ))
}

/// Misses of node caches of every size.
#[must_use]
pub fn miss_curve(counted: &Counted) -> Panel {
    let series = counted.memory.curves().iter().map(|(_, curve)| {
        let accesses = curve.accesses().max(1) as f64;
        let points = curve.points();
        let share =
            |p: &hwmodel::memory::MissPoint| (p.bytes as f64, 100.0 * p.misses as f64 / accesses);
        Series {
            dots: false,
            ..Series::curve(
                format!("lines of {} bytes", curve.line_bytes()),
                points.iter().map(share).collect::<Vec<_>>(),
            )
        }
    });
    Panel::Chart(Chart {
        title: "Misses of node caches of every size".to_owned(),
        x: axis("bytes", Scale::Log),
        y: axis("percent of the reads", Scale::Linear),
        series: series.collect(),
        level: None,
    })
}

/// Wrong samples over area, for word formats; the ones that no other beats in both are joined.
#[must_use]
pub fn formats(rows: &[FormatRow]) -> Panel {
    let mut points: Vec<Point> = rows
        .iter()
        .filter_map(|row| {
            let Outcome::Drawn(costs) = &row.outcome else {
                return None;
            };
            Some(Point {
                x: costs.area_nand2,
                // None is shown at the bottom of the scale.
                y: (costs.error.differing() as f64).max(0.5),
                label: Some(row.bits.to_string()),
            })
        })
        .collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut least = f64::INFINITY;
    let front: Vec<(f64, f64)> = points
        .iter()
        .filter(|point| {
            let better = point.y < least;
            least = least.min(point.y);
            better
        })
        .map(|point| (point.x, point.y))
        .collect();
    Panel::Chart(Chart {
        title: "Word length: wrong samples over area (labels: bits)".to_owned(),
        x: axis("area, NAND2 equivalents", Scale::Linear),
        y: axis(
            "samples that differ from the exact picture (0 at 0.5)",
            Scale::Log,
        ),
        series: vec![
            Series {
                grey: true,
                ..Series::dots("formats", points)
            },
            Series::curve("that no other beats in both", front),
        ],
        level: None,
    })
}

/// Energy over the size of the node cache: both designs, each with its range.
#[must_use]
pub fn caches(rows: &[CacheRow]) -> Panel {
    type Of = fn(&Range) -> f64;
    let ends: [(&str, Of); 3] = [
        ("", |range| range.value),
        (", low end", |range| range.low),
        (", high end", |range| range.high),
    ];
    let mut series = Vec::new();
    let mut add = |name: &str, points: Vec<(f64, Range)>| {
        for (end, of) in ends {
            let values = points.iter().map(|(x, range)| (*x, of(range) / 1e6));
            series.push(Series {
                dots: end.is_empty(),
                ..Series::curve(format!("{name}{end}"), values)
            });
        }
    };
    let bytes = |row: &CacheRow| f64::from(row.bytes);
    let light = rows.iter().map(|row| (bytes(row), row.light.energy_pj));
    add("light hardware", light.collect());
    let best = rows.iter().map(|row| (bytes(row), row.best.energy_pj));
    add("ray caster, best order", best.collect());
    Panel::Chart(Chart {
        title: "Energy of the frame over the size of the node cache".to_owned(),
        x: axis("bytes of the node cache", Scale::Log),
        y: axis("microjoules", Scale::Linear),
        series,
        level: None,
    })
}
