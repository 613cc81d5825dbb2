//! The outputs of some blocks for a row, by SPEC.md and the manifest. Mutants replace the roundings and ties of most of
//! them; `rtl/` has the others for one kind of cage or of limit only.

use serde_json::Value;

use super::rows::Row;

/// The constants of a frame, and the roundings and limits of the rules, which mutants replace.
pub(super) struct Rules {
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

    /// `None`: a block that `rtl/` has.
    pub(super) fn replay(&self, block: &str, row: &Row) -> Option<Vec<i128>> {
        let get = |name: &str| row.get(name);
        let (half, scaled, nearest) = (self.half, self.scaled, self.nearest);
        Some(match block {
            "change_guard" => {
                let (x, w) = (row.vertices("x"), row.vertices("w"));
                // Times 2^places where that is a multiple, so that nothing is rounded.
                let (by, part) = (1 << get("places").max(0), 1 << (-get("places")).max(0));
                let mut vertices = x.iter().zip(&w);
                let is_inside =
                    |(x, w): (&i128, &i128)| x * by + w * part >= 0 && (w - x) * by + w * part >= 0;
                bits(&[vertices.all(is_inside)])
            }
            "size_limit" => {
                let (w, below) = (get("w_min"), get("below"));
                let shares = self.size_shifts.iter().map(|s| scaled(w, -(s + below)));
                vec![shares.sum()]
            }
            "centre" => {
                let (min, max) = (row.three("min"), row.three("max"));
                (0..3).map(|k| half(min[k] + max[k])).collect()
            }
            "margin_grow" => {
                let (places, more) = (get("places"), i128::from(get("places") > 0));
                let grown = row.of("w").iter().map(|&w| scaled(w, -places) + more);
                grown.collect()
            }
            "margin_gap" => {
                let w = row.of("w").iter();
                w.map(|&w| -scaled(w, -get("below"))).collect()
            }
            "cage_centre" => vec![match *row.of("cage") {
                [corner, x, y, z] => corner + half(x + y + z),
                ref corners => half(corners[0] + corners[7]),
            }],
            "plane_side" => vec![self.plane_side(row.three("plane"), row.flag("sample"))],
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
                let opacity =
                    |k: usize| row.of(["opacity_x", "opacity_y", "opacity_z"][k])[high[k] as usize];
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
            _ => return None,
        })
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
