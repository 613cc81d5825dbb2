//! Traces of a simulation's beginning: Chrome/Perfetto trace events, and VCD.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;

use super::hardware::Hardware;
use super::observe::{Observer, START, VisitSpan};
use crate::Stage;

/// The traced part of a simulation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TraceLimit {
    /// Only records below this number, and the start.
    pub records: u64,
    /// Only visits that begin in these cycles.
    pub cycles: Range<u64>,
}

impl Default for TraceLimit {
    /// The first 10,000 records.
    fn default() -> Self {
        Self {
            records: 10_000,
            cycles: 0..u64::MAX,
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Queue {
    cycle: u64,
    lane: u32,
    stored: u32,
    ready: u32,
}

/// Keeps visits for a trace, about 80 bytes each.
#[derive(Debug)]
pub struct Recorder {
    limit: TraceLimit,
    visits: Vec<VisitSpan>,
    queues: Vec<Queue>,
    /// Last cycle of any visit kept.
    end: u64,
}

impl Recorder {
    /// An empty recorder.
    pub fn new(limit: TraceLimit) -> Self {
        Self {
            limit,
            visits: Vec::new(),
            queues: Vec::new(),
            end: 0,
        }
    }

    /// The recorded visits, in the order in which they began.
    pub fn visits(&self) -> &[VisitSpan] {
        &self.visits
    }

    /// Stacks from the first to the last recorded visit.
    fn queues(&self) -> impl Iterator<Item = &Queue> {
        let begin = self.visits.first().map_or(0, |visit| visit.arrives);
        self.queues
            .iter()
            .filter(move |queue| (begin..=self.end).contains(&queue.cycle))
    }

    /// Writes trace events (JSON) for Perfetto or `chrome://tracing`: lanes are processes, contexts are threads, one
    /// microsecond is one cycle.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write_chrome(&self, hardware: &Hardware, mut to: impl Write) -> io::Result<()> {
        write!(
            to,
            "{{\"otherData\":{{\"unit\":\"1 us is 1 cycle\",\"clock_mhz\":\"{}\"}},\n\"traceEvents\":[",
            hardware.clock_mhz
        )?;
        let mut comma = "";
        for lane in 0..hardware.lanes {
            write!(
                to,
                "{comma}\n{{\"ph\":\"M\",\"name\":\"process_name\",\"pid\":{lane},\"args\":{{\"name\":\"lane {lane}\"}}}}"
            )?;
            comma = ",";
            for context in 0..hardware.contexts {
                write!(
                    to,
                    ",\n{{\"ph\":\"M\",\"name\":\"thread_name\",\"pid\":{lane},\"tid\":{context},\"args\":{{\"name\":\"context {context}\"}}}}"
                )?;
            }
        }
        for visit in &self.visits {
            let VisitSpan { lane, context, .. } = *visit;
            let name = visit.stage.name();
            if visit.begins > visit.arrives {
                write!(
                    to,
                    ",\n{{\"ph\":\"X\",\"name\":\"wait for {name}\",\"cat\":\"wait\",\"pid\":{lane},\"tid\":{context},\"ts\":{},\"dur\":{}}}",
                    visit.arrives,
                    visit.begins - visit.arrives
                )?;
            }
            write!(
                to,
                ",\n{{\"ph\":\"X\",\"name\":\"{name}\",\"cat\":\"stage\",\"pid\":{lane},\"tid\":{context},\"ts\":{},\"dur\":{},\"args\":{{",
                visit.begins,
                visit.ends - visit.begins
            )?;
            if visit.record == START {
                write!(to, "\"record\":\"start\"")?;
            } else {
                write!(to, "\"record\":{}", visit.record)?;
            }
            if let Some((cause, cycles)) = visit.stall {
                write!(
                    to,
                    ",\"stall\":\"{}\",\"stall_cycles\":{cycles}",
                    cause.name()
                )?;
            }
            write!(to, "}}}}")?;
        }
        for queue in self.queues() {
            write!(
                to,
                ",\n{{\"ph\":\"C\",\"name\":\"stack\",\"pid\":{},\"ts\":{},\"args\":{{\"ready\":{},\"waiting\":{}}}}}",
                queue.lane,
                queue.cycle,
                queue.ready,
                queue.stored - queue.ready
            )?;
        }
        writeln!(to, "\n]}}")
    }

    /// Writes a value change dump (IEEE 1364) for GTKWave or Surfer: per lane the records on its stack and the issuing
    /// blocks, per context its stage, record, and whether it waits. One nanosecond is one cycle.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write_vcd(&self, hardware: &Hardware, mut to: impl Write) -> io::Result<()> {
        let wires = Wires {
            contexts: hardware.contexts,
        };
        writeln!(
            to,
            "$comment {} : 1 ns is 1 cycle $end",
            hardware.name.replace('$', "")
        )?;
        let codes = Stage::ALL.map(|stage| format!("{}={}", stage as u32, word(stage)));
        writeln!(to, "$comment stages: {} {IDLE}=idle $end", codes.join(" "))?;
        writeln!(to, "$timescale 1 ns $end\n$scope module hardware $end")?;
        for lane in 0..hardware.lanes {
            writeln!(to, "$scope module lane{lane} $end")?;
            let mut wire = |name: &str, number: u32, bits: u32| {
                let id = id(number);
                writeln!(to, "$var wire {bits} {id} {name} $end")
            };
            wire("stored", wires.stored(lane), 32)?;
            wire("ready", wires.ready(lane), 32)?;
            for stage in Stage::ALL {
                wire(
                    &format!("issues_{}", word(stage)),
                    wires.issues(lane, stage),
                    1,
                )?;
            }
            for context in 0..hardware.contexts {
                let [stage, waits, record] = wires.context(lane, context);
                wire(&format!("context{context}_stage"), stage, 4)?;
                wire(&format!("context{context}_waits"), waits, 1)?;
                wire(&format!("context{context}_record"), record, 64)?;
            }
            writeln!(to, "$upscope $end")?;
        }
        writeln!(to, "$upscope $end\n$enddefinitions $end")?;
        self.write_changes(hardware, wires, to)
    }

    fn write_changes(
        &self,
        hardware: &Hardware,
        wires: Wires,
        mut to: impl Write,
    ) -> io::Result<()> {
        // By cycle and wire, the last value set; ends are inserted first.
        let mut changes: BTreeMap<(u64, u32), (u32, u64)> = BTreeMap::new();
        for visit in &self.visits {
            let [stage, ..] = wires.context(visit.lane, visit.context);
            let issues = wires.issues(visit.lane, visit.stage);
            changes.insert((visit.ends, stage), (4, IDLE));
            changes.insert((visit.frees, issues), (1, 0));
        }
        for visit in &self.visits {
            let [stage, waits, record] = wires.context(visit.lane, visit.context);
            let issues = wires.issues(visit.lane, visit.stage);
            changes.insert((visit.arrives, stage), (4, visit.stage as u64));
            changes.insert((visit.arrives, record), (64, visit.record));
            changes.insert((visit.begins, waits), (1, 0));
            changes.insert((visit.begins, issues), (1, 1));
        }
        for visit in self
            .visits
            .iter()
            .filter(|visit| visit.begins > visit.arrives)
        {
            let [_, waits, _] = wires.context(visit.lane, visit.context);
            changes.insert((visit.arrives, waits), (1, 1));
        }
        for queue in self.queues() {
            let stored = u64::from(queue.stored);
            let ready = u64::from(queue.ready);
            changes.insert((queue.cycle, wires.stored(queue.lane)), (32, stored));
            changes.insert((queue.cycle, wires.ready(queue.lane)), (32, ready));
        }
        let mut values = vec![0; wires.count(hardware.lanes) as usize];
        writeln!(to, "$dumpvars")?;
        for lane in 0..hardware.lanes {
            write_value(&mut to, wires.stored(lane), 32, 0)?;
            write_value(&mut to, wires.ready(lane), 32, 0)?;
            for stage in Stage::ALL {
                write_value(&mut to, wires.issues(lane, stage), 1, 0)?;
            }
            for context in 0..hardware.contexts {
                let [stage, waits, record] = wires.context(lane, context);
                values[stage as usize] = IDLE;
                write_value(&mut to, stage, 4, IDLE)?;
                write_value(&mut to, waits, 1, 0)?;
                write_value(&mut to, record, 64, 0)?;
            }
        }
        writeln!(to, "$end")?;
        let mut written = None;
        for ((cycle, wire), (bits, value)) in changes {
            if std::mem::replace(&mut values[wire as usize], value) == value {
                continue;
            }
            if written != Some(cycle) {
                writeln!(to, "#{cycle}")?;
                written = Some(cycle);
            }
            write_value(&mut to, wire, bits, value)?;
        }
        Ok(())
    }
}

impl Observer for Recorder {
    fn visit(&mut self, span: &VisitSpan) {
        let wanted = span.record == START || span.record < self.limit.records;
        if wanted && self.limit.cycles.contains(&span.begins) {
            self.end = self.end.max(span.ends);
            self.visits.push(*span);
        }
    }

