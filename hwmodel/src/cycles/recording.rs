//! What the turns of a frame did, kept to be simulated again on other hardware.
//!
//! That is sound where a record finds the same whenever its turn comes: where all that share a part
//! of the picture come one after the other. Else a turn depends on what hardware it is on,
//! and [`simulate`](super::simulate) must have the workload itself.

use std::ops::Range;

use super::hardware::Hardware;
use super::turn::{CLASSES, Child, STAGES, TurnLog, WIDTHS, Workload};
use crate::{Memory, OpClass, Probe, Stage, StageLevel, Trap};

/// A probe that is asked for the log of a turn, and told when it ends.
pub trait TurnProbe: Probe {
    /// The log.
    fn turn_log(&mut self) -> &mut TurnLog;

    /// The turn of `item`, or of the start, is over, and left `children`.
    fn ended(&mut self, item: Option<u32>, children: &[Child]);
}

impl TurnProbe for TurnLog {
    fn turn_log(&mut self) -> &mut TurnLog {
        self
    }

    fn ended(&mut self, _: Option<u32>, _: &[Child]) {}
}

impl TurnProbe for (TurnLog, Tape) {
    fn turn_log(&mut self) -> &mut TurnLog {
        &mut self.0
    }

    fn ended(&mut self, item: Option<u32>, children: &[Child]) {
        self.1.ended(item, children);
    }
}

/// Operations of a turn that are alike.
#[derive(Debug, Clone, Copy)]
struct Tally {
    stage: Stage,
    class: OpClass,
    bits: u8,
    times: u32,
}

#[derive(Debug, Clone, Copy)]
struct RecordedAccess {
    address: u64,
    memory: Memory,
    stage: Stage,
    write: bool,
}

/// Where a turn's parts lie.
#[derive(Debug, Clone, Default)]
struct Turn {
    level: u32,
    tallies: Range<usize>,
    accesses: Range<usize>,
    children: Range<usize>,
}

/// The turns of a frame.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// By number; 0 is the start.
    turns: Vec<Turn>,
    tallies: Vec<Tally>,
    accesses: Vec<RecordedAccess>,
    /// Their items are numbers of turns.
    children: Vec<Child>,
}

impl Recording {
    /// Bytes of memory that it takes, about.
    fn bytes(&self) -> usize {
        size_of::<Turn>() * self.turns.len()
            + size_of::<Tally>() * self.tallies.len()
            + size_of::<RecordedAccess>() * self.accesses.len()
            + size_of::<Child>() * self.children.len()
    }

    /// The recorded turns as a workload, for a hardware that [`Hardware::check`] finds sound.
    #[must_use]
    pub fn replay(&self, hardware: &Hardware) -> Replay<'_> {
        Replay {
            recording: self,
            log: TurnLog::new(hardware),
        }
    }
}

/// A probe that records turns.
#[derive(Debug)]
pub struct Tape {
    /// How often, in this turn; by stage, class and width.
    times: Box<[[[u32; WIDTHS]; CLASSES]; STAGES]>,
    met: Vec<(Stage, OpClass, u8)>,
    /// Where this turn's accesses begin.
    begun: usize,
    level: u32,
    /// The turn of each of the workload's items.
    numbers: Vec<u32>,
    recording: Recording,
    most_bytes: usize,
}

impl Tape {
    /// An empty tape, for a recording of so many bytes at most.
    #[must_use]
    pub fn new(most_bytes: usize) -> Self {
        Self {
            times: Box::new([[[0; WIDTHS]; CLASSES]; STAGES]),
            met: Vec::new(),
            begun: 0,
            level: 0,
            numbers: Vec::new(),
            recording: Recording {
                turns: vec![Turn::default()],
                ..Recording::default()
            },
            most_bytes,
        }
    }

    /// What was recorded; none where it would have been too long.
    #[must_use]
    pub fn finish(self) -> Option<Recording> {
        self.is_on().then_some(self.recording)
    }

    fn is_on(&self) -> bool {
        self.most_bytes > 0
    }

    fn ended(&mut self, item: Option<u32>, children: &[Child]) {
        if !self.is_on() {
            return;
        }
        let recording = &mut self.recording;
        let number = item.map_or(0, |item| self.numbers[item as usize] as usize);
        let tallies = recording.tallies.len();
        for (stage, class, bits) in self.met.drain(..) {
            let times = &mut self.times[stage as usize][class as usize][usize::from(bits)];
            recording.tallies.push(Tally {
                stage,
                class,
                bits,
                times: std::mem::take(times),
            });
        }
        let first_child = recording.children.len();
        for child in children {
            let turn = recording.turns.len() as u32;
            recording.turns.push(Turn::default());
            let at = child.item as usize;
            if self.numbers.len() <= at {
                self.numbers.resize(at + 1, 0);
            }
            self.numbers[at] = turn;
            recording.children.push(Child {
                item: turn,
                ..*child
            });
        }
        recording.turns[number] = Turn {
            level: self.level,
            tallies: tallies..recording.tallies.len(),
            accesses: self.begun..recording.accesses.len(),
            children: first_child..recording.children.len(),
        };
        self.begun = recording.accesses.len();
        if recording.bytes() > self.most_bytes {
            self.most_bytes = 0;
            self.recording = Recording::default();
        }
    }

    fn access(&mut self, memory: Memory, address: u64, stage: Stage, write: bool) {
        if self.is_on() {
            self.recording.accesses.push(RecordedAccess {
                address,
                memory,
                stage,
                write,
            });
        }
    }
}

impl Probe for Tape {
    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        // As `TurnLog` has it.
        let bits = (bits as usize).min(WIDTHS - 1);
        let sum = &mut self.times[place.stage as usize][class as usize][bits];
        if *sum == 0 {
            self.met.push((place.stage, class, bits as u8));
        }
        *sum += times;
    }

    fn record(&mut self, _: u64, level: u32) {
        self.level = level;
    }

    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.access(memory, address, place.stage, false);
    }

    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.access(memory, address, place.stage, true);
    }
}

/// Recorded turns as a workload.
#[derive(Debug)]
pub struct Replay<'a> {
    recording: &'a Recording,
    log: TurnLog,
}

impl Replay<'_> {
    fn play(&mut self, turn: usize, children: &mut Vec<Child>) {
        let recording = self.recording;
        let turn = &recording.turns[turn];
        let place = |stage| StageLevel {
            stage,
            level: turn.level,
        };
        self.log.record(0, turn.level);
        for tally in &recording.tallies[turn.tallies.clone()] {
            let bits = u32::from(tally.bits);
            self.log
                .op(tally.class, bits, place(tally.stage), tally.times);
        }
        for access in &recording.accesses[turn.accesses.clone()] {
            let at = place(access.stage);
            match access.write {
                false => self.log.read(access.memory, access.address, at),
                true => self.log.write(access.memory, access.address, at),
            }
        }
        children.extend_from_slice(&recording.children[turn.children.clone()]);
    }
}

impl Workload for Replay<'_> {
    type Error = Trap;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Trap> {
        self.play(0, children);
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Trap> {
        self.play(item as usize, children);
        Ok(())
    }

    fn log(&mut self) -> &mut TurnLog {
        &mut self.log
    }
}
