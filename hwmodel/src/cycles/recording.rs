//! The turns of a frame, recorded for other hardware. Valid where no turn's result depends on its time: where records
//! that share a part of the picture run one after the other.

use std::collections::HashMap;
use std::marker::PhantomData;
use std::ops::Range;

use super::hardware::Hardware;
use super::observe::NoObserver;
use super::report::CycleReport;
use super::simulate::{SimulationError, simulate};
use super::turn::{CLASSES, Child, STAGES, TurnLog, WIDTHS, Workload};
use crate::{Memory, OpClass, Operand, Probe, Stage, StageLevel};

/// A probe that contains a turn's log and is notified of its end.
pub trait TurnProbe: Probe {
    /// The log.
    fn turn_log(&mut self) -> &mut TurnLog;

    /// The turn of `item`, or of the start, ended with `children`.
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Tally {
    /// Its number.
    stage: u8,
    class: OpClass,
    bits: u8,
    times: u32,
}

#[derive(Debug, Clone, Copy)]
struct RecordedAccess {
    address: u32,
    memory: Memory,
    /// Its number.
    stage: u8,
    write: bool,
}

#[derive(Debug, Clone, Default)]
struct Turn {
    level: u32,
    visits: Range<u32>,
    accesses: Range<u32>,
    children: Range<u32>,
}

fn index(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

/// The turns of a frame.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// By number; 0 is the start.
    turns: Vec<Turn>,
    /// Operations of a stage, each distinct list once.
    visits: Vec<Range<u32>>,
    tallies: Vec<Tally>,
    visited: Vec<u32>,
    accesses: Vec<RecordedAccess>,
    /// Their items are numbers of turns.
    children: Vec<Child>,
    /// By number.
    stages: [Stage; STAGES],
}

impl Recording {
    fn bytes(&self) -> usize {
        size_of::<Turn>() * self.turns.len()
            + size_of::<Range<u32>>() * self.visits.len()
            // Once here and once in the map.
            + 2 * size_of::<Tally>() * self.tallies.len()
            + size_of::<u32>() * self.visited.len()
            + size_of::<RecordedAccess>() * self.accesses.len()
            + size_of::<Child>() * self.children.len()
    }

    /// Simulates the turns on hardware that is not [sequential](Hardware::sequential): the order of steps is not recorded.
    pub fn simulate<E>(&self, hardware: &Hardware) -> Result<CycleReport, SimulationError<E>> {
        hardware.check().map_err(SimulationError::Hardware)?;
        let mut replay = Replay {
            recording: self,
            log: TurnLog::new(hardware),
            error: PhantomData,
        };
        simulate(hardware, &mut replay, &mut NoObserver)
    }
}

/// A probe that records turns.
#[derive(Debug)]
pub struct Tape {
    times: Box<[[[u32; WIDTHS]; CLASSES]; STAGES]>,
    met: Vec<Tally>,
    known: HashMap<Box<[Tally]>, u32>,
    begun: u32,
    level: u32,
    numbers: Vec<u32>,
    recording: Recording,
    most_bytes: usize,
}

impl Tape {
    /// A tape for a recording of at most so many bytes.
    pub fn new(most_bytes: usize) -> Self {
        Self {
            times: Box::new([[[0; WIDTHS]; CLASSES]; STAGES]),
            met: Vec::new(),
            known: HashMap::new(),
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

    /// The recording; none if it was too long.
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
        for met in &mut self.met {
            let by_width = &mut self.times[usize::from(met.stage)][met.class as usize];
            met.times = std::mem::take(&mut by_width[usize::from(met.bits)]);
        }
        self.met.sort_unstable();
        let first_visit = recording.visited.len() as u32;
        for visit in self.met.chunk_by(|a, b| a.stage == b.stage) {
            let number = match self.known.get(visit) {
                Some(&number) => number,
                None => {
                    let number = recording.visits.len() as u32;
                    let first = recording.tallies.len() as u32;
                    recording.tallies.extend_from_slice(visit);
                    recording.visits.push(first..recording.tallies.len() as u32);
                    self.known.insert(visit.into(), number);
                    number
                }
            };
            recording.visited.push(number);
        }
        self.met.clear();
        let first_child = recording.children.len() as u32;
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
            visits: first_visit..recording.visited.len() as u32,
            accesses: self.begun..recording.accesses.len() as u32,
            children: first_child..recording.children.len() as u32,
        };
        self.begun = recording.accesses.len() as u32;
        if recording.bytes() > self.most_bytes {
            self.give_up();
        }
    }

    fn give_up(&mut self) {
        self.most_bytes = 0;
        self.recording = Recording::default();
        self.known = HashMap::new();
    }

    fn access(&mut self, memory: Memory, address: u64, stage: Stage, write: bool) {
        if !self.is_on() {
            return;
        }
        let Ok(address) = u32::try_from(address) else {
            return self.give_up();
        };
        self.recording.stages[stage.number()] = stage;
        self.recording.accesses.push(RecordedAccess {
            address,
            memory,
            stage: stage.number() as u8,
            write,
        });
    }
}

impl Probe for Tape {
    #[inline]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        if operand != Operand::Control {
            self.op(class, bits, place, 1);
        }
    }

    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        let bits = (bits as usize).min(WIDTHS - 1);
        let sum = &mut self.times[place.stage.number()][class as usize][bits];
        if *sum == 0 {
            self.recording.stages[place.stage.number()] = place.stage;
            self.met.push(Tally {
                stage: place.stage.number() as u8,
                class,
                bits: bits as u8,
                times: 0,
            });
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

struct Replay<'a, E> {
    recording: &'a Recording,
    log: TurnLog,
    error: PhantomData<E>,
}

impl<E> Replay<'_, E> {
    fn play(&mut self, turn: usize, children: &mut Vec<Child>) {
        let recording = self.recording;
        let turn = &recording.turns[turn];
        let place = |stage: u8| StageLevel {
            stage: recording.stages[usize::from(stage)],
            level: turn.level,
        };
        self.log.record(0, turn.level);
        for &visit in &recording.visited[index(&turn.visits)] {
            for tally in &recording.tallies[index(&recording.visits[visit as usize])] {
                let (bits, at) = (u32::from(tally.bits), place(tally.stage));
                self.log.op(tally.class, bits, at, tally.times);
            }
        }
        for access in &recording.accesses[index(&turn.accesses)] {
            let (address, at) = (u64::from(access.address), place(access.stage));
            match access.write {
                false => self.log.read(access.memory, address, at),
                true => self.log.write(access.memory, address, at),
            }
        }
        children.extend_from_slice(&recording.children[index(&turn.children)]);
    }
}

impl<E> Workload for Replay<'_, E> {
    type Error = E;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), E> {
        self.play(0, children);
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), E> {
        self.play(item as usize, children);
        Ok(())
    }

    fn log(&mut self) -> &mut TurnLog {
        &mut self.log
    }
}
