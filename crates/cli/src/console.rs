//! Output: data on stdout, notes and progress on stderr.

use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::document;
use super::error::{CliError, Kind};
use shiftvox::graph::{Progress, Silent};
use shiftvox::whole;

pub(super) struct Console {
    quiet: bool,
    pub(super) verbose: u8,
    pub(super) json: bool,
    progress: Box<dyn Progress>,
    /// The document that is printed at the end of the run, with the error if the run fails.
    held: Mutex<Option<Value>>,
    in_lines: AtomicBool,
    /// The output, if it is not for stdout.
    kept: Option<Mutex<String>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Console {
    pub(super) fn new(quiet: bool, verbose: u8, json: bool) -> Self {
        let progress: Box<dyn Progress> = if !quiet && is_drawn_on() {
            Box::new(Bar::default())
        } else {
            Box::new(Silent)
        };
        Self {
            quiet,
            verbose,
            json,
            progress,
            held: Mutex::default(),
            in_lines: AtomicBool::new(false),
            kept: None,
        }
    }

    /// Keeps JSON documents for a caller in this process, without notes.
    pub(super) fn keeping() -> Self {
        Self {
            kept: Some(Mutex::default()),
            ..Self::new(true, 0, true)
        }
    }

    pub(super) fn kept(self) -> String {
        let kept = self.kept.unwrap_or_default();
        kept.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn print(&self, text: &str) -> Result<(), CliError> {
        match &self.kept {
            Some(kept) => lock(kept).extend([text, "\n"]),
            None => {
                let mut out = io::stdout().lock();
                writeln!(out, "{}", json_text(text))?;
                out.flush()?;
            }
        }
        Ok(())
    }

    pub(super) fn progress(&self) -> &dyn Progress {
        &*self.progress
    }

    pub(super) fn data(&self, text: impl AsRef<str>) -> Result<(), CliError> {
        self.print(&harmless(text.as_ref()))
    }

    /// Prints a line of JSON at once if results are JSON, for results that come one by one.
    pub(super) fn line(&self, text: &str) -> Result<(), CliError> {
        if !self.json {
            return Ok(());
        }
        self.in_lines.store(true, Ordering::Relaxed);
        self.print(text)
    }

    /// Prints a command's document at the end of the run, if results are JSON.
    pub(super) fn report(&self, command: &str, fields: Value) {
        if self.json {
            self.hold(document::document(command, fields));
        }
    }

    pub(super) fn hold(&self, document: Value) {
        *lock(&self.held) = Some(document);
    }

    /// Ends a run: prints the document, with the error. With `--json` there always is one.
    pub(super) fn end(&self, result: Result<(), CliError>) -> Result<(), CliError> {
        let held = lock(&self.held).take();
        let printed = match (&result, held) {
            (Err(error), _) if error.kind == Kind::Pipe => Ok(()),
            (Err(error), held) if self.json || held.is_some() => {
                let document = document::failed(held, error);
                match self.in_lines.load(Ordering::Relaxed) {
                    true => self.print(&document.to_string()),
                    false => self.print(&format!("{document:#}")),
                }
            }
            (_, Some(held)) => self.print(&format!("{held:#}")),
            (_, None) => Ok(()),
        };
        result.and(printed)
    }

    pub(super) fn note(&self, text: impl AsRef<str>) {
        if !self.quiet {
            say(text.as_ref());
        }
    }

    /// Writes a file, and says so.
    pub(super) fn write(
        &self,
        path: &Path,
        bytes: impl AsRef<[u8]>,
        force: bool,
    ) -> Result<(), CliError> {
        whole::write(path, bytes.as_ref(), force)?;
        self.note(format!("{}: written", path.display()));
        Ok(())
    }

    pub(super) fn detail(&self, text: impl AsRef<str>) {
        if self.verbose > 0 {
            self.note(text);
        }
    }
}

pub(super) fn report_error(error: &CliError) {
    say(&format!("shiftvox: {error}"));
}

fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(text));
}

