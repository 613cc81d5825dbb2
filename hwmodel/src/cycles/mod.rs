//! How many cycles a hardware takes, and what for.
//!
//! Nothing is recorded and replayed (but see [`Recording`]): [`simulate`] has a [`Workload`] do one
//! record's turn at a time, in the order of simulated time, watches through a
//! probe ([`TurnLog`]) what it does, and lays that out in cycles. So a record
//! that is worked on early finds less drawn before it than serially, as it
//! would on the hardware. Only records that are not finished are kept.
//!
//! # Rules
//!
//! All times are whole cycles. The same input gives the same output.
//!
//! 1. **Hardware.** [`Hardware::lanes`] lanes; each has a stack, one block for
//!    each stage, and [`Hardware::contexts`] contexts. A context has one record
//!    at a time. Caches, fill vectors and pixels are shared by all lanes.
//! 2. **Turn.** All that a record does in one stage is one *visit*. Visits are
//!    made one after the other, in this order: pop, filled?, to screen, one
//!    pixel?, centre, order, vertex pool, child box, quadtree fit, push, draw,
//!    fill update; stages in which a record does nothing are left out.
//!    What a turn reads and writes (fill vectors, pixels) happens, as far as
//!    other records can see, in the cycle in which it begins.
//! 3. **Block.** A visit that comes to a block waits until those that came
//!    before have gone in, and the block is free. Then, in cycle *s*, it begins.
//!    An operation of *b* bits is `ceil(b / width)` passes; for each class of
//!    operation, issuing takes `ceil(passes / count) * interval` cycles; the
//!    largest of these, at least 1, is the visit's *occupancy*. The largest
//!    latency among the classes that are used is its *latency*. Results are
//!    there at *s* + occupancy + latency.
//! 4. **Memory.** The visit's accesses are issued in order, the first not
//!    before *s*, none before the one before it; each in the first cycle that
//!    has a port left, after all accesses of visits that began before.
//!    A read is done `latency` cycles after its issue, a write after 1.
//!    The block is free again when all operations and accesses are issued
//!    (an access takes the cycle of its issue); the visit ends when all
//!    results are there and all accesses are done. What it ends later than it
//!    would with no other record about, no port short and no miss is *stall*,
//!    charged to what the access that ended last (of equal ones the first)
//!    waited for.
//! 5. **Stack.** A lane's, `ports` accesses a cycle. A record is taken from
//!    the stack on which it lies; one that lies on another lane's stack takes
//!    [`Hardware::steal_cycles`] longer in stage *pop*. A record for which a
//!    stack has no entry is an error or is *spilled*: written out in the
//!    background and read back, from the cycle in which it is taken on, in
//!    `spill_cycles` more of stage *pop*. Either way its bits take the port to
//!    outer memory ([`OuterMemory::cycles`]); what reading back waits for that
//!    port, and the cycles of its own bits, come to the `spill_cycles`.
//! 6. **Cache.** Set-associative, least recently used goes first. A hit is done after
//!    `hit_latency`. A miss waits for one of the `misses` slots and for the port to
//!    outer memory, which its line then takes; both while holding the
//!    cache's port. It is done after `hit_latency` and the longer of `miss_latency` and
//!    the line's own cycles, and so is, at the earliest, a hit on the same line.
//! 7. **Fill vectors.** An address lies in bank `address mod banks`; each bank has
//!    its own ports.
//! 8. **Pixels.** Written into a buffer through ports; one that finds it full
//!    waits for the oldest to leave. They leave in order, `drain_interval` cycles apart at least. Coming
//!    into the buffer, a pixel of 24 bits asks for the port to outer memory: neighbours share words, so it takes the
//!    port for as many cycles as it completes words, and has left when they are over, too.
//! 9. **Children** are on the stack of the lane, nearest on top, in the cycle in which the turn ends.
//!    A child is *ready* when all its earlier siblings that it is not
//!    independent of ([`Independence::allows`]) are finished with all their
//!    descendants. Siblings are all that needs to be examined: descendants stay in
//!    their ancestor's image node and in its place in the order.
//! 10. **Next record.** A record that becomes ready goes on top of its lane's list, below the
//!     earlier siblings of its own that are on top. A context whose turn has ended takes, in the
//!     same cycle, the topmost record of its lane; if there is none, the lowest one
//!     of the next lane (cyclically) that has one. Then idle contexts of lanes with ready records
//!     take those, then other idle contexts steal, lowest numbers first. With one context
//!     this is depth first, nearest first, whatever the independence.
//! 11. **Start.** What the workload does before the first record is a turn of
//!     lane 0, context 0, in cycle 0.
//!
//! 12. **Sequential hardware** ([`Hardware::sequential`]) has a block work on one thing at a time, in the order in
//!     which the record loop makes the steps: wherever the loop goes on to another stage, or says that the next step
//!     needs this one ([`Probe::next_step`](crate::Probe::next_step)), a visit ends and the next begins (so a stage
//!     may be visited several times a turn). What it does *beside* the stage that it is in
//!     ([`Probe::beside`](crate::Probe::beside)) is done in the visit of that. In a visit an access is issued when the
//!     one before is done; a read takes one more cycle, in which its result is looked at. These cycles issue operations; what
//!     they leave of the visit's occupancy, and its latency, comes after the last access. A visit takes at least a
//!     cycle, and its block is free when it ends. This is what a simple state machine does: `rtl/` is one.
//!     What several lanes ask for is served in the order in which they ask, each access in its
//!     own cycle (not, as in rule 4, all of a visit when that begins); of one cycle, nodes before attributes, and the
//!     lowest lane and context first. An access takes the port of its cache for two cycles: it is looked up, and what is found is
//!     looked at, which a miss that waits for the port to outer memory makes longer. A line that comes in takes it, too,
//!     for the cycles that it moves, the last before it is there.
//! 13. **Tiles on sequential hardware** ([`Organisation::tile_levels`]) are not records on a stack. A context without
//!     records asks for a tile, from cycle 0 on; in each cycle the one that asked first is given the next tile, row by row,
//!     and begins it in the cycle after. It draws it to its end: nothing is stolen, and stack and fill vectors are a
//!     context's own.
//! 14. **Contexts of a sequential lane**, which need tiles, work in turns: one has the lane. From the cycle in which
//!     it asks a cache, or for a tile, until the cycle before the answer, another may have the lane. In each such
//!     cycle the context that has wanted it longest is given it, of one cycle the lowest number, and goes on in the
//!     cycle after: it looks at what it read, or begins its tile. A context that does not have the lane wants it from
//!     the cycle of the answer on; one that has it still looks at what it read in that cycle. Cycles in which a
//!     context wants the lane are *block busy*.
//!
//! # Work and span
//!
//! A turn *alone* takes the sum over its visits of the larger of occupancy + latency
//! and the longest latency of an access that hits. **Work** is the sum over all
//! turns; **span** is the longest chain of turns alone that had to follow
//! each other, parent to child and sibling to sibling, in this very execution. No
//! number of lanes, contexts or ports makes the frame shorter than the span.
//!
//! # What holds, and what does not
//!
//! Cycles are never below any bound of the report, and never above
//! [`CycleReport::serial`]. With one context, which works in the serial order,
//! no part that is made faster or wider makes a frame slower. With several that
//! is not so: records then meet in another order (the anomalies of list
//! scheduling, Graham 1969). Of 2000 improvements of random hardware on random
//! records, 117 made the frame slower, at worst by 19 % (`tests/hwmodel/cycles_properties.rs`).
//!
//! # What is left out
//!
//! - Operations of one visit that need each other's results (the levels of a
//!   fit, the steps of a divide) are charged with one latency: the block is
//!   taken for a pipeline. For few contexts this is optimistic; raise latencies.
//! - A turn's effects are seen by others from its first cycle on (rule 2): up to one turn's length too early.
//! - Passing results from stage to stage takes no time; neither does finding ready records.
mod contexts;
mod hardware;
mod memories;
mod observe;
mod recording;
mod report;
mod scaling;
mod sequential;
mod simulate;
mod tasks;
mod totals;
mod trace;
mod turn;
mod wheel;

pub use hardware::{
    Banks, Cache, Hardware, HardwareError, Independence, MAX_CONTEXTS, MAX_LANES, MAX_TILE_LEVELS,
    Organisation, OuterMemory, PRESETS, Pixels, Stack, StackHolds, StackOverflow, Unit,
};
pub use observe::{NoObserver, Observer, Progress, START, VisitSpan};
pub use recording::{Recording, Replay, Tape, TurnProbe};
pub use report::{
    Bottleneck, Bound, CacheReport, Cause, ContextReport, CycleReport, REPORT_VERSION, StackReport,
    StageReport, Stalls,
};
pub use scaling::{LANES, ScalingRow, scaling};
pub use simulate::{SimulationError, simulate};
pub use trace::{Recorder, TraceLimit};
pub use turn::{Child, ImageNode, TurnLog, Workload};
