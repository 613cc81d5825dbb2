//! The bounds on a vertex's error are not much larger than the errors. That they hold is a check of every sweep.

use shiftvox_lab::stress::run_case;

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
