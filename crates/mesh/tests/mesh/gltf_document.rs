//! glTF documents, composed of choices: a seed's in the tests, a fuzzer's bytes in `fuzz/fuzz_targets/gltf_scene.rs`.
//!
//! With a document comes what it shows, worked out here without the reader. All numbers are such that places are exact in
//! `f32`: small whole numbers, and turns and mirror images that only exchange axes.
#![allow(
    unreachable_pub,
    reason = "a module of a test crate, and of a fuzz target"
)]

use std::io;

use serde_json::{Map, Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::{Beside, LoadOptions, Mesh, MeshFormat, read};

use super::gltf_bytes::{Choose, damage, data_uri, glb};

/// A document and what belongs to it.
pub struct Document {
    pub json: Value,
    /// The binary chunk of a `.glb`.
    pub binary: Option<Vec<u8>>,
    /// Files of the same folder.
    pub beside: Vec<(String, Vec<u8>)>,
    /// Its triangles, in order, without those that have no area; none where it was damaged afterwards.
    pub shows: Option<Vec<[[f32; 3]; 3]>>,
}

impl Beside for Document {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let found = self.beside.iter().find(|(file, _)| file == name);
        found
            .map(|(_, bytes)| bytes.clone())
            .ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

impl Document {
    /// Reads it, and fails where that gives something else than it shows; says whether it was read.
    pub fn check(&self, name: &str) -> bool {
        let json = self.json.to_string();
        let (format, bytes) = match &self.binary {
            Some(binary) => (MeshFormat::Glb, glb(&json, binary)),
            None => (MeshFormat::Gltf, json.into_bytes()),
        };
        let options = LoadOptions::default();
        let mesh = read(&bytes, format, name, self, &options, &Silent);
        let corners = |mesh: &Mesh| -> Vec<[[f32; 3]; 3]> {
            let triangles = mesh.triangles().iter();
            triangles
                .map(|t| t.map(|i| mesh.positions()[i as usize].map(|c| c as f32)))
                .collect()
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

/// Rows of a matrix whose last is (0, 0, 0, 1).
type Affine = [[f64; 4]; 3];

const UNMOVED: Affine = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

/// Quaternions, not all of length 1, and where they take the axes.
const TURNS: [([f64; 4], [[f64; 3]; 3]); 4] = [
    (
        [0.0, 0.0, 0.0, 2.0],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ),
    (
        [1.0, 0.0, 0.0, 0.0],
        [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
    ),
    (
        [0.5, 0.5, 0.5, 0.5],
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    ),
    (
        [0.0, 0.0, 0.0, 0.0],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ),
];

/// A document in the making.
#[derive(Default)]
struct Composer {
    buffers: Vec<Vec<u8>>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

/// Vertices in a buffer.
struct Vertices {
    positions: Vec<[f32; 3]>,
    attributes: Map<String, Value>,
}

struct Primitive {
    triangles: Vec<[usize; 3]>,
    vertices: usize,
}

/// Composes a document.
pub fn compose(choose: &mut Choose<'_>) -> Document {
    let mut composer = Composer {
        buffers: vec![Vec::new(); 1 + choose(3) as usize],
        ..Composer::default()
    };
    let vertices: Vec<Vertices> = (0..1 + choose(3))
        .map(|_| composer.vertices(choose))
        .collect();
    let (mut meshes, mut shown) = (Vec::new(), Vec::new());
    for _ in 0..1 + choose(3) {
        let primitives = (0..1 + choose(2)).map(|_| composer.primitive(&vertices, choose));
        let (json, parts): (Vec<Value>, Vec<Primitive>) = primitives.unzip();
        meshes.push(json!({ "primitives": json }));
        shown.push(parts);
    }
    let count = 1 + choose(7) as usize;
    let (mut nodes, mut places) = (Vec::new(), Vec::new());
    let mut children = vec![Vec::new(); count];
    let mut roots = Vec::new();
    for number in 0..count {
        let (mut node, place) = node(choose);
        if choose(4) > 0 {
            node.insert("mesh".into(), choose(meshes.len() as u32).into());
        }
        match choose(number as u32 + 1) as usize {
            parent if number > 0 && parent < number && choose(3) > 0 => {
                children[parent].push(number);
            }
            _ => roots.push(number),
        }
        nodes.push(node);
        places.push(place);
    }
    for (node, children) in nodes.iter_mut().zip(&children) {
        if !children.is_empty() {
            node.insert("children".into(), json!(children));
        }
    }
    let mut json = json!({
        "asset": {"version": "2.0"}, "accessors": composer.accessors, "bufferViews": composer.views,
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}}, {"alphaMode": "BLEND"}],
        "meshes": meshes,
    });
    match choose(3) {
        // Without scenes all is shown.
        0 => {}
        scenes => {
            let scene = choose(scenes);
            json["scenes"] = (0..scenes).map(|_| json!({"nodes": []})).collect();
            roots.retain(|_| choose(4) > 0);
            json["scenes"][scene as usize]["nodes"] = json!(roots);
            if scene > 0 || choose(2) == 0 {
                json["scene"] = scene.into();
            }
        }
    }
    let mut shows = Vec::new();
    let mut open: Vec<(usize, Affine)> = roots.iter().rev().map(|&n| (n, UNMOVED)).collect();
    while let Some((number, parent)) = open.pop() {
        let place = after(&parent, &places[number]);
        if let Some(mesh) = nodes[number].get("mesh").and_then(Value::as_u64) {
            for primitive in &shown[mesh as usize] {
                let positions = &vertices[primitive.vertices].positions;
                show(positions, &primitive.triangles, &place, &mut shows);
            }
        }
        open.extend(children[number].iter().rev().map(|&n| (n, place)));
    }
    json["nodes"] = json!(nodes);
    let mut document = Document {
        json,
        binary: None,
        beside: Vec::new(),
        shows: Some(shows),
    };
    store(composer.buffers, &mut document, choose);
    for _ in 0..choose(8).saturating_sub(4) {
        damage(&mut document.json, choose);
        document.shows = None;
    }
    document
}

impl Composer {
    /// Numbers into a buffer, `stride` bytes from one element to the next, and a view of them.
    fn view(&mut self, elements: &[Vec<u8>], stride: usize, choose: &mut Choose<'_>) -> usize {
        let number = choose(self.buffers.len() as u32) as usize;
        let buffer = &mut self.buffers[number];
        // The padding is not read.
        buffer.resize(
            buffer.len().next_multiple_of(4) + 4 * choose(2) as usize,
            0xee,
        );
        let begin = buffer.len();
        for element in elements {
            let length = buffer.len();
            buffer.extend(element);
            buffer.resize(length + stride, 0xee);
        }
        let mut view =
            json!({"buffer": number, "byteOffset": begin, "byteLength": buffer.len() - begin});
        view["byteStride"] = stride.into();
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Positions, with or without normals and colours: one after the other, or together in one view.
    fn vertices(&mut self, choose: &mut Choose<'_>) -> Vertices {
        let count = 3 + choose(5) as usize;
        let (kind, normalized) = (
            [5126, 5120, 5121, 5122, 5123][choose(5) as usize],
            choose(2) == 0,
        );
        let (mut raw, mut positions) = (Vec::new(), Vec::new());
        for _ in 0..count {
            let (mut bytes, mut position) = (Vec::new(), [0.0; 3]);
            for c in &mut position {
                let n = choose(6) as u8;
                let full = match kind {
                    5126 => {
                        bytes.extend(f32::from(n).to_le_bytes());
                        1.0
                    }
                    5120 | 5121 => {
                        bytes.push(n);
                        if kind == 5120 { 127.0 } else { 255.0 }
                    }
                    _ => {
                        bytes.extend([n, 0]);
                        if kind == 5122 { 32767.0 } else { 65535.0 }
                    }
                };
                let is_share = normalized && kind != 5126;
                *c = f32::from(n) / if is_share { full } else { 1.0 };
            }
            bytes.resize(bytes.len().next_multiple_of(4), 0xee);
            raw.push(bytes);
            positions.push(position);
        }
        let mut lists = vec![(
            "POSITION",
            json!({"componentType": kind, "normalized": normalized, "type": "VEC3"}),
            raw,
        )];
        if choose(2) == 0 {
            let up = [0.0f32, 0.0, 1.0].map(f32::to_le_bytes).concat();
            lists.push((
                "NORMAL",
                json!({"componentType": 5126, "type": "VEC3"}),
                vec![up; count],
            ));
        }
        if choose(2) == 0 {
            let color = [1, 2, 3, 255].map(|c: u8| c.wrapping_mul(choose(100) as u8));
            lists.push((
                "COLOR_0",
                json!({"componentType": 5121, "normalized": true, "type": "VEC4"}),
                vec![color.to_vec(); count],
            ));
        }
        let mut attributes = Map::new();
        let gap = 4 * choose(3) as usize;
        if choose(2) == 0 {
            let together: Vec<Vec<u8>> = (0..count)
                .map(|i| lists.iter().flat_map(|list| list.2[i].clone()).collect())
                .collect();
            let view = self.view(&together, together[0].len() + gap, choose);
            let mut offset = 0;
            for (name, mut accessor, elements) in lists {
                accessor["bufferView"] = view.into();
                accessor["byteOffset"] = offset.into();
                accessor["count"] = count.into();
                offset += elements[0].len();
                attributes.insert(name.into(), self.accessor(accessor).into());
            }
        } else {
            for (name, mut accessor, elements) in lists {
                let view = self.view(&elements, elements[0].len() + gap, choose);
                accessor["bufferView"] = view.into();
                accessor["count"] = count.into();
                attributes.insert(name.into(), self.accessor(accessor).into());
            }
        }
        Vertices {
            positions,
            attributes,
        }
    }

    fn primitive(&mut self, all: &[Vertices], choose: &mut Choose<'_>) -> (Value, Primitive) {
        let vertices = choose(all.len() as u32) as usize;
        let count = all[vertices].positions.len();
        let mut json = json!({"attributes": all[vertices].attributes});
        let corners: Vec<usize> = match choose(4) {
            0 => (0..count).collect(),
            width => {
                let width = [1, 2, 4][width as usize - 1];
                let corners: Vec<usize> = (0..choose(13))
                    .map(|_| choose(count as u32) as usize)
                    .collect();
                let elements: Vec<Vec<u8>> = corners
                    .iter()
                    .map(|&i| (i as u32).to_le_bytes()[..width].to_vec())
                    .collect();
                let view = self.view(&elements, width, choose);
                if choose(2) == 0 {
                    self.views[view]["byteStride"].take();
                }
                let kind = [5121, 5123, 0, 5125][width - 1];
                json["indices"] = self
                    .accessor(json!({"bufferView": view, "componentType": kind,
                        "count": corners.len(), "type": "SCALAR"}))
                    .into();
                corners
            }
        };
        let mode = [4, 4, 4, 5, 6, 0, 1][choose(7) as usize];
        if mode != 4 || choose(2) == 0 {
            json["mode"] = mode.into();
        }
        if choose(2) == 0 {
            json["material"] = choose(3).into();
        }
        let fan = |k: usize| match mode {
            4 => [3 * k, 3 * k + 1, 3 * k + 2],
            5 => [k + k % 2, k + 1 - k % 2, k + 2],
            _ => [0, k + 1, k + 2],
        };
        let triangles = match mode {
            4 => corners.len() / 3,
            5 | 6 => corners.len().saturating_sub(2),
            _ => 0,
        };
        let triangles = (0..triangles).map(|k| fan(k).map(|i| corners[i])).collect();
        (
            json,
            Primitive {
                triangles,
                vertices,
            },
        )
    }
}

/// A node without mesh and children, and its place.
fn node(choose: &mut Choose<'_>) -> (Map<String, Value>, Affine) {
    let mut node = Map::new();
    let small = |choose: &mut Choose<'_>| f64::from(choose(5)) - 2.0;
    let mut place = UNMOVED;
    match choose(3) {
        0 => {}
        1 => {
            place = place.map(|row| row.map(|_| small(choose)));
            // Column by column.
            let columns = (0..16).map(|i| match (i % 4, i / 4) {
                (3, column) => f64::from(u8::from(column == 3)),
                (row, column) => place[row][column],
            });
            node.insert("matrix".into(), columns.collect::<Vec<f64>>().into());
        }
        _ => {
            let (mut scale, mut by) = ([1.0; 3], [0.0; 3]);
            let (quaternion, turn) = TURNS[choose(4) as usize];
            if choose(2) == 0 {
                scale = scale.map(|_| small(choose));
                node.insert("scale".into(), json!(scale));
            }
            if choose(2) == 0 {
                by = by.map(|_| small(choose));
                node.insert("translation".into(), json!(by));
            }
            node.insert("rotation".into(), json!(quaternion));
            for row in 0..3 {
                for k in 0..3 {
                    place[row][k] = turn[row][k] * scale[k];
                }
                place[row][3] = by[row];
            }
        }
    }
    (node, place)
}

/// First the one place, then the other.
fn after(outer: &Affine, inner: &Affine) -> Affine {
    std::array::from_fn(|row| {
        std::array::from_fn(|k| {
            let sum: f64 = (0..3).map(|i| outer[row][i] * inner[i][k]).sum();
            sum + if k == 3 { outer[row][3] } else { 0.0 }
        })
    })
}

fn show(
    positions: &[[f32; 3]],
    triangles: &[[usize; 3]],
    place: &Affine,
    shows: &mut Vec<[[f32; 3]; 3]>,
) {
    let [a, b, c] = [0, 1, 2].map(|row| [place[row][0], place[row][1], place[row][2]]);
    let is_mirror = dot(cross(a, b), c) < 0.0;
    for &triangle in triangles {
        let mut corners = triangle.map(|i| {
            let [x, y, z] = positions[i].map(f64::from);
            place.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3])
        });
        if is_mirror {
            corners.swap(1, 2);
        }
        let [p, q, r] = corners;
        let edge = |to: [f64; 3]| [0, 1, 2].map(|k| to[k] - p[k]);
        if cross(edge(q), edge(r)) != [0.0; 3] {
            shows.push(corners.map(|corner| corner.map(|c| c as f32)));
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[u, v]| a[u] * b[v] - a[v] * b[u])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Puts the buffers into the file, into addresses and beside it.
fn store(buffers: Vec<Vec<u8>>, document: &mut Document, choose: &mut Choose<'_>) {
    let mut list = Vec::new();
    for (number, bytes) in buffers.into_iter().enumerate() {
        let mut buffer = json!({"byteLength": bytes.len()});
        match choose(3) {
            0 if number == 0 => document.binary = Some(bytes),
            1 => {
                let name = format!("b {number}.bin");
                buffer["uri"] = name.replace(' ', "%20").into();
                document.beside.push((name, bytes));
            }
            _ => {
                let uri = data_uri(&bytes);
                buffer["uri"] = match choose(2) {
                    0 => uri.trim_end_matches('=').into(),
                    _ => uri.into(),
                };
            }
        }
        list.push(buffer);
    }
    document.json["buffers"] = list.into();
}