    fn queue(&mut self, cycle: u64, lane: u32, stored: u32, ready: u32) {
        // Queues after the last visit are not shown.
        if self.limit.cycles.contains(&cycle) && self.queues.len() <= 4 * self.visits.len() {
            self.queues.push(Queue {
                cycle,
                lane,
                stored,
                ready,
            });
        }
    }
}

/// A context's stage while it has no record.
const IDLE: u64 = 15;

/// Wire numbers of a dump.
#[derive(Debug, Clone, Copy)]
struct Wires {
    contexts: u32,
}

impl Wires {
    const STAGES: u32 = Stage::ALL.len() as u32;

    fn count(self, lanes: u32) -> u32 {
        lanes * (2 + Self::STAGES + 3 * self.contexts)
    }

    fn stored(self, lane: u32) -> u32 {
        self.count(lane)
    }

    fn ready(self, lane: u32) -> u32 {
        self.stored(lane) + 1
    }

    fn issues(self, lane: u32, stage: Stage) -> u32 {
        self.stored(lane) + 2 + stage as u32
    }

    fn context(self, lane: u32, context: u32) -> [u32; 3] {
        let first = self.stored(lane) + 2 + Self::STAGES + 3 * context;
        [first, first + 1, first + 2]
    }
}

/// A wire's short name in a dump: digits of base 94.
fn id(mut number: u32) -> String {
    let mut id = String::new();
    loop {
        id.push((b'!' + (number % 94) as u8) as char);
        number /= 94;
        if number == 0 {
            return id;
        }
    }
}

fn word(stage: Stage) -> String {
    let letters = stage.name().chars().filter(|&letter| letter != '?');
    letters
        .map(|letter| if letter == ' ' { '_' } else { letter })
        .collect()
}

fn write_value(to: &mut impl Write, wire: u32, bits: u32, value: u64) -> io::Result<()> {
    let id = id(wire);
    if bits == 1 {
        writeln!(to, "{value}{id}")
    } else {
        writeln!(to, "b{value:b} {id}")
    }
}
