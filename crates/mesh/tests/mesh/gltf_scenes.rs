//! Random glTF documents against the scenes that they were composed from, also damaged.

use std::cell::Cell;
use std::io;

use serde_json::json;
use shiftvox::graph::Silent;
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::{Beside, LoadOptions, MeshFormat, read};

use super::gltf_document::compose;
use super::shapes::{gltf_json, square_buffer};

#[test]
fn random_documents_are_read_as_composed_or_refused() {
    // By whether a document is sound, those refused and read.
    let mut counts = [[0; 2]; 2];
    for seed in 0..3000 {
        let mut dice = SplitMix::new(seed);
        let document = compose(&mut |end| dice.below(end.into()) as u32);
        let is_read = document.check(&format!("seed {seed}"));
        counts[usize::from(document.shows.is_some())][usize::from(is_read)] += 1;
    }
    let [[refused, damaged], [_, sound]] = counts;
    let is_varied = sound > 1000 && damaged > 50 && refused > 500;
    assert!(is_varied, "{counts:?}");
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
fn a_file_with_many_references_is_read_once() {
    let mut json = gltf_json("");
    json["buffers"] = json!(vec![json!({"uri": "a.bin", "byteLength": 60}); 1000]);
    let json = json.to_string().into_bytes();
    let (files, options) = (Counting(Cell::new(0)), LoadOptions::default());
    let mesh = read(&json, MeshFormat::Gltf, "a", &files, &options, &Silent);
    assert_eq!(mesh.unwrap().triangles().len(), 2);
    assert_eq!(files.0.get(), 1);
}
