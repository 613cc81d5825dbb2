//! Signals: Ctrl-C, `kill`, a closed terminal, refused memory (SIGABRT), a mapped file cut short (SIGBUS).
//!
//! A waiting thread removes unfinished files. After a request to stop, it ends the program by the signal, so that shells
//! show 130 for Ctrl-C. After the other two, it reports the error and exits with the usual code.

use std::sync::Mutex;

static SCENES: Mutex<Vec<String>> = Mutex::new(Vec::new());

pub(super) fn reads(scene: &str) {
    if let Ok(mut scenes) = SCENES.lock()
        && !scenes.iter().any(|known| known == scene)
    {
        scenes.push(scene.to_owned());
    }
}

#[cfg(unix)]
pub(super) use handlers::install;

#[cfg(not(unix))]
pub(super) fn install(_json: bool) {}

#[cfg(unix)]
mod handlers {
    use std::io::{self, Write};
    use std::sync::Arc;

    use libc::{SIGABRT, SIGBUS, SIGHUP, SIGINT, SIGTERM, SIGXFSZ, c_int};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::{emulate_default_handler, register};

    use crate::error::{CliError, Kind};
    use crate::{console, document};
    use shiftvox::whole::remove_unfinished;

    /// Memory that is given back when the system refuses more, for the report.
    const RESERVE: usize = 1 << 20;
    /// How long a thread that cannot continue waits for the end of the program, milliseconds.
    const PATIENCE_MS: c_int = 5000;

    /// Installs the handlers. Without them the program ends as any other does. `json`: whether errors are also printed
    /// as JSON.
    fn try_install(json: bool) -> io::Result<()> {
        // A write beyond a limit of file size becomes an error of the write.
        signal_hook::flag::register(SIGXFSZ, Arc::default())?;
        // Shells and `nohup` start programs with signals that stay ignored.
        let ignored = ignored_signals();
        let stops = [SIGINT, SIGTERM, SIGHUP].into_iter();
        let wanted = stops.filter(|signal| ignored >> (signal - 1) & 1 == 0);
        let mut signals = Signals::new(wanted.chain([SIGABRT, SIGBUS]))?;
        let mut reserve: Vec<u8> = Vec::new();
        let _ = reserve.try_reserve_exact(RESERVE);
        let reserve = std::hint::black_box(reserve);
        let wait = move || {
            let signal = signals.forever().next();
            drop(reserve);
            match signal {
                Some(signal @ (SIGABRT | SIGBUS)) => report(signal, json),
                Some(signal) => remove_unfinished(|| {
                    let _ = emulate_default_handler(signal);
                    std::process::exit(128 + signal);
                }),
                None => {}
            }
        };
        let thread = std::thread::Builder::new().name("signals".to_owned());
        thread.stack_size(1 << 18).spawn(wait)?;
        for signal in [SIGABRT, SIGBUS] {
            let code = c_int::from(kind(signal).code());
            // SAFETY: `poll` and `_exit` may be called in handlers. The thread above was woken before, as actions run
            // in the order of their registration.
            unsafe {
                register(signal, move || {
                    libc::poll(std::ptr::null_mut(), 0, PATIENCE_MS);
                    libc::_exit(code);
                })?;
            }
        }
        Ok(())
    }

    pub(crate) fn install(json: bool) {
        let _ = try_install(json);
    }

    fn kind(signal: c_int) -> Kind {
        match signal {
            SIGBUS => Kind::Input,
            _ => Kind::Limit,
        }
    }

    fn report(signal: c_int, json: bool) {
        let (message, advice) = match signal {
            SIGBUS => (
                "a file that is read was cut short, or its disk failed, while it was in use",
                "see that nothing else writes to it, and begin again",
            ),
            _ => (
                "the system refuses memory that is needed",
                "ask for a smaller picture or a scene of fewer levels, or give the program more memory",
            ),
        };
        let error = CliError::new(kind(signal), message).advise(advice);
        let error = match super::SCENES.try_lock() {
            Ok(scenes) if !scenes.is_empty() => error.at(scenes.join(", ")),
            _ => error,
        };
        console::report_error(&error);
        remove_unfinished(|| {
            if json {
                let document = document::failed(None, &error);
                let _ = writeln!(io::stdout(), "{document:#}");
            }
            std::process::exit(i32::from(error.kind.code()));
        });
    }

    /// Signals that this process was started to ignore, as bits from signal 1 on (Linux).
    fn ignored_signals() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.unwrap_or(0)
    }
}
