//! A folder of files that appears whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use shiftvox::whole;
use shiftvox::whole::WholeError;

/// The file that identifies a folder of vectors.
pub(super) const MANIFEST: &str = "manifest.json";
/// The file that describes the others.
pub(super) const README: &str = "README.txt";
/// The header with the frame's constants.
pub(super) const PARAMETERS: &str = "parameters.vh";
/// How testbenches end.
pub(super) const VERILOG: &str = "v";
/// How the files of rows end.
pub(super) const ROWS: &str = "hex";

/// Why a folder was not written. Whatever stood there before still does.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// It is there already, or cannot be written.
    #[error(transparent)]
    Store(#[from] WholeError),
    /// What is there did not come from here, and is not replaced even on demand.
    #[error("{path} holds more than vectors ({other}), so it is not replaced")]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// What is in it.
        other: String,
    },
}

fn failed(path: &Path, source: io::Error) -> FolderError {
    FolderError::Store(WholeError::Io {
        path: path.to_owned(),
        source,
    })
}

/// What stands where a folder is to be.
enum Target {
    Nothing,
    EmptyFolder,
    Vectors,
}

/// Finds what stands at a path. Without `overwrite` only nothing and empty folders will do;
/// with it, a folder of vectors too, but nothing else.
fn find_target(path: &Path, overwrite: bool) -> Result<Target, FolderError> {
    let kind = match fs::symlink_metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Target::Nothing),
        Err(e) => return Err(failed(path, e)),
        Ok(metadata) => metadata.file_type(),
    };
    let exists = || FolderError::Store(WholeError::Exists(path.to_owned()));
    let foreign = |other: &str| FolderError::Foreign {
        path: path.to_owned(),
        other: other.to_owned(),
    };
    if !kind.is_dir() {
        return Err(if overwrite {
            foreign("it is no folder")
        } else {
            exists()
        });
    }
    let mut is_known = false;
    let mut others = None;
    let mut is_empty = true;
    for entry in fs::read_dir(path).map_err(|e| failed(path, e))? {
        let entry = entry.map_err(|e| failed(path, e))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        let is_rows = Path::new(&name)
            .extension()
            .is_some_and(|e| e == ROWS || e == VERILOG);
        is_empty = false;
        is_known |= name == MANIFEST;
        if !(is_file && (is_rows || [MANIFEST, README, PARAMETERS].contains(&name.as_str()))) {
            others = Some(name);
        }
    }
    match (is_empty, overwrite, others) {
        (true, ..) => Ok(Target::EmptyFolder),
        (_, false, _) => Err(exists()),
        (_, true, Some(other)) => Err(foreign(&other)),
        (_, true, None) if is_known => Ok(Target::Vectors),
        (_, true, None) => Err(foreign("no manifest among them")),
    }
}

/// Whether vectors may be written to a folder; called before long work.
///
/// # Errors
/// [`WholeError::Exists`] where a file or a folder with anything in it is there
/// and may not be overwritten; [`FolderError::Foreign`] where it may, but holds other things.
pub fn check_free(path: &Path, overwrite: bool) -> Result<(), FolderError> {
    find_target(path, overwrite)?;
    Ok(whole::check_folder(whole::folder_of(path))?)
}

/// Fills a folder under a temporary name beside its place, then renames it.
///
/// # Errors
/// As [`check_free`]; the errors of `fill`; where the system refuses.
pub(super) fn write<T, E: From<FolderError>>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&Path) -> Result<T, E>,
) -> Result<T, E> {
    find_target(path, overwrite)?;
    let parent = whole::folder_of(path);
    whole::make_folder(parent).map_err(FolderError::from)?;
    // Removed with all that is left in it, however this ends.
    let (shelter, _in_use) = whole::temporary_folder(parent).map_err(FolderError::from)?;
    let made = shelter.path().join("made");
    fs::create_dir(&made).map_err(|e| failed(path, e))?;
    let result = fill(&made)?;
    // Someone else may have been there meanwhile.
    match find_target(path, overwrite)? {
        Target::Nothing => {}
        Target::EmptyFolder => fs::remove_dir(path).map_err(|e| failed(path, e))?,
        Target::Vectors => {
            let before = shelter.path().join("before");
            fs::rename(path, &before).map_err(|e| failed(path, e))?;
            return match fs::rename(&made, path) {
                Ok(()) => Ok(result),
                Err(error) => {
                    // Back to what it was; the first error is the one to report.
                    let _ = fs::rename(&before, path);
                    Err(failed(path, error).into())
                }
            };
        }
    }
    fs::rename(&made, path).map_err(|e| failed(path, e))?;
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of the entries of a folder, in order.
    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<String> = entries
            .map(|entry| name(entry).into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn put(path: &Path, overwrite: bool, name: &str) -> Result<(), FolderError> {
        write(path, overwrite, |folder| {
            fs::write(folder.join(MANIFEST), b"{}").map_err(|e| failed(folder, e))?;
            fs::write(folder.join(name), b"").map_err(|e| failed(folder, e))
        })
    }

    #[test]
    fn whole_or_not_at_all() {
        let shelter = tempfile::tempdir().unwrap();
        let path = shelter.path().join("new/vectors");
        put(&path, false, "one.hex").unwrap();
        assert_eq!(names(&path), [MANIFEST, "one.hex"]);
        let again = put(&path, false, "two.hex");
        assert!(matches!(
            again,
            Err(FolderError::Store(WholeError::Exists(_)))
        ));
        put(&path, true, "two.hex").unwrap();
        assert!(names(&path).contains(&"two.hex".to_owned()));
        assert!(!names(&path).contains(&"one.hex".to_owned()));
        let broken: Result<(), FolderError> = write(&path, true, |folder| {
            Err(failed(folder, io::Error::other("power cut")))
        });
        assert!(broken.is_err());
        assert!(names(&path).contains(&"two.hex".to_owned()));
        assert_eq!(names(&shelter.path().join("new")), ["vectors"]);
    }

    #[test]
    fn other_things_are_never_replaced() {
        let shelter = tempfile::tempdir().unwrap();
        let path = shelter.path().join("home");
        fs::create_dir(&path).unwrap();
        put(&path, false, "one.hex").unwrap();
        fs::write(path.join("thesis.tex"), b"mine").unwrap();
        let refused = put(&path, true, "two.hex");
        assert!(matches!(refused, Err(FolderError::Foreign { .. })));
        assert_eq!(fs::read(path.join("thesis.tex")).unwrap(), b"mine");
        fs::remove_file(path.join("thesis.tex")).unwrap();
        fs::remove_file(path.join(MANIFEST)).unwrap();
        let refused = put(&path, true, "two.hex");
        assert!(matches!(refused, Err(FolderError::Foreign { .. })));
        let file = shelter.path().join("file");
        fs::write(&file, b"mine").unwrap();
        assert!(put(&file, true, "two.hex").is_err());
        assert_eq!(fs::read(&file).unwrap(), b"mine");
    }
}
