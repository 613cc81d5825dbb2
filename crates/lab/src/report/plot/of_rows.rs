//! Charts made of the columns of measurements.

use super::{Chart, Point, Series};
use crate::report::Row;

#[derive(Debug, Clone, Copy, Default)]
pub struct RowPlot<'a> {
    pub title: &'a str,
    pub x: (&'a str, &'a str),
    pub y: (&'a str, &'a str),
    pub series: &'a str,
    pub deviation: Option<&'a str>,
    /// The column that names points. Points that others dominate are then grey and without name,
    /// and a line joins the Pareto front.
    pub front: Option<&'a str>,
    pub level: Option<(f64, &'a str)>,
}

/// Whether `q` is nowhere worse than `p`, and somewhere better. A
/// coordinate that is not a number makes it false.
pub(crate) fn dominates<const N: usize>(q: &[f64; N], p: &[f64; N]) -> bool {
    let pairs = || q.iter().zip(p);
    pairs().all(|(q, p)| q <= p) && pairs().any(|(q, p)| q < p)
}

impl RowPlot<'_> {
    /// A chart over two logarithmic axes; `None` if no row has a place on it.
    pub fn chart<'r>(&self, rows: impl IntoIterator<Item = &'r Row>) -> Option<Chart> {
        let place = |row: &Row| [row.number(self.x.0), row.number(self.y.0)];
        let rows: Vec<&Row> = rows
            .into_iter()
            .filter(|row| place(row).iter().all(|at| at.is_finite() && *at > 0.0))
            .collect();
        if rows.is_empty() {
            return None;
        }
        let places: Vec<[f64; 2]> = rows.iter().map(|row| place(row)).collect();
        let mut grey = Series::dots("dominated", Vec::new());
        grey.grey = true;
        let mut front: Vec<(f64, f64)> = Vec::new();
        let mut all: Vec<Series> = Vec::new();
        for (row, own) in rows.iter().zip(&places) {
            let [x, y] = *own;
            if self.front.is_some() && places.iter().any(|other| dominates(other, own)) {
                grey.points.push((x, y).into());
                continue;
            }
            front.push((x, y));
            let series = Series::of_name(&mut all, &row.text(self.series), self.front.is_none());
            let label = self.front.map(|name| row.text(name));
            series.points.push(Point { x, y, label });
            let deviation = self.deviation.map(|name| row.number(name));
            series.deviations.extend(deviation);
        }
        if self.front.is_some() {
            front.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut line = Series::curve("", front);
            (line.dots, line.grey) = (false, true);
            all.splice(0..0, [grey, line]);
        }
        Some(Chart {
            level: self.level.map(|(at, name)| (at, name.to_owned())),
            ..Chart::growth(self.title, self.x.1, self.y.1, all)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_series_with_error_bars_and_a_front() {
        // The point at 0 has no place on a logarithmic axis.
        let points = [("a", 1, 8), ("b", 2, 4), ("a", 4, 8), ("b", 8, 0)];
        let rows = points.map(|(name, x, y)| {
            let mut row = Row::default();
            row.put("name", name);
            row.put("x", x);
            row.put("y", y);
            row
        });
        let series = |front| {
            let plot = RowPlot {
                x: ("x", "across"),
                y: ("y", "up"),
                series: "name",
                deviation: Some("x"),
                front,
                ..RowPlot::default()
            };
            plot.chart(&rows).unwrap().series.into_iter()
        };
        let deviations = series(None).map(|of| of.deviations).collect::<Vec<_>>();
        assert_eq!(deviations, [vec![1.0, 4.0], vec![2.0]]);
        // Dominated points, the line, and the series.
        let lengths = series(Some("name"))
            .map(|of| of.points.len())
            .collect::<Vec<_>>();
        assert_eq!(lengths, [1, 2, 1, 1]);
        assert_eq!(RowPlot::default().chart(&rows), None);
        // Equal points dominate nothing, and neither does NaN.
        assert!(!dominates(&[1.0, 2.0], &[1.0, 2.0]) && !dominates(&[f64::NAN, 0.0], &[6.0, 1.0]));
    }
}
