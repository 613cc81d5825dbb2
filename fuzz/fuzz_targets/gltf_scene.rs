//! A glTF document composed from bytes is read correctly or, if it was damaged afterwards, rejected.
#![no_main]

#[path = "../../crates/mesh/tests/mesh/gltf_bytes.rs"]
mod gltf_bytes;
#[path = "../../crates/mesh/tests/mesh/gltf_document.rs"]
mod gltf_document;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    // Bytes, then zeros.
    let mut bytes = data.iter();
    let document = gltf_document::compose(&mut |end| u32::from(bytes.next().copied().unwrap_or(0)) % end);
    document.check("fuzz");
});
