//! The cost of a subdivided record, in both spaces and seen from within.

use super::*;

/// The cost of a cage coordinate: halvings and additions of the vertex pool, numbers held, minima, maxima and additions
/// of a span.
const CAGES: [(CageKind, [u64; 5]); 2] = [
    (CageKind::Corners, [19, 0, 8, 7 + 7, 0]),
    (CageKind::Frame, [3, 7, 4, 3 + 3, 6]),
];

/// Pool, box and fit of the table above, for both cages in both spaces.
#[test]
fn a_subdivided_record_costs_what_the_table_says() {
    for (cage, [halvings, pool_adds, numbers, min_max, adds]) in CAGES {
        for tolerance in [0.0, f64::INFINITY] {
            let in_clip = tolerance == 0.0;
            let coordinates = if in_clip { 3 } else { 2 };
            // In clip space the box has the span of W alone, which is compared with the near plane.
            let spans = if in_clip { 1 } else { 2 };
            each_subdivided(&options(cage, tolerance), |name, setup, turn, c| {
                let bits = setup.format.bits();
                check_centre_and_order(setup, turn);
                assert_eq!(
                    turn.ops(Stage::VertexPool),
                    ops(&[
                        (OpClass::Add, bits + 1, coordinates * halvings),
                        (OpClass::Shift, bits + 1, coordinates * halvings),
                        (OpClass::Add, bits, coordinates * pool_adds),
                    ]),
                    "{name}, {cage:?}"
                );
                assert_eq!(
                    turn.ops(Stage::ChildBox),
                    ops(&[
                        (OpClass::Select, bits, 6 * c),
                        (OpClass::MinMax, bits, spans * min_max * c),
                        (OpClass::Add, bits, spans * adds * c),
                        (OpClass::Compare, bits, if in_clip { c } else { 0 }),
                    ]),
                    "{name}, {cage:?}, {c} children"
                );
                if in_clip {
                    check_clip_fit(name, setup, turn, [numbers, min_max, adds]);
                    return;
                }
                let tests = fit_tests(turn);
                assert!(tests >= c, "{name}: each child is tested once at least");
                assert_eq!(
                    sum(turn.children_s_fits()),
                    ops(&[
                        (OpClass::Compare, bits, 2 * 2 * tests),
                        (OpClass::Logic, 4, tests)
                    ]),
                    "{name}, {cage:?}"
                );
            });
        }
    }
}

/// Test by test: two compares per axis, one read of a fill vector, one and.
#[test]
fn the_fit_is_one_small_step_over_and_over() {
    each_subdivided(
        &options(CageKind::Corners, f64::INFINITY),
        |name, setup, turn, _| {
            let bits = setup.format.bits();
            let events = turn.children_s_fits();
            let steps = events.chunks_exact(6);
            assert_eq!(steps.remainder(), [], "{name}");
            for step in steps {
                assert_eq!(step[..4], [Event::Op(OpClass::Compare, bits); 4], "{name}");
                assert!(
                    matches!(step[4], Event::Read(Memory::FillVector, _)),
                    "{name}"
                );
                assert_eq!(step[5], Event::Op(OpClass::Logic, 4), "{name}");
            }
        },
    );
}

/// The fit in clip space, where a cage coordinate has `numbers` numbers and its span
/// takes `min_max` and `adds`.
fn check_clip_fit(name: &str, setup: &FrameSetup, turn: &Turn, [numbers, min_max, adds]: [u64; 3]) {
    let bits = setup.format.bits();
    let tests = fit_tests(turn);
    let found = sum(turn.children_s_fits());
    let shifts = found[&(OpClass::Shift, bits)];
    assert_eq!(
        found,
        ops(&[
            (OpClass::Shift, bits, shifts),
            (OpClass::Sub, bits, 2 * numbers * tests),
            (OpClass::MinMax, bits, 2 * min_max * tests),
            (OpClass::Add, bits, 2 * adds * tests),
            (OpClass::Compare, bits, 2 * 2 * tests),
            (OpClass::Logic, 4, tests)
        ]),
        "{name}"
    );
    // Beyond those of the tests, a cage coordinate's worth for each left half.
    let doubled = shifts - 2 * numbers * tests;
    assert_eq!(doubled % numbers, 0, "{name}");
    assert!(doubled <= 2 * numbers * tests, "{name}");
}

/// From within the object, records lie behind the eye, across the near plane and beyond the picture, and change to
/// screen space one by one. The stages before the children's boxes cost the same.
#[test]
fn the_view_from_within_costs_the_same() {
    let walls = |[x, y, z]: [i32; 3]| x == 0 || y == 15 || z == 0;
    let graph = octree(4, &walls);
    let camera = camera([7.3, 5.1, 8.6], [2.0, 16.0, 3.0], 16);
    for (cage, [halvings, adds, ..]) in CAGES {
        let setup = setup(&graph, &camera, &options(cage, 0.25));
        let bits = setup.format.bits();
        let pool = |coordinates: u64| {
            ops(&[
                (OpClass::Add, bits + 1, coordinates * halvings),
                (OpClass::Shift, bits + 1, coordinates * halvings),
                (OpClass::Add, bits, coordinates * adds),
            ])
        };
        let (_, probe) = watch(&graph, &setup, ByRecord::default());
        let (mut in_clip, mut in_screen) = (0, 0);
        for turn in probe.turns.iter().filter(|turn| turn.is_subdivided()) {
            check_centre_and_order(&setup, turn);
            let children = turn.children(&graph);
            assert_eq!(turn.count(Stage::ChildBox, OpClass::Select), 6 * children);
            let found = turn.ops(Stage::VertexPool);
            if found == pool(3) {
                in_clip += 1;
            } else {
                assert_eq!(found, pool(2), "{cage:?}");
                in_screen += 1;
            }
        }
        assert!(
            in_clip > 100 && in_screen > 100,
            "{in_clip} and {in_screen}"
        );
    }
}

/// A graph with four of eight children costs half of what all eight do, and
/// one with one child an eighth, in the stage that is paid for by child.
#[test]
fn absent_children_cost_nothing() {
    let cost = |children: &[u8]| {
        let mut links = [None; 8];
        for &octant in children {
            links[octant as usize] = Some(0);
        }
        let graph = linked(1, &[links]);
        let camera = camera([6.0, 5.0, 4.0], [1.0, 1.0, 1.0], 16);
        let setup = setup(&graph, &camera, &options(CageKind::Corners, f64::INFINITY));
        let (_, probe) = watch(&graph, &setup, ByRecord::default());
        let object = &probe.turns[0];
        assert!(object.is_subdivided());
        let pushes = object
            .of(Stage::Push)
            .filter(|event| *event == Event::Write(Memory::Stack))
            .count();
        assert_eq!(pushes, children.len(), "all are seen");
        let boxes = object.count(Stage::ChildBox, OpClass::MinMax)
            + object.count(Stage::ChildBox, OpClass::Select);
        assert_eq!(boxes, children.len() as u64 * (6 + 28));
        assert_eq!(object.count(Stage::VertexPool, OpClass::Add), 38);
        object.count(Stage::QuadtreeFit, OpClass::Logic)
    };
    let all = cost(&[0, 1, 2, 3, 4, 5, 6, 7]);
    let each: u64 = (0..8).map(|octant| cost(&[octant])).sum();
    assert_eq!(all, each, "a child's fit does not depend on its siblings");
    assert!(cost(&[0, 3, 5, 6]) < all);
}
