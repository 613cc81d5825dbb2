//! Composes `.vox` files, right or wrong, and random ones of which it knows the voxels. The fuzz target `vox_graph` uses
//! it, too.
#![allow(dead_code, reason = "a module of a test crate, and of a fuzz target")]

use std::collections::BTreeMap;

pub(crate) type Attributes<'a> = &'a [(&'a str, &'a str)];

#[derive(Clone, Default)]
pub(crate) struct VoxFile {
    children: Vec<u8>,
}

impl VoxFile {
    pub(crate) fn chunk(mut self, id: &[u8; 4], content: &[u8]) -> Self {
        self.children.extend(id);
        self.children.extend(numbers(&[content.len() as u32, 0]));
        self.chunks(content)
    }

    pub(crate) fn chunks(mut self, chunks: &[u8]) -> Self {
        self.children.extend(chunks);
        self
    }

    pub(crate) fn model(self, size: [u32; 3], voxels: &[[u8; 4]]) -> Self {
        let mut content = numbers(&[voxels.len() as u32]);
        content.extend(voxels.as_flattened());
        self.chunk(b"SIZE", &numbers(&size))
            .chunk(b"XYZI", &content)
    }

    pub(crate) fn palette(self, entries: &[[u8; 4]]) -> Self {
        self.chunk(b"RGBA", entries.as_flattened())
    }

    fn node(self, kind: &[u8; 4], id: u32, attributes: Attributes<'_>, rest: &[u8]) -> Self {
        let content = [&numbers(&[id])[..], &dict(attributes), rest].concat();
        self.chunk(kind, &content)
    }

