//! JSON; of `.glb` a byte, which times 16 is the length of the JSON with itself, JSON and a buffer. A mesh or an error.

use shiftvox::graph::Silent;
use shiftvox_mesh::{ColorSpace, MeshFormat, no_files, read};

pub(crate) fn run(format: MeshFormat, bytes: &[u8]) {
    let colors = ColorSpace::default();
    let result = if format == MeshFormat::Gltf {
        read(bytes, format, "fuzz", &no_files, colors, &Silent)
    } else {
        let cut = bytes.first().map_or(0, |&b| usize::from(b) * 16);
        let (json, buffer) = bytes.split_at(cut.max(1).min(bytes.len()));
        let json = json.get(1..).unwrap_or_default();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((12 + 8 + json.len() as u32 + 8 + buffer.len() as u32).to_le_bytes());
        for (kind, content) in [(b"JSON", json), (b"BIN\0", buffer)] {
            file.extend((content.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(content);
        }
        read(&file, format, "fuzz", &no_files, colors, &Silent)
    };
    if let Ok(mesh) = result {
        assert!(mesh.triangles().iter().flatten().all(|&i| (i as usize) < mesh.positions().len()));
        assert_eq!(mesh.triangles().len(), mesh.material_of().len());
    }
}
