//! Regular files of limited size, read whole. Pipes and devices are not opened, because opening may wait.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a file of settings: hardware, prices, flags.
pub const SETTINGS: u64 = 16 << 20;

/// Opens a file. Fails also if it is not a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    if !kind.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    File::open(path)
}

/// The bytes of a regular file of at most `most` bytes. Fails also if it is longer, or with
/// [`OutOfMemory`](io::ErrorKind::OutOfMemory).
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let bytes = file.metadata()?.len();
    let too_long = |bytes| {
        let message = format!("it has {bytes} bytes or more, and at most {most} are read");
        io::Error::new(io::ErrorKind::FileTooLarge, message)
    };
    if bytes > most {
        return Err(too_long(bytes));
    }
    // It may have grown.
    let content = rest(&mut { file }.take(bytes.saturating_add(1)), bytes)?;
    match content.len() as u64 {
        read if read > most => Err(too_long(read)),
        _ => Ok(content),
    }
}

/// The rest of a file, about `bytes` long; [`OutOfMemory`](io::ErrorKind::OutOfMemory) if it does not fit in memory.
pub(crate) fn rest(reader: &mut impl Read, bytes: u64) -> io::Result<Vec<u8>> {
    let what = "a file that is read whole";
    let length = usize::try_from(bytes).unwrap_or(usize::MAX);
    let mut content = crate::budget::check(what, bytes)
        .and_then(|()| crate::budget::room(what, length))
        .map_err(|short| io::Error::new(io::ErrorKind::OutOfMemory, short))?;
    reader.read_to_end(&mut content)?;
    Ok(content)
}

/// The text of a file of settings, which must be UTF-8.
pub fn read_settings(path: &Path) -> io::Result<String> {
    let text = String::from_utf8(read(path, SETTINGS)?);
    text.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_bounded_size_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, b"abc").unwrap();
        assert_eq!(read(&path, 3).unwrap(), b"abc");
        let message = read(&path, 2).unwrap_err().to_string();
        assert!(message.starts_with("it has 3 bytes or more"), "{message}");
        assert!(read(folder.path(), 9).is_err());
    }
}
