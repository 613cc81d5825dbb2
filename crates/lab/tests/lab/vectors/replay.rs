//! The outputs of every block for a row, by SPEC.md and the manifest.

use super::rows::{Constants, Row, scaled};

fn bits(flags: &[bool]) -> Vec<i128> {
    flags.iter().map(|&f| i128::from(f)).collect()
}

/// A quotient to the nearest, halves up.
pub(super) fn nearest(a: i128, b: i128) -> i128 {
    (2 * a + b).div_euclid(2 * b)
}

pub(super) fn replay(block: &str, row: &Row, constants: &Constants) -> Vec<i128> {
    let get = |name: &str| row.get(name);
    match block {
        "filled" => bits(&[get("vector") == 15]),
        "change_depth" | "detail_depth" => bits(&[get("w_min") >= get("least")]),
        "change_guard" => {
            let (x, w, places) = (row.cage("x"), row.cage("w"), get("places"));
            // Times 2^places where that is a multiple, so that nothing is rounded.
            let (by, part) = (1 << places.max(0), 1 << (-places).max(0));
            let left = x.with(by, &w, part).least();
            let right = w.with(by, &x, -by).with(1, &w, part).least();
            bits(&[left >= 0 && right >= 0])
        }
        "to_screen_divide" => {
            let (x, w) = (get("x"), get("w"));
            assert!(w > 0 && -4 * w <= x && x < 12 * w, "{x} / {w}");
            vec![((x + 4 * w) << get("fraction_bits")).div_euclid(w)]
        }
        "size_limit" => vec![constants.share(get("w_min"), get("below"))],
        "size_clip" => {
            let (x, w) = (row.three("edge_x"), row.three("edge_w"));
            let size: i128 = (0..3).map(|k| x[k].abs().max((x[k] - w[k]).abs())).sum();
            bits(&[size <= get("most")])
        }
        "size_screen" => bits(&[get("high") - get("low") <= get("limit")]),
        "centre" => {
            let (min, max) = (row.three("min"), row.three("max"));
            (0..3).map(|k| (min[k] + max[k]).div_euclid(2)).collect()
        }
        "octant_order" => {
            let (centre, eye) = (row.three("centre"), row.three("eye_floor"));
            let octant = (0..3).map(|k| i128::from(centre[k] > eye[k]) << (2 - k));
            let octant: i128 = octant.sum();
            [
                vec![octant],
                [7, 6, 5, 3, 4, 2, 1, 0].map(|at| octant ^ at).into(),
            ]
            .concat()
        }
        "vertex_pool" => {
            let children = row.cage("parent").children();
            children.into_iter().flat_map(|child| child.0).collect()
        }
        "child_planes" => {
            let octant = get("octant");
            let has = |k: usize| octant >> (2 - k) & 1;
            let moved = |j: usize| {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                let (plane, along_k, along_l) = (edge(row, j), axis(row, k), axis(row, l));
                let half = 1 << get("half");
                [0, 1, 2].map(|c| plane[c] + half * (has(l) * along_k[c] - has(k) * along_l[c]))
            };
            (0..3).flat_map(moved).collect()
        }
        "child_corners" => {
            let (min, max, centre) = (row.three("min"), row.three("max"), row.three("centre"));
            let upper = |k: usize| get("octant") >> (2 - k) & 1 == 1;
            let low = (0..3).map(|k| if upper(k) { centre[k] } else { min[k] });
            let high = (0..3).map(|k| if upper(k) { max[k] } else { centre[k] });
            low.chain(high).collect()
        }
        "child_span" => {
            let child = row.cage("child");
            vec![child.least(), child.greatest()]
        }
        "margin_grow" => {
            let places = get("places");
            let more = i128::from(places > 0);
            row.cage("w").each(|w| scaled(w, -places) + more).0
        }
        "margin_gap" => {
            let below = get("below");
            row.cage("w").each(|w| -scaled(w, -below)).0
        }
        "border_clip" => {
            let (x, w, m) = (row.cage("x"), row.cage("w"), row.cage("margin"));
            let right = x.with(1, &w, -1);
            let outside = x.with(1, &m, 1).greatest() < 0 || right.with(1, &m, -1).least() > 0;
            let (low, high) = (x.with(1, &m, -1).least(), right.with(1, &m, 1).greatest());
            let strict = i128::from(row.flag("wider"));
            bits(&[outside, !outside && low >= strict && high <= -strict])
        }
        "bisector_clip" => {
            let (x, w, m) = (row.cage("x"), row.cage("w"), row.cage("margin"));
            let relative = x.with(2, &w, -1);
            let (mut low, mut high);
            if row.flag("closed") {
                low = relative.with(1, &m, -1).least() <= 0;
                high = relative.with(1, &m, 1).greatest() >= 0;
            } else {
                low = relative.least() < 0;
                high = relative.greatest() > 0 || !low;
            }
            if row.flag("sample") {
                (low, high) = (low && high, low && high);
            }
            [relative.0, bits(&[low, high])].concat()
        }
        "near_node" => {
            let (x, w) = (row.cage("x"), row.cage("w"));
            bits(&[x.with(1, &w, 1).least() >= 0 && x.with(1, &w, -2).greatest() <= 0])
        }
        "half_clip" if row.flag("right") => row.cage("far").0,
        "half_clip" => row.cage("x").each(|x| 2 * x).0,
        "plane_quadrant" => {
            let [a, b, c] = row.three("plane");
            let quadrant = get("quadrant");
            vec![2 * c + (quadrant & 1) * a + (quadrant >> 1) * b]
        }
        "border_screen" => {
            let (low, high, node) = (get("low"), get("high"), get("node"));
            let unit = get("below") + constants.fraction;
            let (left, right) = (node << unit, (node + 1) << unit);
            let outside = high < left || low > right;
            bits(&[outside, !outside && left <= low && high <= right])
        }
        "bisector_screen" => {
            let unit = get("below") + constants.fraction - 1;
            let bisector = scaled(2 * get("node") + 1, unit);
            let low = get("low") < bisector;
            bits(&[low, get("high") > bisector || !low])
        }
        "quadrants" => {
            let x = [row.flag("low_half_x"), row.flag("high_half_x")];
            let y = [row.flag("low_half_y"), row.flag("high_half_y")];
            let bit = |q: usize| i128::from(x[q & 1] && y[q >> 1]) << q;
            vec![(0..4).map(bit).sum()]
        }
        "node_choice" => {
            let overlapped = get("overlapped");
            let among: Vec<i128> = (0..4).filter(|q| overlapped >> q & 1 == 1).collect();
            let rejected = among.iter().all(|q| get("vector") >> q & 1 == 1);
            let single = among.len() == 1;
            let quadrant = if single { among[0] } else { 0 };
            vec![i128::from(rejected), i128::from(single), quadrant]
        }
        "cage_centre" => vec![match row.cage("cage").0[..] {
            [corner, x, y, z] => corner + (x + y + z).div_euclid(2),
            ref corners => (corners[0] + corners[7]).div_euclid(2),
        }],
        "centre_half" => {
            let beyond = 2 * get("value") - get("w");
            let right = beyond >= 0;
            vec![
                i128::from(right),
                if right { beyond } else { 2 * get("value") },
            ]
        }
        "centre_sample" => {
            let (node, below) = (get("node"), get("below"));
            let sample = get("centre").div_euclid(1 << constants.fraction);
            vec![sample.clamp(node << below, ((node + 1) << below) - 1)]
        }
        "cube_planes" => {
            let side = 1 << get("side");
            let planes = |j: usize| {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                let (here, along_k, along_l) = (edge(row, j), axis(row, k), axis(row, l));
                // The edge itself, moved along k, along l, along both.
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(by_k, by_l)| {
                    [0, 1, 2].map(|c| here[c] + side * (by_l * along_k[c] - by_k * along_l[c]))
                })
            };
            (0..3).flat_map(planes).flatten().collect()
        }
        "cube_front" => {
            let (min, max) = (row.three("min"), row.three("max"));
            let (floor, ceil) = (row.three("eye_floor"), row.three("eye_ceil"));
            let outside = (0..3).find(|&k| ceil[k] <= min[k] || max[k] <= floor[k]);
            outside.map_or(vec![0, 0, 0], |k| {
                let same = (ceil[k] <= min[k]) == row.flag("positive");
                vec![1, k as i128, if same { 1 } else { 2 }]
            })
        }
        "plane_side" => vec![plane_side(row.three("plane"), row.flag("sample"))],
        "plane_cover" => vec![plane_cover(row)],
        "fill_update" => {
            let after = get("vector") | get("bits");
            vec![after, i128::from(after == 15)]
        }
        "blend_way" => {
            let centre = (get("min") + get("max")).div_euclid(2);
            vec![(scaled(centre, -get("shift")) - get("eye")).abs()]
        }
        "blend_shares" => {
            let way = row.three("way");
            let all = way.iter().sum::<i128>().max(1);
            let x = nearest(16 * way[0], all);
            let y = nearest(16 * way[1], all).min(16 - x);
            vec![x, y, 16 - x - y]
        }
        "blend_counts" => {
            let squares = row.three("share").map(|share| share * share);
            let length = (squares.iter().sum::<i128>() as f64).sqrt().round() as i128;
            squares.map(|square| nearest(square, length)).to_vec()
        }
        "blend_weight" => {
            let (high, count) = (row.three("high"), row.three("count"));
            let opacity = |k: usize| row.of(&format!("opacity_{}", AXES[k]))[high[k] as usize];
            if (0..3).any(|k| opacity(k) == 15) {
                return vec![256];
            }
            // 15 covers all sixteen sixteenths.
            let covered = |k| opacity(k) + i128::from(opacity(k) >= 8);
            vec![(0..3).map(|k| covered(k) * count[k]).sum()]
        }
        "blend_sample" => {
            let (left, weight) = (get("left"), get("weight"));
            let share = nearest(left * weight, 256);
            let full = left - share <= 64;
            let taken = if full { left } else { share };
            let mut out = vec![left - taken];
            let colors = row.of("sum").iter().zip(row.of("light"));
            out.extend(colors.map(|(sum, light)| sum + taken * light));
            out.extend(bits(&[left == 256, full]));
            out
        }
        other => panic!("no rule for block {other}"),
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn edge(row: &Row, j: usize) -> [i128; 3] {
    row.three(&format!("edge_{}", AXES[j]))
}

fn axis(row: &Row, l: usize) -> [i128; 3] {
    let [a, b] = row.of(&format!("axis_{}", AXES[l])) else {
        unreachable!("a and b");
    };
    [*a, *b, row.get(&format!("axis_{}_c", AXES[l]))]
}

/// The side of the open node's samples: at its corners the function takes all
/// its extremes, and a sample is moved right, then down, by next to nothing.
fn plane_side([a, b, c]: [i128; 3], is_sample: bool) -> i128 {
    let corners = [c, c + a, c + b, c + a + b];
    if corners == [0; 4] {
        3
    } else if corners.iter().all(|&v| v >= 0) {
        1
    } else if corners.iter().all(|&v| v <= 0) {
        2
    } else if is_sample {
        let middle = [2 * c + a + b, a, b];
        match middle.into_iter().find(|&v| v != 0) {
            Some(v) if v > 0 => 1,
            Some(_) => 2,
            None => 3,
        }
    } else {
        0
    }
}

fn plane_cover(row: &Row) -> i128 {
    let mut all = true;
    for axis in AXES {
        let sides = row.of(&format!("side_{axis}"));
        let (above, below) = (sides.contains(&1), sides.contains(&2));
        if !(above && below) {
            if !sides.contains(&0) {
                return 0;
            }
            all = false;
        }
    }
    if row.flag("front") {
        let side = row.get("front_side");
        if side == 0 {
            all = false;
        } else if side != row.get("wanted") {
            // Where an axis is not settled, the front has not been examined yet;
            // its side is then the last one, for which the record was still alive.
            return 0;
        }
    }
    if all { 2 } else { 1 }
}
