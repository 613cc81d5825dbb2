//! The sweep: the same in every run, and clean on the machine as it is.

use shiftvox::graph::Silent;
use shiftvox_lab::stress::{Case, End, Key, SweepPlan, run_case, sweep};

fn small(seed: u64) -> SweepPlan {
    let scenes = [
        "gen:shell,depth=3",
        "solid:4",
        "cyclic:7,2",
        "gen:sierpinski,depth=30",
    ];
    SweepPlan {
        scenes: scenes.map(|text| text.parse().unwrap()).into(),
        bits: vec![16, 24, 48],
        pixels: vec![20],
        random_viewpoints: 1,
        rules: 2,
        most_records: 100_000,
        ..SweepPlan::new(seed, false)
    }
}

#[test]
fn a_sweep_is_clean_and_the_same_again() {
    let found = sweep(&small(3), &Silent).unwrap();
    assert!(found.failures.is_empty(), "{:?}", found.failed);
    // Under `exact` the picture is the oracle's.
    let is_strict = |key: &Key| key.coverage == 0;
    let strict = found.tallies.iter().filter(|(key, _)| is_strict(key));
    assert_eq!(strict.map(|(_, tally)| tally.holes).sum::<u64>(), 0);
    let total = found.total();
    assert!(
        total.drawn > 300 && total.trapped > 10 && total.refused > 0,
        "{total:?}"
    );
    let few = |seed| {
        let mut plan = small(seed);
        plan.scenes.truncate(1);
        plan.bits.truncate(2);
        sweep(&plan, &Silent).unwrap()
    };
    assert_eq!(few(3), few(3));
    assert_ne!(few(3), few(4));
}

#[test]
fn a_trap_has_its_place_and_a_refusal_its_reason() {
    let run = |text: &str| {
        let case: Case = text.parse().unwrap();
        run_case(&case, 100_000).unwrap()
    };
    let scene = "scene=gen:shell,depth=6;eye=130,-200,90;target=32,32,32";
    let End::Trapped(trap) = run(&format!("{scene};bits=16;frac=10")).end else {
        panic!("no trap");
    };
    assert!(
        trap.contains("16 bits") && trap.contains("stage") && trap.contains("record"),
        "{trap}"
    );
    let End::Refused(reason) = run(&format!("{scene};bits=16;frac=0")).end else {
        panic!("not refused");
    };
    assert!(reason.contains("collapses"), "{reason}");
    // A frame that goes on for long, but ends.
    let inside = "scene=solid:5;eye=11.84,13.12,14.72;target=16,16,16;fov=170;size=40x40;coverage=center;tolerance=inf";
    assert_eq!(run(inside).end, End::CutOff);
    assert!(run(inside).failures.is_empty());
}
