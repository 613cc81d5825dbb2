//! Edits fields of sound `.vxg`, `.far` and `.tvx` files, corrects lengths and checksums, and draws accepted files. Eight
//! bytes select the file, and eight more each edit: `crates/mesh/tests/sealed/`.
#![no_main]
#![allow(clippy::unwrap_used)]

#[path = "../../crates/mesh/tests/sealed/edit.rs"]
mod edit;
#[path = "../../crates/mesh/tests/sealed/exercise.rs"]
mod exercise;
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod seal;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let (choices, _) = data.as_chunks();
    let choices = choices.iter().map(|&choice| u64::from_le_bytes(choice));
    if let Some((format, bytes)) = exercise::edited(choices) {
        let path = std::env::temp_dir().join(format!("edited-{}.vxg", std::process::id()));
        exercise::exercise(format, &bytes, &path);
    }
});
