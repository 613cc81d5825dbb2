//! Temporary files and folders: listed for signal handlers, and locked, so that other processes recognise abandoned
//! ones.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile, TempDir};

use super::{WholeError, failed};

const PREFIX: &str = ".shiftvox-";
const SUFFIX: &str = ".tmp";
/// Most bytes of a file's name that its temporary name repeats; names have at most 255.
const MOST_NAME: usize = 100;
const MOST_TRIES: u32 = 100;

pub(super) struct InProgress {
    unfinished: Vec<PathBuf>,
    /// Folders that were searched for abandoned files.
    pub(super) tidied: Vec<PathBuf>,
}

static IN_PROGRESS: Mutex<InProgress> = Mutex::new(InProgress {
    unfinished: Vec::new(),
    tidied: Vec::new(),
});

pub(super) fn in_progress() -> MutexGuard<'static, InProgress> {
    IN_PROGRESS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all unfinished files of this process, then calls `end`, during which no file is renamed: for signal
/// handlers.
pub fn remove_unfinished<R>(end: impl FnOnce() -> R) -> R {
    let mut list = in_progress();
    for path in list.unfinished.drain(..) {
        // Other threads may still add files to a folder, and a file may belong to another user.
        for _ in 0..MOST_TRIES {
            let removed = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
            if removed.is_ok() || fs::symlink_metadata(&path).is_err() {
                break;
            }
        }
    }
    end()
}

/// A temporary file or folder, listed for removal until this is dropped.
#[derive(Debug)]
pub struct TemporaryGuard(PathBuf);

impl TemporaryGuard {
    /// Makes, lists and locks a file or a folder, without an interruption by a signal.
    fn around<T: AsRef<Path>>(
        make: impl Fn() -> io::Result<T>,
        lock: impl Fn(&T) -> bool,
    ) -> io::Result<(T, Self)> {
        loop {
            let mut list = in_progress();
            let made = make()?;
            let path = made.as_ref().to_owned();
            list.unfinished.push(path.clone());
            drop(list);
            let guard = Self(path);
            // Otherwise another process removed it before it was locked. Without locks none removes it.
            if !lock(&made) || guard.0.exists() {
                return Ok((made, guard));
            }
        }
    }
}

impl Drop for TemporaryGuard {
    fn drop(&mut self) {
        in_progress().unfinished.retain(|path| *path != self.0);
    }
}

impl InProgress {
    pub(super) fn forget(&mut self, guard: TemporaryGuard) {
        self.unfinished.retain(|path| *path != guard.0);
        std::mem::forget(guard);
    }
}

/// Creates a temporary folder. It is removed when it is dropped; if the process is killed, by the next one that writes
/// there.
pub fn temporary_folder(parent: &Path) -> Result<(TempDir, FolderLock), WholeError> {
    tidy(parent);
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    let make = || {
        let folder = builder.tempdir_in(parent)?;
        let open = File::open(folder.path()).ok();
        Ok(Opened(folder, open))
    };
    let lock = |made: &Opened| made.1.as_ref().is_some_and(|open| open.lock().is_ok());
    let made = TemporaryGuard::around(make, lock);
    let (Opened(folder, lock), guard) = made.map_err(|e| failed(parent, e))?;
    let lock = FolderLock {
        _guard: guard,
        _lock: lock,
    };
    Ok((folder, lock))
}

struct Opened(TempDir, Option<File>);

impl AsRef<Path> for Opened {
    fn as_ref(&self) -> &Path {
        self.0.path()
    }
}

/// Protects a temporary folder from other processes.
#[derive(Debug)]
pub struct FolderLock {
    _guard: TemporaryGuard,
    _lock: Option<File>,
}

pub(super) fn temporary(folder: &Path, path: &Path) -> io::Result<(NamedTempFile, TemporaryGuard)> {
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
        // As for any new file; the process's mask applies.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let lock = |file: &NamedTempFile| file.as_file().lock().is_ok();
    TemporaryGuard::around(|| builder.tempfile_in(folder), lock)
}

/// Removes the abandoned files of other processes in a folder, when this process first writes to it.
pub(super) fn tidy(folder: &Path) {
    {
        let mut list = in_progress();
        if list.tidied.iter().any(|known| known == folder) {
            return;
        }
        list.tidied.push(folder.to_owned());
    }
    // Errors are harmless.
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let Ok(kind) = entry.file_type() else {
            continue;
        };
        if (kind.is_file() || kind.is_dir()) && name.starts_with(PREFIX) && name.ends_with(SUFFIX) {
            remove_if_left(&entry.path(), kind.is_dir());
        }
    }
}

fn remove_if_left(path: &Path, is_folder: bool) {
    let Ok(file) = File::options().read(true).write(!is_folder).open(path) else {
        return;
    };
    match file.try_lock() {
        Ok(()) if is_folder => drop(fs::remove_dir_all(path)),
        Ok(()) => drop(fs::remove_file(path)),
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
    }
}
