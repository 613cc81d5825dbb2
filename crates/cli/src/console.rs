//! Output: data on stdout, notes and progress on stderr.
//!
//! A JSON document is printed at the end of the run, with the error if the run fails. Names of files
//! may hold anything: control characters are escaped.

use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::error::{CliError, Kind};
use super::{document, names};
use shiftvox::graph::{Progress, Silent};

/// The two streams and their verbosity.
pub(super) struct Console {
    quiet: bool,
    verbose: u8,
    /// Whether results are printed as JSON.
    pub(super) json: bool,
    progress: Box<dyn Progress>,
    /// The document that is printed at the end of the run.
    held: Mutex<Option<Value>>,
    /// Whether each document is one line.
    in_lines: AtomicBool,
    /// The output, if it is not for stdout.
    kept: Option<Mutex<String>>,
}

impl Console {
    pub(super) fn new(quiet: bool, verbose: u8, json: bool) -> Self {
        let progress: Box<dyn Progress> = if !quiet && is_drawn_on() {
            Box::new(Bars::default())
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

    /// The output of a console that keeps it.
    pub(super) fn kept(self) -> String {
        let kept = self.kept.unwrap_or_default();
        kept.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn print(&self, text: &str) -> Result<(), CliError> {
        let Some(kept) = &self.kept else {
            return print(text);
        };
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push_str(text);
        kept.push('\n');
        Ok(())
    }

    /// Receives the progress of long work.
    pub(super) fn progress(&self) -> &dyn Progress {
        &*self.progress
    }

    /// Prints data and a newline.
    pub(super) fn data(&self, text: impl AsRef<str>) -> Result<(), CliError> {
        self.print(&harmless(text.as_ref()))
    }

    /// Prints a line of JSON at once if results are JSON, for results that come one by one.
    pub(super) fn line(&self, text: &str) -> Result<(), CliError> {
        if !self.json {
            return Ok(());
        }
        self.in_lines.store(true, Ordering::Relaxed);
        self.print(&json_text(text))
    }

    /// Prints a JSON document: at the next one, or at the end of the run.
    pub(super) fn document(&self, value: &Value) -> Result<(), CliError> {
        let before = self.held().replace(value.clone());
        match before {
            Some(before) => self.print(&as_json(&before)),
            None => Ok(()),
        }
    }

    fn held(&self) -> MutexGuard<'_, Option<Value>> {
        // A document, or none, also after a panic.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends a run: prints the last document, with the error. With `--json` there always is one.
    pub(super) fn end(&self, result: Result<(), CliError>) -> Result<(), CliError> {
        let held = self.held().take();
        let printed = match (&result, held) {
            (Err(error), _) if error.kind == Kind::Pipe => Ok(()),
            (Err(error), held) if self.json || held.is_some() => {
                let document = document::failed(held, error);
                match self.in_lines.load(Ordering::Relaxed) {
                    true => self.print(&json_text(&document.to_string())),
                    false => self.print(&as_json(&document)),
                }
            }
            (_, Some(held)) => self.print(&as_json(&held)),
            (_, None) => Ok(()),
        };
        result.and(printed)
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

    /// Reports an error that does not stop the work.
    pub(super) fn error(&self, error: &CliError) {
        report_error(error);
    }
}

/// Prints an error on stderr.
pub(super) fn report_error(error: &CliError) {
    say(&format!("shiftvox: {error}"));
}

fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.write_all(b"\n")?;
    out.flush()?;
    Ok(())
}

/// A closed stderr does not stop the work.
fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(text));
}

/// A text for a terminal: control characters other than newlines and tabs are escaped, and bytes of
/// names that are not UTF-8.
fn harmless(text: &str) -> Cow<'_, str> {
    let is_plain = |letter| letter == '\n' || letter == '\t';
    escaped(text, |letter| match names::byte_of(letter) {
        Some(byte) => Some(format!("\\x{byte:02x}")),
        None if letter.is_control() && !is_plain(letter) => {
            Some(letter.escape_default().to_string())
        }
        None => None,
    })
}

/// The text of a document with JSON escapes in place of these.
pub(super) fn as_json(document: &Value) -> String {
    json_text(&format!("{document:#}")).into_owned()
}

/// JSON text with the same escapes.
fn json_text(text: &str) -> Cow<'_, str> {
    // Those below 32 are escaped already, or lines' ends between values.
    escaped(text, |letter| match names::byte_of(letter) {
        Some(byte) => Some(format!("\\\\x{byte:02x}")),
        None if letter.is_control() && letter != '\n' => {
            Some(format!("\\u{:04x}", u32::from(letter)))
        }
        None => None,
    })
}