/// JSON in which terminals find no control characters: those below 32 are escaped already, or ends of lines.
pub(super) fn json_text(text: &str) -> String {
    let shown = |letter: char| match letter.is_control() && letter != '\n' {
        true => format!("\\u{:04x}", u32::from(letter)),
        false => letter.to_string(),
    };
    text.chars().map(shown).collect()
}

/// A text for a terminal: control characters other than newlines and tabs are escaped.
fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmful = |letter: char| letter.is_control() && letter != '\n' && letter != '\t';
    if !text.contains(is_harmful) {
        return text.into();
    }
    let shown = |letter: char| match is_harmful(letter) {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    text.chars().map(shown).collect()
}

fn is_drawn_on() -> bool {
    let has_name = |name: std::ffi::OsString| !name.is_empty() && name != "dumb";
    io::stderr().is_terminal() && std::env::var_os("TERM").is_some_and(has_name)
}

/// Progress of the current work: a line that is rewritten, and removed at the end.
#[derive(Default)]
struct Bar(Mutex<Option<Work>>);

struct Work {
    name: String,
    /// Steps in all; 0 if unknown.
    steps: u64,
    done: u64,
    started: Instant,
    written: Option<Instant>,
}

const REFRESH: Duration = Duration::from_millis(100);
/// Longest name: lines must not wrap.
const MOST_LETTERS: usize = 56;

impl Work {
    /// The finished share, and the remaining time at the present rate.
    fn line(&self, elapsed: Duration) -> String {
        let name: String = self.name.chars().take(MOST_LETTERS).collect();
        let share = self.done.min(self.steps) as f64 / self.steps.max(1) as f64;
        if share == 0.0 {
            return format!("{name} ...");
        }
        let left = elapsed.as_secs_f64() * (1.0 - share) / share;
        let left = match left {
            seconds if seconds < 99.5 => format!("{seconds:.0} s"),
            seconds => format!("{:.0} min", seconds / 60.0),
        };
        format!("{name} {:3.0} % ({left} left)", 100.0 * share)
    }

    fn write(&mut self) {
        let now = Instant::now();
        if self.written.is_none_or(|at| now - at >= REFRESH) {
            self.written = Some(now);
            let line = self.line(now - self.started);
            let _ = write!(io::stderr().lock(), "\r{line}\x1b[K");
        }
    }
}

impl Progress for Bar {
    fn begin(&self, what: &str, steps: u64) {
        self.end();
        let mut work = Work {
            name: harmless(what).replace('\n', " "),
            steps,
            done: 0,
            started: Instant::now(),
            written: None,
        };
        if steps == 0 {
            work.write();
        }
        *lock(&self.0) = Some(work);
    }

    fn advance(&self, steps: u64) {
        if let Some(work) = &mut *lock(&self.0) {
            work.done += steps;
            work.write();
        }
    }

    fn end(&self) {
        if lock(&self.0).take().is_some() {
            let _ = write!(io::stderr().lock(), "\r\x1b[K");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_one_line_with_the_time_that_is_left() {
        for (steps, done, seconds, expected) in [
            (0, 9, 5, " ..."),
            (200, 50, 10, "  25 % (30 s left)"),
            (4, 1, 100, "  25 % (5 min left)"),
            (4, 5, 3, " 100 % (0 s left)"),
        ] {
            let work = Work {
                name: "x".repeat(500),
                steps,
                done,
                started: Instant::now(),
                written: None,
            };
            let line = work.line(Duration::from_secs(seconds));
            assert_eq!(line, "x".repeat(MOST_LETTERS) + expected);
        }
        assert_eq!(harmless("a\tb\n\u{e9}"), "a\tb\n\u{e9}");
        assert_eq!(harmless("\u{1b}[2Jx\r\u{9b}"), "\\u{1b}[2Jx\\r\\u{9b}");
    }
}
