//! Files that are wrong: refused or repaired with a message, never a panic.

use proptest::prelude::*;
use shiftvox_mesh::MeshFormat;

use super::shapes::{data_uri, glb, gltf_json, load, square_buffer, squares};

fn message(bytes: &[u8], format: MeshFormat) -> String {
    match load(bytes, format) {
        Ok(mesh) => panic!(
            "{} triangles of {}",
            mesh.triangles().len(),
            bytes.escape_ascii()
        ),
        Err(error) => error.to_string(),
    }
}

#[test]
fn each_fault_is_told_with_its_place() {
    let gltf = |from: &str, to: &str| {
        let json = gltf_json(&data_uri(&square_buffer()), "");
        assert!(json.contains(from), "{from}");
        json.replacen(from, to, 1).into_bytes()
    };
    let ply = |body: &str| {
        format!("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n{body}").into_bytes()
    };
    let glb_cut = glb(&gltf_json("", ""), &square_buffer());
    let cases: Vec<(MeshFormat, Vec<u8>, &str)> = vec![
        (MeshFormat::Obj, b"".to_vec(), "a file: mesh: expected at least one triangle, found none; "),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\n".to_vec(), "expected at least one triangle, found none"),
        (MeshFormat::Obj, b"# c\nv 0 0\n".to_vec(), "a file: vertex at line 2: expected \"v x y z\""),
        (MeshFormat::Obj, b"v 0 0 0\nf 1 1 x\n".to_vec(), "a file: face at line 2: expected \"f\" and corners such as"),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 4\nf 1 2 3\n".to_vec(),
            "a file: face at line 5: expected a corner from 1 to 3, counted up to there, found 4; the file is cut"),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 0\n".to_vec(), "a file: face at line 4: expected a corner from 1 to 3"),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 -4\n".to_vec(), "a file: face at line 4: expected a corner from 1 to 3"),
        // Counted back beyond the first, where a build with overflow checks once panicked.
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/-12 2/1 3/1\n".to_vec(),
            "a file: face at line 5: expected a corner from 1 to 1, counted up to there, found -12"),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 2 3".to_vec(),
            "a file: face at line 5: expected three or more corners of one form in the last line, which has no end, found \"f 2 3\"; the file is cut"),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 2//1 3/".to_vec(), "a file: face at line 6: expected three"),
        (MeshFormat::Obj, b"v nan 0 0\nv inf 0 0\nv 1 1 0\nf 1 2 3\n".to_vec(),
            "found none that can be drawn: 1 of 1 triangles with a coordinate that is infinite or not a number"),
        (MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n".to_vec(), "2 of 2 triangles without area"),
        (MeshFormat::Ply, b"ply\nformat ascii 2.0\n".to_vec(), "a file: header"),
        (MeshFormat::Ply, b"ply\n".to_vec(), "a file: header"),
        (MeshFormat::Ply, ply("0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n"), "a file: face 0 at byte 172: expected corners from 0 to 2, found 3"),
        (MeshFormat::Ply, ply("0 0 0\n1 0 0\n1 1 0\n3 0 -1 2\n"), "expected corners from 0 to 2, found -1"),
        (MeshFormat::Ply, ply("0 0 0\n1 0 0\n"), "a file: vertex 2 at byte 166: expected as many elements as the header says"),
        (MeshFormat::Ply, ply("0 0 0\n1 0 0\n1 1 0\n9 0 1 2\n"), "a file: face 0 at byte"),
        (MeshFormat::Ply, b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\nabc".to_vec(),
            "vertex 0 at byte 178: expected as many elements as the header says"),
        (MeshFormat::Ply, b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nend_header\nabcabcabcabc".to_vec(),
            "expected at least one triangle"),
        (MeshFormat::Stl, b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n".to_vec(), "a file: triangle 1: expected \"facet normal"),
        (MeshFormat::Stl, b"solid a\nendsolid a\n".to_vec(), "expected at least one triangle"),
        (MeshFormat::Stl, vec![7; 200], "a file: header at byte 80: expected 5895053234 bytes in all for the 117901063 triangles"),
        (MeshFormat::Stl, vec![0; 20], "a file: header at byte 0: expected 84 bytes, found 20 bytes; the file is cut short or damaged"),
        (MeshFormat::Gltf, b"{\"asset\": ".to_vec(), "a file: JSON at line 1: expected glTF 2.0"),
        (MeshFormat::Gltf, gltf("\"2.0\"", "\"1.0\""), "a file: asset: expected version 2, found 1.0"),
        (MeshFormat::Gltf, gltf("\"count\": 4", "\"count\": 400000000000"), "a file: accessor 0: expected 400000000000 elements of 12 bytes"),
        (MeshFormat::Gltf, gltf("\"count\": 4", "\"count\": 18446744073709551615"), "a file: accessor 0: expected 18446744073709551615 elements"),
        (MeshFormat::Gltf, gltf("\"count\": 4", "\"count\": 3"), "a file: mesh 0: expected indices from 0 to 2, found 3"),
        (MeshFormat::Gltf, gltf("\"byteOffset\": 48", "\"byteOffset\": 18446744073709551615"), "expected a buffer view within its buffer"),
        (MeshFormat::Gltf, gltf("\"byteLength\": 60", "\"byteLength\": 61"), "a file: buffer 0: expected 61 bytes, found 60"),
        (MeshFormat::Gltf, gltf("[0]", "[0, 7]"), "a file: node 7: expected a node of this number"),
        (MeshFormat::Gltf, gltf("[{\"mesh\"", "[{\"children\": [0], \"mesh\""), "a file: node 0: expected one parent, in a tree"),
        (MeshFormat::Gltf, gltf("\"scene\": 0", "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"]"),
            "a file: extensionsRequired: expected no extension that has to be understood, found KHR_draco"),
        (MeshFormat::Gltf, gltf("5123", "5126"), "a file: accessor 1: expected 6 elements of 4 bytes"),
        (MeshFormat::Glb, glb_cut[..glb_cut.len() - 1].to_vec(), "a file: header at byte 8"),
        (MeshFormat::Glb, b"glTF\x02".to_vec(), "a file: header at byte 0: expected 12 bytes"),
    ];
    for (format, bytes, expected) in cases {
        let found = message(&bytes, format);
        assert!(
            found.contains(expected),
            "{}\n  expected: {expected}\n  found:    {found}",
            bytes.escape_ascii()
        );
    }
}

