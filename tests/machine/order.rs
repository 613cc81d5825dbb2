//! Occlusion order (image-order paper, 3.2), proved for every position of the eye.

use crate::common::*;
use shiftvox::frame::Frame;
use shiftvox::machine::{MachineOptions, OCCLUSION_ORDER};
use shiftvox::project::{Engine, SetupOptions};
use shiftvox::rays::Rays;

/// Children in occlusion order for an eye on side -1, 0, +1 of each centre plane.
fn order_for(eye_side: [i32; 3], order: [u8; 8]) -> [u8; 8] {
    // The machine's rule: a bit is set where the centre is on the positive
    // side of the eye, strictly.
    let octant = eye_side
        .iter()
        .fold(0u8, |bits, &side| bits << 1 | u8::from(side < 0));
    order.map(|nearest| octant ^ nearest)
}

/// Whether no ray from the eye meets the inside of `second` before that of
/// `first`: some centre plane parts them with the eye on it or on `first`'s side.
fn never_occludes(eye_side: [i32; 3], second: u8, first: u8) -> bool {
    (0..3).any(|axis| {
        let side = |child: u8| if child >> (2 - axis) & 1 != 0 { 1 } else { -1 };
        side(first) != side(second) && eye_side[axis] != side(second)
    })
}

fn all_eye_sides() -> impl Iterator<Item = [i32; 3]> {
    (0..27).map(|i| [i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1])
}

fn is_an_occlusion_order(order: [u8; 8]) -> bool {
    all_eye_sides().all(|eye| {
        let children = order_for(eye, order);
        (0..8).all(|later| {
            (0..later).all(|earlier| never_occludes(eye, children[later], children[earlier]))
        })
    })
}

#[test]
fn later_children_never_occlude_earlier_ones_for_all_27_eye_positions() {
    assert!(is_an_occlusion_order(OCCLUSION_ORDER));
}

/// The separating-plane argument itself, against rays: from eyes on a small
/// lattice, every ray to a lattice point visits children in an order that
/// `never_occludes` allows.
#[test]
fn the_criterion_agrees_with_rays() {
    // A cube of side 4 about the origin; positions in quarters, rays sampled
    // at 64 points, none of which lies on a centre plane for these numbers.
    let mut visits = 0;
    for eye_side in all_eye_sides() {
        let eye = eye_side.map(|side| f64::from(side) * 3.0);
        for target in 0..1000 {
            let target =
                [target / 100, target / 10 % 10, target % 10].map(|c| f64::from(c) * 0.437 - 1.969);
            let mut seen: Vec<u8> = Vec::new();
            for step in 0..400 {
                let t = f64::from(step) * 0.0057 + 0.00123;
                let at: [f64; 3] = std::array::from_fn(|k| eye[k] + t * (target[k] - eye[k]));
                if at.iter().any(|c| c.abs() >= 2.0) {
                    continue;
                }
                let child = at.iter().fold(0, |bits, &c| bits << 1 | u8::from(c > 0.0));
                if seen.last() != Some(&child) {
                    seen.push(child);
                }
            }
            for later in 1..seen.len() {
                for earlier in 0..later {
                    visits += 1;
                    // The ray met `earlier` first: it must not be claimed that it never does.
                    assert!(
                        !never_occludes(eye_side, seen[earlier], seen[later]),
                        "eye {eye_side:?}: {seen:?}"
                    );
                }
            }
        }
    }
    assert!(visits > 1000, "only {visits} pairs were met");
}

/// An array is an occlusion order if no child comes after one that it may hide: one whose bits include its own.
#[test]
fn other_arrays_are_told_from_occlusion_orders() {
    let mut wrong = 0;
    for a in 0..8 {
        for b in 0..a {
            let mut order = OCCLUSION_ORDER;
            order.swap(a, b);
            let respects_inclusion = (0..8).all(|later| {
                (0..later).all(|earlier| order[earlier] & order[later] != order[earlier])
            });
            assert_eq!(
                is_an_occlusion_order(order),
                respects_inclusion,
                "places {a} and {b}"
            );
            wrong += u32::from(!respects_inclusion);
        }
    }
    assert!(wrong > 10, "only {wrong} disturbed arrays are wrong");
}

#[test]
fn a_disturbed_order_draws_another_picture() {
    let graph = octree(4, &|[x, y, z]| (x * 3 + y * 5 + z * 7) % 4 == 0);
    let camera = camera([-20.0, -15.0, 25.0], [8.0, 8.0, 8.0], 64);
    let options = SetupOptions {
        lod_px: 0.0,
        ..SetupOptions::default()
    };
    let setup = setup(&graph, &camera, &options);
    let mut oracle = Frame::new(64, 64, false);
    Rays.render(&graph.view(), &setup, &mut oracle)
        .expect("a frame");
    assert_eq!(draw(&graph, &setup).voxel, oracle.voxel);

    let mut order = OCCLUSION_ORDER;
    order.swap(0, 7);
    let disturbed = MachineOptions {
        order,
        ..MachineOptions::default()
    };
    let (frame, _) = draw_with(disturbed, &graph, &setup).expect("a frame");
    assert_ne!(frame.voxel, oracle.voxel);
}
