//! Sums of a simulation, and its report.

use super::hardware::Hardware;
use super::memories::Memories;
use super::report::{
    Bottleneck, ContextReport, CycleReport, OUTER_PORT, REPORT_VERSION, SPAN, StackReport,
    StageReport,
};
use super::tasks::Tasks;
use super::turn::{CLASSES, STAGES};

#[derive(Debug)]
pub(super) struct Totals {
    pub(super) stages: Vec<StageReport>,
    pub(super) records: u64,
    pub(super) work: u64,
    pub(super) serial: u64,
    pub(super) idle_cycles: ContextReport,
    pub(super) stack: StackReport,
}

impl Totals {
    pub(super) fn new() -> Self {
        Self {
            stages: vec![StageReport::default(); STAGES],
            records: 0,
            work: 0,
            serial: 0,
            idle_cycles: ContextReport::default(),
            stack: StackReport::default(),
        }
    }

    pub(super) fn report(
        mut self,
        hardware: &Hardware,
        cycles: u64,
        memories: &Memories,
        tasks: &Tasks,
        most_passes: &[[u64; CLASSES]; STAGES],
    ) -> CycleReport {
        let per_lane = |sum: u64| sum.div_ceil(u64::from(hardware.lanes));
        let mut bounds = vec![(SPAN.to_owned(), tasks.span)];
        self.stages.retain(|stage| stage.visits > 0);
        for stage in &mut self.stages {
            stage.most_passes = most_passes[stage.stage.number()];
            let used = stage.busy + stage.held;
            let all = (cycles * u64::from(hardware.lanes)).max(1);
            stage.utilisation = used as f64 / all as f64;
            bounds.push((format!("{} block", stage.stage.name()), per_lane(used)));
        }
        let stack_ports = memories.stacks.iter().map(|port| port.bound()).sum();
        bounds.push(("stack port".to_owned(), per_lane(stack_ports)));
        for (name, bound) in [
            ("node cache port", memories.nodes.port.bound()),
            ("node cache misses", memories.nodes.miss_bound()),
            ("attribute cache port", memories.attributes.port.bound()),
            ("attribute cache misses", memories.attributes.miss_bound()),
            ("busiest fill-vector bank", memories.fill_bound()),
            ("pixel port", memories.pixels.port.bound()),
            ("pixel drain", memories.pixels.drain_bound()),
            (OUTER_PORT, memories.outer.busy),
        ] {
            bounds.push((name.to_owned(), bound));
        }
        if let Some(bound) = memories.outer.bank_bound() {
            bounds.push(("busiest bank of outer memory".to_owned(), bound));
        }
        let ratio = |a: u64, b: u64| if b == 0 { 0.0 } else { a as f64 / b as f64 };
        let (fill_reads, fill_writes) = memories.fill_accesses();
        let pixels = memories.pixels.port.accesses;
        let mut report = CycleReport {
            version: REPORT_VERSION,
            hardware: hardware.name.clone(),
            lanes: hardware.lanes,
            contexts: hardware.contexts,
            independence: hardware.independence,
            clock_mhz: hardware.clock_mhz,
            cycles,
            records: self.records,
            pixels,
            cycles_per_record: ratio(cycles, self.records),
            cycles_per_pixel: ratio(cycles, pixels),
            frames_per_second: hardware.clock_mhz * 1e6 / cycles.max(1) as f64,
            work: self.work,
            span: tasks.span,
            parallelism: ratio(self.work, tasks.span),
            serial: self.serial,
            context_cycles: ContextReport {
                working: self.work,
                stalled: self.stages.iter().map(|stage| stage.stalls.total()).sum(),
                ..self.idle_cycles
            },
            node_cache: memories.nodes.report(),
            node_buffer: memories.buffer_report(),
            attribute_cache: memories.attributes.report(),
            fill_reads,
            fill_writes,
            outer_busy: memories.outer.busy,
            outer_rows: memories.outer.rows(),
            stack: StackReport {
                most_open: tasks.most_open,
                ..self.stack
            },
            stages: self.stages,
            bounds: Vec::new(),
            bottleneck: Bottleneck::default(),
        };
        report.conclude(bounds);
        report
    }
}
