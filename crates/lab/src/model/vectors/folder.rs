//! A folder of files that appear when all of them are whole.

use std::fs;
use std::io;
use std::path::Path;

use super::VectorsError;
use shiftvox::whole::{self, WholeError};

pub(super) const MANIFEST: &str = "manifest.json";

pub(super) fn failed(path: &Path, source: io::Error) -> VectorsError {
    VectorsError::Store(WholeError::Io {
        path: path.to_owned(),
        source,
    })
}

/// Checks before long work that vectors may be written to a folder.
///
/// # Errors
/// [`WholeError::Exists`] if there are files and none may be replaced, others where no folder can be made.
pub fn check_free(path: &Path, overwrite: bool) -> Result<(), VectorsError> {
    let is_empty = || fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
    if !overwrite && fs::symlink_metadata(path).is_ok() && !is_empty() {
        return Err(WholeError::Exists(path.to_owned()).into());
    }
    if fs::symlink_metadata(path).is_ok() && !path.is_dir() {
        return Err(failed(path, io::ErrorKind::NotADirectory.into()));
    }
    Ok(whole::check_folder(whole::folder_of(path))?)
}

/// Fills a temporary folder beside the folder's place, then moves its files. Files of other names stay.
pub(super) fn write<T>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&Path) -> Result<T, VectorsError>,
) -> Result<T, VectorsError> {
    check_free(path, overwrite)?;
    let parent = whole::folder_of(path);
    whole::make_folder(parent)?;
    // Removed with everything left in it, whatever happens.
    let shelter = whole::TemporaryFolder::within(parent)?;
    let made = shelter.path().join("made");
    fs::create_dir(&made).map_err(|e| failed(path, e))?;
    let result = fill(&made)?;
    check_free(path, overwrite)?;
    let moved = whole::undisturbed(|| {
        if !path.exists() {
            return fs::rename(&made, path);
        }
        for entry in fs::read_dir(&made)? {
            let name = entry?.file_name();
            fs::rename(made.join(&name), path.join(&name))?;
        }
        Ok(())
    });
    moved.map_err(|e| failed(path, e))?;
    Ok(result)
}
