//! Reads bytes as `.far` and `.tvx` files. Then edits fields of sound `.vxg`, `.far` and `.tvx` files, repairs lengths and
//! checksums, and draws what is accepted.
#![no_main]
#![allow(clippy::unwrap_used)]

#[path = "../../crates/mesh/tests/sealed/exercise.rs"]
mod exercise;
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod seal;

use libfuzzer_sys::fuzz_target;
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::textured::TexturedFile;

fuzz_target!(|data: &[u8]| {
    let is_sound = FarFile::from_bytes(data).is_ok_and(|file| file.verify().is_ok());
    std::hint::black_box((is_sound, TexturedFile::from_bytes(data).is_ok()));
    let (choices, _) = data.as_chunks();
    let choices = choices.iter().map(|&choice| u64::from_le_bytes(choice));
    if let Some((format, bytes)) = exercise::edited(choices) {
        let path = std::env::temp_dir().join(format!("edited-{}.vxg", std::process::id()));
        exercise::exercise(format, &bytes, &path);
    }
});
