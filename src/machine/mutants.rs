//! Machines with one injury each, for tests of the checks that must find
//! them. The loop is generic over its lattice, so the product knows nothing of this.

use hwmodel::{Datapath, NoProbe, Probe, Signal, Trap, Wires, Word};

use super::lattice::{Corners, Frame as FrameLattice, Lattice};
use super::vertices::{self, Held};
use super::walk;
use super::{Machine, MachineOptions};
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::lab::stress::subject::Subject;
use crate::project::{CageKind, EngineError, FrameSetup, Stats};

/// An injury of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Injury {
    /// One unit of the last place too much in one child's corner, frames alone.
    UlpInFrames,
    /// The same in one of the pool's vertices, corners alone.
    UlpInCorners,
    /// Edges halved down in place of towards zero.
    HalvesDown,
    /// Midpoints rounded up.
    MidpointsUp,
    /// Quotients rounded up.
    QuotientsUp,
    /// Two neighbours of the order array swapped.
    OrderSwapped,
    /// The order array backwards: farthest first.
    OrderReversed,
    /// No record is too near to be drawn, or to change to screen space at once.
    NearSkipped,
}

const ULP: u8 = 0;
const HALVES_DOWN: u8 = 1;
const MIDPOINTS_UP: u8 = 2;
const QUOTIENTS_UP: u8 = 3;

/// A lattice with an injury.
#[derive(Debug, Clone, Copy)]
struct Hurt<L, const INJURY: u8>(L);

impl<L: Wires, const INJURY: u8> Wires for Hurt<L, INJURY> {
    fn show(&self, to: &mut Vec<Signal>) {
        self.0.show(to);
    }
}

impl<L: Lattice, const INJURY: u8> Lattice for Hurt<L, INJURY> {
    type Pool = [L; 8];

    fn from_frame<P: Probe>(dp: &mut Datapath<P>, corner: Word, edges: [Word; 3]) -> Self {
        Self(L::from_frame(dp, corner, edges))
    }

    fn pool<P: Probe>(&self, dp: &mut Datapath<P>) -> [L; 8] {
        let one = Word::from_host(1);
        let mut children = self.0.children(dp);
        match INJURY {
            ULP => children[5] = children[5].moved(dp, one),
            HALVES_DOWN => {
                // What an odd negative edge loses by rounding down.
                let corner = self.0.vertices(dp)[0];
                let edges = self.0.edges(dp).map(|edge| dp.shr(edge, 1));
                let whole = L::from_frame(dp, corner, edges);
                let corners = whole.vertices(dp);
                children = corners.map(|corner| L::from_frame(dp, corner, edges));
            }
            MIDPOINTS_UP => {
                // -floor((-a - b) / 2) is the midpoint rounded up.
                let negative = self.0.map(|a| dp.neg(a));
                let halved = negative.children(dp);
                children = halved.map(|child| child.map(|a| dp.neg(a)));
            }
            _ => {}
        }
        children
    }

    fn child(pool: &[L; 8], octant: usize) -> Self {
        Self(pool[octant])
    }

    fn span<P: Probe>(&self, dp: &mut Datapath<P>) -> (Word, Word) {
        self.0.span(dp)
    }

    fn centre<P: Probe>(&self, dp: &mut Datapath<P>) -> Word {
        self.0.centre(dp)
    }

    fn vertices<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 8] {
        self.0.vertices(dp)
    }

    fn edges<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 3] {
        self.0.edges(dp)
    }

    fn map(&self, f: impl FnMut(Word) -> Word) -> Self {
        Self(self.0.map(f))
    }

    fn zip(&self, other: &Self, f: impl FnMut(Word, Word) -> Word) -> Self {
        Self(self.0.zip(&other.0, f))
    }

    fn moved<P: Probe>(&self, dp: &mut Datapath<P>, by: Word) -> Self {
        Self(self.0.moved(dp, by))
    }

    fn project<P: Probe>(
        dp: &mut Datapath<P>,
        x: &Self,
        w: &Self,
        mut divide: impl FnMut(&mut Datapath<P>, Word, Word) -> Word,
    ) -> Self {
        let one = Word::from_host(1);
        Self(L::project(dp, &x.0, &w.0, |dp, x, w| {
            let quotient = divide(dp, x, w);
            if INJURY == QUOTIENTS_UP {
                dp.add(quotient, one)
            } else {
                quotient
            }
        }))
    }
}

/// A machine with an injury.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mutant(pub(crate) Injury);

