//! The outputs of every block for a row, by SPEC.md and the manifest.

use serde_json::Value;

use super::rows::Row;

/// The constants of a frame, and the roundings and limits of the rules, which mutants replace.
pub(super) struct Rules {
    fraction: i128,
    size_shifts: Vec<i128>,
    /// Half of a sum of two words.
    pub(super) half: fn(i128) -> i128,
    /// `a * 2^places`.
    pub(super) scaled: fn(i128, i128) -> i128,
    /// A quotient to the nearest.
    pub(super) nearest: fn(i128, i128) -> i128,
    /// A square root to the nearest.
    pub(super) root: fn(i128) -> i128,
    /// Sixteenths that an opacity of 0 to 15 covers.
    pub(super) covered: fn(i128) -> i128,
    /// The numbers of a plane by which a sample on it is moved off, in order.
    pub(super) ties: fn([i128; 3]) -> Vec<i128>,
    /// Remaining light, of 256, that counts as none.
    pub(super) opaque: i128,
}

impl Rules {
    pub(super) fn new(manifest: &Value) -> Self {
        let constants = &manifest["constants"];
        let number = |value: &Value| i128::from(value.as_i64().unwrap());
        let shifts = constants["size_shifts"].as_array().unwrap();
        Self {
            fraction: number(&constants["screen_fraction_bits"]),
            size_shifts: shifts.iter().map(number).collect(),
            half: |sum| sum.div_euclid(2),
            scaled: |a, places| match places >= 0 {
                true => a << places,
                false => a.div_euclid(1 << (-places).min(100)),
            },
            nearest: |a, b| (2 * a + b).div_euclid(2 * b),
            root: |square| (square as f64).sqrt().round() as i128,
            covered: |opacity| opacity + i128::from(opacity >= 8),
            ties: |[a, b, c]| vec![2 * c + a + b, a, b],
            opaque: 64,
        }
    }

