//! Machines with one error each, which checks must find.

use hwmodel::{Datapath, NoProbe, Probe, Signal, Trap, Wires, Word};

use super::positions::{Cage, cages_as};
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::machine::cage::{CageCoordinate, CornerAndEdges, Corners, Linear};
use crate::machine::engine::Machine;
use crate::machine::state::MachineOptions;
use crate::project::{CageKind, EngineError, FrameSetup, Stats};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mutation {
    /// One unit of the last place too much in one child, only in cages of a corner and edges.
    UlpInFrames,
    /// The same, only in cages of corners.
    UlpInCorners,
    QuotientsUp,
    /// Two children in the wrong order.
    OrderSwapped,
    /// No record is too near to be drawn, or to change to screen space.
    NearSkipped,
}

const ULP: u8 = 0;
const QUOTIENTS_UP: u8 = 1;

/// A cage coordinate with a mutation.
#[derive(Debug, Clone, Copy)]
struct Mutated<L, const MUTATION: u8>(L);

impl<L: Wires, const MUTATION: u8> Wires for Mutated<L, MUTATION> {
    fn show(&self, to: &mut Vec<Signal>) {
        self.0.show(to);
    }
}

impl<L: CageCoordinate, const MUTATION: u8> Linear for Mutated<L, MUTATION> {
    fn map(&self, f: impl FnMut(Word) -> Word) -> Self {
        Self(self.0.map(f))
    }

    fn zip(&self, other: &Self, f: impl FnMut(Word, Word) -> Word) -> Self {
        Self(self.0.zip(&other.0, f))
    }
}

impl<L: CageCoordinate, const MUTATION: u8> CageCoordinate for Mutated<L, MUTATION> {
    type Pool = [L; 8];

    fn from_frame<P: Probe>(dp: &mut Datapath<P>, corner: Word, edges: [Word; 3]) -> Self {
        Self(L::from_frame(dp, corner, edges))
    }

    fn pool<P: Probe>(&self, dp: &mut Datapath<P>) -> [L; 8] {
        let mut children = L::all(&self.0.pool(dp));
        if MUTATION == ULP {
            children[5] = children[5].moved(dp, Word::from_host(1));
        }
        children
    }

    fn child(pool: &[L; 8], octant: usize) -> Self {
        Self(pool[octant])
    }

    type Seed = [L; 8];

    fn seed<P: Probe>(&self, dp: &mut Datapath<P>) -> [L; 8] {
        self.pool(dp)
    }

    fn grow<P: Probe>(_: &mut Datapath<P>, seed: &[L; 8], octant: usize) -> Self {
        Self(seed[octant])
    }

    fn of_parent<P: Probe>(&self, dp: &mut Datapath<P>, octant: u8) -> Self {
        Self(self.0.of_parent(dp, octant))
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
            if MUTATION == QUOTIENTS_UP {
                dp.add(quotient, one)
            } else {
                quotient
            }
        }))
    }
}

macro_rules! with_cage {
    ($mutation:expr, $setup:expr, $coordinate:ident => $body:expr) => {{
        macro_rules! with {
            ($of:ty) => {{
                type $coordinate = $of;
                $body
            }};
        }
        match ($mutation, $setup.options.cage) {
            (Mutation::UlpInFrames, CageKind::Frame) => with!(Mutated<CornerAndEdges, ULP>),
            (Mutation::UlpInCorners, CageKind::Corners) => with!(Mutated<Corners, ULP>),
            (Mutation::QuotientsUp, CageKind::Frame) => with!(Mutated<CornerAndEdges, QUOTIENTS_UP>),
            (_, CageKind::Corners) => with!(Corners),
            (_, CageKind::Frame) => with!(CornerAndEdges),
        }
    }};
}

#[derive(Debug, Clone, Copy)]
pub struct Mutant(pub Mutation);

impl Mutant {
    fn setup(&self, setup: &FrameSetup) -> FrameSetup {
        let mut setup = setup.clone();
        if self.0 == Mutation::NearSkipped {
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

    /// As [`Machine::render_within`].
    pub fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        let mut options = MachineOptions::default();
        if self.0 == Mutation::OrderSwapped {
            options.order.swap(1, 7);
        }
        let mut machine = Machine::new(options);
        let setup = &self.setup(setup);
        let drawn = with_cage!(self.0, setup, L => {
            machine.run_as::<_, L>(graph, setup, frame, NoProbe, most_records)?
        });
        Ok(drawn.map(|(stats, _)| stats))
    }

    /// As [`cages_along`](super::cages_along).
    pub fn cages_along(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
        let setup = &self.setup(setup);
        with_cage!(self.0, setup, L => cages_as::<L>(setup, path))
    }
}
