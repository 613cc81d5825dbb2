//! The scene graph: transform, group and shape nodes, layers, and the placements of models that they make.
//!
//! A small file can place a model a million times, by nodes with many parents. So placements are found before any voxel
//! is passed on, and a repeated one costs nothing. Of an animation the first key frame is read.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::chunk::{Chunk, Dict, Fields};
use super::transform::Transform;
use super::{AGAIN, DAMAGED};
use crate::scene::fault::{Fault, Problem};

/// Most visits of nodes and models, which the file's length does not bound.
const MAX_VISITS: u64 = if cfg!(fuzzing) { 1 << 13 } else { 1 << 20 };

struct Node {
    part: String,
    offset: u64,
    hidden: bool,
    kind: NodeKind,
}

enum NodeKind {
    Transform {
        child: u32,
        layer: Option<u32>,
        transform: Transform,
    },
    Group(Vec<u32>),
    Shape(Vec<u32>),
}

#[derive(Default)]
pub(super) struct SceneGraph {
    nodes: BTreeMap<u32, Node>,
    hidden_layers: BTreeSet<u32>,
}

enum Step<'g> {
    Enter {
        id: u32,
        parent: Option<&'g Node>,
        transform: Transform,
        hidden: bool,
    },
    Leave(u32),
}

impl SceneGraph {
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub(super) fn add_layer(&mut self, chunk: &Chunk<'_>) -> Result<(), Box<Fault>> {
        let mut fields = Fields::new(chunk);
        let id = fields.u32("layer id")?;
        if fields.dict()?.is_set("_hidden") {
            self.hidden_layers.insert(id);
        }
        Ok(())
    }

    pub(super) fn add_node(&mut self, chunk: &Chunk<'_>) -> Result<(), Box<Fault>> {
        let mut fields = Fields::new(chunk);
        let id = fields.u32("node id")?;
        let hidden = fields.dict()?.is_set("_hidden");
        let part = format!("{} (node {id})", fields.part());
        let kind = match &chunk.id {
            b"nTRN" => transform_node(&mut fields, &part)?,
            b"nGRP" => {
                let count = fields.count("children", 4)?;
                let children = (0..count).map(|_| fields.u32("child id"));
                NodeKind::Group(children.collect::<Result<_, _>>()?)
            }
            _ => {
                let (mut first, mut shown) = (u32::MAX, Vec::new());
                for _ in 0..fields.count("models", 8)? {
                    let model = fields.u32("model number")?;
                    let attributes = fields.dict()?;
                    // Models without a key frame of their own are all shown together.
                    let frame = frame_of(&attributes, &part)?.unwrap_or(0);
                    if frame < first {
                        shown.clear();
                        first = frame;
                    }
                    if frame == first {
                        shown.push(model);
                    }
                }
                NodeKind::Shape(shown)
            }
        };
        let offset = chunk.offset as u64;
        let node = Node {
            part,
            offset,
            hidden,
            kind,
        };
        if let Some(first) = self.nodes.insert(id, node) {
            let part = format!("chunk {} (node {id})", chunk.id.escape_ascii());
            let found = format!("the id of the {} at byte {}", first.part, first.offset);
            return Err(Fault::new(
                part,
                offset,
                "a node id of its own",
                found,
                AGAIN,
            ));
        }
        Ok(())
    }

    /// All different placements of models that are not hidden. Of equal ones the last is kept, because of voxels at one
    /// index the last one counts. Also returns the number of those that are hidden.
    pub(super) fn placements(
        &self,
        models: usize,
        warnings: &mut Vec<String>,
    ) -> Result<(Vec<(u32, Transform)>, u32), Problem> {
        let (mut shown, mut hidden_ones) = (0, 0);
        let mut is_placed = vec![false; models];
        let mut last: HashMap<(u32, Transform), u32> = HashMap::new();
        self.walk(|node, model, transform, hidden| {
            let Some(is_placed) = is_placed.get_mut(model as usize) else {
                let expected = format!("a model from 0 to {}", models as i64 - 1);
                let found = format!("model {model}");
                let part = node.part.clone();
                return Err(Fault::new(part, node.offset, expected, found, DAMAGED));
            };
            *is_placed = true;
            if hidden {
                hidden_ones += 1;
            } else {
                last.insert((model, transform), shown);
                shown += 1;
            }
            Ok(())
        })?;
        let missing = is_placed.iter().filter(|placed| !**placed).count();
        if missing > 0 {
            warnings.push(format!(
                "{missing} of {models} models are not placed by the scene graph and were left out"
            ));
        }
        let repeated = shown as usize - last.len();
        if repeated > 0 {
            warnings.push(format!(
                "{repeated} placements put a model where it is already, and were left out"
            ));
        }
        let mut placed: Vec<_> = last.into_iter().collect();
        placed.sort_unstable_by_key(|&(_, order)| order);
        let placed = placed.into_iter().map(|(placement, _)| placement);
        Ok((placed.collect(), hidden_ones))
    }

