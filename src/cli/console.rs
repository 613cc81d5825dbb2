//! What is said, and where: data on stdout, notes and progress on stderr.

use std::io::{self, IsTerminal, Write};
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};

use super::error::CliError;
use crate::graph::{Progress, Silent};

/// The two streams, and how much is said on them.
pub(super) struct Console {
    quiet: bool,
    verbose: u8,
    /// Whether results are printed as JSON.
    pub(super) json: bool,
    progress: Box<dyn Progress>,
}

impl Console {
    pub(super) fn new(quiet: bool, verbose: u8, json: bool) -> Self {
        let progress: Box<dyn Progress> = if !quiet && io::stderr().is_terminal() {
            Box::new(Bars::default())
        } else {
            Box::new(Silent)
        };
        Self {
            quiet,
            verbose,
            json,
            progress,
        }
    }

    /// Receives the progress of long work.
    pub(super) fn progress(&self) -> &dyn Progress {
        &*self.progress
    }

    /// Prints data, with a line's end.
    pub(super) fn data(&self, text: impl AsRef<str>) -> Result<(), CliError> {
        let mut out = io::stdout().lock();
        out.write_all(text.as_ref().as_bytes())?;
        out.write_all(b"\n")?;
        out.flush()?;
        Ok(())
    }

    /// Prints a JSON document.
    pub(super) fn document(&self, value: &serde_json::Value) -> Result<(), CliError> {
        self.data(format!("{value:#}"))
    }

    /// Prints a note, except with `--quiet`.
    pub(super) fn note(&self, text: impl AsRef<str>) {
        if !self.quiet {
            say(text.as_ref());
        }
    }

    /// Prints a note with `--verbose`.
    pub(super) fn detail(&self, text: impl AsRef<str>) {
        if self.verbose > 0 && !self.quiet {
            say(text.as_ref());
        }
    }

    /// Reports an error after which the work goes on.
    pub(super) fn error(&self, error: &CliError) {
        say(&format!("shiftvox: {error}"));
    }
}

/// A closed stderr does not stop the work.
fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// One bar at a time, without colours, gone when the work is done.
#[derive(Default)]
struct Bars {
    bar: Mutex<Option<ProgressBar>>,
}

impl Bars {
    fn with(&self, act: impl FnOnce(&mut Option<ProgressBar>)) {
        // A bar is no reason to fail: whoever panicked left it usable.
        act(&mut self
            .bar
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner));
    }
}

impl Progress for Bars {
    fn begin(&self, what: &str, steps: u64) {
        let bar = if steps == 0 {
            ProgressBar::new_spinner()
        } else {
            ProgressBar::new(steps)
        };
        if steps > 0
            && let Ok(style) = ProgressStyle::with_template("{msg} [{bar:30}] {percent}% {eta}")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(what.to_owned());
        self.with(|slot| {
            if let Some(old) = slot.replace(bar) {
                old.finish_and_clear();
            }
        });
    }

    fn advance(&self, steps: u64) {
        self.with(|slot| {
            if let Some(bar) = slot {
                bar.inc(steps);
            }
        });
    }

    fn end(&self) {
        self.with(|slot| {
            if let Some(bar) = slot.take() {
                bar.finish_and_clear();
            }
        });
    }
}
