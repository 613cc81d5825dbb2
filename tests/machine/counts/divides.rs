//! Where the machine divides: for the change to screen space alone.

use super::*;

/// With an infinite tolerance only the object's own record changes to screen space. It takes one divide per vertex and
/// coordinate of the cage.
#[test]
fn only_the_change_to_screen_space_divides() {
    for (cage, vertices) in [(CageKind::Corners, 8), (CageKind::Frame, 4)] {
        for scene in scenes() {
            let name = scene.name;
            let setup = setup(&scene.graph, &scene.camera, &options(cage, f64::INFINITY));
            let (_, probe) = watch(&scene.graph, &setup, ByRecord::default());
            for turn in &probe.turns {
                for stage in Stage::ALL.into_iter().filter(|s| *s != Stage::ToScreen) {
                    assert_eq!(turn.count(stage, OpClass::DivideStep), 0, "{name}");
                }
            }
            assert_eq!(probe.before.count(Stage::ToScreen, OpClass::DivideStep), 0);
            // The object lies across the picture's bisectors, so that its node is the root: 4 integer bits, a bit per
            // level, and the fraction.
            let steps = 4 + setup.levels + setup.format.frac();
            let first = &probe.turns[0];
            let divides = first.count(Stage::ToScreen, OpClass::DivideStep);
            assert_eq!(divides, 2 * vertices * u64::from(steps), "{name}, {cage:?}");
            for turn in &probe.turns[1..] {
                assert_eq!(turn.ops(Stage::ToScreen), ops(&[]), "{name}, {cage:?}");
            }
        }
    }
}

/// With no tolerance the machine never divides; where records change one by one, divides stay in their stage.
#[test]
fn divides_stay_in_their_stage() {
    use Coverage::{Any, Center, Exact};
    for (coverage, tolerance_px) in [
        (Any, 0.0),
        (Center, 0.0),
        (Exact, 0.0),
        (Any, 0.25),
        (Center, 0.25),
    ] {
        for (cage, scene) in [CageKind::Corners, CageKind::Frame]
            .into_iter()
            .flat_map(|cage| scenes().into_iter().map(move |scene| (cage, scene)))
        {
            let options = SetupOptions {
                coverage,
                lod_px: 1.0,
                ..options(cage, tolerance_px)
            };
            let setup = setup(&scene.graph, &scene.camera, &options);
            let (_, counter) = watch(&scene.graph, &setup, Counter::new());
            let divides = counter.ops_of(OpClass::DivideStep);
            assert_eq!(
                divides,
                counter.ops_at(Stage::ToScreen, OpClass::DivideStep)
            );
            assert_eq!(divides > 0, tolerance_px > 0.0, "{}", scene.name);
            assert_ne!(counter.ops_of(OpClass::Add), 0);
        }
    }
}
