//! Signals that stop the program: Ctrl-C, `kill`, a closed terminal.
//!
//! Unfinished files are removed; then the program ends by the signal, so that shells see why (130 for Ctrl-C).

/// Installs the handlers. A file beyond a limit (SIGXFSZ) is an error of the write. A signal that the program was started
/// to ignore, as by `nohup`, stays ignored.
#[cfg(unix)]
pub(super) fn tidy_up_when_stopped() {
    use std::sync::Arc;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    use shiftvox::whole::remove_unfinished;

    // Nobody reads the flag: what counts is that the signal is caught.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
    let ignored = ignored_signals();
    let wanted = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = Signals::new(wanted) else {
        return;
    };
    let wait = move || {
        if let Some(signal) = signals.forever().next() {
            remove_unfinished(|| {
                let _ = emulate_default_handler(signal);
                std::process::exit(128 + signal);
            });
        }
    };
    let _ = std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(wait);
}

#[cfg(not(unix))]
pub(super) fn tidy_up_when_stopped() {}

/// The signals that this process was started to ignore, a bit each, from signal 1 on. Only Linux says.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0)
}
