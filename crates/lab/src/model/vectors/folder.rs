//! A folder of files that appears completely or not at all.

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

/// Whether there is a folder that may be replaced: an empty one or, with `overwrite`, one of vectors.
fn is_replaceable(path: &Path, overwrite: bool) -> Result<bool, VectorsError> {
    let kind = match fs::symlink_metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(false),
        Err(e) => return Err(failed(path, e)),
        Ok(metadata) => metadata.file_type(),
    };
    let refused = |other: &str| match overwrite {
        false => Err(VectorsError::Store(WholeError::Exists(path.to_owned()))),
        true => Err(VectorsError::Foreign {
            path: path.to_owned(),
            other: other.to_owned(),
        }),
    };
    if !kind.is_dir() {
        return refused("it is not a folder");
    }
    let (mut names, mut others) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(path).map_err(|e| failed(path, e))? {
        let entry = entry.map_err(|e| failed(path, e))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        let end = name.rsplit('.').next().unwrap_or_default();
        if !is_file || !["jsonl", "hex"].contains(&end) && name != MANIFEST {
            others.push(name.clone());
        }
        names.push(name);
    }
    match others.first() {
        _ if names.is_empty() => Ok(true),
        Some(other) => refused(other),
        None if !overwrite || !names.iter().any(|name| name == MANIFEST) => {
            refused("there is no manifest")
        }
        None => Ok(true),
    }
}

/// Checks before long work that vectors may be written to a folder.
///
/// # Errors
/// [`WholeError::Exists`] if the folder may not be overwritten; [`VectorsError::Foreign`] if it may, but holds other
/// things.
pub fn check_free(path: &Path, overwrite: bool) -> Result<(), VectorsError> {
    is_replaceable(path, overwrite)?;
    Ok(whole::check_folder(whole::folder_of(path))?)
}

/// Fills a folder under a temporary name beside its place, then renames it.
pub(super) fn write<T>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&Path) -> Result<T, VectorsError>,
) -> Result<T, VectorsError> {
    is_replaceable(path, overwrite)?;
    let parent = whole::folder_of(path);
    whole::make_folder(parent)?;
    // Removed with everything left in it, whatever happens.
    let shelter = whole::TemporaryFolder::within(parent)?;
    let made = shelter.path().join("made");
    fs::create_dir(&made).map_err(|e| failed(path, e))?;
    let result = fill(&made)?;
    // Outside of the shelter, so that the old folder is not removed before the new one is in its place.
    let before = shelter.path().with_extension("old");
    // The path may have changed meanwhile.
    let is_old = is_replaceable(path, overwrite)?;
    let renamed = whole::undisturbed(|| {
        if is_old {
            fs::rename(path, &before)?;
        }
        fs::rename(&made, path).inspect_err(|_| {
            // The first error is the one to report.
            let _ = fs::rename(&before, path);
        })
    });
    renamed.map_err(|e| failed(path, e))?;
    if is_old {
        let _ = fs::remove_dir_all(&before);
    }
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_folders_with_a_manifest_are_replaced() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("centre.jsonl"), b"mine").unwrap();
        let refused = check_free(folder.path(), true);
        assert!(matches!(refused, Err(VectorsError::Foreign { .. })));
        fs::write(folder.path().join(MANIFEST), b"{}").unwrap();
        check_free(folder.path(), true).unwrap();
    }
}
