//! A picture in SVG: a few shapes, as text.

use std::fmt::Write;

pub(super) type Color = u32;

#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Debug, Default)]
pub(super) struct Canvas {
    body: String,
    pub(super) top: f64,
}

impl Canvas {
    pub(super) fn finish(self, width: f64, height: f64) -> String {
        format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a text does not fail.
        let _ = writeln!(self.body, "{element}");
    }

    pub(super) fn rectangle(&mut self, [left, top, width, height]: [f64; 4], fill: Color) {
        let top = top + self.top;
        self.put(format_args!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"#{fill:06x}\"/>"
        ));
    }

    pub(super) fn line(&mut self, places: &[(f64, f64)], color: Color, width: u32, dashes: &str) {
        let mut points = String::new();
        for (x, y) in places {
            let _ = write!(points, "{x:.1},{:.1} ", y + self.top);
        }
        let dashes = match dashes {
            "" => String::new(),
            dashes => format!(" stroke-dasharray=\"{dashes}\""),
        };
        self.put(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#{color:06x}\" stroke-width=\"{width}\"{dashes}/>",
            points.trim_end()
        ));
    }

    pub(super) fn dot(&mut self, (x, y): (f64, f64), color: Color) {
        let y = y + self.top;
        self.put(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#{color:06x}\"/>"
        ));
    }

    /// A text whose line is `size` high and has its middle at a place's height.
    pub(super) fn text(&mut self, text: &str, (x, y): (f64, f64), size: u32, anchor: Anchor) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (y, text) = (y + self.top + 0.35 * f64::from(size), escaped(text));
        self.put(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>"
        ));
    }

    pub(super) fn upwards(&mut self, text: &str, (x, y): (f64, f64), size: u32) {
        let (y, text) = (y + self.top, escaped(text));
        self.put(format_args!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" font-size=\"{size}\" \
             text-anchor=\"middle\">{text}</text>"
        ));
    }
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
