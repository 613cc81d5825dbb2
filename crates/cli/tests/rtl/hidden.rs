//! Stage B does not search for hidden records (`docs/rtl.md`, section 4), because its fit never stops early. A record that
//! is subdivided and no larger than a sample descends to a sample or is rejected. This is checked along one axis of the
//! picture, with the roundings of `rtl/stage_b/image_step.v` and `rtl/blocks/size_clip.v`.

/// A number of a cage: at its corner, and along its three edges.
type Number = [i64; 4];

/// The least and greatest of a number at the cage's vertices.
fn span(number: Number) -> (i64, i64) {
    let edges = &number[1..];
    let sum = |of: fn(i64) -> i64| number[0] + edges.iter().map(|&edge| of(edge)).sum::<i64>();
    (sum(|edge| edge.min(0)), sum(|edge| edge.max(0)))
}

fn both(a: Number, b: Number, of: impl Fn(i64, i64) -> i64) -> Number {
    std::array::from_fn(|k| of(a[k], b[k]))
}

/// Whether a cage is no larger than a sample, in a node so many levels above the samples.
fn fits(x: Number, w: Number, below: u32) -> bool {
    let size: i64 = (1..4).map(|k| x[k].abs().max((x[k] - w[k]).abs())).sum();
    size <= span(w).0 >> below
}

/// The cage where the fit stops above the samples. `None` if it does not stop, or rejects.
fn stops(mut x: Number, w: Number, mut below: u32) -> Option<(Number, u32)> {
    if span(x).1 < 0 || span(both(x, w, |x, w| x - w)).0 > 0 {
        return None;
    }
    while below > 0 {
        let beyond = both(x, w, |x, w| 2 * x - w);
        let half_a_sample = w.map(|w| w >> below);
        let low = span(both(beyond, half_a_sample, |a, b| a + b)).0 <= 0;
        let high = span(both(beyond, half_a_sample, |a, b| a - b)).1 >= 0;
        let inner = match (low, high) {
            (false, false) => return None,
            (true, true) => return Some((x, below)),
            (true, false) => x.map(|x| 2 * x),
            (false, true) => beyond,
        };
        let is_near = span(both(inner, w, |x, w| x + w)).0 >= 0
            && span(both(inner, w, |x, w| x - 2 * w)).1 <= 0;
        if !is_near {
            return Some((x, below));
        }
        (x, below) = (inner, below - 1);
    }
    None
}

/// How many of random cages stop and are no larger than a sample there. `side`: of the record, in voxels, of which all
/// edges are multiples.
fn small_ones_that_stop(side: i64) -> u32 {
    let mut state = 1u64;
    let mut next = |low: i64, high: i64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (state >> 33) as i64 % (high - low + 1)
    };
    let mut found = 0;
    for _ in 0..1_000_000 {
        let below = next(1, 5) as u32;
        let depth = next(1, 12 << below);
        let w = [
            depth,
            next(-2, 2) * side,
            next(-2, 2) * side,
            next(-1, 1) * side,
        ];
        if w[1..] == [0; 3] {
            // Such an object has no volume before the eye, or is seen by no camera.
            continue;
        }
        let sample = (depth >> below) / side + 1;
        let long = next(-sample, sample) * side;
        let x = [
            next(-depth / 2, depth + depth / 2),
            long,
            next(-1, 1) * side,
            next(-1, 1) * side,
        ];
        if let Some((x, below)) = stops(x, w, below) {
            found += u32::from(fits(x, w, below));
        }
    }
    found
}

#[test]
fn no_record_of_two_voxels_or_more_stops_and_is_as_small_as_a_sample() {
    assert_eq!(small_ones_that_stop(2), 0);
    assert_eq!(small_ones_that_stop(4), 0);
    // Single voxels, whose edges may be odd, do: but they are drawn, and not subdivided.
    assert!(small_ones_that_stop(1) > 10);
}
