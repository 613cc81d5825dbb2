//! The sweep: the same in every run, and clean on the machine as it is.

use shiftvox::graph::Silent;
use shiftvox_lab::stress::{Case, End, SweepPlan, run_case, sweep};

fn small(seed: u64, scenes: &[&str], bits: &[u32]) -> SweepPlan {
    SweepPlan {
        scenes: scenes.iter().map(|text| text.parse().unwrap()).collect(),
        bits: bits.into(),
        pixels: vec![20],
        random_viewpoints: 1,
        rules: 2,
        most_records: 100_000,
        ..SweepPlan::new(seed, false)
    }
}

#[test]
fn a_sweep_is_clean_and_the_same_again() {
    let scenes = [
        "gen:shell,depth=3",
        "solid:4",
        "cyclic:7,2",
        "gen:sierpinski,depth=30",
    ];
    let found = sweep(&small(3, &scenes, &[16, 24, 48]), &Silent).unwrap();
    assert!(found.failures.is_empty(), "{:?}", found.failed);
    // Under `exact` the picture is the oracle's.
    let strict = found.tallies.iter().filter(|(key, _)| key.coverage == 0);
    assert_eq!(strict.map(|(_, tally)| tally.holes).sum::<u64>(), 0);
    let total = found.total();
    let are_many = total.drawn > 300 && total.trapped > 10 && total.refused > 0;
    assert!(are_many, "{total:?}");
    let few = |seed| sweep(&small(seed, &scenes[..1], &[16, 24]), &Silent).unwrap();
    assert_eq!(few(3), few(3));
    assert_ne!(few(3), few(4));
}

#[test]
fn frames_end_by_traps_refusals_and_cut_offs() {
    let run = |text: &str| {
        let case: Case = text.parse().unwrap();
        run_case(&case, 100_000).unwrap()
    };
    let scene = "scene=gen:shell,depth=6;eye=130,-200,90;target=32,32,32;bits=16";
    let End::Trapped(trap) = run(&format!("{scene};frac=10")).end else {
        panic!("no trap");
    };
    let has_place = ["16 bits", "stage", "record"].map(|part| trap.contains(part));
    assert_eq!(has_place, [true; 3], "{trap}");
    let refused = run(&format!("{scene};frac=0")).end;
    assert!(matches!(refused, End::Refused(_)), "{refused:?}");
    // A frame that takes long, but ends.
    let inside = "scene=solid:5;eye=11.84,13.12,14.72;target=16,16,16;fov=170;size=40x40;coverage=center;tolerance=inf";
    let long = run(inside);
    assert_eq!((long.end, long.failures), (End::CutOff, vec![]));
}
