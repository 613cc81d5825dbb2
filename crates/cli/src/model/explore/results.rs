//! The file of results: lines are appended to it as points are measured.

use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{CliError, Kind};
use shiftvox::bounded;
use shiftvox::whole;
use shiftvox_lab::model::explore::lines::{self, Recorded};

pub(super) struct ResultsFile {
    file: File,
    path: PathBuf,
}

impl ResultsFile {
    /// Opens or makes a file and reads it. An incomplete last line is removed.
    pub(super) fn open(path: &Path, asked: &[Value]) -> Result<(Self, Recorded), CliError> {
        let at = |kind: Kind| {
            move |error: &dyn std::fmt::Display| CliError::new(kind, error).at(path.display())
        };
        if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
            return Err(at(Kind::Input)(&"it is not a regular file"));
        }
        whole::make_folder(whole::folder_of(path))?;
        let mut options = File::options();
        let file = options.create(true).append(true).open(path);
        let file = file.map_err(|error| at(Kind::Run)(&error))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(at(Kind::Run)(&"another run writes to it"));
            }
            Err(TryLockError::Error(_)) => {}
        }
        let text = bounded::read(path, u64::MAX).map_err(|error| at(Kind::Run)(&error))?;
        let recorded = lines::read(&text, asked).map_err(|error| {
            at(Kind::Input)(&error).advise("give another name with --results, or remove the file")
        })?;
        if recorded.bytes < text.len() {
            file.set_len(recorded.bytes as u64)
                .map_err(|error| at(Kind::Run)(&error))?;
        }
        let path = path.to_owned();
        Ok((Self { file, path }, recorded))
    }

    pub(super) fn append(&mut self, line: &str) -> Result<(), CliError> {
        let written = self.file.write_all(format!("{line}\n").as_bytes());
        written.map_err(|error| CliError::new(Kind::Run, error).at(self.path.display()))
    }
}
