//! Files appear whole or not at all, also when the program is stopped.
//!
//! A file is written under a temporary name beside its place, `.shiftvox-NAME-??????.tmp`, and renamed. A signal
//! handler must call [`remove_unfinished`] before it ends the program. The files of a killed process are removed by the
//! next one that writes to the folder. It recognises them by name and by lock, which ends with the process.

mod temporary;

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

pub use temporary::{FolderLock, TemporaryGuard, remove_unfinished, temporary_folder};
use temporary::{in_progress, temporary, tidy};

/// Checks whether a file may be written, before long work. Errors: [`WholeError::Exists`] if it exists and may not be
/// overwritten, [`WholeError::NoFolder`] without a folder for it, otherwise [`WholeError::Io`].
pub fn check_free(path: &Path, overwrite: bool) -> Result<(), WholeError> {
    let path = &check_place(path, overwrite)?;
    let folder = folder_of(path);
    if folder.is_dir() {
        tempfile::tempfile_in(folder).map_err(|e| failed(path, e))?;
    }
    Ok(())
}

fn check_place(path: &Path, overwrite: bool) -> Result<PathBuf, WholeError> {
    if !overwrite && fs::symlink_metadata(path).is_ok() {
        return Err(WholeError::Exists(path.to_owned()));
    }
    let path = target(path);
    match fs::metadata(&path) {
        Ok(there) if !there.is_file() => {
            return Err(failed(&path, io::Error::other("it is not a regular file")));
        }
        Err(e) if e.kind() == io::ErrorKind::InvalidFilename => return Err(failed(&path, e)),
        _ => {}
    }
    check_folder(folder_of(&path))?;
    Ok(path)
}

/// Checks whether a folder exists, or can be created in the one above it.
pub fn check_folder(folder: &Path) -> Result<(), WholeError> {
    if folder.is_dir() {
        return Ok(());
    }
    if fs::symlink_metadata(folder).is_ok() {
        return Err(failed(
            folder,
            io::Error::from(io::ErrorKind::NotADirectory),
        ));
    }
    // One missing folder is created; several are probably a typing error.
    match folder_of(folder).is_dir() {
        true => Ok(()),
        false => Err(WholeError::NoFolder(folder_of(folder).to_owned())),
    }
}

pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The file to which a path leads, which need not exist.
fn target(path: &Path) -> PathBuf {
    match fs::read_link(path) {
        Ok(link) => fs::canonicalize(path).unwrap_or_else(|_| folder_of(path).join(link)),
        Err(_) => path.to_owned(),
    }
}

/// Creates a folder in an existing one; otherwise [`WholeError::NoFolder`].
pub fn make_folder(folder: &Path) -> Result<(), WholeError> {
    match fs::create_dir(folder) {
        Ok(()) => Ok(()),
        Err(_) if folder.is_dir() => Ok(()),
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            Err(WholeError::NoFolder(folder_of(folder).to_owned()))
        }
        Err(e) => Err(failed(folder, e)),
    }
}

/// A written file with a temporary name, removed if it is never renamed.
#[derive(Debug)]
pub struct Prepared {
    file: NamedTempFile,
    path: PathBuf,
    overwrite: bool,
    guard: TemporaryGuard,
}

