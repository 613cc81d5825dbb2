//! The cycles of a hardware design, and their causes.
//!
//! [`simulate`] executes a [`Workload`] turn by turn, in the order of simulated time, and lays its work ([`TurnLog`])
//! out in cycles. So a record that runs early finds fewer samples drawn than serially, as on the hardware.
//!
//! A design of another kind lists its own stages ([`stages!`](crate::stages)), and uses the memories that it has: a stack,
//! two caches (`Node`, `Attribute`), banks of on-chip memory (`FillVector`) and an output (`Pixel`). A *record* is whatever
//! the design works on. `examples/box_filter.rs` models one in 60 lines.
//!
//! # Rules
//!
//! All times are whole cycles. The same input gives the same output.
//!
//! 1. **Hardware.** A design has [`Hardware::lanes`]. Each lane has a stack, one block per stage, and [`Hardware::contexts`] with
//!    one record each at a time. Caches, fill vectors and pixels are shared by all lanes.
//! 2. **Turn.** All work of a record in one stage is one *visit*. Visits follow each other in the order of the stages'
//!    numbers. Stages without work are left out. Other records see the effects of a turn from its first cycle.
//! 3. **Block.** A visit begins in cycle *s*, when earlier visits have entered the block and it is free. An operation of
//!    *b* bits is `ceil(b / width)` passes. Issuing a class of operation takes `ceil(passes / count) * interval` cycles;
//!    the largest of these, at least 1, is the *occupancy*. The *latency* is the largest of the used classes. Results
//!    are ready at *s* + occupancy + latency.
//! 4. **Memory.** Accesses are issued in order from *s*, each in the first cycle with a free port after all accesses of
//!    visits that began before. A read is done `latency` cycles after its issue, a write after 1. The block is free when
//!    all is issued. The visit ends when all results are ready and all accesses are done. Its delay against a visit with
//!    free ports and without misses is *stall*, whose cause is that of the access that ended last (of equal ones the
//!    first).
//! 5. **Stack.** Each has `ports` accesses per cycle. A record on another lane's stack takes [`Hardware::steal_cycles`]
//!    longer in stage 0. A record for which a stack has no entry is an error or is *spilled*. It is written to outer
//!    memory in the background, and read back when it is taken, in `spill_cycles` more of stage 0. Both transfers
//!    take the port to outer memory ([`OuterMemory::cycles`]); the second one and its wait add to the `spill_cycles`.
//! 6. **Cache.** Set-associative, replaces the least recently used line. A hit is done after `hit_latency`. A miss waits
//!    for one of the `misses` slots and for the port to outer memory, which its line then takes; both hold the cache's
//!    port. It is done after `hit_latency` and the longer of `miss_latency` and the line's own cycles. A hit on the same
//!    line is not done earlier.
//! 7. **Fill vectors.** An address lies in bank `address mod banks`; each bank has its own ports.
//! 8. **Pixels** enter a buffer through ports, and leave in order, at least `drain_interval` cycles apart. A pixel that
//!    finds the buffer full waits. On entry, its 24 bits take the port to outer memory for the words that they complete,
//!    since neighbours share words. It leaves after those cycles.
//! 9. **Children** are on the stack of the lane, nearest on top, when the turn ends. A child is *ready* when all earlier
//!    siblings that it depends on ([`Independence::allows`]) are finished with all their descendants. Other records need
//!    not be examined: descendants stay in their ancestor's image node and place in the order.
//! 10. **Next record.** Each lane lists its ready records. A new record is placed on top, but below its own earlier
//!     siblings. A context whose turn has ended takes, in the same cycle, the topmost record of its lane, or the lowest
//!     one of the next lane (cyclically) that has one. Then idle contexts of lanes with ready records take those, then
//!     other idle contexts steal, lowest numbers first.
//! 11. **Start.** The work before the first record is a turn of lane 0, context 0, in cycle 0.
//! 12. **Sequential hardware** ([`Hardware::sequential`]) does one thing at a time, in the order of the record loop. A
//!     visit ends where the loop enters another stage or reports a dependence
//!     ([`Probe::next_step`](crate::Probe::next_step)). Work *beside* a stage ([`Probe::beside`](crate::Probe::beside))
//!     belongs to its visit. An access is issued when the previous one is done; a read takes one more cycle, in which
//!     its result is inspected. These cycles issue operations; the rest of the occupancy, and the latency, come after
//!     the last access. A visit takes at least a cycle. Requests of several lanes are served in order, each in its own
//!     cycle; of one cycle, nodes before attributes, and the lowest lane and context first. An access takes the port of
//!     its cache for lookup and inspection, longer for a miss that waits for outer memory. An incoming line takes it for
//!     the cycles of its transfer.
//! 13. **Tiles on sequential hardware** ([`Organisation::tile_levels`]). From cycle 0 on, a context without records
//!     requests a tile. In each cycle the earliest request receives the next tile, row by row. Its context begins the
//!     tile in the next cycle and draws it to its end, with its own stack and fill vectors.
//! 14. **Contexts of a sequential lane** share it: one has the lane. From its request to a cache, or for a tile, until
//!     the cycle before the answer, another may have it: in each such cycle the one that was answered first, of one cycle
//!     the lowest number. It continues in the next cycle; its wait is *block busy*. A context with the lane inspects its
//!     result in the cycle of the answer.
//! 15. **Banks of outer memory** ([`OuterMemory::dram`], if it is given) hold rows of `row_bytes`; neighbouring rows lie in
//!     neighbouring banks. A bank serves one request at a time, in the order in which the port accepts them, and leaves
//!     the row open. A request to the open row takes `t_cl` cycles, the first one of a bank `t_rcd` more, and one to
//!     another row `t_rp + t_rcd` more. Its data then come, and keep the bank for the port's cycles. A miss, a pixel or a
//!     record that comes back is done later by these cycles, and by those for which its bank was busy.
//!
//! A turn *alone* takes the sum over its visits of the larger of occupancy + latency and the longest latency of an
//! access that hits. **Work** is the sum over all turns. **Span** is the longest chain of turns alone that had to follow
//! each other. Cycles are never below any bound of the report, and never above [`CycleReport::serial`]. With one context,
//! no faster or wider part makes a frame slower. docs/hardware-model.md lists what the model leaves out.

mod built;
mod hardware;
mod memories;
mod observe;
mod outer;
mod report;
mod sequential;
mod simulate;
mod tasks;
mod totals;
mod turn;
mod wheel;

pub use built::{Built, Size, Sizes};
pub use hardware::{
    Banks, Cache, Hardware, HardwareError, Independence, MAX_CONTEXTS, MAX_LANES, MAX_TILE_LEVELS,
    Organisation, OuterMemory, PRESETS, Pixels, Stack, StackHolds, StackOverflow, Unit,
};
pub use observe::{NoObserver, Observer, START, VisitSpan};
pub use outer::{Dram, OuterRequest, RowReport, write_ramulator};
pub use report::{
    Bottleneck, Bound, CacheReport, Cause, ContextReport, CycleReport, REPORT_VERSION, StackReport,
    StageReport, Stalls,
};
pub use simulate::{SimulationError, simulate};
pub use turn::{Child, ImageNode, TurnLog, Workload};
