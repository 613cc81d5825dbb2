//! The checks find machines that are known to be wrong.

use hwmodel::Trap;

use super::subject::Subject;
use super::sweep::sweep_of;
use super::{Case, Check, Findings, SweepPlan};
use shiftvox::frame::Frame;
use shiftvox::graph::{GraphView, Silent};
use shiftvox::machine::{Cage, Coordinates, Machine, MachineOptions, cages_along};
use shiftvox::project::{EngineError, FrameSetup, Stats};

/// A machine with one error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mutant {
    /// One unit of the last place too much in one vertex of one child.
    UlpInChild,
    QuotientsUp,
    /// Two children in the wrong order.
    OrderSwapped,
    /// No record is too near to be drawn, or to change to screen space.
    NearSkipped,
}

impl Mutant {
    fn setup(self, setup: &FrameSetup) -> FrameSetup {
        let mut setup = setup.clone();
        if self == Self::NearSkipped {
            // The whole object lies before this.
            let reach = setup.position_reach().unwrap_or(i128::MAX);
            let behind_all = i64::try_from(-reach).unwrap_or(i64::MIN);
            for depth in &mut setup.screen_depth {
                if *depth == setup.near {
                    *depth = behind_all;
                }
            }
            setup.near = behind_all;
        }
        setup
    }
}

impl Subject for Mutant {
    fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        let mut options = MachineOptions::default();
        if *self == Self::OrderSwapped {
            options.order.swap(1, 7);
        }
        Machine::new(options).render_within(graph, &self.setup(setup), frame, most_records)
    }

    fn cages_along(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
        let mut cages = cages_along(&self.setup(setup), path)?;
        for (cage, octant) in cages.iter_mut().skip(1).zip(path) {
            match (self, cage) {
                (Self::UlpInChild, Coordinates::Clip([x, ..]) | Coordinates::Screen([x, _])) => {
                    x[0] += i64::from(*octant == 5);
                }
                (Self::QuotientsUp, Coordinates::Screen(all)) => {
                    all.as_flattened_mut().iter_mut().for_each(|at| *at += 1);
                }
                _ => {}
            }
        }
        Ok(cages)
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

/// The check that is meant for it finds each mutant, with a case.
#[test]
fn every_mutant_is_found_by_name() {
    for (mutant, expected) in [
        (Mutant::UlpInChild, Check::Specification),
        (Mutant::QuotientsUp, Check::Specification),
        (Mutant::OrderSwapped, Check::Order),
        (Mutant::NearSkipped, Check::Specification),
    ] {
        // Few records change to screen space where they may not: more scenes, until one has them.
        let mut scenes = SCENES.iter();
        let found = loop {
            let scene = scenes.next().expect("a scene that shows it");
            let found = sweep(&mutant, &[scene], &[24]);
            if found.failures.contains_key(&expected) {
                break found;
            }
        };
        let first = found.failed.iter().find(|f| f.check == expected).unwrap();
        assert!(first.case.parse::<Case>().is_ok(), "{mutant:?}: {first:?}");
    }
}
