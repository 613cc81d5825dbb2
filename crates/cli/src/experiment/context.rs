//! The computer and command of a measurement.

use serde_json::{Value, json};

use crate::console::Console;
use shiftvox::project::SetupOptions;
use shiftvox_lab::bench::Schedule;

/// Load above which times are likely to be disturbed.
const BUSY: f64 = 0.5;

pub(crate) struct Context {
    processor: Option<String>,
    threads: usize,
    /// Processes that ran or waited, averaged over the last minute.
    load: Option<f64>,
    pub(crate) command: String,
}

impl Context {
    pub(crate) fn now() -> Self {
        let command: Vec<String> = std::env::args_os()
            .skip(1)
            .map(|word| word.to_string_lossy().into_owned())
            .collect();
        let load = std::fs::read_to_string("/proc/loadavg").ok();
        let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Self {
            processor: processor_name(&cpuinfo),
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            load: load.and_then(|text| text.split_whitespace().next()?.parse().ok()),
            command: format!("shiftvox {}", command.join(" ")),
        }
    }

    pub(crate) fn warn(&self, console: &Console) {
        if let Some(load) = self.load.filter(|&load| load > BUSY) {
            console.note(format!(
                "this computer is busy (load {load}): trust counters, processor times and minima"
            ));
        }
    }

    pub(crate) fn json(&self, schedule: Schedule, options: &SetupOptions) -> Value {
        let mut options = json!(options);
        if options["tolerance_px"].is_null() {
            options["tolerance_px"] = json!("inf");
        }
        json!({
            "command": self.command,
            "machine": {
                "processor": self.processor,
                "threads": self.threads,
                "load_before": self.load,
                "system": std::env::consts::OS,
                "architecture": std::env::consts::ARCH,
            },
            "schedule": { "warmup": schedule.warmup, "runs": schedule.runs },
            "options": options,
        })
    }
}

fn processor_name(cpuinfo: &str) -> Option<String> {
    let mut lines = cpuinfo.lines();
    let line = lines.find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
