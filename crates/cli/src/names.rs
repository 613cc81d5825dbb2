//! Names of scenes: any bytes, as file systems have them, in a `String`.
//!
//! The name of a scene is a generator or a path. A byte of a path that is not UTF-8 becomes one of the
//! last 256 code points, which are for private use. If a name has such a code point itself, its bytes
//! are written in the same way, so that every name can be restored. The terminal shows `\xff`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::builder::{OsStringValueParser, TypedValueParser};

/// The code point of byte 0.
const FIRST: u32 = 0x10_ff00;

/// The byte that a letter encodes.
pub(super) fn byte_of(letter: char) -> Option<u8> {
    u32::from(letter).checked_sub(FIRST)?.try_into().ok()
}

/// Reads the name of a scene on the command line.
pub(super) fn parser() -> impl TypedValueParser<Value = String> {
    OsStringValueParser::new().map(|name| of_bytes(name.as_encoded_bytes()))
}

/// The name of a path, for documents and for composed names.
pub(super) fn of_path(path: &Path) -> String {
    of_bytes(path.as_os_str().as_encoded_bytes())
}

/// A name of these bytes.
fn of_bytes(bytes: &[u8]) -> String {
    // Below 2^21: a code point.
    let stand_in = |&byte: &u8| char::from_u32(FIRST + u32::from(byte)).unwrap_or_default();
    let mut name = String::new();
    for chunk in bytes.utf8_chunks() {
        for letter in chunk.valid().chars() {
            match byte_of(letter) {
                None => name.push(letter),
                Some(_) => {
                    let bytes = letter.encode_utf8(&mut [0; 4]).as_bytes().to_vec();
                    name.extend(bytes.iter().map(stand_in));
                }
            }
        }
        name.extend(chunk.invalid().iter().map(stand_in));
    }
    name
}

/// The path that a name means.
pub(super) fn path(name: &str) -> PathBuf {
    if !name.contains(|letter| byte_of(letter).is_some()) {
        return name.into();
    }
    let mut bytes = Vec::new();
    for letter in name.chars() {
        match byte_of(letter) {
            Some(byte) => bytes.push(byte),
            None => bytes.extend(letter.encode_utf8(&mut [0; 4]).as_bytes()),
        }
    }
    of_system(bytes).into()
}

/// A path with a name in place of a word.
pub(super) fn replace(path: &Path, word: &str, name: &str) -> PathBuf {
    self::path(&of_path(path).replace(word, name))
}

#[cfg(unix)]
fn of_system(bytes: Vec<u8>) -> OsString {
    std::os::unix::ffi::OsStringExt::from_vec(bytes)
}

#[cfg(not(unix))]
fn of_system(bytes: Vec<u8>) -> OsString {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_comes_back() {
        let odd: [&[u8]; 5] = [
            "a/\u{e9}.vox".as_bytes(),
            b"t\xff\xc3.vox",
            "\u{10ffff}\u{10feff}".as_bytes(),
            b"",
            b"\xf4\x8f",
        ];
        for bytes in odd {
            let name = of_bytes(bytes);
            let is_same = path(&name).as_os_str().as_encoded_bytes() == bytes;
            assert!(is_same || !cfg!(unix), "{name:?}");
        }
        assert_eq!(
            of_bytes(b"\xff").chars().next().and_then(byte_of),
            Some(255)
        );
        let put = replace(Path::new("out/{stem}.png"), "{stem}", "a");
        assert_eq!(put, PathBuf::from("out/a.png"));
    }
}
