//! Any bytes as `.glb` or `.gltf`: a mesh or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox_mesh::{LoadOptions, MeshFormat, Nothing, read};

fuzz_target!(|bytes: &[u8]| {
    // The first byte selects JSON only, or JSON and a buffer in a binary file.
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let options = LoadOptions::default();
    let result = if choice & 1 == 0 {
        read(rest, MeshFormat::Gltf, "fuzz", &Nothing, &options, &Silent)
    } else {
        // The second byte times 16 is the length of the JSON.
        let cut = rest.first().map_or(0, |&b| usize::from(b) * 16);
        let (json, buffer) = rest.split_at(cut.clamp(1, rest.len().max(1)).min(rest.len()));
        let json = json.get(1..).unwrap_or_default();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((12 + 8 + json.len() as u32 + 8 + buffer.len() as u32).to_le_bytes());
        for (kind, content) in [(b"JSON", json), (b"BIN\0", buffer)] {
            file.extend((content.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(content);
        }
        read(&file, MeshFormat::Glb, "fuzz", &Nothing, &options, &Silent)
    };
    if let Ok(mesh) = result {
        assert!(mesh.triangles().iter().flatten().all(|&i| (i as usize) < mesh.positions().len()));
        assert_eq!(mesh.triangles().len(), mesh.material_of().len());
    }
});
