//! Visits every placement of a model, from the root of the scene graph down.

use std::collections::BTreeSet;

use super::nodes::{Node, NodeKind, SceneGraph};
use super::transform::Transform;
use crate::scene::fault::{Fault, Problem};

/// Most visits of nodes and models. A scene graph is meant to be a tree. But a file can name one node as the child of
/// many, and then the number of visits is not bounded by the file's length.
const MAX_VISITS: u64 = 1 << 20;

/// A model, placed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instance {
    /// Number of the model.
    pub model: u32,
    /// Its transform.
    pub transform: Transform,
    /// Whether it, a node above it or its layer is hidden.
    pub hidden: bool,
}

/// A node on the way down.
struct Step {
    node: u32,
    next_child: usize,
    transform: Transform,
    hidden: bool,
}

/// Calls `visit` for each placement, in the order of the file's lists.
pub(super) fn walk(
    graph: &SceneGraph,
    mut visit: impl FnMut(Instance) -> Result<(), Problem>,
) -> Result<(), Problem> {
    let mut path = Vec::new();
    let mut on_path = BTreeSet::new();
    let mut visits = 0u64;
    enter(graph, 0, None, &mut path, &mut on_path)?;
    while let Some(step) = path.last_mut() {
        let (id, hidden, transform) = (step.node, step.hidden, step.transform);
        // Only nodes that exist are entered.
        let Some(node) = graph.get(id) else { break };
        let child = match &node.kind {
            NodeKind::Transform { child, .. } => (step.next_child == 0).then_some(*child),
            NodeKind::Group(children) => children.get(step.next_child).copied(),
            NodeKind::Shape(models) => {
                visits += models.len() as u64;
                check_visits(visits, node)?;
                for model in models {
                    visit(Instance {
                        model: *model,
                        transform,
                        hidden,
                    })
                    .map_err(|problem| at_shape(problem, &node.part, node.offset))?;
                }
                None
            }
        };
        step.next_child += 1;
        let Some(child) = child else {
            on_path.remove(&id);
            path.pop();
            continue;
        };
        visits += 1;
        check_visits(visits, node)?;
        enter(
            graph,
            child,
            Some((transform, hidden)),
            &mut path,
            &mut on_path,
        )?;
    }
    Ok(())
}

/// Fails at a node after too many visits.
fn check_visits(visits: u64, node: &Node) -> Result<(), Problem> {
    if visits <= MAX_VISITS {
        return Ok(());
    }
    Err(Problem::Limit(Fault::new(
        node.part.clone(),
        node.offset,
        format!("a scene of at most {MAX_VISITS} placed nodes and models"),
        "more",
        "the scene graph shares nodes too often; open the file in MagicaVoxel and save it again",
    )))
}

/// Goes down to a node.
fn enter(
    graph: &SceneGraph,
    id: u32,
    above: Option<(Transform, bool)>,
    path: &mut Vec<Step>,
    on_path: &mut BTreeSet<u32>,
) -> Result<(), Box<Fault>> {
    // The root has no parent to blame.
    let parent = path.last().and_then(|step| graph.get(step.node));
    let (part, offset) = parent.map_or(("scene graph".to_owned(), 0), |parent| {
        (parent.part.clone(), parent.offset)
    });
    let Some(node) = graph.get(id) else {
        return Err(Fault::new(
            part,
            offset,
            format!("a node with id {id} (the root has id 0)"),
            "none in the file",
            "the file is cut short or its exporter is at fault; open it in MagicaVoxel and save it again",
        ));
    };
    if !on_path.insert(id) {
        return Err(Fault::new(
            part,
            offset,
            "a scene graph without circles",
            format!("node {id}, which contains this node, as its child"),
            "the file's exporter is at fault; a .vox scene cannot contain itself",
        ));
    }
    let (mut transform, mut hidden) = above.unwrap_or((Transform::IDENTITY, false));
    hidden |= node.hidden;
    if let NodeKind::Transform {
        transform: own,
        layer,
        ..
    } = &node.kind
    {
        hidden |= layer.is_some_and(|layer| graph.is_layer_hidden(layer));
        transform = transform.after(own).ok_or_else(|| {
            Fault::new(
                node.part.clone(),
                node.offset,
                "translations whose sum fits 62 bits",
                "more",
                "move the scene towards the origin",
            )
        })?;
    }
    path.push(Step {
        node: id,
        next_child: 0,
        transform,
        hidden,
    });
    Ok(())
}

/// Adds the shape node to a problem without a place.
fn at_shape(problem: Problem, part: &str, offset: u64) -> Problem {
    match problem {
        Problem::Invalid(mut fault) if fault.part.is_empty() => {
            part.clone_into(&mut fault.part);
            fault.offset = offset;
            Problem::Invalid(fault)
        }
        other => other,
    }
}
