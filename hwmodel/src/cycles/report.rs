//! What a simulation came to.

use serde::Serialize;

use super::hardware::Independence;
use crate::{OpClass, Stage};

/// Version of the report's fields.
pub const REPORT_VERSION: u32 = 1;

/// What a record waited for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Cause {
    /// Another record in the stage's block.
    BlockBusy,
    /// A port of the stack or of a cache.
    MemoryPort,
    /// A bank of the fill vectors.
    BankConflict,
    /// A cache miss, its own or one under way.
    CacheMiss,
    /// The way out for pixels.
    PixelPort,
    /// Being read back from outer memory.
    StackSpill,
    /// Being taken from another lane.
    Steal,
}

impl Cause {
    /// All causes, in the order of their discriminants.
    pub const ALL: [Self; 7] = [
        Self::BlockBusy,
        Self::MemoryPort,
        Self::BankConflict,
        Self::CacheMiss,
        Self::PixelPort,
        Self::StackSpill,
        Self::Steal,
    ];

    /// The cause in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::BlockBusy => "block busy",
            Self::MemoryPort => "memory port",
            Self::BankConflict => "bank conflict",
            Self::CacheMiss => "cache miss",
            Self::PixelPort => "pixel port",
            Self::StackSpill => "stack spill",
            Self::Steal => "steal",
        }
    }
}

/// Cycles by cause, summed over records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Stalls {
    /// See [`Cause::BlockBusy`].
    pub block_busy: u64,
    /// See [`Cause::MemoryPort`].
    pub memory_port: u64,
    /// See [`Cause::BankConflict`].
    pub bank_conflict: u64,
    /// See [`Cause::CacheMiss`].
    pub cache_miss: u64,
    /// See [`Cause::PixelPort`].
    pub pixel_port: u64,
    /// See [`Cause::StackSpill`].
    pub stack_spill: u64,
    /// See [`Cause::Steal`].
    pub steal: u64,
}

impl Stalls {
    /// Cycles of one cause.
    #[must_use]
    pub fn of(&self, cause: Cause) -> u64 {
        match cause {
            Cause::BlockBusy => self.block_busy,
            Cause::MemoryPort => self.memory_port,
            Cause::BankConflict => self.bank_conflict,
            Cause::CacheMiss => self.cache_miss,
            Cause::PixelPort => self.pixel_port,
            Cause::StackSpill => self.stack_spill,
            Cause::Steal => self.steal,
        }
    }

    /// Cycles of all causes.
    #[must_use]
    pub fn total(&self) -> u64 {
        Cause::ALL.iter().map(|&cause| self.of(cause)).sum()
    }

    #[inline]
    pub(super) fn add(&mut self, cause: Cause, cycles: u64) {
        *match cause {
            Cause::BlockBusy => &mut self.block_busy,
            Cause::MemoryPort => &mut self.memory_port,
            Cause::BankConflict => &mut self.bank_conflict,
            Cause::CacheMiss => &mut self.cache_miss,
            Cause::PixelPort => &mut self.pixel_port,
            Cause::StackSpill => &mut self.stack_spill,
            Cause::Steal => &mut self.steal,
        } += cycles;
    }
}

/// One stage, over all lanes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageReport {
    /// The stage.
    pub stage: Stage,
    /// Records that came.
    pub visits: u64,
    /// Operations, wires included.
    pub operations: u64,
    /// Passes through units: more than operations where words are wider than
    /// units, none for wires.
    pub passes: u64,
    /// Most passes that one visit had, by class in the order of [`OpClass::ALL`]:
    /// more units than that are never used.
    pub most_passes: [u64; OpClass::ALL.len()],
    /// Cycles in which its blocks issued operations.
    pub busy: u64,
    /// Further cycles in which its blocks waited to issue accesses.
    pub held: u64,
    /// `busy + held` over cycles and lanes, 0 to 1.
    pub utilisation: f64,
    /// Cycles of the records in it if nothing is waited for.
    pub alone: u64,
    /// Cycles of the records in it beyond that, by cause.
    pub stalls: Stalls,
}