#[test]
fn a_small_gltf_does_not_become_large() {
    // A thousand nodes that show a mesh of a thousand triangles.
    let triangles = 10_000;
    let nodes: Vec<String> = (0..1000).map(|_| "{\"mesh\": 0}".to_owned()).collect();
    let list: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
    let buffer: Vec<u8> = (0..9 * triangles)
        .flat_map(|i: u32| (i as f32).sqrt().to_le_bytes())
        .collect();
    let json = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"scenes\": [{{\"nodes\": [{}]}}], \"nodes\": [{}],
        \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0}}}}]}}],
        \"accessors\": [{{\"bufferView\": 0, \"componentType\": 5126, \"count\": {}, \"type\": \"VEC3\"}}],
        \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": {}}}], \"buffers\": [{{\"byteLength\": {}}}]}}",
        list.join(","), nodes.join(","), 3 * triangles, buffer.len(), buffer.len()
    );
    let error = load(&glb(&json, &buffer), MeshFormat::Glb).unwrap_err();
    assert!(error.is_limit(), "{error}");
}

#[test]
fn every_beginning_of_a_file_is_survived() {
    for (name, format, bytes) in squares() {
        for length in 0..bytes.len() {
            if let Ok(mesh) = load(&bytes[..length], format) {
                assert!(mesh.triangles().len() <= 2, "{name} {length}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Bytes replaced, inserted and removed.
    #[test]
    fn damaged_files_are_survived(
        which in 0usize..8,
        damages in prop::collection::vec((any::<prop::sample::Index>(), 0..3u8, any::<u8>(), any::<bool>()), 1..6),
    ) {
        let (_, format, mut bytes) = squares().swap_remove(which);
        for (place, kind, byte, digit) in damages {
            let at = place.index(bytes.len());
            let byte = if digit { b"0123456789-./e "[usize::from(byte) % 15] } else { byte };
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => { bytes.remove(at); }
            }
        }
        if let Ok(mesh) = load(&bytes, format) {
            prop_assert!(mesh.triangles().iter().flatten().all(|&i| (i as usize) < mesh.positions().len()));
            let (low, high) = mesh.bounds();
            prop_assert!(low.is_finite() && high.is_finite());
        }
    }
}
