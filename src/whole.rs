//! Files appear whole or not at all, also when the program is stopped.
//!
//! A file is written under a temporary name beside its place, `.shiftvox-NAME-??????.tmp`, and renamed.
//! A signal handler that ends the program calls [`remove_unfinished`] first. What a killed or crashed process left
//! behind is removed by the next one that writes to the folder: such a file is known by its name and by
//! its lock, which ends with the process that held it.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile, TempPath};

/// How temporary names begin and end.
const PREFIX: &str = ".shiftvox-";
const SUFFIX: &str = ".tmp";
/// Most bytes of a file's name that its temporary name repeats; names have at most 255.
const MOST_NAME: usize = 100;

/// Why a file was not written. Whatever stood there before still does.
#[derive(Debug, thiserror::Error)]
pub enum WholeError {
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

fn failed(path: &Path, source: io::Error) -> WholeError {
    WholeError::Io {
        path: path.to_owned(),
        source,
    }
}

/// What this process is writing.
struct InProgress {
    /// Temporary files and folders that have not got their names yet.
    unfinished: Vec<PathBuf>,
    /// Folders that were searched for what other processes left behind.
    tidied: Vec<PathBuf>,
}

static IN_PROGRESS: Mutex<InProgress> = Mutex::new(InProgress {
    unfinished: Vec::new(),
    tidied: Vec::new(),
});

fn in_progress() -> MutexGuard<'static, InProgress> {
    // Lists of names, usable even after a panic.
    IN_PROGRESS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all that this process has begun to write, then calls `end`, during which no file gets its name:
/// for signal handlers.
pub fn remove_unfinished<R>(end: impl FnOnce() -> R) -> R {
    let mut in_progress = in_progress();
    for path in in_progress.unfinished.drain(..) {
        // Gone already, or not ours to remove: nothing can be done about it.
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
    }
    end()
}

/// A temporary file or folder, listed for removal until this is dropped.
#[derive(Debug)]
pub struct TemporaryGuard(PathBuf);

impl TemporaryGuard {
    /// Lists one that was just made.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        in_progress().unfinished.push(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for TemporaryGuard {
    fn drop(&mut self) {
        in_progress().unfinished.retain(|path| *path != self.0);
    }
}

/// Whether a file may be written; called before long work.
///
/// # Errors
/// [`WholeError::Exists`] where something is there already and may not be overwritten.
pub fn check_free(path: &Path, overwrite: bool) -> Result<(), WholeError> {
    if !overwrite && fs::symlink_metadata(path).is_ok() {
        return Err(WholeError::Exists(path.to_owned()));
    }
    Ok(())
}

/// Writes a file under a temporary name beside its place and renames it.
///
/// Its folder is made if it does not exist. With `overwrite` an older file is
/// replaced in one step; without, an existing file is an error, also when it
/// appears while this one is written.
///
/// # Errors
/// See [`WholeError`].
pub fn write_with(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), WholeError> {
    check_free(path, overwrite)?;
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    tidy(folder);
    let (mut file, guard) = temporary(folder, path).map_err(|e| failed(folder, e))?;
    fill(file.as_file_mut()).map_err(|e| failed(path, e))?;
    let (_open, temporary) = file.into_parts();
    keep(temporary, path, overwrite, guard)
}

/// Gives a temporary file its name.
fn keep(
    temporary: TempPath,
    path: &Path,
    overwrite: bool,
    guard: TemporaryGuard,
) -> Result<(), WholeError> {
    let kept = {
        // Not while the program is being ended.
        let _in_progress = in_progress();
        if overwrite {
            temporary.persist(path)
        } else {
            temporary.persist_noclobber(path)
        }
    };
    drop(guard);
    match kept {
        Ok(()) => Ok(()),
        Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => {
            Err(WholeError::Exists(path.to_owned()))
        }
        Err(e) => Err(failed(path, e.error)),
    }
}

/// A temporary file for a place, locked for as long as it is open.
fn temporary(folder: &Path, path: &Path) -> io::Result<(NamedTempFile, TemporaryGuard)> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let end = (0..=name.len().min(MOST_NAME))
        .rev()
        .find(|&end| name.is_char_boundary(end));
    let prefix = format!("{PREFIX}{}-", &name[..end.unwrap_or(0)]);
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file gets; the process's mask takes its share.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    loop {
        let file = builder.tempfile_in(folder)?;
        let guard = TemporaryGuard::new(file.path());
        // Where there are no locks, nobody takes it for left behind either.
        let is_locked = file.as_file().lock().is_ok();
        if !is_locked || file.path().exists() {
            return Ok((file, guard));
        }
        // Another process was quicker and took it for one.
    }
}

/// Removes what ended processes left in a folder, the first time that this one writes to it.
fn tidy(folder: &Path) {
    {
        let mut in_progress = in_progress();
        if in_progress.tidied.iter().any(|known| known == folder) {
            return;
        }
        in_progress.tidied.push(folder.to_owned());
    }
    // Whatever cannot be read or removed stays: it does not stand in the way.
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && name.starts_with(PREFIX) && name.ends_with(SUFFIX) {
            remove_if_left(&entry.path());
        }
    }
}

fn remove_if_left(path: &Path) {
    let Ok(file) = File::options().write(true).open(path) else {
        return;
    };
    match file.try_lock() {
        // Removed while it is locked: see `temporary`.
        Ok(()) => drop(fs::remove_file(path)),
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::io::Write;

    /// Names of what is in a folder, in order.
    pub(crate) fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn put(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), WholeError> {
        write_with(path, overwrite, |file| file.write_all(bytes))
    }

    #[test]
    fn whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/a.txt");
        put(&path, b"one", false).unwrap();
        assert!(matches!(
            put(&path, b"two", false),
            Err(WholeError::Exists(_))
        ));
        assert_eq!(fs::read(&path).unwrap(), b"one");
        put(&path, b"three", true).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"three");
        let broken = write_with(&path, true, |file| {
            file.write_all(b"half")?;
            let within = names(&folder.path().join("new"));
            assert!(within[0].starts_with(".shiftvox-a.txt-") && within[0].ends_with(".tmp"));
            Err(io::Error::other("power cut"))
        });
        assert!(broken.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"three");
        assert_eq!(names(&folder.path().join("new")), ["a.txt"]);
        // Something appears while the file is written.
        let late = folder.path().join("late");
        let raced = write_with(&late, false, |_| fs::write(&late, b"other"));
        assert!(matches!(raced, Err(WholeError::Exists(_))));
        assert_eq!(fs::read(&late).unwrap(), b"other");
        assert_eq!(names(folder.path()), ["late", "new"]);
    }

    #[test]
    fn names_of_any_length_do() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a".repeat(255), "\u{20ac}".repeat(85), "-".to_owned()] {
            put(&folder.path().join(&name), b"x", false).unwrap();
        }
        assert_eq!(names(folder.path()).len(), 3);
    }

    #[test]
    fn what_others_left_is_removed_and_what_they_write_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in [
            ".shiftvox-a.far-123456.tmp",
            ".shiftvox-b.far-123456.tmp",
            ".other.tmp",
            ".shiftvox-a.far",
        ] {
            fs::write(at(name), b"half").unwrap();
        }
        // Of another process that still writes: a lock is that of an open file.
        let other = File::open(at(".shiftvox-b.far-123456.tmp")).unwrap();
        other.lock().unwrap();
        put(&at("a.far"), b"whole", false).unwrap();
        let left = [
            ".other.tmp",
            ".shiftvox-a.far",
            ".shiftvox-b.far-123456.tmp",
            "a.far",
        ];
        assert_eq!(names(folder.path()), left);
    }
}
