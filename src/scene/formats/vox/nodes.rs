//! The scene graph: transform, group and shape nodes, and layers.

use std::collections::{BTreeMap, BTreeSet};

use super::chunk::{Chunk, Dict, Fields};
use super::transform::{Transform, bad_rotation};
use crate::scene::fault::Fault;

/// A node and its place in the file.
#[derive(Debug)]
pub(super) struct Node {
    /// Its name in error messages.
    pub part: String,
    /// Offset of its chunk.
    pub offset: u64,
    /// Whether the editor hides it.
    pub hidden: bool,
    /// Its kind.
    pub kind: NodeKind,
}

/// A node's kind.
#[derive(Debug)]
pub(super) enum NodeKind {
    /// Moves its child.
    Transform {
        /// The child's node id.
        child: u32,
        /// The layer's id, if it is on one.
        layer: Option<u32>,
        /// Its transform at the frame that is read.
        transform: Transform,
    },
    /// Holds other nodes, by id.
    Group(Vec<u32>),
    /// Shows models, by number: those of the frame that is read.
    Shape(Vec<u32>),
}

/// All nodes of a file by their ids, and the hidden layers.
#[derive(Debug, Default)]
pub(super) struct SceneGraph {
    nodes: BTreeMap<u32, Node>,
    hidden_layers: BTreeSet<u32>,
}

const AGAIN: &str = "open the file in MagicaVoxel and save it again";

impl SceneGraph {
    /// Whether the file has no scene graph.
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The node of an id.
    pub(super) fn get(&self, id: u32) -> Option<&Node> {
        self.nodes.get(&id)
    }

    /// Whether a layer is hidden in the editor.
    pub(super) fn is_layer_hidden(&self, layer: u32) -> bool {
        self.hidden_layers.contains(&layer)
    }

    /// Reads a chunk `LAYR`.
    pub(super) fn add_layer(&mut self, chunk: &Chunk<'_>) -> Result<(), Box<Fault>> {
        let mut fields = Fields::new(chunk);
        let id = fields.u32("layer id")?;
        let attributes = fields.dict()?;
        if attributes.is_set("_hidden") {
            self.hidden_layers.insert(id);
        }
        Ok(())
    }

    /// Reads a chunk `nTRN`, `nGRP` or `nSHP`, as it is at `frame`.
    pub(super) fn add_node(&mut self, chunk: &Chunk<'_>, frame: u32) -> Result<(), Box<Fault>> {
        let mut fields = Fields::new(chunk);
        let id = fields.u32("node id")?;
        let attributes = fields.dict()?;
        let part = format!("{} (node {id})", fields.part());
        let kind = match &chunk.id {
            b"nTRN" => transform_node(&mut fields, &part, frame)?,
            b"nGRP" => group_node(&mut fields)?,
            _ => shape_node(&mut fields, &part, frame)?,
        };
        let offset = chunk.offset as u64;
        let node = Node {
            part,
            offset,
            hidden: attributes.is_set("_hidden"),
            kind,
        };
        if let Some(first) = self.nodes.insert(id, node) {
            return Err(Fault::new(
                format!("chunk {} (node {id})", chunk.id.escape_ascii()),
                offset,
                "a node id of its own",
                format!("the id of the {} at byte {}", first.part, first.offset),
                AGAIN,
            ));
        }
        Ok(())
    }
}

/// The rest of a chunk `nTRN`.
fn transform_node(fields: &mut Fields<'_>, part: &str, frame: u32) -> Result<NodeKind, Box<Fault>> {
    let child = fields.u32("child id")?;
    fields.u32("reserved field")?;
    let layer = fields.u32("layer id")?;
    let count = fields.count("frames", 4)?;
    let mut keys = KeyFrames::new(frame);
    for i in 0..count {
        let attributes = fields.dict()?;
        let key = frame_of(&attributes, part)?.unwrap_or(i);
        keys.offer(key, attributes);
    }
    let mut transform = Transform::IDENTITY;
    if let Some(attributes) = keys.chosen.first() {
        let rotation = "a rotation: one number from 0 to 127";
        if let Some([value]) = attributes.numbers("_r", part, rotation)? {
            transform = u8::try_from(value)
                .ok()
                .and_then(Transform::from_rotation_byte)
                .ok_or_else(|| bad_rotation(part, attributes.offset, value))?;
        }
        let translation = "a translation: three whole numbers of 32 bits";
        if let Some(translation) = attributes.numbers("_t", part, translation)? {
            transform = transform.with_translation(translation);
        }
    }
    Ok(NodeKind::Transform {
        child,
        // -1: on no layer.
        layer: (layer != u32::MAX).then_some(layer),
        transform,
    })
}

/// The rest of a chunk `nGRP`.
fn group_node(fields: &mut Fields<'_>) -> Result<NodeKind, Box<Fault>> {
    let count = fields.count("children", 4)?;
    let mut children = Vec::with_capacity(count as usize);
    for _ in 0..count {
        children.push(fields.u32("child id")?);
    }
    Ok(NodeKind::Group(children))
}

/// The rest of a chunk `nSHP`.
fn shape_node(fields: &mut Fields<'_>, part: &str, frame: u32) -> Result<NodeKind, Box<Fault>> {
    let count = fields.count("models", 8)?;
    let mut keys = KeyFrames::new(frame);
    for _ in 0..count {
        let model = fields.u32("model number")?;
        let attributes = fields.dict()?;
        // Models without a key frame of their own are all shown together.
        let key = frame_of(&attributes, part)?.unwrap_or(0);
        keys.offer(key, model);
    }
    Ok(NodeKind::Shape(keys.chosen))
}

/// The key frame that attributes belong to, if they say so.
fn frame_of(attributes: &Dict<'_>, part: &str) -> Result<Option<u32>, Box<Fault>> {
    let frame = attributes.numbers::<1>("_f", part, "a frame number")?;
    // Frames before the first count as the first.
    Ok(frame.map(|[frame]| u32::try_from(frame).unwrap_or(0)))
}

/// Keeps what belongs to the last key frame at or before a frame, or, where all
/// key frames come later, to the first of them.
struct KeyFrames<T> {
    frame: u32,
    key: u32,
    chosen: Vec<T>,
}

impl<T> KeyFrames<T> {
    fn new(frame: u32) -> Self {
        Self {
            frame,
            key: 0,
            chosen: Vec::new(),
        }
    }

    fn offer(&mut self, key: u32, item: T) {
        let better = match (key <= self.frame, self.key <= self.frame) {
            (true, true) => key > self.key,
            (true, false) => true,
            (false, true) => false,
            (false, false) => key < self.key,
        };
        if self.chosen.is_empty() || better {
            self.chosen.clear();
            self.key = key;
        }
        if key == self.key {
            self.chosen.push(item);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::KeyFrames;

    #[test]
    fn last_key_frame_at_or_before_the_frame() {
        let at = |frame, keys: &[u32]| {
            let mut frames = KeyFrames::new(frame);
            for (i, key) in keys.iter().enumerate() {
                frames.offer(*key, i);
            }
            frames.chosen
        };
        assert_eq!(at(0, &[0, 10, 20]), [0]);
        assert_eq!(at(9, &[0, 10, 20]), [0]);
        assert_eq!(at(10, &[0, 10, 20]), [1]);
        assert_eq!(at(99, &[20, 0, 10]), [0]);
        assert_eq!(at(3, &[20, 10]), [1], "all later: the first");
        assert_eq!(at(0, &[0, 0, 5]), [0, 1], "shown together");
        assert!(at(0, &[]).is_empty());
    }
}