    pub(super) fn replay(&self, block: &str, row: &Row) -> Vec<i128> {
        let get = |name: &str| row.get(name);
        let (half, scaled, nearest) = (self.half, self.scaled, self.nearest);
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
            "size_limit" => {
                let (w, below) = (get("w_min"), get("below"));
                let shares = self.size_shifts.iter().map(|s| scaled(w, -(s + below)));
                vec![shares.sum()]
            }
            "size_clip" => {
                let (x, w) = (row.three("edge_x"), row.three("edge_w"));
                let size: i128 = (0..3).map(|k| x[k].abs().max((x[k] - w[k]).abs())).sum();
                bits(&[size <= get("most")])
            }
            "size_screen" => bits(&[get("high") - get("low") <= get("limit")]),
            "centre" => {
                let (min, max) = (row.three("min"), row.three("max"));
                (0..3).map(|k| half(min[k] + max[k])).collect()
            }
            "octant_order" => {
                let (centre, eye) = (row.three("centre"), row.three("eye_floor"));
                let octant = (0..3).map(|k| i128::from(centre[k] > eye[k]) << (2 - k));
                let octant: i128 = octant.sum();
                // Itself, then the children, nearest first.
                [0, 7, 6, 5, 3, 4, 2, 1, 0].map(|at| octant ^ at).into()
            }
            "vertex_pool" => row.cage("parent").children(),
            "child_planes" => {
                let has = |k: usize| get("octant") >> (2 - k) & 1;
                let moved =
                    |j| moved_edge(row, j, get("half"), [has((j + 1) % 3), has((j + 2) % 3)]);
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
                let (places, more) = (get("places"), i128::from(get("places") > 0));
                row.cage("w").each(|w| scaled(w, -places) + more).0
            }
            "margin_gap" => row.cage("w").each(|w| -scaled(w, -get("below"))).0,
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
                let (mut low, mut high) = match row.flag("closed") {
                    true => (
                        relative.with(1, &m, -1).least() <= 0,
                        relative.with(1, &m, 1).greatest() >= 0,
                    ),
                    false => halves(relative.least() < 0, relative.greatest() > 0),
                };
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
                let ([a, b, c], quadrant) = (row.three("plane"), get("quadrant"));
                vec![2 * c + (quadrant & 1) * a + (quadrant >> 1) * b]
            }
            "border_screen" => {
                let (low, high, node) = (get("low"), get("high"), get("node"));
                let unit = get("below") + self.fraction;
                let (left, right) = (node << unit, (node + 1) << unit);
                let outside = high < left || low > right;
                bits(&[outside, !outside && left <= low && high <= right])
            }
            "bisector_screen" => {
                let unit = get("below") + self.fraction - 1;
                let bisector = scaled(2 * get("node") + 1, unit);
                let (low, high) = halves(get("low") < bisector, get("high") > bisector);
                bits(&[low, high])
            }
            "quadrants" => {
                let x = [row.flag("low_half_x"), row.flag("high_half_x")];
                let y = [row.flag("low_half_y"), row.flag("high_half_y")];
                let bit = |q: usize| i128::from(x[q & 1] && y[q >> 1]) << q;
                vec![(0..4).map(bit).sum()]
            }
            "node_choice" => {
                let (overlapped, vector) = (get("overlapped"), get("vector"));
                let rejected = i128::from(overlapped & !vector == 0);
                match overlapped.count_ones() {
                    1 => vec![rejected, 1, overlapped.trailing_zeros().into()],
                    _ => vec![rejected, 0, 0],
                }
            }
            "cage_centre" => vec![match row.cage("cage").0[..] {
                [corner, x, y, z] => corner + half(x + y + z),
                ref corners => half(corners[0] + corners[7]),
            }],
            "centre_half" => match 2 * get("value") - get("w") {
                beyond @ 0.. => vec![1, beyond],
                _ => vec![0, 2 * get("value")],
            },
            "centre_sample" => {
                let (node, below) = (get("node"), get("below"));
                let sample = scaled(get("centre"), -self.fraction);
                vec![sample.clamp(node << below, ((node + 1) << below) - 1)]
            }
            "cube_planes" => {
                // The edge itself, moved along k, along l, along both.
                let ways = [[0, 0], [1, 0], [0, 1], [1, 1]];
                let planes = |j| ways.map(|by| moved_edge(row, j, get("side"), by));
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
            "plane_side" => vec![self.plane_side(row.three("plane"), row.flag("sample"))],
            "plane_cover" => vec![plane_cover(row)],
            "fill_update" => {
                let after = get("vector") | get("bits");
                vec![after, i128::from(after == 15)]
            }
            "blend_way" => {
                let centre = half(get("min") + get("max"));
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
                let length = (self.root)(squares.iter().sum());
                squares.map(|square| nearest(square, length)).into()
            }
            "blend_weight" => {
                let (high, count) = (row.three("high"), row.three("count"));
                let opacity = |k: usize| row.of(&format!("opacity_{}", AXES[k]))[high[k] as usize];
                match (0..3).any(|k| opacity(k) == 15) {
                    true => vec![256],
                    false => vec![(0..3).map(|k| (self.covered)(opacity(k)) * count[k]).sum()],
                }
            }
            "blend_sample" => {
                let left = get("left");
                let share = nearest(left * get("weight"), 256);
                let full = left - share <= self.opaque;
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

    /// The side of the open node's samples: at its corners the function takes all its extremes, and a
    /// sample is moved right, then down, by next to nothing.
    fn plane_side(&self, plane: [i128; 3], is_sample: bool) -> i128 {
        let [a, b, c] = plane;
        let corners = [c, c + a, c + b, c + a + b];
        if corners == [0; 4] {
            3
        } else if corners.iter().all(|&v| v >= 0) {
            1
        } else if corners.iter().all(|&v| v <= 0) {
            2
        } else if is_sample {
            match (self.ties)(plane).into_iter().find(|&v| v != 0) {
                Some(v) if v > 0 => 1,
                Some(_) => 2,
                None => 3,
            }
        } else {
            0
        }
    }
}

fn bits(flags: &[bool]) -> Vec<i128> {
    flags.iter().map(|&flag| flag.into()).collect()
}

/// A box beside no bisector is in the upper half.
fn halves(low: bool, high: bool) -> (bool, bool) {
    (low, high || !low)
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// The plane of edge `j`, moved by cubes of `2^side` along the two next axes.
fn moved_edge(row: &Row, j: usize, side: i128, [by_k, by_l]: [i128; 2]) -> [i128; 3] {
    let plane = row.three(&format!("edge_{}", AXES[j]));
    let along = |l: usize| {
        let axis = AXES[(j + l) % 3];
        let [a, b] = *row.of(&format!("axis_{axis}")) else {
            unreachable!("a and b");
        };
        [a, b, row.get(&format!("axis_{axis}_c"))]
    };
    let (along_k, along_l) = (along(1), along(2));
    [0, 1, 2].map(|c| plane[c] + (by_l * along_k[c] - by_k * along_l[c]) * (1 << side))
}

fn plane_cover(row: &Row) -> i128 {
    let mut all = true;
    for axis in AXES {
        let sides = row.of(&format!("side_{axis}"));
        if !(sides.contains(&1) && sides.contains(&2)) {
            if !sides.contains(&0) {
                return 0;
            }
            all = false;
        }
    }
    // Where an axis is not settled, the front has not been examined yet; its side is then the last
    // one, for which the record was still alive.
    match row.get("front_side") {
        _ if !row.flag("front") => {}
        0 => all = false,
        side if side != row.get("wanted") => return 0,
        _ => {}
    }
    if all { 2 } else { 1 }
}
