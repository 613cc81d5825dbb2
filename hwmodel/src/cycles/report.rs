//! The report of a simulation.

use serde::{Serialize, Serializer};

use super::hardware::Independence;
use super::outer::RowReport;
use crate::{OpClass, Stage};

/// Version of the report's fields.
pub const REPORT_VERSION: u32 = 1;

named! {
    /// Why a record waited.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "snake_case")]
    #[repr(u8)]
    pub enum Cause {
        /// Another record in the stage's block.
        BlockBusy = "block busy",
        /// A port of the stack or of a cache.
        MemoryPort = "memory port",
        /// A bank of the fill vectors.
        BankConflict = "bank conflict",
        /// Its own, or one in flight.
        CacheMiss = "cache miss",
        PixelPort = "pixel port",
        /// Being read back from outer memory.
        StackSpill = "stack spill",
        /// Being taken from another lane.
        Steal = "steal",
    }
}

/// Cycles by cause, summed over records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stalls([u64; Cause::ALL.len()]);

impl Stalls {
    /// Cycles of one cause.
    pub fn of(&self, cause: Cause) -> u64 {
        self.0[cause as usize]
    }

    /// Cycles of all causes.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    #[inline]
    pub(super) fn add(&mut self, cause: Cause, cycles: u64) {
        self.0[cause as usize] += cycles;
    }
}

impl Serialize for Stalls {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(Cause::ALL.map(|cause| (cause, self.of(cause))))
    }
}

/// One stage, over all lanes.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct StageReport {
    pub stage: Stage,
    pub visits: u64,
    /// With those that are wires.
    pub operations: u64,
    /// Through units.
    pub passes: u64,
    /// Most passes of one visit by class: the most units that can be used.
    pub most_passes: [u64; OpClass::ALL.len()],
    /// Cycles in which blocks issued operations.
    pub busy: u64,
    /// Additional cycles in which blocks waited to issue accesses.
    pub held: u64,
    /// `busy + held` divided by cycles and lanes, 0 to 1.
    pub utilisation: f64,
    /// Cycles of its records without waiting.
    pub alone: u64,
    /// Additional cycles of its records.
    pub stalls: Stalls,
}

/// Cycles of the contexts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ContextReport {
    /// With a record that did not wait.
    pub working: u64,
    /// With a record that waited in a stage.
    pub stalled: u64,
    /// Without a record, while all remaining records had to wait for others.
    pub order_wait: u64,
    /// Without a record, while all remaining records were in progress.
    pub no_record: u64,
}

/// A cache.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct CacheReport {
    pub accesses: u64,
    pub misses: u64,
    /// Accesses to lines in flight.
    pub delayed_hits: u64,
    /// `1 - misses / accesses`; 1 without accesses.
    pub hit_rate: f64,
    pub bytes_in: u64,
}

/// Stacks, and the order's table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct StackReport {
    /// Most records on one lane's stack.
    pub deepest: u64,
    /// Most records on all stacks and in all contexts.
    pub most_live: u64,
    /// Most records at once that had their turn and have unfinished descendants: entries of the order's table.
    pub most_open: u64,
    /// Records that found no entry.
    pub spilled: u64,
    /// Their bits, written once and read once.
    pub spilled_bits: u64,
    /// Records taken from another lane.
    pub stolen: u64,
}

/// A lower bound of the frame's cycles, set by a resource.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Bound {
    pub resource: String,
    pub cycles: u64,
    /// `cycles` divided by the frame's, 0 to 1.
    pub share: f64,
}

/// The limit of the frame.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Bottleneck {
    /// A bound's `resource`, `latency`, `order` or `records`.
    pub resource: String,
    /// Share of the cycles, 0 to 1, for which it was busy.
    pub share: f64,
    /// The same in words, with a remedy.
    pub sentence: String,
}

