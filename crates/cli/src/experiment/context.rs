//! The computer and command of a measurement.

use serde_json::{Value, json};

use crate::console::Console;
use shiftvox::project::SetupOptions;
use shiftvox_lab::bench::Schedule;

/// Load above which times are likely to be disturbed.
const BUSY: f64 = 0.5;

/// Machine and command, found before the first measurement.
pub(crate) struct Context {
    processor: Option<String>,
    threads: usize,
    /// Processes that ran or waited, averaged over the last minute.
    load: Option<f64>,
    command: String,
}

impl Context {
    /// Properties that the system reports.
    pub(crate) fn now() -> Self {
        let command: Vec<String> = std::env::args_os()
            .skip(1)
            .map(|word| word.to_string_lossy().into_owned())
            .collect();
        let load = std::fs::read_to_string("/proc/loadavg").ok();
        Self {
            processor: std::fs::read_to_string("/proc/cpuinfo")
                .ok()
                .as_deref()
                .and_then(processor_name),
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            load: load.and_then(|text| text.split_whitespace().next()?.parse().ok()),
            command: format!("shiftvox {}", command.join(" ")),
        }
    }

    /// The command line.
    pub(crate) fn command_line(&self) -> String {
        self.command.clone()
    }

    /// Warns if other work is likely to disturb the times.
    pub(crate) fn warn(&self, console: &Console) {
        if let Some(load) = self.load.filter(|&load| load > BUSY) {
            console.note(format!(
                "this computer is busy (load {load}): trust counters, processor times and minima"
            ));
        }
    }

    /// As JSON fields, with how the frames were drawn.
    pub(crate) fn json(&self, schedule: Schedule, options: &SetupOptions) -> Value {
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
            "options": options_json(options),
        })
    }

    /// As lines of Markdown.
    pub(crate) fn markdown(&self, schedule: Schedule) -> String {
        let processor = self
            .processor
            .as_deref()
            .unwrap_or("a processor without a name");
        let load = self
            .load
            .map_or_else(String::new, |load| format!(", load {load} before"));
        format!(
            "`{}`\n\nshiftvox {}, {processor}, {} hardware threads, {} {}{load}. Warm-up {}, runs \
             {}, interleaved; times in ms: median, least, median absolute deviation; processor \
             time of the drawing thread where there is one thread.\n",
            self.command,
            env!("CARGO_PKG_VERSION"),
            self.threads,
            std::env::consts::OS,
            std::env::consts::ARCH,
            schedule.warmup,
            schedule.runs,
        )
    }
}

fn options_json(options: &SetupOptions) -> Value {
    let mut value = json!(options);
    if options.tolerance_px.is_infinite() {
        // JSON has no infinity.
        value["tolerance_px"] = json!("inf");
    }
    value
}

fn processor_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo
        .lines()
        .find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_has_a_name() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nflags\t: a b\n";
        assert_eq!(processor_name(text).as_deref(), Some("Some CPU @ 2 GHz"));
        assert_eq!(processor_name("Hardware : x"), None);
    }
}
