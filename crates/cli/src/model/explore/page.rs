//! The fronts as a page: three plots a scene, whose points say what they are when
//! the pointer is on them. Without scripts: the style sheet does it.

use std::fmt::Write;

use super::Explorations;
use super::words::{given_up, values};
use shiftvox_lab::model::explore::PointFigures;
use shiftvox_lab::model::explore::lines::PointLine;
use shiftvox_lab::report::Table;
use shiftvox_lab::report::html::{Page, escaped};

/// The page. `tables`: one a scene.
pub(super) fn html(found: &[Explorations], tables: &[Table], command: &str) -> String {
    let mut page = Page::new("Which hardware draws it");
    page.lines(command);
    page.text(
        "Each dot is a hardware. Grey ones are beaten by another in time, area, energy and wrong samples together; blue \
         ones are not, and orange ones are not either but have wrong samples. Large are those beside which none is better \
         by a tenth in something and nowhere worse by a tenth. Put the pointer on a dot: it is marked in \
         all three plots, and the line below says what it is and what it gives up.",
    );
    for (place, (of, table)) in found.iter().zip(tables).enumerate() {
        page.chapter(&of.scene);
        page.plot(&plots(of, place), &table.title);
        page.table(table);
    }
    page.finish()
}

/// A figure of a point, and what an axis says of it.
type Quantity = (&'static str, fn(&PointFigures) -> f64);

const TIME: Quantity = ("time, ms", |of| of.time_ms);
const ENERGY: Quantity = ("energy, uJ", |of| of.energy_pj.value / 1e6);
const AREA: Quantity = ("area, thousand NAND2", |of| of.area_nand2.value / 1e3);

/// Side of a plot's field, and the room around it, pixels.
const SIDE: f64 = 270.0;
const ROOM: f64 = 50.0;
/// Height of the lines of words below.
const WORDS: f64 = 66.0;

/// The least and the greatest of a quantity, with a little room.
fn ends(points: &[PointLine], of: Quantity) -> (f64, f64) {
    let values = points.iter().filter_map(PointLine::figures).map(of.1);
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    (low.min(high) / 1.05, high * 1.05)
}

/// Three plots over logarithmic axes, side by side.
fn plots(of: &Explorations, place: usize) -> String {
    let (width, height) = (3.0 * (SIDE + ROOM), SIDE + 2.0 * ROOM + WORDS);
    let mut svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" font-family="sans-serif" font-size="12"><style>"#
    );
    // Writing to a string does not fail.
    let mut add = |text: std::fmt::Arguments<'_>| {
        let _ = svg.write_fmt(text);
    };
    add(format_args!(".words{{visibility:hidden}}"));
    for point in &of.front {
        let name = format!("s{place}p{}", point.line.point);
        add(format_args!(
            "svg:has(.{name}:hover) .{name}{{r:8;stroke:#000;visibility:visible}}"
        ));
    }
    add(format_args!("</style>"));
    for (at, (x, y)) in [(TIME, ENERGY), (TIME, AREA), (AREA, ENERGY)]
        .into_iter()
        .enumerate()
    {
        let left = at as f64 * (SIDE + ROOM) + ROOM;
        let (across, up) = (ends(&of.points, x), ends(&of.points, y));
        let share =
            |value: f64, (low, high): (f64, f64)| libm::log(value / low) / libm::log(high / low);
        add(format_args!(
            r##"<rect x="{left}" y="20" width="{SIDE}" height="{SIDE}" fill="none" stroke="#999"/>"##
        ));
        let (middle, below) = (left + SIDE / 2.0, SIDE + 36.0);
        add(format_args!(
            r#"<text x="{left}" y="14">{} over {}</text><text x="{left}" y="{below}">{:.3}</text>"#,
            y.0, x.0, across.0
        ));
        add(format_args!(
            r#"<text x="{middle}" y="{below}" text-anchor="middle">{}</text><text x="{}" y="{below}" text-anchor="end">{:.3}</text>"#,
            x.0,
            left + SIDE,
            across.1
        ));
        for (value, down) in [(up.0, SIDE + 20.0), (up.1, 30.0)] {
            add(format_args!(
                r#"<text x="{}" y="{down}" text-anchor="end">{value:.1}</text>"#,
                left - 4.0
            ));
        }
        let mut dot = |line: &PointLine, kind: &str| {
            let Some(figures) = line.figures() else {
                return;
            };
            let cx = left + SIDE * share((x.1)(figures), across);
            let cy = 20.0 + SIDE * (1.0 - share((y.1)(figures), up));
            add(format_args!(
                r#"<circle cx="{cx:.1}" cy="{cy:.1}" {kind}/>"#
            ));
        };
        for line in &of.points {
            dot(line, r##"r="2" fill="#bbb""##);
        }
        for point in &of.front {
            let color = match point.figures().wrong_samples {
                0 => "#0072b2",
                _ => "#d55e00",
            };
            let number = point.line.point;
            let radius = if point.stands_out { 6 } else { 3 };
            let kind = format!(r#"class="s{place}p{number}" r="{radius}" fill="{color}""#);
            dot(&point.line, &kind);
        }
    }
    let words = SIDE + ROOM + 20.0;
    for point in &of.front {
        let (number, figures) = (point.line.point, point.figures());
        let what = format!(
            "#{number}: {}. {:.3} ms, {:.0} thousand NAND2, {:.1} uJ ({:.1} to {:.1}), {} wrong samples; the ray caster {:.1} uJ",
            values(&point.line, &of.points),
            figures.time_ms,
            figures.area_nand2.value / 1e3,
            figures.energy_pj.value / 1e6,
            figures.energy_pj.low / 1e6,
            figures.energy_pj.high / 1e6,
            figures.wrong_samples,
            figures.ray_caster.energy_pj.value / 1e6,
        );
        add(format_args!(
            r#"<g class="words s{place}p{number}"><text x="4" y="{words}">{}</text><text x="4" y="{}">Less elsewhere: {}</text></g>"#,
            escaped(&what),
            words + 20.0,
            escaped(&given_up(point))
        ));
    }
    svg.push_str("</svg>");
    svg
}
