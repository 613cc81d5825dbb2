//! The bounds on a vertex's error hold on random frames and formats, and are not much larger than
//! the errors.

use proptest::prelude::*;
use proptest::sample::select;
use shiftvox::project::{CageKind, Coverage, SetupOptions};
use shiftvox_lab::stress::{Case, Check, StressScene, run_case};

use crate::common::{any_view, cases, solid, tolerance_of};

fn any_options() -> impl Strategy<Value = SetupOptions> {
    (
        16..=64u32,
        prop_oneof![2 => Just(None), 1 => (0..24u32).prop_map(Some)],
        select(&[CageKind::Corners, CageKind::Frame]),
        select(&[0.0, 1.0 / 64.0, 0.125, f64::INFINITY]),
        select(&[Coverage::Any, Coverage::Center, Coverage::Exact]),
    )
        .prop_map(|(bits, frac, cage, tolerance_px, coverage)| SetupOptions {
            bits,
            frac,
            cage,
            tolerance_px: tolerance_of(coverage, tolerance_px),
            coverage,
            lod_px: 0.0,
            aa_log2: 0,
        })
}

proptest! {
    #![proptest_config(cases(75))]

    #[test]
    fn vertices_are_as_specified_and_within_their_bounds(
        depth in 1..7u32,
        (_, mut camera) in any_view(Just(solid(3)), 4..40),
        shift in prop_oneof![3 => Just(0), 1 => -1_000_000_000..1_000_000_000i64],
        options in any_options(),
    ) {
        let scale = f64::from(1u32 << depth) / 8.0;
        camera.eye *= scale;
        camera.target *= scale;
        let scene: StressScene = format!("plane:{depth},1,3,5").parse().unwrap();
        let case = Case { scene, camera, shift, options };
        let outcome = run_case(&case, 100_000).unwrap();
        for check in [Check::Specification, Check::Bound] {
            prop_assert!(outcome.failures.iter().all(|failure| failure.check != check), "{case}: {:?}", outcome.failures);
        }
        prop_assert!(outcome.worst.iter().all(|worst| worst.tightest <= 1.0));
    }
}

/// Each kind of bound comes within this factor of an error that is seen.
#[test]
fn the_bounds_are_within_a_small_factor() {
    let mut tightest = [0.0f64; 3];
    for bits in [24, 32, 40, 64] {
        for rules in [
            "coverage=any;cage=frame",
            "coverage=any;cage=corners",
            "coverage=center;cage=frame",
            "coverage=center;cage=corners",
        ] {
            for tolerance in ["0", "0.0625", "inf"] {
                for eye in ["60,-41,45", "-20,-90,12", "16,-30,16.4"] {
                    let text = format!(
                        "scene=plane:5,1,3,5;eye={eye};target=16,15,17;size=64x64;bits={bits};\
                         {rules};tolerance={tolerance};lod=0"
                    );
                    let outcome = run_case(&text.parse().unwrap(), 1_000_000).unwrap();
                    assert_eq!(outcome.failures, [], "{text}");
                    for (most, worst) in tightest.iter_mut().zip(outcome.worst) {
                        *most = most.max(worst.tightest);
                    }
                }
            }
        }
    }
    let is_tight = |tightest: &f64| (0.3..=1.0).contains(tightest);
    assert!(tightest.iter().all(is_tight), "{tightest:?}");
}
