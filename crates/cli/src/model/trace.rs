//! `--trace`: the first records, one by one.

use std::path::Path;

use hwmodel::cycles::{Hardware, Recorder};

use crate::console::Console;
use crate::error::CliError;
use shiftvox::whole;

/// The format of a trace.
#[derive(Clone, Copy)]
pub(super) enum TraceKind {
    Events,
    Waves,
}

/// Fails where the name says no format.
pub(super) fn kind(path: &Path) -> Result<TraceKind, CliError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("json") => Ok(TraceKind::Events),
        Some("vcd") => Ok(TraceKind::Waves),
        _ => Err(CliError::usage(format!(
            "{}: a trace is .json (Perfetto) or .vcd (waveforms)",
            path.display()
        ))),
    }
}

/// Writes a trace.
pub(super) fn write(
    path: &Path,
    recorder: &Recorder,
    hardware: &Hardware,
    force: bool,
    console: &Console,
) -> Result<(), CliError> {
    let mut text = Vec::new();
    match kind(path)? {
        TraceKind::Events => recorder.write_chrome(hardware, &mut text)?,
        TraceKind::Waves => recorder.write_vcd(hardware, &mut text)?,
    }
    whole::write(path, &text, force)?;
    console.note(format!("{}: written", path.display()));
    Ok(())
}
