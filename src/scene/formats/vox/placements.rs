//! The different placements of models.
//!
//! A file of some kilobytes can place a model a million times, by nodes with many parents. So placements are found
//! before any voxel is passed on: their number is known, and a repeated placement costs nothing. Of equal placements
//! the last is kept, because of voxels at one index the last one counts.

use std::collections::HashMap;

use super::Contents;
use super::model::Model;
use super::transform::Transform;
use super::walk;
use crate::scene::fault::{Fault, Problem};
use crate::scene::{ReadOptions, SceneInfo};

/// A model and its transform.
pub(super) struct Placement<'m, 'f> {
    pub(super) model: &'m Model<'f>,
    pub(super) transform: Transform,
}

/// All different placements of the scene graph that are read, in the order of their last occurrence.
pub(super) fn find<'m, 'f>(
    contents: &'m Contents<'f>,
    options: &ReadOptions,
    info: &mut SceneInfo,
) -> Result<Vec<Placement<'m, 'f>>, Problem> {
    let mut is_placed = vec![false; contents.models.len()];
    let mut last: HashMap<(u32, Transform), u32> = HashMap::new();
    walk::walk(&contents.graph, |instance| {
        let Some(is_placed) = is_placed.get_mut(instance.model as usize) else {
            // The walk adds the shape node.
            return Err(Problem::Invalid(Fault::new(
                "",
                0,
                format!("a model from 0 to {}", contents.models.len() as i64 - 1),
                format!("model {}", instance.model),
                "the file is cut short or its exporter is at fault; open it in MagicaVoxel and save it again",
            )));
        };
        *is_placed = true;
        if instance.hidden && !options.hidden {
            info.hidden_instances += 1;
            return Ok(());
        }
        // The walk visits far fewer than 2^32.
        last.insert((instance.model, instance.transform), info.instances);
        info.instances += 1;
        Ok(())
    })?;
    let missing = is_placed.iter().filter(|placed| !**placed).count();
    if missing > 0 {
        info.warnings.push(format!(
            "{missing} of {} models are not placed by the scene graph and were left out",
            is_placed.len()
        ));
    }
    let repeated = info.instances as usize - last.len();
    if repeated > 0 {
        info.warnings.push(format!(
            "{repeated} placements put a model where it is already, and were left out"
        ));
    }
    let mut placed: Vec<_> = last.into_iter().collect();
    placed.sort_unstable_by_key(|&(_, order)| order);
    let of = |((number, transform), _): ((u32, Transform), u32)| {
        let model = contents.models.get(number as usize)?;
        Some(Placement { model, transform })
    };
    Ok(placed.into_iter().filter_map(of).collect())
}
