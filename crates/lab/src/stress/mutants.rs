//! The checks find machines that are known to be wrong.

use hwmodel::Trap;

use super::subject::Subject;
use super::sweep::sweep_of;
use super::{Case, Check, Findings, SweepPlan};
use shiftvox::frame::Frame;
use shiftvox::graph::{GraphView, Silent};
use shiftvox::machine::Cage;
use shiftvox::machine::mutants::{Mutant, Mutation};
use shiftvox::project::{EngineError, FrameSetup, Stats};

impl Subject for Mutant {
    fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        self.draw(graph, setup, frame, most_records)
    }

    fn cages_along(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
        self.cages_along(setup, path)
    }
}

const SCENES: [&str; 3] = ["gen:shell,depth=3", "gen:random,depth=3", "plane:4,3,5,7"];

fn sweep(subject: &dyn Subject, scenes: &[&str], bits: &[u32]) -> Findings {
    let plan = SweepPlan {
        scenes: scenes.iter().map(|text| text.parse().unwrap()).collect(),
        bits: bits.to_vec(),
        pixels: vec![24],
        random_viewpoints: 0,
        rules: 4,
        seed: 1,
        most_records: 1_000_000,
    };
    sweep_of(subject, &plan, &Silent).unwrap()
}

/// The check that is meant for it finds each mutation, with a case.
#[test]
fn every_mutation_is_found_by_name() {
    for (mutation, expected) in [
        (Mutation::UlpInFrames, Check::Specification),
        (Mutation::UlpInCorners, Check::Specification),
        (Mutation::QuotientsUp, Check::Specification),
        (Mutation::OrderSwapped, Check::Order),
        (Mutation::NearSkipped, Check::Specification),
    ] {
        // Few records change to screen space where they may not: more scenes, until one has them.
        let mut scenes = SCENES.iter();
        let found = loop {
            let scene = scenes.next().expect("a scene that shows it");
            let found = sweep(&Mutant(mutation), &[scene], &[24]);
            if found.failures.contains_key(&expected) {
                break found;
            }
        };
        let first = found.failed.iter().find(|f| f.check == expected).unwrap();
        assert!(
            first.case.parse::<Case>().is_ok(),
            "{mutation:?}: {first:?}"
        );
    }
}