/// Writes a file under its temporary name. Its folder is created if the folder above exists.
pub fn prepare(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<Prepared, WholeError> {
    let path = check_place(path, overwrite)?;
    let folder = folder_of(&path);
    make_folder(folder)?;
    tidy(folder);
    let (mut file, guard) = temporary(folder, &path).map_err(|e| failed(folder, e))?;
    fill(file.as_file_mut()).map_err(|e| failed(&path, e))?;
    if let Ok(old) = fs::metadata(&path) {
        // Impossible for some files of other owners, which are replaced all the same.
        let _ = file.as_file().set_permissions(old.permissions());
    }
    Ok(Prepared {
        file,
        path,
        overwrite,
        guard,
    })
}

/// Renames files: all of them, or, if one fails, none that is new.
pub fn keep(files: Vec<Prepared>) -> Result<(), WholeError> {
    let mut list = in_progress();
    let mut kept: Vec<PathBuf> = Vec::new();
    let mut result = Ok(());
    let mut files = files.into_iter();
    for Prepared {
        file,
        path,
        overwrite,
        guard,
    } in files.by_ref()
    {
        let (_open, temporary) = file.into_parts();
        let is_new = fs::symlink_metadata(&path).is_err();
        let named = match overwrite {
            true => temporary.persist(&path),
            false => temporary.persist_noclobber(&path),
        };
        list.forget(guard);
        match named {
            Ok(()) if is_new => kept.push(path),
            Ok(()) => {}
            Err(e) => {
                for path in &kept {
                    let _ = fs::remove_file(path);
                }
                result = Err(match e.error.kind() {
                    io::ErrorKind::AlreadyExists => WholeError::Exists(path),
                    _ => failed(&path, e.error),
                });
                break;
            }
        }
    }
    drop(list);
    drop(files);
    result
}

/// Writes a file. A replaced file keeps its permissions, and a link to a file stays a link. Without `overwrite` an
/// existing file is an error, also if it appears during the writing.
pub fn write_with(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), WholeError> {
    keep(vec![prepare(path, overwrite, fill)?])
}

/// As [`write_with`], for existing bytes.
pub fn write(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), WholeError> {
    write_with(path, overwrite, |file| file.write_all(bytes))
}

/// Why a file was not written. An older file is kept.
#[derive(Debug, thiserror::Error)]
pub enum WholeError {
    #[error("{0} exists already")]
    Exists(PathBuf),
    /// Neither the folder nor the one above it exists.
    #[error("{0}: there is no such folder")]
    NoFolder(PathBuf),
    #[error("{path}: {source}")]
    Io {
        /// The file, or its folder.
        path: PathBuf,
        source: io::Error,
    },
}

pub(super) fn failed(path: &Path, source: io::Error) -> WholeError {
    WholeError::Io {
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use WholeError::{Exists, Io, NoFolder};

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let names: std::collections::BTreeSet<_> = names.collect();
        names.into_iter().collect()
    }

    #[test]
    fn whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let path = at("new/a.txt");
        write(&path, b"one", false).unwrap();
        write(&path, b"three", true).unwrap();
        assert!(matches!(write(&path, b"two", false), Err(Exists(_))));
        let broken = write_with(&path, true, |file| {
            file.write_all(b"half")?;
            let within = names(&at("new"));
            assert!(within[0].starts_with(".shiftvox-a.txt-") && within[0].ends_with(".tmp"));
            Err(io::Error::other("power cut"))
        });
        assert!(broken.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"three");
        assert_eq!(names(&at("new")), ["a.txt"]);
        // One missing folder is made, not several.
        let deep = at("no/such/a");
        assert!(matches!(check_free(&deep, false), Err(NoFolder(_))));
        assert!(matches!(write(&deep, b"x", true), Err(NoFolder(_))));
        for other in [at("new/a.txt/b"), at("new"), PathBuf::from("/dev/null")] {
            assert!(matches!(check_free(&other, true), Err(Io { .. })));
        }
        for name in ["a".repeat(255), "\u{20ac}".repeat(85), "-".to_owned()] {
            write(&at(&name), b"x", false).unwrap();
        }
        assert_eq!(names(folder.path()).len(), 4);
    }

    /// Also if one of them appears meanwhile.
    #[test]
    fn files_that_belong_together_appear_together() {
        for taken in ["a", "b", "c"] {
            let folder = tempfile::tempdir().unwrap();
            let at = |name: &str| folder.path().join(name);
            let prepare = |name| prepare(&at(name), false, |file| file.write_all(b"x")).unwrap();
            drop(prepare("c"));
            let all = ["a", "b", "c"].map(prepare);
            assert!(!at("c").exists());
            fs::write(at(taken), b"other").unwrap();
            assert!(matches!(keep(all.into()), Err(Exists(_))));
            assert_eq!(names(folder.path()), [taken]);
            assert_eq!(fs::read(at(taken)).unwrap(), b"other");
        }
    }

    #[test]
    #[cfg(unix)]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};

        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        write(&at("deep/real"), b"one", false).unwrap();
        fs::set_permissions(at("deep/real"), fs::Permissions::from_mode(0o600)).unwrap();
        for (link, file) in [("link", "deep/real"), ("early", "deep/new")] {
            symlink(file, at(link)).unwrap();
            assert!(matches!(write(&at(link), b"two", false), Err(Exists(_))));
            write(&at(link), b"two", true).unwrap();
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink());
            assert_eq!(fs::read(at(file)).unwrap(), b"two");
        }
        let mode = fs::metadata(at("deep/real")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        assert_eq!(names(&at("deep")), ["new", "real"]);
    }

    #[test]
    fn abandoned_files_and_folders_are_removed_and_those_in_use_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (used, _in_use) = temporary_folder(folder.path()).unwrap();
        fs::create_dir(at(".shiftvox-left.tmp")).unwrap();
        let abandoned = [".shiftvox-left.tmp/rows.hex", ".shiftvox-a.far-1.tmp"];
        let others = [".other.tmp", ".shiftvox-a.far", ".shiftvox-b.far-1.tmp"];
        for name in abandoned.iter().chain(&others) {
            fs::write(at(name), b"half").unwrap();
        }
        // Of another process that still writes: a lock is that of an open file.
        let other = File::open(at(".shiftvox-b.far-1.tmp")).unwrap();
        other.lock().unwrap();
        // As another process would: this one has looked here already.
        in_progress().tidied.retain(|known| known != folder.path());
        write(&at("a.far"), b"whole", false).unwrap();
        let left = names(folder.path());
        assert_eq!(left.len(), 5);
        assert!(used.path().exists() && at("a.far").exists());
        assert!(others.iter().all(|name| at(name).exists()));
    }
}