    fn walk<'g>(
        &'g self,
        mut visit: impl FnMut(&'g Node, u32, Transform, bool) -> Result<(), Box<Fault>>,
    ) -> Result<(), Problem> {
        let mut visits = 0;
        let mut on_path = BTreeSet::new();
        let mut steps = vec![Step::Enter {
            id: 0,
            parent: None,
            transform: Transform::IDENTITY,
            hidden: false,
        }];
        while let Some(step) = steps.pop() {
            let (id, parent, mut transform, mut hidden) = match step {
                Step::Enter {
                    id,
                    parent,
                    transform,
                    hidden,
                } => (id, parent, transform, hidden),
                Step::Leave(id) => {
                    on_path.remove(&id);
                    continue;
                }
            };
            let at_parent = |expected: String, found: String| {
                let (part, offset) = match parent {
                    Some(parent) => (parent.part.clone(), parent.offset),
                    None => ("scene graph".to_owned(), 0),
                };
                Fault::new(part, offset, expected, found, DAMAGED)
            };
            let Some(node) = self.nodes.get(&id) else {
                let expected = format!("a node with id {id} (the root has id 0)");
                return Err(at_parent(expected, "none in the file".to_owned()).into());
            };
            if !on_path.insert(id) {
                let found = format!("node {id}, which contains this node, as its child");
                return Err(at_parent("a scene graph without circles".to_owned(), found).into());
            }
            steps.push(Step::Leave(id));
            hidden |= node.hidden;
            let children = match &node.kind {
                NodeKind::Transform {
                    child,
                    layer,
                    transform: own,
                } => {
                    hidden |= layer.is_some_and(|layer| self.hidden_layers.contains(&layer));
                    transform = transform.after(own).ok_or_else(|| {
                        let expected = "translations whose sum fits 62 bits";
                        let advice = "move the scene towards the origin";
                        Fault::new(node.part.clone(), node.offset, expected, "more", advice)
                    })?;
                    std::slice::from_ref(child)
                }
                NodeKind::Group(children) => children,
                NodeKind::Shape(models) => {
                    visits += models.len() as u64;
                    for &model in models {
                        visit(node, model, transform, hidden)?;
                    }
                    &[]
                }
            };
            visits += children.len() as u64;
            if visits > MAX_VISITS {
                return Err(Problem::Limit(Fault::new(
                    node.part.clone(),
                    node.offset,
                    format!("a scene of at most {MAX_VISITS} placed nodes and models"),
                    "more",
                    format!("the scene graph shares nodes too often; {AGAIN}"),
                )));
            }
            steps.extend(children.iter().rev().map(|&id| Step::Enter {
                id,
                parent: Some(node),
                transform,
                hidden,
            }));
        }
        Ok(())
    }
}

fn transform_node(fields: &mut Fields<'_>, part: &str) -> Result<NodeKind, Box<Fault>> {
    let child = fields.u32("child id")?;
    fields.u32("reserved field")?;
    let layer = fields.u32("layer id")?;
    let mut first: Option<(u32, Dict<'_>)> = None;
    for i in 0..fields.count("frames", 4)? {
        let attributes = fields.dict()?;
        let frame = frame_of(&attributes, part)?.unwrap_or(i);
        if first.as_ref().is_none_or(|(least, _)| frame < *least) {
            first = Some((frame, attributes));
        }
    }
    let mut transform = Transform::IDENTITY;
    if let Some((_, attributes)) = first {
        let rotation = "a rotation: one number from 0 to 127";
        if let Some([value]) = attributes.numbers("_r", part, rotation)? {
            transform = u8::try_from(value)
                .ok()
                .and_then(Transform::from_rotation_byte)
                .ok_or_else(|| {
                    let part = format!("{part}, attribute _r");
                    let expected = "a rotation: bits 0-1 and 2-3 two different axes of 0, 1, 2, bits 4-6 signs";
                    Fault::new(part, attributes.offset, expected, value.to_string(), DAMAGED)
                })?;
        }
        let translation = "a translation: three whole numbers of 32 bits";
        if let Some(translation) = attributes.numbers("_t", part, translation)? {
            transform = transform.with_translation(translation);
        }
    }
    Ok(NodeKind::Transform {
        child,
        layer: (layer != u32::MAX).then_some(layer),
        transform,
    })
}

fn frame_of(attributes: &Dict<'_>, part: &str) -> Result<Option<u32>, Box<Fault>> {
    let frame = attributes.numbers::<1>("_f", part, "a frame number")?;
    // Frames before the first count as the first.
    Ok(frame.map(|[frame]| u32::try_from(frame).unwrap_or(0)))
}
