//! The image-order paper's drawings, as SVG: the voxel's children with their numbers
//! (Figure 1) and their occlusion order (Figure 2).

use std::fmt::Write;

use crate::project::OCCLUSION_ORDER;

/// Width and height of a drawing, pixels.
const SIZE: (u32, u32) = (900, 330);

/// Where a corner of the unit cube is seen: x to the lower left, y to the
/// right, z up.
fn seen(origin: (f64, f64), side: f64, [x, y, z]: [f64; 3]) -> (f64, f64) {
    (
        origin.0 + side * (y - 0.5 * x),
        origin.1 + side * (0.4 * x - z),
    )
}

fn polygon(svg: &mut String, points: &[(f64, f64)], fill: &str) {
    let points: Vec<String> = points
        .iter()
        .map(|(x, y)| format!("{x:.1},{y:.1}"))
        .collect();
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        "<polygon points=\"{}\" fill=\"{fill}\" stroke=\"#1c1f23\" stroke-width=\"1.2\" stroke-linejoin=\"round\"/>",
        points.join(" ")
    );
}

fn words(svg: &mut String, (x, y): (f64, f64), size: u32, anchor: &str, text: &str) {
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
         font-family=\"sans-serif\" fill=\"#1c1f23\">{text}</text>"
    );
}

/// A cube whose three visible faces are seen: shades of one colour.
fn cube(
    svg: &mut String,
    origin: (f64, f64),
    side: f64,
    low: [f64; 3],
    edge: f64,
    fills: [&str; 3],
) {
    let at = |dx: f64, dy: f64, dz: f64| {
        seen(
            origin,
            side,
            [low[0] + dx * edge, low[1] + dy * edge, low[2] + dz * edge],
        )
    };
    // Top, front (x high), side (y high).
    polygon(
        svg,
        &[
            at(0., 0., 1.),
            at(1., 0., 1.),
            at(1., 1., 1.),
            at(0., 1., 1.),
        ],
        fills[0],
    );
    polygon(
        svg,
        &[
            at(1., 0., 0.),
            at(1., 1., 0.),
            at(1., 1., 1.),
            at(1., 0., 1.),
        ],
        fills[1],
    );
    polygon(
        svg,
        &[
            at(0., 1., 0.),
            at(1., 1., 0.),
            at(1., 1., 1.),
            at(0., 1., 1.),
        ],
        fills[2],
    );
}

/// Shades by turn: near ones dark.
const SHADES: [[&str; 3]; 8] = [
    ["#1c6fb0", "#155a90", "#10466f"],
    ["#3a86c1", "#2f73aa", "#275f8d"],
    ["#4a92c9", "#3c7fb4", "#326a98"],
    ["#5b9ed0", "#4b8bbe", "#3f75a2"],
    ["#83b8de", "#70a5cc", "#5e8db1"],
    ["#95c3e4", "#81b0d3", "#6d98b8"],
    ["#a7ceea", "#93bbd9", "#7ea3bf"],
    ["#d3e6f4", "#bfd5e6", "#a9bfd0"],
];

/// Children in the order in which they are drawn, for a viewer's octant, with
/// the array that gives it: the child nearest to the viewer is first.
#[must_use]
pub fn order_diagram(octant: u8) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n\
         <rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
        SIZE.0, SIZE.1
    );
    let order = OCCLUSION_ORDER.map(|entry| octant ^ entry);
    let turn = |child: u8| order.iter().position(|&c| c == child).unwrap_or(0);
    let place = |child: u8| [child >> 2 & 1, child >> 1 & 1, child & 1].map(f64::from);
    // Together, then apart: far ones first, as a painter does.
    for (origin, side, spread) in [((90.0, 215.0), 130.0, 0.5), ((330.0, 235.0), 150.0, 0.72)] {
        let mut back_to_front: Vec<u8> = (0..8).collect();
        back_to_front.sort_by_key(|child| child.count_ones());
        for child in back_to_front {
            let low = place(child).map(|c| c * spread);
            cube(&mut svg, origin, side, low, 0.5, SHADES[turn(child)]);
            if spread > 0.5 {
                // On the top face, which is always seen.
                let middle = [low[0] + 0.25, low[1] + 0.25, low[2] + 0.5];
                let (x, y) = seen(origin, side, middle);
                let text = format!("{}", turn(child) + 1);
                words(&mut svg, (x, y + 5.0), 15, "middle", &text);
            }
        }
    }
    words(
        &mut svg,
        (20.0, 30.0),
        17,
        "start",
        "A voxel, its children apart, and their turn",
    );
    words(
        &mut svg,
        (560.0, 30.0),
        17,
        "start",
        &format!("Octant {octant:03b}"),
    );
    for (at, (&child, entry)) in order.iter().zip(OCCLUSION_ORDER).enumerate() {
        let y = 62.0 + 30.0 * at as f64;
        let line = format!("{octant:03b} XOR {entry:03b} = {child:03b}, child {child}");
        let _ = writeln!(
            svg,
            "<rect x=\"560\" y=\"{:.0}\" width=\"18\" height=\"18\" fill=\"{}\" stroke=\"#1c1f23\"/>",
            y - 14.0,
            SHADES[at][1]
        );
        words(
            &mut svg,
            (590.0, y),
            15,
            "start",
            &format!("{}.  {line}", at + 1),
        );
    }
    words(
        &mut svg,
        (560.0, 315.0),
        13,
        "start",
        "three compares, one XOR each: no sorting",
    );
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_diagram_has_the_papers_example() {
        // Figure 2 of the image-order paper: octant 110.
        let svg = order_diagram(0b110);
        for (at, child) in [1, 0, 3, 5, 2, 4, 7, 6].into_iter().enumerate() {
            assert!(
                svg.contains(&format!("{}.  110 XOR", at + 1))
                    && svg.contains(&format!("= {child:03b}, child {child}")),
                "{at}"
            );
        }
    }
}