    pub(crate) fn transform(
        self,
        [id, child]: [u32; 2],
        attributes: Attributes<'_>,
        layer: u32,
        frames: &[Attributes<'_>],
    ) -> Self {
        let mut rest = numbers(&[child, u32::MAX, layer, frames.len() as u32]);
        rest.extend(frames.iter().flat_map(|frame| dict(frame)));
        self.node(b"nTRN", id, attributes, &rest)
    }

    /// A transform on no layer, of one frame.
    pub(crate) fn moved(self, link: [u32; 2], frame: Attributes<'_>) -> Self {
        self.transform(link, &[], u32::MAX, &[frame])
    }

    pub(crate) fn group(self, id: u32, children: &[u32]) -> Self {
        let rest = [&[children.len() as u32], children].concat();
        self.node(b"nGRP", id, &[], &numbers(&rest))
    }

    pub(crate) fn shape(self, id: u32, models: &[(u32, Attributes<'_>)]) -> Self {
        let mut rest = numbers(&[models.len() as u32]);
        for (model, attributes) in models {
            rest.extend(numbers(&[*model]));
            rest.extend(dict(attributes));
        }
        self.node(b"nSHP", id, &[], &rest)
    }

    pub(crate) fn layer(self, id: u32, attributes: Attributes<'_>) -> Self {
        self.node(b"LAYR", id, attributes, &numbers(&[u32::MAX]))
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = b"VOX \x96\0\0\0MAIN\0\0\0\0".to_vec();
        bytes.extend(numbers(&[self.children.len() as u32]));
        bytes.extend(&self.children);
        bytes
    }
}

fn numbers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn dict(attributes: Attributes<'_>) -> Vec<u8> {
    let mut bytes = numbers(&[attributes.len() as u32]);
    for text in attributes.iter().flat_map(|(key, value)| [key, value]) {
        bytes.extend(numbers(&[text.len() as u32]));
        bytes.extend(text.as_bytes());
    }
    bytes
}

enum Node {
    /// Translation, rotation byte, child.
    Moves([i32; 3], u8, u32),
    Groups(Vec<u32>),
    Shows(Vec<u32>),
}

/// A scene graph whose nodes share children. A child has a higher number than its parents; the last nodes are shapes.
pub(crate) struct Scene {
    models: Vec<([u32; 3], Vec<[u8; 4]>)>,
    nodes: Vec<Node>,
}

impl Scene {
    /// A scene of `inner` nodes above its shapes. `below` chooses a number below another. A wild scene is large, and may
    /// have circles, wrong rotations and nodes or models that do not exist.
    pub(crate) fn compose(inner: u32, is_wild: bool, below: &mut dyn FnMut(u32) -> u32) -> Self {
        // Small scenes overlap; large ones use all of a byte and of a translation.
        let [side, span] = [[3, 4], [256, 10_000]][usize::from(is_wild || below(4) == 0)];
        let mut models = Vec::new();
        for _ in 0..=below(3) {
            let size = [0; 3].map(|_| 1 + below(side));
            let voxels = (0..=below(4)).map(|_| {
                let [x, y, z] = size.map(|side| below(side) as u8);
                [x, y, z, below(4) as u8]
            });
            models.push((size, voxels.collect()));
        }
        let end = inner + 1 + below(3);
        let mut nodes = Vec::new();
        for number in 0..inner {
            let child = |below: &mut dyn FnMut(u32) -> u32| match is_wild && below(16) == 0 {
                true => below(end + 1),
                false => number + 1 + below((end - number - 1).min(4)),
            };
            nodes.push(if below(2) == 0 {
                let by = [0; 3].map(|_| below(span) as i32 - span as i32 / 2);
                let first = below(3);
                let second = (first + 1 + below(2)) % 3;
                let rotation = first | second << 2 | below(8) << 4;
                let turned = u32::from(is_wild && below(16) == 0);
                Node::Moves(by, (rotation ^ turned) as u8, child(below))
            } else {
                Node::Groups((0..below(4)).map(|_| child(below)).collect())
            });
        }
        for _ in inner..end {
            let known = models.len() as u32 + u32::from(is_wild && below(16) == 0);
            let shown = (0..=below(2)).map(|_| below(known));
            nodes.push(Node::Shows(shown.collect()));
        }
        Self { models, nodes }
    }

    pub(crate) fn file(&self) -> VoxFile {
        let mut file = VoxFile::default();
        for (size, voxels) in &self.models {
            file = file.model(*size, voxels);
        }
        for (id, node) in (0..).zip(&self.nodes) {
            file = match node {
                Node::Moves(by, rotation, child) => {
                    let by = by.map(|c| c.to_string()).join(" ");
                    file.moved([id, *child], &[("_r", &rotation.to_string()), ("_t", &by)])
                }
                Node::Groups(children) => file.group(id, children),
                Node::Shows(models) => {
                    let models: Vec<_> = models.iter().map(|&model| (model, &[][..])).collect();
                    file.shape(id, &models)
                }
            };
        }
        file
    }

    /// The colour of each voxel of a scene that is not wild: goes down every path, and keeps the last at an index.
    pub(crate) fn voxels(&self) -> BTreeMap<[i32; 3], u8> {
        let mut found = BTreeMap::new();
        self.place(0, &|v| v, &mut found);
        found
    }

    /// The voxels below a node. `to` maps a centre, in half voxels, to its place.
    fn place(
        &self,
        number: u32,
        to: &dyn Fn([i64; 3]) -> [i64; 3],
        found: &mut BTreeMap<[i32; 3], u8>,
    ) {
        match &self.nodes[number as usize] {
            Node::Moves(by, rotation, child) => {
                let [first, second] = [usize::from(rotation & 3), usize::from(rotation >> 2 & 3)];
                let from = [first, second, 3 - first - second];
                let sign = |row: usize| 1 - 2 * i64::from(rotation >> (4 + row) & 1);
                let moved = |v: [i64; 3]| {
                    to([0, 1, 2].map(|row| sign(row) * v[from[row]] + 2 * i64::from(by[row])))
                };
                self.place(*child, &moved, found);
            }
            Node::Groups(children) => {
                for &child in children {
                    self.place(child, to, found);
                }
            }
            Node::Shows(models) => {
                for (size, voxels) in models.iter().map(|&model| &self.models[model as usize]) {
                    for [x, y, z, color] in voxels.iter().filter(|voxel| voxel[3] != 0) {
                        let p = [*x, *y, *z].map(i64::from);
                        let centre = [0, 1, 2].map(|k| 2 * (p[k] - i64::from(size[k] / 2)) + 1);
                        found.insert(to(centre).map(|c| (c >> 1) as i32), *color);
                    }
                }
            }
        }
    }
}
