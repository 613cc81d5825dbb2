//! Refused memory (SIGABRT) and a mapped file cut short (SIGBUS).
//!
//! The handler wakes a waiting thread, which reports the error, removes unfinished files and exits with the usual code.
//! After five seconds the handler exits itself.

use std::hint::black_box;
use std::io::{self, Write};
use std::sync::Mutex;

static SCENES: Mutex<Vec<String>> = Mutex::new(Vec::new());

pub(super) fn reads(scene: &str) {
    if let Ok(mut scenes) = SCENES.lock()
        && !scenes.iter().any(|known| known == scene)
    {
        scenes.push(scene.to_owned());
    }
}

/// Memory that a backtrace may take, bytes.
const BACKTRACE: usize = 1 << 29;

/// Panics print no backtrace if there is little memory. The standard library reports memory that is refused meanwhile
/// with a backtrace, too, and waits for ever until the first is finished.
fn guard_backtraces() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let mut room: Vec<u8> = Vec::new();
        if room.try_reserve_exact(BACKTRACE).is_err() || black_box(&room).capacity() == 0 {
            let _ = writeln!(io::stderr(), "{panic}");
            return;
        }
        drop(room);
        usual(panic);
    }));
}

/// Installs the handlers. `json`: whether the error is also printed as a JSON document.
#[cfg(unix)]
pub(super) fn install(json: bool) {
    guard_backtraces();
    // Where there is no pipe or no thread, the program ends as any other does.
    let _ = handlers::install(json);
}

#[cfg(not(unix))]
pub(super) fn install(_json: bool) {
    guard_backtraces();
}

#[cfg(unix)]
mod handlers {
    use std::io::{self, Read, Write};
    use std::os::fd::IntoRawFd;
    use std::sync::atomic::{AtomicI32, Ordering};

    use libc::{SIGABRT, SIGBUS, c_int};

    use crate::error::{CliError, Kind};
    use crate::{console, document};
    use shiftvox::whole::remove_unfinished;

    /// The end of the pipe that handlers write to.
    static WAKE: AtomicI32 = AtomicI32::new(-1);
    /// Bytes that are given back when memory is refused, so that there are some for the report.
    const RESERVE: usize = 1 << 20;
    /// How long a handler waits to be ended, milliseconds.
    const PATIENCE_MS: c_int = 5000;

    pub(super) fn install(json: bool) -> io::Result<()> {
        let (mut reader, writer) = io::pipe()?;
        WAKE.store(writer.into_raw_fd(), Ordering::Relaxed);
        // First, since a thread may end the program as it starts.
        handle_signals();
        let mut reserve: Vec<u8> = Vec::new();
        // Where it is refused already, the report may be cut short.
        let _ = reserve.try_reserve_exact(RESERVE);
        let reserve = std::hint::black_box(reserve);
        let wait = move || {
            let mut signal = [0];
            if reader.read_exact(&mut signal).is_ok() {
                drop(reserve);
                end(c_int::from(signal[0]), json);
            }
        };
        std::thread::Builder::new()
            .name("fatal-signals".to_owned())
            .stack_size(1 << 18)
            .spawn(wait)?;
        Ok(())
    }

    fn handle_signals() {
        // Not by `signal-hook`: it calls the handler of the standard library first, which restores the default, so that
        // a second thread at the same fault would end the program.
        for signal in [SIGABRT, SIGBUS] {
            // SAFETY: a `sigaction` of zeros is one without flags and with an empty mask, and the
            // handler makes only calls that POSIX allows in handlers.
            unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                action.sa_sigaction = handler as *const () as libc::sighandler_t;
                libc::sigaction(signal, &raw const action, std::ptr::null_mut());
            }
        }
    }

    /// Wakes the thread that waits and lets it end the program. Without such a thread ends the program itself.
    extern "C" fn handler(signal: c_int) {
        let byte = signal as u8;
        // SAFETY: `write`, `poll` and `_exit` may be called in handlers; one byte is written from
        // one that lives.
        unsafe {
            if libc::write(WAKE.load(Ordering::Relaxed), (&raw const byte).cast(), 1) == 1 {
                libc::poll(std::ptr::null_mut(), 0, PATIENCE_MS);
            }
            libc::_exit(c_int::from(kind(signal).code()));
        }
    }

    fn kind(signal: c_int) -> Kind {
        match signal {
            SIGBUS => Kind::Input,
            _ => Kind::Limit,
        }
    }

    fn end(signal: c_int, json: bool) {
        let error = match signal {
            SIGBUS => CliError::new(
                kind(signal),
                "a file that is read was cut short, or its disk failed, while it was in use",
            )
            .advise("see that nothing else writes to it, and begin again"),
            // The standard library has said how much was refused.
            _ => CliError::new(kind(signal), "the system refuses memory that is needed").advise(
                "ask for a smaller picture or a scene of fewer levels, or give the program \
                 more memory",
            ),
        };
        // Held only while a name is added; where that very thread has stopped, there is no name.
        let error = match super::SCENES.try_lock() {
            Ok(scenes) if !scenes.is_empty() => error.at(scenes.join(", ")),
            _ => error,
        };
        console::report_error(&error);
        remove_unfinished(|| {
            if json {
                let document = document::failed(None, &error);
                let _ = writeln!(
                    io::stdout(),
                    "{}",
                    console::json_text(&format!("{document:#}"))
                );
            }
            std::process::exit(i32::from(error.kind.code()));
        });
    }
}

#[cfg(all(test, target_os = "linux"))]
#[test]
fn a_panic_without_memory_ends() {
    let this = "SHIFTVOX_PANICS_WITHOUT_MEMORY";
    if std::env::var(this).is_ok() {
        guard_backtraces();
        // For the message itself.
        let little: Vec<u8> = Vec::with_capacity(1 << 16);
        let mut taken: Vec<Vec<u8>> = Vec::with_capacity(1 << 16);
        for size in (6..26).rev().map(|log2| 1 << log2) {
            let mut more = Vec::new();
            while taken.len() < taken.capacity() && more.try_reserve_exact(size).is_ok() {
                taken.push(std::mem::take(&mut more));
            }
        }
        drop(black_box(little));
        panic!("no memory is left");
    }
    let script = "ulimit -v 200000; exec timeout 20 \"$0\" a_panic_without --nocapture";
    let mut again = std::process::Command::new("sh");
    again
        .args(["-c", script])
        .arg(std::env::current_exe().unwrap());
    let ended = again.envs([(this, "1"), ("RUST_BACKTRACE", "1")]).output();
    let ended = ended.unwrap();
    let told = String::from_utf8_lossy(&ended.stderr);
    assert!(told.contains("no memory is left"), "{told}");
    // 124: it had to be stopped.
    assert_ne!(ended.status.code(), Some(124), "{told}");
}
