//! One reader of files. The variable `SHIFTVOX_READER` names it; the bytes are a file, or choices that compose one.
#![no_main]
#![allow(clippy::unwrap_used)]

mod edited;
#[path = "../../crates/mesh/tests/sealed/exercise.rs"]
mod exercise;
mod gltf;
mod mesh;
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod seal;
#[path = "../../tests/input/vox_file.rs"]
mod vox_file;
mod vox_graph;
mod voxels;

use std::sync::LazyLock;

use exercise::Format::{Far, Tvx, Vxg};
use libfuzzer_sys::fuzz_target;
use shiftvox_mesh::MeshFormat::{Glb, Gltf, Obj, Ply, Stl};

static READER: LazyLock<String> =
    LazyLock::new(|| std::env::var("SHIFTVOX_READER").expect("SHIFTVOX_READER names a reader"));

fuzz_target!(|bytes: &[u8]| match READER.as_str() {
    "vox-graph" => vox_graph::run(bytes),
    "obj" => mesh::run(Obj, b"mtllib a\n", bytes),
    "ply-mesh" => mesh::run(Ply, b"ply\n", bytes),
    "stl" => mesh::run(Stl, b"", bytes),
    "gltf" => gltf::run(Gltf, bytes),
    "glb" => gltf::run(Glb, bytes),
    "vxg" => edited::run(Vxg, bytes),
    "far" => edited::run(Far, bytes),
    "tvx" => edited::run(Tvx, bytes),
    ending => voxels::run(ending, bytes),
});
