//! The bounds on a vertex's error hold on random frames and formats, and are not much larger than
//! the errors.

use glam::DVec3;
use proptest::prelude::*;
use shiftvox::project::{CageKind, Coverage, SetupOptions};
use shiftvox_lab::bounds::{Bounds, Cube, Space, Widths, worst_host_px};
use shiftvox_lab::stress::{Case, Check, Hold, StressScene, run_case};

use crate::common::{any_view, cases, solid, tolerance_of};

fn any_options() -> impl Strategy<Value = SetupOptions> {
    (
        16..=64u32,
        prop_oneof![2 => Just(None), 1 => (0..24u32).prop_map(Some)],
        prop_oneof![Just(CageKind::Corners), Just(CageKind::Frame)],
        prop_oneof![
            Just(0.0),
            Just(1.0 / 64.0),
            Just(0.125),
            Just(f64::INFINITY)
        ],
        prop_oneof![
            Just(Coverage::Any),
            Just(Coverage::Center),
            Just(Coverage::Exact)
        ],
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

    /// On any frame: vertices as specified, and within their bounds.
    #[test]
    fn no_vertex_is_beyond_its_bound(
        depth in 1..7u32,
        (_, camera) in any_view(Just(solid(3)), 4..40),
        shift in prop_oneof![3 => Just(0), 1 => -1_000_000_000..1_000_000_000i64],
        options in any_options(),
    ) {
        let scale = f64::from(1u32 << depth) / 8.0;
        let mut camera = camera;
        camera.eye *= scale;
        camera.target *= scale;
        let scene: StressScene = format!("plane:{depth},1,3,5").parse().unwrap();
        let case = Case { scene, camera, shift, options };
        let outcome = run_case(&case, 100_000).unwrap();
        for check in [Check::Specification, Check::Bound] {
            prop_assert!(!outcome.fails(check), "{case}: {:?}", outcome.failures);
        }
        for worst in outcome.worst {
            prop_assert!(worst.tightest <= 1.0);
        }
    }
}

/// Each kind of bound comes within this factor of an error that is seen.
#[test]
fn the_bounds_are_within_a_small_factor() {
    let mut tightest = [0.0f64; 3];
    for bits in [24, 32, 40, 64] {
        for coverage in ["any", "center"] {
            for cage in ["frame", "corners"] {
                for tolerance in ["0", "0.0625", "inf"] {
                    for eye in ["60,-41,45", "-20,-90,12", "16,-30,16.4"] {
                        let text = format!(
                            "scene=plane:5,1,3,5;eye={eye};target=16,15,17;size=64x64;bits={bits};\
                             cage={cage};coverage={coverage};tolerance={tolerance};lod=0"
                        );
                        let case: Case = text.parse().unwrap();
                        let outcome = run_case(&case, 1_000_000).unwrap();
                        assert_eq!(outcome.failures, [], "{text}");
                        for (most, worst) in tightest.iter_mut().zip(outcome.worst) {
                            *most = most.max(worst.tightest);
                        }
                    }
                }
            }
        }
    }
    for (hold, tightest) in Hold::ALL.iter().zip(tightest) {
        println!("{}: {tightest:.3}", hold.name());
        assert!(
            (0.3..=1.0).contains(&tightest),
            "{}: {tightest}",
            hold.name()
        );
    }
}

/// The closed form for a whole picture is no less than any vertex's.
#[test]
fn the_picture_wide_bound_holds_everywhere() {
    let camera = crate::common::camera([40.0, -25.0, 30.0], [8.0, 8.0, 8.0], 256);
    let placement = shiftvox::graph::Placement::default();
    for clip_frac in [4, 8, 16, 30] {
        let widths = Widths {
            clip_frac,
            screen_frac: 16,
            aa_log2: 0,
        };
        let bounds = Bounds::new(&camera, &placement, widths).unwrap();
        // 60 degrees high and wide: the diagonal is wider.
        let half_angle = libm::atan(libm::tan(30f64.to_radians()) * 2f64.sqrt());
        let cube = Cube {
            corner: DVec3::ZERO,
            side: 16.0,
        };
        for vertex in 0..4096u32 {
            let u = DVec3::new(
                f64::from(vertex >> 8),
                f64::from(vertex >> 4 & 15),
                f64::from(vertex & 15),
            );
            let Some([x, y]) = bounds.project(u) else {
                continue;
            };
            if !(0.0..=256.0).contains(&x) || !(0.0..=256.0).contains(&y) {
                continue;
            }
            let here = bounds.host(u);
            let most = worst_host_px(clip_frac, 256.0, bounds.depth(u), half_angle);
            assert!(
                here[0] <= most * 1.001 && here[1] <= most * 1.001,
                "{u}: {here:?}, {most}"
            );
            // The parts of a bound only grow with the levels below the change.
            let at = |levels| bounds.vertex(Space::Frame(cube), levels, u)[0];
            assert!(at(1) <= at(5));
        }
    }
}