/// What the contexts did; the four sum to `cycles * lanes * contexts`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ContextReport {
    /// Cycles in which a record was worked on, or waited for nothing but its
    /// own latencies.
    pub working: u64,
    /// Cycles in which a record waited in a stage.
    pub stalled: u64,
    /// Cycles without a record, while all records left had to wait for others.
    pub order_wait: u64,
    /// Cycles without a record, while there were none left but those worked on.
    pub no_record: u64,
}

/// A cache.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct CacheReport {
    /// Reads.
    pub accesses: u64,
    /// Reads of lines that were not there.
    pub misses: u64,
    /// Reads of lines that were on their way.
    pub delayed_hits: u64,
    /// `1 - misses / accesses`; 1 where there were none.
    pub hit_rate: f64,
    /// Bytes that the misses brought.
    pub bytes_in: u64,
}

/// Stacks, and what must be remembered of order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct StackReport {
    /// Most records on one lane's stack.
    pub deepest: u64,
    /// Most records on all stacks and in all contexts.
    pub most_live: u64,
    /// Most records at once whose turn is over and some of whose descendants
    /// are not: each is an entry of the table that keeps the order.
    pub most_open: u64,
    /// Records that found no entry.
    pub spilled: u64,
    /// Their bits: written to outer memory once and read from there once.
    pub spilled_bits: u64,
    /// Records taken from another lane.
    pub stolen: u64,
}

/// A number of cycles below which the frame cannot be.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bound {
    /// What sets it.
    pub resource: String,
    /// Cycles.
    pub cycles: u64,
    /// `cycles` over the frame's, 0 to 1: how busy the resource is.
    pub share: f64,
}

/// What limits the frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bottleneck {
    /// What, as a bound's `resource`; or `latency`, `order`.
    pub resource: String,
    /// Share of the cycles, 0 to 1, for which it was busy.
    pub share: f64,
    /// The same in words, and what would help.
    pub sentence: String,
}

/// What a simulation came to. Cycles are of the hardware's clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CycleReport {
    /// [`REPORT_VERSION`].
    pub version: u32,
    /// The hardware's name.
    pub hardware: String,
    /// Its lanes.
    pub lanes: u32,
    /// Its contexts per lane.
    pub contexts: u32,
    /// Its rule.
    pub independence: Independence,
    /// Its clock, MHz.
    pub clock_mhz: f64,
    /// From the first record's first to the last pixel's last cycle.
    pub cycles: u64,
    /// Records that had their turn.
    pub records: u64,
    /// Pixels written.
    pub pixels: u64,
    /// `cycles / records`.
    pub cycles_per_record: f64,
    /// `cycles / pixels` written; 0 where none are.
    pub cycles_per_pixel: f64,
    /// Frames a second at the clock.
    pub frames_per_second: f64,
    /// Cycles of all turns if nothing is waited for.
    pub work: u64,
    /// Cycles of the longest chain of turns that must follow each other, if
    /// nothing else is waited for: what no number of lanes goes below.
    pub span: u64,
    /// `work / span`: so many contexts could be kept busy on average.
    pub parallelism: f64,
    /// Cycles of all turns one after the other, each waiting for all it ever
    /// must: what no hardware of these parts exceeds.
    pub serial: u64,
    /// By stage, in the order of the record loop.
    pub stages: Vec<StageReport>,
    /// What the contexts did.
    pub context_cycles: ContextReport,
    /// The node cache.
    pub node_cache: CacheReport,
    /// The attribute cache.
    pub attribute_cache: CacheReport,
    /// Fill vectors read.
    pub fill_reads: u64,
    /// Fill vectors written.
    pub fill_writes: u64,
    /// Cycles for which the port to outer memory was taken: by lines of the
    /// caches and by spilled records.
    pub outer_busy: u64,
    /// Stacks.
    pub stack: StackReport,
    /// By resource, tightest first.
    pub bounds: Vec<Bound>,
    /// What limits the frame.
    pub bottleneck: Bottleneck,
}

