//! Files appear whole or not at all: [`crate::whole`], with bytes that are at hand.

use std::io::Write;
use std::path::Path;

pub use crate::whole::{Prepared, WholeError as StoreError, check_free, keep, prepare, write_with};

/// As [`write_with`], of bytes.
///
/// # Errors
/// See [`StoreError`].
pub fn write(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), StoreError> {
    write_with(path, overwrite, |file| file.write_all(bytes))
}
