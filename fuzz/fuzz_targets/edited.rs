//! A `.vxg`, `.far` or `.tvx` file. Then 64 bits that choose a sound one and 64 for each edit of a field, with repaired
//! lengths and checksums. An accepted file is drawn.

use crate::exercise::{self, Format};

pub(crate) fn run(format: Format, bytes: &[u8]) {
    std::hint::black_box(exercise::is_sound(format, bytes));
    let (choices, _) = bytes.as_chunks();
    let choices = choices.iter().map(|&choice| u64::from_le_bytes(choice));
    if let Some((_, bytes)) = exercise::edited(&[format], choices) {
        let path = std::env::temp_dir().join(format!("edited-{}.vxg", std::process::id()));
        std::hint::black_box(exercise::exercise(format, &bytes, &path));
    }
}
