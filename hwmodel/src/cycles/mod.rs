//! How many cycles a hardware takes.
mod hardware;
mod memories;
mod observe;
mod report;
mod simulate;
mod tasks;
mod turn;
mod wheel;

pub use hardware::{
    Banks, Cache, Hardware, HardwareError, Independence, MAX_CONTEXTS, MAX_LANES, PRESETS, Pixels,
    Stack, StackOverflow, Unit,
};
pub use observe::{NoObserver, Observer, Progress, START, VisitSpan};
pub use report::{
    Bottleneck, Bound, CacheReport, Cause, ContextReport, CycleReport, REPORT_VERSION, StackReport,
    StageReport, Stalls,
};
pub use simulate::{SimulationError, simulate};
pub use turn::{Child, Region, TurnLog, Workload};
