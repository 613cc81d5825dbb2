//! The trace of a simulation's beginning, as Chrome/Perfetto trace events.

use std::io::{self, Write};

use super::hardware::Hardware;
use super::observe::{Observer, START, VisitSpan};

/// Keeps the visits of the start and of the first records, about 80 bytes each.
#[derive(Debug, Default)]
pub struct Recorder {
    records: u64,
    visits: Vec<VisitSpan>,
    /// Cycle, lane, stored and ready records.
    queues: Vec<(u64, u32, u32, u32)>,
    end: u64,
}

impl Recorder {
    /// A recorder of the first `records` records.
    pub fn new(records: u64) -> Self {
        Self {
            records,
            ..Self::default()
        }
    }

    /// The recorded visits, in the order in which they began.
    pub fn visits(&self) -> &[VisitSpan] {
        &self.visits
    }

    /// Writes trace events (JSON) for Perfetto or `chrome://tracing`: lanes are processes, contexts are threads, one
    /// microsecond is one cycle.
    pub fn write_chrome(&self, hardware: &Hardware, mut to: impl Write) -> io::Result<()> {
        let clock = hardware.clock_mhz;
        write!(
            to,
            "{{\"otherData\":{{\"unit\":\"1 us is 1 cycle\",\"clock_mhz\":\"{clock}\"}},\n\"traceEvents\":["
        )?;
        let mut comma = "";
        let mut event = |kind: char, name: &str, lane: u32, rest: &str| {
            write!(to, "{comma}\n{{\"ph\":\"{kind}\",\"name\":\"{name}\",")?;
            comma = ",";
            write!(to, "\"pid\":{lane},{rest}}}")
        };
        for lane in 0..hardware.lanes {
            let name = format!("\"args\":{{\"name\":\"lane {lane}\"}}");
            event('M', "process_name", lane, &name)?;
            for context in 0..hardware.contexts {
                let name = format!("\"tid\":{context},\"args\":{{\"name\":\"context {context}\"}}");
                event('M', "thread_name", lane, &name)?;
            }
        }
        for visit in &self.visits {
            let name = visit.stage.name();
            let span = |category: &str, begins: u64, ends: u64| {
                let (context, cycles) = (visit.context, ends - begins);
                format!("\"cat\":\"{category}\",\"tid\":{context},\"ts\":{begins},\"dur\":{cycles}")
            };
            if visit.begins > visit.arrives {
                let wait = span("wait", visit.arrives, visit.begins);
                event('X', &format!("wait for {name}"), visit.lane, &wait)?;
            }
            let record = match visit.record {
                START => "\"start\"".to_owned(),
                number => number.to_string(),
            };
            let stall = visit.stall.map_or_else(String::new, |(cause, cycles)| {
                format!(",\"stall\":\"{}\",\"stall_cycles\":{cycles}", cause.name())
            });
            let span = span("stage", visit.begins, visit.ends);
            let rest = format!("{span},\"args\":{{\"record\":{record}{stall}}}");
            event('X', name, visit.lane, &rest)?;
        }
        let begin = self.visits.first().map_or(0, |visit| visit.arrives);
        for &(cycle, lane, stored, ready) in &self.queues {
            if (begin..=self.end).contains(&cycle) {
                let waiting = stored - ready;
                let rest =
                    format!("\"ts\":{cycle},\"args\":{{\"ready\":{ready},\"waiting\":{waiting}}}");
                event('C', "stack", lane, &rest)?;
            }
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
            self.queues.push((cycle, lane, stored, ready));
        }
    }
}
