//! Files without a name yet, and named temporary files and folders, which are listed for signal handlers.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile, TempDir};

use super::{WholeError, failed};

const PREFIX: &str = ".shiftvox-";
const SUFFIX: &str = ".tmp";
/// Most characters of a file's name that its temporary name repeats; names have at most 255 bytes.
const MOST_NAME: usize = 25;
const MOST_TRIES: u32 = 100;

static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Temporary paths of this process. While this is held, no signal handler ends it.
pub(super) fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all unfinished files of this process, then calls `end`, during which no file is renamed: for signal
/// handlers.
pub fn remove_unfinished<R>(end: impl FnOnce() -> R) -> R {
    let mut list = unfinished();
    for path in list.drain(..) {
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

/// A temporary path, listed for removal by signal handlers until this is dropped.
#[derive(Debug)]
pub(super) struct Listed(PathBuf);

impl Listed {
    /// Makes and lists a file or a folder, without an interruption by a signal.
    fn around<T: AsRef<Path>>(make: impl Fn() -> io::Result<T>) -> io::Result<(T, Self)> {
        let mut list = unfinished();
        let made = make()?;
        let path = made.as_ref().to_owned();
        list.push(path.clone());
        Ok((made, Self(path)))
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

/// A folder that is removed with all its contents when it is dropped, or by [`remove_unfinished`].
#[derive(Debug)]
pub struct TemporaryFolder {
    // Removed before it leaves the list.
    folder: TempDir,
    _listed: Listed,
}

impl TemporaryFolder {
    pub fn within(parent: &Path) -> Result<Self, WholeError> {
        let mut builder = Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX);
        let made = Listed::around(|| builder.tempdir_in(parent));
        let (folder, listed) = made.map_err(|e| failed(parent, e))?;
        Ok(Self {
            folder,
            _listed: listed,
        })
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// A file that has no name, or a temporary one.
#[derive(Debug)]
pub(super) enum Unfinished {
    /// It disappears with the process, however that ends.
    Nameless(File),
    Named(NamedTempFile, Listed),
}

impl Unfinished {
    /// A new file, later to be named `path` in `folder`.
    pub(super) fn new(folder: &Path, path: &Path) -> io::Result<Self> {
        match nameless(folder) {
            Some(file) => Ok(Self::Nameless(file)),
            None => Self::with_name(folder, path),
        }
    }

    pub(super) fn with_name(folder: &Path, path: &Path) -> io::Result<Self> {
        let mut options = File::options();
        options.read(true).write(true).create_new(true);
        let (file, listed) = Listed::around(|| named(folder, path, |to| options.open(to)))?;
        Ok(Self::Named(file, listed))
    }

    pub(super) fn file(&mut self) -> &mut File {
        match self {
            Self::Nameless(file) => file,
            Self::Named(file, _) => file.as_file_mut(),
        }
    }

    /// Names it, in place of another file if it may. `list` is that of [`unfinished`].
    pub(super) fn name(
        self,
        path: &Path,
        overwrite: bool,
        list: &mut Vec<PathBuf>,
    ) -> io::Result<()> {
        let temporary = match self {
            Self::Nameless(file) if !overwrite => return link(&file, path),
            // A link replaces nothing, but a renamed file does.
            Self::Nameless(file) => {
                named(super::folder_of(path), path, |to| link(&file, to))?.into_temp_path()
            }
            Self::Named(file, listed) => {
                list.retain(|path| *path != listed.0);
                std::mem::forget(listed);
                file.into_temp_path()
            }
        };
        let named = match overwrite {
            true => temporary.persist(path),
            false => temporary.persist_noclobber(path),
        };
        named.map_err(|e| e.error)
    }
}

/// Makes something with a temporary name that contains the later one.
fn named<T>(
    folder: &Path,
    path: &Path,
    make: impl FnMut(&Path) -> io::Result<T>,
) -> io::Result<NamedTempFile<T>> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name: String = name.chars().take(MOST_NAME).collect();
    let prefix = format!("{PREFIX}{name}-");
    Builder::new()
        .prefix(&prefix)
        .suffix(SUFFIX)
        .make_in(folder, make)
}

/// A file without a name, where the system has such files and can name them later.
#[cfg(target_os = "linux")]
fn nameless(folder: &Path) -> Option<File> {
    use rustix::fs::{Mode, OFlags};

    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(0o666)).ok()?);
    open_path(&file).exists().then_some(file)
}

#[cfg(target_os = "linux")]
fn link(file: &File, to: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD};

    let from = open_path(file);
    Ok(rustix::fs::linkat(
        CWD,
        from,
        CWD,
        to,
        AtFlags::SYMLINK_FOLLOW,
    )?)
}

#[cfg(target_os = "linux")]
fn open_path(file: &File) -> PathBuf {
    use std::os::fd::AsRawFd;

    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

#[cfg(not(target_os = "linux"))]
fn nameless(_: &Path) -> Option<File> {
    None
}

#[cfg(not(target_os = "linux"))]
fn link(_: &File, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
