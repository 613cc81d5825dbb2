//! The trace of a simulation's beginning, as Chrome/Perfetto trace events.

use std::io::{self, Write};

use super::hardware::Hardware;
use super::observe::{Observer, START, VisitSpan};

#[derive(Debug, Clone, Copy)]
struct Queue {
    cycle: u64,
    lane: u32,
    stored: u32,
    ready: u32,
}

/// Keeps the visits of the start and of the first records, about 80 bytes each.
#[derive(Debug)]
pub struct Recorder {
    records: u64,
    visits: Vec<VisitSpan>,
    queues: Vec<Queue>,
    end: u64,
}

impl Recorder {
    /// A recorder of the first `records` records.
    pub fn new(records: u64) -> Self {
        Self {
            records,
            visits: Vec::new(),
            queues: Vec::new(),
            end: 0,
        }
    }

    /// The recorded visits, in the order in which they began.
    pub fn visits(&self) -> &[VisitSpan] {
        &self.visits
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
            let record = match visit.record {
                START => "\"start\"".to_owned(),
                number => number.to_string(),
            };
            let stall = visit.stall.map_or_else(String::new, |(cause, cycles)| {
                format!(",\"stall\":\"{}\",\"stall_cycles\":{cycles}", cause.name())
            });
            write!(
                to,
                ",\n{{\"ph\":\"X\",\"name\":\"{name}\",\"cat\":\"stage\",\"pid\":{lane},\"tid\":{context},\"ts\":{},\"dur\":{},\"args\":{{\"record\":{record}{stall}}}}}",
                visit.begins,
                visit.ends - visit.begins
            )?;
        }
        let begin = self.visits.first().map_or(0, |visit| visit.arrives);
        let is_shown = |queue: &&Queue| (begin..=self.end).contains(&queue.cycle);
        for queue in self.queues.iter().filter(is_shown) {
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
}

impl Observer for Recorder {
    fn watches_visits(&self) -> bool {
        true
    }

    fn visit(&mut self, span: &VisitSpan) {
        if span.record == START || span.record < self.records {
            self.end = self.end.max(span.ends);
            self.visits.push(*span);
        }
    }

    fn queue(&mut self, cycle: u64, lane: u32, stored: u32, ready: u32) {
        if self.queues.len() <= 4 * self.visits.len() {
            self.queues.push(Queue {
                cycle,
                lane,
                stored,
                ready,
            });
        }
    }
}
