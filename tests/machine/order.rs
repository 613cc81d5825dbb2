//! Occlusion order (image-order paper, 3.2), proved for every position of the eye.

use shiftvox::machine::OCCLUSION_ORDER;

/// Whether no ray from the eye meets the inside of `second` before that of `first`: some centre plane parts them with
/// the eye on it or on `first`'s side.
fn never_occludes(eye_side: [i32; 3], second: u8, first: u8) -> bool {
    (0..3).any(|axis| {
        let side = |child: u8| if child >> (2 - axis) & 1 != 0 { 1 } else { -1 };
        side(first) != side(second) && eye_side[axis] != side(second)
    })
}

#[test]
fn later_children_never_occlude_earlier_ones_for_all_27_eye_positions() {
    for eye in (0..27).map(|i| [i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1]) {
        // The machine's rule: a bit is set where the centre is on the positive side of the eye, strictly.
        let bit = |bits, side: i32| bits << 1 | u8::from(side < 0);
        let octant = eye.into_iter().fold(0, bit);
        let children = OCCLUSION_ORDER.map(|nearest| octant ^ nearest);
        for later in 0..8 {
            for earlier in 0..later {
                let is_free = never_occludes(eye, children[later], children[earlier]);
                assert!(is_free, "{eye:?}: {children:?}");
            }
        }
    }
}
