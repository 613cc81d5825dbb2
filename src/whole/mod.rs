//! Files appear whole or not at all, also when the program is stopped.
//!
//! A file is written without a name and named when it is whole. Where a system or a disk has no nameless files, it is
//! written under a temporary name beside its place, `.shiftvox-NAME-??????.tmp`. A signal handler must call
//! [`remove_unfinished`] before it ends the program. A killed process may leave a file or folder with a temporary name,
//! which nothing removes: it could be the user's.

mod temporary;

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub use temporary::{TemporaryFolder, remove_unfinished};
use temporary::{Unfinished, unfinished};

/// Does some work during which no signal handler ends the program.
pub fn undisturbed<T>(work: impl FnOnce() -> T) -> T {
    let _list = unfinished();
    work()
}

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
        Err(e) if path.is_symlink() => return Err(failed(&path, e)),
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
    let mut path = path.to_owned();
    while let Ok(link) = fs::read_link(&path) {
        match fs::metadata(&path) {
            // No file is at the end of a circle.
            Err(e) if e.kind() != io::ErrorKind::NotFound => break,
            _ => path = folder_of(&path).join(link),
        }
    }
    path
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

/// A written file that is not yet named, and is removed if it never is.
#[derive(Debug)]
pub struct Prepared {
    file: Unfinished,
    path: PathBuf,
    overwrite: bool,
}

impl Prepared {
    /// The file that it will be.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Writes a file without naming it yet. Its folder is created if the folder above exists.
pub fn prepare(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<Prepared, WholeError> {
    let path = check_place(path, overwrite)?;
    let folder = folder_of(&path);
    make_folder(folder)?;
    let mut file = Unfinished::new(folder, &path).map_err(|e| failed(folder, e))?;
    fill(file.file()).map_err(|e| failed(&path, e))?;
    if let Ok(old) = fs::metadata(&path) {
        // Impossible for some files of other owners, which are replaced all the same.
        let _ = file.file().set_permissions(old.permissions());
    }
    Ok(Prepared {
        file,
        path,
        overwrite,
    })
}

/// Names files: all of them, or, if one fails, none that is new.
pub fn keep(files: Vec<Prepared>) -> Result<(), WholeError> {
    let mut list = unfinished();
    let mut kept: Vec<PathBuf> = Vec::new();
    let mut result = Ok(());
    let mut files = files.into_iter();
    for Prepared {
        file,
        path,
        overwrite,
    } in files.by_ref()
    {
        let is_new = fs::symlink_metadata(&path).is_err();
        match file.name(&path, overwrite, &mut list) {
            Ok(()) if is_new => kept.push(path),
            Ok(()) => {}
            Err(e) => {
                for path in &kept {
                    let _ = fs::remove_file(path);
                }
                result = Err(match e.kind() {
                    io::ErrorKind::AlreadyExists => WholeError::Exists(path),
                    _ => failed(&path, e),
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
    #[error("{path}: cannot write it: {source}")]
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
            // Without a name here, or with a temporary one.
            let within = names(&at("new"));
            let is_temporary = |name: &String| name.starts_with(".shiftvox-a.txt-");
            assert!(
                within.iter().all(|n| n == "a.txt" || is_temporary(n)),
                "{within:?}"
            );
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
        symlink("deep/last", at("second")).unwrap();
        symlink("circle", at("circle")).unwrap();
        write(&at("circle"), b"two", true).unwrap_err();
        for (link, file) in [
            ("link", "deep/real"),
            ("early", "deep/new"),
            ("first", "second"),
        ] {
            symlink(file, at(link)).unwrap();
            assert!(matches!(write(&at(link), b"two", false), Err(Exists(_))));
            write(&at(link), b"two", true).unwrap();
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink());
            assert_eq!(fs::read(at(file)).unwrap(), b"two");
        }
        let mode = fs::metadata(at("deep/real")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        assert_eq!(names(&at("deep")), ["last", "new", "real"]);
    }

    #[test]
    fn files_with_and_without_a_name_are_alike() {
        for overwrite in [false, true] {
            for make in [Unfinished::new, Unfinished::with_name] {
                let folder = tempfile::tempdir().unwrap();
                let at = |name: &str| folder.path().join(name);
                let path = at("a");
                drop(make(folder.path(), &path).unwrap());
                for is_first in [true, false] {
                    let mut new = make(folder.path(), &path).unwrap();
                    new.file().write_all(b"x").unwrap();
                    let named = new.name(&path, overwrite, &mut unfinished());
                    assert_eq!(named.is_ok(), is_first || overwrite);
                }
                assert_eq!(names(folder.path()), ["a"]);
                assert_eq!(fs::read(&path).unwrap(), b"x");
                assert!(
                    unfinished()
                        .iter()
                        .all(|left| !left.starts_with(folder.path()))
                );
            }
        }
    }

    #[test]
    fn nothing_of_the_user_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at(".shiftvox-mine.tmp")).unwrap();
        fs::write(at(".shiftvox-mine.tmp/notes"), b"mine").unwrap();
        fs::write(at(".shiftvox-a.far-123456.tmp"), b"mine").unwrap();
        let before = names(folder.path());
        write(&at("a.far"), b"whole", false).unwrap();
        drop(TemporaryFolder::within(folder.path()).unwrap());
        fs::remove_file(at("a.far")).unwrap();
        assert_eq!(names(folder.path()), before);
        assert!(at(".shiftvox-mine.tmp/notes").exists());
    }
}
