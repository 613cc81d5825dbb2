//! Random glTF documents against what they were composed of: shared meshes and accessors, interleaved and padded
//! vertices, buffers in the file, in addresses and beside it, trees of nodes; and the same documents damaged.

use std::cell::Cell;
use std::io;

use shiftvox::graph::Silent;
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::{Beside, LoadOptions, MeshFormat, read};

use super::gltf_document::compose;
use super::shapes::{gltf_json, square_buffer};

#[test]
fn random_documents_are_read_as_what_they_show_or_refused() {
    let (mut sound, mut damaged, mut refused) = (0, 0, 0);
    for seed in 0..3000 {
        let mut dice = SplitMix::new(seed);
        let document = compose(&mut |end| dice.below(end.into()) as u32);
        let is_read = document.check(&format!("seed {seed}"));
        match (document.shows.is_some(), is_read) {
            (true, true) => sound += 1,
            (true, false) => {}
            (false, true) => damaged += 1,
            (false, false) => refused += 1,
        }
    }
    // Each happens often, or the documents are not what they should be.
    assert!(
        sound > 1000 && damaged > 50 && refused > 500,
        "{sound} {damaged} {refused}"
    );
}

/// Counts how often a file is read.
struct Counting(Cell<u32>);

impl Beside for Counting {
    fn read(&self, _name: &str) -> io::Result<Vec<u8>> {
        self.0.set(self.0.get() + 1);
        Ok(square_buffer())
    }
}

#[test]
fn a_file_that_is_named_often_is_read_once() {
    let buffer = "\"buffers\": [{";
    let often = "{\"uri\": \"a.bin\", \"byteLength\": 60},".repeat(1000);
    let json = gltf_json("a.bin", "");
    assert!(json.contains(buffer));
    let json = json.replace(buffer, &format!("\"buffers\": [{often}{{"));
    let files = Counting(Cell::new(0));
    let options = LoadOptions::default();
    let mesh = read(
        json.as_bytes(),
        MeshFormat::Gltf,
        "a.gltf",
        &files,
        &options,
        &Silent,
    );
    assert_eq!(mesh.unwrap().triangles().len(), 2);
    assert_eq!(files.0.get(), 1);
}