impl Mutant {
    /// The frame as the injured machine takes it.
    fn setup(&self, setup: &FrameSetup) -> FrameSetup {
        let mut setup = setup.clone();
        if self.0 == Injury::NearSkipped {
            // Nothing of the object lies so far behind the eye.
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

    fn draw_as<L: Lattice>(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        let mut options = MachineOptions::default();
        match self.0 {
            Injury::OrderSwapped => options.order.swap(1, 7),
            Injury::OrderReversed => options.order.reverse(),
            _ => {}
        }
        let setup = self.setup(setup);
        frame.clear();
        let mut fill = None;
        let fill = Machine::emptied(&mut fill, &setup);
        let drawn = walk::run::<_, L>(&options, graph, &setup, fill, frame, NoProbe, most_records)?;
        Ok(drawn.map(|(stats, _)| stats))
    }
}

impl Subject for Mutant {
    fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most: u64,
    ) -> Result<Option<Stats>, EngineError> {
        match (self.0, setup.options.cage) {
            (Injury::UlpInFrames, CageKind::Frame) => {
                self.draw_as::<Hurt<FrameLattice, ULP>>(graph, setup, frame, most)
            }
            (Injury::UlpInCorners, CageKind::Corners) => {
                self.draw_as::<Hurt<Corners, ULP>>(graph, setup, frame, most)
            }
            (Injury::HalvesDown, CageKind::Frame) => {
                self.draw_as::<Hurt<FrameLattice, HALVES_DOWN>>(graph, setup, frame, most)
            }
            (Injury::MidpointsUp, CageKind::Corners) => {
                self.draw_as::<Hurt<Corners, MIDPOINTS_UP>>(graph, setup, frame, most)
            }
            (Injury::QuotientsUp, CageKind::Frame) => {
                self.draw_as::<Hurt<FrameLattice, QUOTIENTS_UP>>(graph, setup, frame, most)
            }
            (_, CageKind::Corners) => self.draw_as::<Corners>(graph, setup, frame, most),
            (_, CageKind::Frame) => self.draw_as::<FrameLattice>(graph, setup, frame, most),
        }
    }

    fn follow(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Held>, Trap> {
        match (self.0, setup.options.cage) {
            (Injury::UlpInFrames, CageKind::Frame) => {
                vertices::follow_as::<Hurt<FrameLattice, ULP>>(setup, path)
            }
            (Injury::UlpInCorners, CageKind::Corners) => {
                vertices::follow_as::<Hurt<Corners, ULP>>(setup, path)
            }
            (Injury::HalvesDown, CageKind::Frame) => {
                vertices::follow_as::<Hurt<FrameLattice, HALVES_DOWN>>(setup, path)
            }
            (Injury::MidpointsUp, CageKind::Corners) => {
                vertices::follow_as::<Hurt<Corners, MIDPOINTS_UP>>(setup, path)
            }
            (Injury::QuotientsUp, CageKind::Frame) => {
                vertices::follow_as::<Hurt<FrameLattice, QUOTIENTS_UP>>(setup, path)
            }
            _ => vertices::follow(&self.setup(setup), path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Silent;
    use crate::lab::stress::sweep::sweep_of;
    use crate::lab::stress::{Check, Findings, Plan, Scene};

    const SCENES: [&str; 3] = ["gen:shell,depth=3", "gen:random,depth=3", "plane:4,3,5,7"];

    /// Small scenes, seen from all standard viewpoints.
    fn sweep(subject: &dyn Subject, scenes: &[&str], bits: &[u32]) -> Findings {
        let plan = Plan {
            scenes: scenes
                .iter()
                .map(|text| text.parse::<Scene>().unwrap())
                .collect(),
            bits: bits.to_vec(),
            pixels: vec![24],
            random_viewpoints: 0,
            rules: 4,
            seed: 1,
            most_records: 1_000_000,
            shrink_budget: 40,
        };
        sweep_of(subject, &plan, &Silent).unwrap()
    }

    #[test]
    fn the_machine_itself_keeps_all() {
        let found = sweep(&crate::lab::stress::subject::Product, &SCENES, &[24, 64]);
        assert_eq!(found.failures, Default::default(), "{:?}", found.failed);
        assert!(found.total().drawn > 500);
    }

    /// Every injury is found by the check that is meant for it, and what
    /// fails is shrunk to a case that fails still.
    #[test]
    fn every_injury_is_found_by_name() {
        for (injury, expected) in [
            (Injury::UlpInFrames, Check::Book),
            (Injury::UlpInCorners, Check::Book),
            (Injury::HalvesDown, Check::Book),
            (Injury::MidpointsUp, Check::Book),
            (Injury::QuotientsUp, Check::Book),
            (Injury::OrderSwapped, Check::Order),
            (Injury::OrderReversed, Check::Order),
            (Injury::NearSkipped, Check::Book),
        ] {
            // Few records change where they may not: more cases for that.
            let is_rare = injury == Injury::NearSkipped;
            let found = if is_rare {
                sweep(&Mutant(injury), &SCENES, &[24, 64])
            } else {
                sweep(&Mutant(injury), &SCENES[..1], &[24])
            };
            println!("{injury:?}: {:?}", found.failures);
            assert!(
                found.failures.contains_key(&expected),
                "{injury:?}: {:?}",
                found.failures
            );
            let first = found.failed.iter().find(|f| f.check == expected).unwrap();
            println!("  {:?}", first.minimal);
            assert!(first.minimal_detail.is_some(), "{injury:?}: {first:?}");
        }
    }
}
