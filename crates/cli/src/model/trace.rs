//! `--trace`: the first records, one by one.

use std::path::Path;

use hwmodel::cycles::{Hardware, Recorder};

use crate::console::Console;
use crate::error::CliError;
use shiftvox::whole;

/// Whether a trace has waveforms and not events. Fails where the name says no format.
pub(super) fn has_waves(path: &Path) -> Result<bool, CliError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("json") => Ok(false),
        Some("vcd") => Ok(true),
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
    match has_waves(path)? {
        false => recorder.write_chrome(hardware, &mut text)?,
        true => recorder.write_vcd(hardware, &mut text)?,
    }
    whole::write(path, &text, force)?;
    console.note(format!("{}: written", path.display()));
    Ok(())
}
