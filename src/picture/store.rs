//! Files appear whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

/// Why a file was not written. Whatever stood there before still does.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Something is there already.
    #[error("{0} exists already")]
    Exists(PathBuf),
    /// The operating system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file, or its folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
}

/// Writes a file under a temporary name beside its place and renames it.
///
/// Its folder is made if it does not exist. With `overwrite` an older file is
/// replaced in one step; without, an existing file is an error, also when it
/// appears while this one is written.
///
/// # Errors
/// See [`StoreError`].
pub fn write(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), StoreError> {
    write_with(path, overwrite, |file| file.write_all(bytes))
}

/// As [`write()`], with the bytes coming from a closure.
///
/// # Errors
/// See [`StoreError`].
pub fn write_with(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut NamedTempFile) -> io::Result<()>,
) -> Result<(), StoreError> {
    check_free(path, overwrite)?;
    let failed = |at: &Path, source| StoreError::Io {
        path: at.to_owned(),
        source,
    };
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    let mut builder = Builder::new();
    builder.prefix(".shiftvox-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file gets; the process's mask takes its share.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(|e| failed(folder, e))?;
    fill(&mut file).map_err(|e| failed(path, e))?;
    let kept = if overwrite {
        file.persist(path)
    } else {
        file.persist_noclobber(path)
    };
    match kept {
        Ok(_) => Ok(()),
        Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => {
            Err(StoreError::Exists(path.to_owned()))
        }
        Err(e) => Err(failed(path, e.error)),
    }
}

/// Whether a file may be written: to ask before long work.
///
/// # Errors
/// [`StoreError::Exists`] where something is there already and may not be overwritten.
pub fn check_free(path: &Path, overwrite: bool) -> Result<(), StoreError> {
    if !overwrite && fs::symlink_metadata(path).is_ok() {
        return Err(StoreError::Exists(path.to_owned()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/a.txt");
        write(&path, b"one", false).unwrap();
        assert!(matches!(
            write(&path, b"two", false),
            Err(StoreError::Exists(_))
        ));
        assert_eq!(fs::read(&path).unwrap(), b"one");
        write(&path, b"three", true).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"three");
        let broken = write_with(&path, true, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("power cut"))
        });
        assert!(broken.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"three");
        assert_eq!(names(&folder.path().join("new")), ["a.txt"]);
    }
}