/// A text with some letters replaced.
fn escaped(text: &str, other_way: impl Fn(char) -> Option<String>) -> Cow<'_, str> {
    if !text.contains(|letter| other_way(letter).is_some()) {
        return text.into();
    }
    let shown = |letter: char| other_way(letter).unwrap_or_else(|| letter.to_string());
    text.chars().map(shown).collect()
}

/// Whether stderr is a terminal that can rewrite its line.
fn is_drawn_on() -> bool {
    let has_name = |name: std::ffi::OsString| !name.is_empty() && name != "dumb";
    io::stderr().is_terminal() && std::env::var_os("TERM").is_some_and(has_name)
}

/// Progress of the current work: a line that is rewritten, and removed at the end.
#[derive(Default)]
struct Bars {
    bar: Mutex<Option<Bar>>,
}

/// Progress of one piece of work.
struct Bar {
    what: String,
    /// Steps in all; 0 if unknown.
    steps: u64,
    done: u64,
    started: Instant,
    /// Time of the last writing.
    written: Option<Instant>,
}

/// Time between two writings.
const REFRESH: Duration = Duration::from_millis(100);
/// Longest text before the percentage: lines must not wrap.
const MOST_LETTERS: usize = 56;

impl Bar {
    /// The finished share, and the remaining time at the present rate.
    fn line(&self, elapsed: Duration) -> String {
        let what: String = self.what.chars().take(MOST_LETTERS).collect();
        let share = self.done.min(self.steps) as f64 / self.steps.max(1) as f64;
        if self.steps == 0 || share == 0.0 {
            return format!("{what} ...");
        }
        let left = elapsed.as_secs_f64() * (1.0 - share) / share;
        let left = match left {
            seconds if seconds < 99.5 => format!("{seconds:.0} s"),
            seconds if seconds < 5970.0 => format!("{:.0} min", seconds / 60.0),
            seconds => format!("{:.1} h", seconds / 3600.0),
        };
        format!("{what} {:3.0} % ({left} left)", 100.0 * share)
    }

    fn write(&mut self) {
        let now = Instant::now();
        if self.written.is_some_and(|at| now - at < REFRESH) {
            return;
        }
        self.written = Some(now);
        // Back to the beginning of the line; the rest of the line is cleared.
        let _ = write!(
            io::stderr().lock(),
            "\r{}\x1b[K",
            self.line(now - self.started)
        );
    }
}

impl Bars {
    /// Replaces the bar, and clears its line if it had one.
    fn put(&self, bar: Option<Bar>) {
        let mut slot = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        if slot.take().is_some() {
            let _ = write!(io::stderr().lock(), "\r\x1b[K");
        }
        *slot = bar;
        // Work of known length is written at its first step.
        let unknown = slot.iter_mut().filter(|bar| bar.steps == 0);
        unknown.for_each(Bar::write);
    }
}

impl Progress for Bars {
    fn begin(&self, what: &str, steps: u64) {
        self.put(Some(Bar {
            what: harmless(what).replace('\n', " "),
            steps,
            done: 0,
            started: Instant::now(),
            written: None,
        }));
    }

    fn advance(&self, steps: u64) {
        let mut slot = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bar) = &mut *slot {
            bar.done += steps;
            bar.write();
        }
    }

    fn end(&self) {
        self.put(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_one_line_with_the_time_that_is_left() {
        let line = |what: &str, steps, done, seconds| {
            let bar = Bar {
                what: what.to_owned(),
                steps,
                done,
                started: Instant::now(),
                written: None,
            };
            bar.line(Duration::from_secs(seconds))
        };
        for (what, steps, done, seconds, expected) in [
            ("reading a", 0, 9, 5, "reading a ..."),
            ("building", 200, 50, 10, "building  25 % (30 s left)"),
            ("b", 4, 1, 100, "b  25 % (5 min left)"),
            ("b", 4, 1, 12_000, "b  25 % (10.0 h left)"),
            ("b", 4, 5, 3, "b 100 % (0 s left)"),
        ] {
            assert_eq!(line(what, steps, done, seconds), expected);
        }
        assert!(line(&"x".repeat(500), 4, 1, 9).chars().count() < 80);
    }

    #[test]
    fn names_do_not_move_the_cursor() {
        assert_eq!(harmless("a\tb\n\u{e9}"), "a\tb\n\u{e9}");
        assert_eq!(harmless("\u{1b}[2Jx\r\u{9b}"), "\\u{1b}[2Jx\\r\\u{9b}");
        assert_eq!(harmless("\u{10ffff}.vox"), "\\xff.vox");
        let document = serde_json::json!({ "a": "\u{10ffff}\u{9b}\u{1b}" });
        let text = as_json(&document);
        assert!(
            text.bytes()
                .all(|byte| (b' '..127).contains(&byte) || byte == b'\n'),
            "{text}"
        );
        let read: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["a"], "\\xff\u{9b}\u{1b}");
    }
}