/// Share of the cycles from which a resource counts as what limits.
const LIMITING: f64 = 0.75;

impl CycleReport {
    /// Bounds and bottleneck from what is counted.
    pub(super) fn conclude(&mut self, bounds: Vec<(String, u64)>) {
        let cycles = self.cycles.max(1) as f64;
        self.bounds = bounds
            .into_iter()
            .map(|(resource, bound)| Bound {
                resource,
                cycles: bound,
                share: bound as f64 / cycles,
            })
            .collect();
        // Stable: equal ones stay in the order in which they were listed.
        self.bounds
            .sort_by_key(|bound| std::cmp::Reverse(bound.cycles));
        self.bottleneck = self.find_bottleneck(cycles);
    }

    fn find_bottleneck(&self, cycles: f64) -> Bottleneck {
        let tightest = self.bounds.first().filter(|bound| bound.share >= LIMITING);
        if let Some(bound) = tightest {
            let percent = bound.share * 100.0;
            let name = &bound.resource;
            let sentence = if name == SPAN {
                format!(
                    "the longest chain of records that wait for each other takes {percent:.0} % \
                     of the time: more lanes or contexts cannot help, shorter latencies would"
                )
            } else {
                format!("the {name} is busy {percent:.0} % of the time: widen it, or do less there")
            };
            return Bottleneck {
                resource: name.clone(),
                share: bound.share,
                sentence,
            };
        }
        let all = cycles * f64::from(self.lanes) * f64::from(self.contexts);
        let of = |part: u64| part as f64 / all;
        let ContextReport {
            working,
            stalled,
            order_wait,
            no_record,
        } = self.context_cycles;
        let (resource, share, sentence) = if of(working + stalled) >= LIMITING {
            let stall = |cause: Cause| -> u64 {
                self.stages.iter().map(|stage| stage.stalls.of(cause)).sum()
            };
            // Of equal ones the first.
            let worst = Cause::ALL
                .into_iter()
                .rev()
                .max_by_key(|&cause| stall(cause));
            let waits = worst
                .filter(|&cause| stall(cause) > 0)
                .map_or_else(String::new, |cause| {
                    let part = of(stall(cause)) * 100.0;
                    format!(
                        "; records wait {part:.0} % of it, most of all for: {}",
                        cause.name()
                    )
                });
            (
                "latency",
                of(working + stalled),
                format!(
                    "no unit is busy enough to limit, but every context has a record {:.0} % of \
                     the time: latencies limit, more contexts per lane would help{waits}",
                    of(working + stalled) * 100.0
                ),
            )
        } else if order_wait >= no_record {
            (
                "order",
                of(order_wait),
                format!(
                    "contexts are idle {:.0} % of the time because the records left wait for \
                     earlier ones; this frame could keep {:.1} contexts busy, the hardware has {}",
                    of(order_wait) * 100.0,
                    self.parallelism,
                    u64::from(self.lanes) * u64::from(self.contexts),
                ),
            )
        } else {
            (
                "records",
                of(no_record),
                format!(
                    "contexts are idle {:.0} % of the time because there are no records left \
                     but those under way; this frame could keep {:.1} contexts busy, the \
                     hardware has {}",
                    of(no_record) * 100.0,
                    self.parallelism,
                    u64::from(self.lanes) * u64::from(self.contexts),
                ),
            )
        };
        Bottleneck {
            resource: resource.to_owned(),
            share,
            sentence,
        }
    }
}

/// Name of the port to outer memory among the bounds.
pub(super) const OUTER_PORT: &str = "outer memory port";
/// Name of the span among the bounds.
pub(super) const SPAN: &str = "longest chain";