/// The result of a simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct CycleReport {
    pub version: u32,
    pub hardware: String,
    pub lanes: u32,
    pub contexts: u32,
    pub independence: Independence,
    pub clock_mhz: f64,
    /// Until the last pixel has left.
    pub cycles: u64,
    pub records: u64,
    pub pixels: u64,
    pub cycles_per_record: f64,
    /// 0 without pixels.
    pub cycles_per_pixel: f64,
    pub frames_per_second: f64,
    /// Cycles of all turns without waiting.
    pub work: u64,
    /// Cycles of the longest chain of dependent turns without other waiting.
    pub span: u64,
    pub parallelism: f64,
    /// Upper bound: cycles of all turns one after the other with their longest waits.
    pub serial: u64,
    pub stages: Vec<StageReport>,
    pub context_cycles: ContextReport,
    pub node_cache: CacheReport,
    /// Of all lanes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node_buffer: Option<CacheReport>,
    pub attribute_cache: CacheReport,
    pub fill_reads: u64,
    pub fill_writes: u64,
    /// Cycles in which the port to outer memory was taken.
    pub outer_busy: u64,
    /// With banks of outer memory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outer_rows: Option<RowReport>,
    pub stack: StackReport,
    /// Tightest first.
    pub bounds: Vec<Bound>,
    pub bottleneck: Bottleneck,
}

/// Share of the cycles from which a resource counts as the limit.
const LIMITING: f64 = 0.75;

impl CycleReport {
    pub(super) fn conclude(&mut self, bounds: Vec<(String, u64)>) {
        let cycles = self.cycles.max(1) as f64;
        let bound = |(resource, bound)| Bound {
            resource,
            cycles: bound,
            share: bound as f64 / cycles,
        };
        self.bounds = bounds.into_iter().map(bound).collect();
        // Stable: equal ones keep their order.
        self.bounds
            .sort_by_key(|bound| std::cmp::Reverse(bound.cycles));
        self.bottleneck = self.find_bottleneck(cycles);
    }

    fn find_bottleneck(&self, cycles: f64) -> Bottleneck {
        let contexts = f64::from(self.lanes) * f64::from(self.contexts);
        let of = |part: u64| part as f64 / (cycles * contexts);
        let ContextReport {
            working,
            stalled,
            order_wait,
            no_record,
        } = self.context_cycles;
        let in_progress = of(working + stalled);
        let tightest = self.bounds.first().filter(|bound| bound.share >= LIMITING);
        let (resource, share) = match tightest {
            Some(bound) => (bound.resource.as_str(), bound.share),
            None if in_progress >= LIMITING => ("latency", in_progress),
            None if order_wait >= no_record => ("order", of(order_wait)),
            None => ("records", of(no_record)),
        };
        let percent = share * 100.0;
        let could = format!(
            "this frame could keep {:.1} contexts busy, the hardware has {contexts}",
            self.parallelism
        );
        let sentence = match resource {
            SPAN => format!(
                "the longest chain of records that wait for each other takes {percent:.0} % of the time: more lanes \
                 or contexts cannot help, shorter latencies would"
            ),
            "latency" => {
                let stall = |cause: Cause| -> u64 {
                    self.stages.iter().map(|stage| stage.stalls.of(cause)).sum()
                };
                // Of equal ones the first.
                let causes = Cause::ALL.into_iter().rev();
                let worst = causes.max_by_key(|&cause| stall(cause));
                let worst = worst.filter(|&cause| stall(cause) > 0);
                let waits = worst.map_or_else(String::new, |cause| {
                    format!(
                        "; records wait {:.0} % of it, most of all for: {}",
                        of(stall(cause)) * 100.0,
                        cause.name()
                    )
                });
                format!(
                    "no unit is busy enough to limit, but every context has a record {percent:.0} % of the time: \
                     latencies limit, more contexts per lane would help{waits}"
                )
            }
            "order" => format!(
                "contexts are idle {percent:.0} % of the time because the records left wait for earlier ones; {could}"
            ),
            "records" => format!(
                "contexts are idle {percent:.0} % of the time because there are no records left but those under way; \
                 {could}"
            ),
            unit => {
                format!("the {unit} is busy {percent:.0} % of the time: widen it, or do less there")
            }
        };
        Bottleneck {
            resource: resource.to_owned(),
            share,
            sentence,
        }
    }
}

pub(super) const OUTER_PORT: &str = "outer memory port";
pub(super) const SPAN: &str = "longest chain";
