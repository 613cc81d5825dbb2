//! A perfect maze.

use super::list::Settings;
use super::shapes::rows;
use super::{gradient, hash, palette};
use crate::graph::{Progress, Voxel};

/// A floor with walls of `max(2, side / 16)` voxels. Squares of the plan with two odd coordinates are rooms, those with
/// one may be doors.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let side = (1i32 << settings.depth) - 1;
    let top = ((side + 1) / 16).max(2);
    let open = plan(settings.depth, settings.seed);
    rows("maze", [side, top + 1], sink, progress, |y, z, put| {
        for x in 0..side {
            if z == 0 {
                put(x, palette(2));
            } else if !open[(y * side + x) as usize] {
                put(x, gradient([x, y, z], side));
            }
        }
    });
}

fn plan(depth: u32, seed: u32) -> Vec<bool> {
    let side = (1i32 << depth) - 1;
    let square = |x: i32, y: i32| (y * side + x) as usize;
    let mut open = vec![false; (side * side) as usize];
    open[square(1, 1)] = true;
    let mut path = vec![(1, 1)];
    let mut steps = 0u32;
    while let Some(&(x, y)) = path.last() {
        let unvisited: Vec<(i32, i32)> = [(1, 0), (-1, 0), (0, 1), (0, -1)]
            .into_iter()
            .filter(|(dx, dy)| {
                let (x, y) = (x + 2 * dx, y + 2 * dy);
                (0..side).contains(&x) && (0..side).contains(&y) && !open[square(x, y)]
            })
            .collect();
        if unvisited.is_empty() {
            path.pop();
            continue;
        }
        let (dx, dy) = unvisited[hash(steps, 0, seed) as usize % unvisited.len()];
        steps += 1;
        open[square(x + dx, y + dy)] = true;
        open[square(x + 2 * dx, y + 2 * dy)] = true;
        path.push((x + 2 * dx, y + 2 * dy));
    }
    open
}
