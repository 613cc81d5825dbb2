//! glTF documents, composed of choices: a seed's in the tests, a fuzzer's bytes in `fuzz/fuzz_targets/gltf_scene.rs`.
//!
//! A document comes with its expected triangles, which are computed without the reader. All coordinates are exact in
//! `f32`: small whole numbers, and turns and mirror images that only exchange axes.
#![allow(
    unreachable_pub,
    reason = "a module of a test crate, and of a fuzz target"
)]

use std::io;

use glam::{DAffine3, DMat4, DVec3};
use serde_json::{Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::{Beside, LoadOptions, Mesh, MeshFormat, read};

use super::gltf_bytes::{Choose, damage, data_uri, glb};

type Corners = [[f32; 3]; 3];

/// A document and its files.
pub struct Document {
    pub json: Value,
    /// The binary chunk of a `.glb`.
    pub binary: Option<Vec<u8>>,
    /// Files of the same folder.
    pub beside: Vec<(String, Vec<u8>)>,
    /// Its triangles that have an area, in order; none where it was damaged.
    pub shows: Option<Vec<Corners>>,
}

impl Beside for Document {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let found = self.beside.iter().find(|(file, _)| file == name);
        let bytes = found.map(|(_, bytes)| bytes.clone());
        bytes.ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

impl Document {
    /// Reads the document and compares its triangles with the expected ones. Returns whether it was read.
    pub fn check(&self, name: &str) -> bool {
        let json = self.json.to_string();
        let (format, bytes) = match &self.binary {
            Some(binary) => (MeshFormat::Glb, glb(&json, binary)),
            None => (MeshFormat::Gltf, json.into_bytes()),
        };
        let options = LoadOptions::default();
        let mesh = read(&bytes, format, name, self, &options, &Silent);
        let corners = |mesh: &Mesh| -> Vec<Corners> {
            let corner = |i: u32| mesh.positions()[i as usize].map(|c| c as f32);
            mesh.triangles().iter().map(|t| t.map(corner)).collect()
        };
        match (&self.shows, &mesh) {
            (Some(shows), Ok(mesh)) => assert_eq!(corners(mesh), *shows, "{name}: {}", self.json),
            (Some(shows), Err(error)) => assert!(shows.is_empty(), "{error}: {}", self.json),
            (None, Ok(mesh)) => assert!(corners(mesh).len() <= 1000, "{name}: {}", self.json),
            (None, Err(error)) => assert!(error.to_string().starts_with(name), "{error}"),
        }
        mesh.is_ok()
    }
}

/// Quaternions, not all of length 1, and the axes to which they turn x, y and z.
const TURNS: [([f64; 4], [DVec3; 3]); 4] = [
    ([0.0, 0.0, 0.0, 2.0], DVec3::AXES),
    ([1.0, 0.0, 0.0, 0.0], [DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z]),
    ([0.5, 0.5, 0.5, 0.5], [DVec3::Y, DVec3::Z, DVec3::X]),
    ([0.0, 0.0, 0.0, 0.0], DVec3::AXES),
];

/// Appends to a list of an object, which is made where there is none. Returns the number of the entry.
fn add(object: &mut Value, list: &str, value: Value) -> usize {
    if object[list].is_null() {
        object[list] = json!([]);
    }
    let list = object[list].as_array_mut();
    list.map_or(0, |list| {
        list.push(value);
        list.len() - 1
    })
}

/// Composes a document.
pub fn compose(choose: &mut Choose<'_>) -> Document {
    let mut composer = Composer {
        buffers: vec![Vec::new(); 1 + choose(3) as usize],
        json: json!({
            "asset": {"version": "2.0"},
            "materials": [
                {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}},
                {"alphaMode": "BLEND"},
            ],
        }),
    };
    let vertices = (0..=choose(3)).map(|_| composer.vertices(choose));
    let vertices: Vec<(Vec<DVec3>, Value)> = vertices.collect();
    let mut shown = Vec::new();
    for _ in 0..=choose(3) {
        let mut mesh = json!({});
        let mut triangles = Vec::new();
        for _ in 0..=choose(2) {
            let vertices = &vertices[choose(vertices.len() as u32) as usize];
            let (primitive, own) = composer.primitive(vertices, choose);
            add(&mut mesh, "primitives", primitive);
            triangles.extend(own);
        }
        add(&mut composer.json, "meshes", mesh);
        shown.push(triangles);
    }
    let Composer { mut json, buffers } = composer;
    let shows = compose_nodes(&mut json, &shown, choose);
    let mut document = Document {
        json,
        binary: None,
        beside: Vec::new(),
        shows: Some(shows),
    };
    store(buffers, &mut document, choose);
    for _ in 0..choose(8).saturating_sub(4) {
        damage(&mut document.json, choose);
        document.shows = None;
    }
    document
}

/// Adds nodes and scenes that show meshes of these triangles. Returns the triangles in the world.
fn compose_nodes(
    json: &mut Value,
    shown: &[Vec<[DVec3; 3]>],
    choose: &mut Choose<'_>,
) -> Vec<Corners> {
    let count = 1 + choose(7) as usize;
    let (mut nodes, places): (Vec<Value>, Vec<DAffine3>) = (0..count).map(|_| node(choose)).unzip();
    let mut children = vec![Vec::new(); count];
    let mut roots = Vec::new();
    for number in 0..count {
        match choose(number as u32 + 1) as usize {
            parent if parent < number && choose(3) > 0 => {
                add(&mut nodes[parent], "children", number.into());
                children[parent].push(number);
            }
            _ => roots.push(number),
        }
    }
    let meshes = [0; 7].map(|_| choose(shown.len() as u32 + 1) as usize);
    for (node, &mesh) in nodes.iter_mut().zip(&meshes) {
        if mesh < shown.len() {
            node["mesh"] = mesh.into();
        }
    }
    json["nodes"] = nodes.into();
    let scenes = choose(3) as usize;
    // Without scenes all nodes are shown.
    if scenes > 0 {
        let scene = choose(scenes as u32) as usize;
        json["scenes"] = vec![json!({"nodes": []}); scenes].into();
        roots.retain(|_| choose(4) > 0);
        json["scenes"][scene]["nodes"] = json!(roots);
        if scene > 0 || choose(2) == 0 {
            json["scene"] = scene.into();
        }
    }
    let mut shows = Vec::new();
    let mut open: Vec<(usize, DAffine3)> = Vec::new();
    open.extend(roots.iter().rev().map(|&n| (n, DAffine3::IDENTITY)));
    while let Some((number, parent)) = open.pop() {
        let place = parent * places[number];
        let own = shown.get(meshes[number]).into_iter().flatten();
        shows.extend(own.filter_map(|triangle| moved(triangle, &place)));
        open.extend(children[number].iter().rev().map(|&n| (n, place)));
    }
    shows
}

struct Composer {
    json: Value,
    buffers: Vec<Vec<u8>>,
}

impl Composer {
    /// Puts elements into a buffer, with padding between them. Completes their accessor and returns its number.
    fn accessor(
        &mut self,
        mut accessor: Value,
        elements: &[Vec<u8>],
        choose: &mut Choose<'_>,
    ) -> usize {
        let number = choose(self.buffers.len() as u32) as usize;
        let buffer = &mut self.buffers[number];
        let begin = buffer.len().next_multiple_of(4) + 4 * choose(2) as usize;
        let [offset, gap] = [0; 2].map(|_| 4 * choose(2) as usize);
        buffer.resize(begin + offset, 0xee);
        for element in elements {
            buffer.extend(element);
            buffer.resize(buffer.len() + gap, 0xee);
        }
        let mut view = json!({
            "buffer": number, "byteOffset": begin, "byteLength": buffer.len() - begin,
        });
        if gap > 0 || accessor["type"] != "SCALAR" {
            view["byteStride"] = (elements.first().map_or(4, Vec::len) + gap).into();
        }
        accessor["bufferView"] = add(&mut self.json, "bufferViews", view).into();
        accessor["byteOffset"] = offset.into();
        accessor["count"] = elements.len().into();
        add(&mut self.json, "accessors", accessor)
    }

    /// Positions and attributes, with or without normals and colours.
    fn vertices(&mut self, choose: &mut Choose<'_>) -> (Vec<DVec3>, Value) {
        let count = 3 + choose(5) as usize;
        // Component type, its bytes, and the number that means 1 if normalized.
        let (kind, width, full) = [
            (5126, 4, 1.0),
            (5120, 1, 127.0),
            (5121, 1, 255.0),
            (5122, 2, 32767.0),
            (5123, 2, 65535.0),
        ][choose(5) as usize];
        let normalized = choose(2) == 0;
        let one: f32 = if normalized { full } else { 1.0 };
        let (mut elements, mut positions) = (Vec::new(), Vec::new());
        for _ in 0..count {
            let numbers = [0; 3].map(|_| choose(6) as u8);
            let mut bytes: Vec<u8> = match kind {
                5126 => numbers.map(|n| f32::from(n).to_le_bytes()).concat(),
                _ => numbers.map(|n| [n, 0][..width].to_vec()).concat(),
            };
            bytes.resize(bytes.len().next_multiple_of(4), 0xee);
            elements.push(bytes);
            let place = numbers.map(|n| f64::from(f32::from(n) / one));
            positions.push(DVec3::from_array(place));
        }
        let position = json!({"componentType": kind, "normalized": normalized, "type": "VEC3"});
        let mut attributes = json!({"POSITION": self.accessor(position, &elements, choose)});
        for name in ["NORMAL", "COLOR_0"] {
            if choose(2) == 0 {
                let up = [0.0f32, 0.0, 1.0].map(f32::to_le_bytes).concat();
                let floats = json!({"componentType": 5126, "type": "VEC3"});
                attributes[name] = self.accessor(floats, &vec![up; count], choose).into();
            }
        }
        (positions, attributes)
    }

    /// A primitive and its triangles.
    fn primitive(
        &mut self,
        (positions, attributes): &(Vec<DVec3>, Value),
        choose: &mut Choose<'_>,
    ) -> (Value, Vec<[DVec3; 3]>) {
        let count = positions.len() as u32;
        let mut json = json!({"attributes": attributes});
        let mut corners: Vec<u32> = (0..count).collect();
        let kinds = [(5121, 1), (5123, 2), (5125, 4)];
        if let Some(&(kind, width)) = kinds.get(choose(4) as usize) {
            corners = (0..choose(13)).map(|_| choose(count)).collect();
            let bytes = corners.iter().map(|i| i.to_le_bytes()[..width].to_vec());
            let elements: Vec<Vec<u8>> = bytes.collect();
            let indices = json!({"componentType": kind, "type": "SCALAR"});
            json["indices"] = self.accessor(indices, &elements, choose).into();
        }
        let mode = [4, 4, 4, 5, 6, 0, 1][choose(7) as usize];
        if mode != 4 || choose(2) == 0 {
            json["mode"] = mode.into();
        }
        if choose(2) == 0 {
            json["material"] = choose(3).into();
        }
        let fan = corners.len().saturating_sub(2);
        let (triangles, numbers): (usize, fn(usize) -> [usize; 3]) = match mode {
            4 => (corners.len() / 3, |k| [3 * k, 3 * k + 1, 3 * k + 2]),
            5 => (fan, |k| [k + k % 2, k + 1 - k % 2, k + 2]),
            6 => (fan, |k| [0, k + 1, k + 2]),
            _ => (0, |_| [0; 3]),
        };
        let position = |i: usize| positions[corners[i] as usize];
        let triangles = (0..triangles).map(|k| numbers(k).map(position));
        (json, triangles.collect())
    }
}

/// A vector of small whole numbers.
fn small(choose: &mut Choose<'_>) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| f64::from(choose(5)) - 2.0))
}

/// A node without mesh and children, and its place.
fn node(choose: &mut Choose<'_>) -> (Value, DAffine3) {
    match choose(3) {
        0 => (json!({}), DAffine3::IDENTITY),
        1 => {
            let [x, y, z, by] = [0; 4].map(|_| small(choose));
            let place = DAffine3::from_cols(x, y, z, by);
            let columns = DMat4::from(place).to_cols_array();
            (json!({ "matrix": columns }), place)
        }
        _ => {
            let (quaternion, [x, y, z]) = TURNS[choose(4) as usize];
            let mut node = json!({ "rotation": quaternion });
            let (mut scale, mut by) = (DVec3::ONE, DVec3::ZERO);
            if choose(2) == 0 {
                scale = small(choose);
                node["scale"] = json!(scale.to_array());
            }
            if choose(2) == 0 {
                by = small(choose);
                node["translation"] = json!(by.to_array());
            }
            let place = DAffine3::from_cols(x * scale.x, y * scale.y, z * scale.z, by);
            (node, place)
        }
    }
}

/// A triangle at its place, if it has an area. Mirror images exchange two corners.
fn moved(triangle: &[DVec3; 3], place: &DAffine3) -> Option<Corners> {
    let mut corners = triangle.map(|corner| place.transform_point3(corner));
    if place.matrix3.determinant() < 0.0 {
        corners.swap(1, 2);
    }
    let [a, b, c] = corners;
    let has_area = (b - a).cross(c - a) != DVec3::ZERO;
    has_area.then(|| corners.map(|corner| corner.as_vec3().to_array()))
}

/// Puts the buffers into the file, into addresses and beside it.
fn store(buffers: Vec<Vec<u8>>, document: &mut Document, choose: &mut Choose<'_>) {
    for (number, bytes) in buffers.into_iter().enumerate() {
        let mut buffer = json!({"byteLength": bytes.len()});
        match choose(4) {
            0 if number == 0 => document.binary = Some(bytes),
            1 => {
                let name = format!("b {number}.bin");
                buffer["uri"] = name.replace(' ', "%20").into();
                document.beside.push((name, bytes));
            }
            2 => buffer["uri"] = data_uri(&bytes).trim_end_matches('=').into(),
            _ => buffer["uri"] = data_uri(&bytes).into(),
        }
        add(&mut document.json, "buffers", buffer);
    }
}
