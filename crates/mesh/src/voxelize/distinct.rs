//! Equal triangles, looked at once.
//!
//! Triangles that have their corners at the same points of the lattice, and the same normals there, in the same order,
//! meet the same voxels with the same parts. Of them the first is looked at; it counts with the opacities of all added
//! up, and has their colours, averaged by opacity. So voxelising takes no longer for triangles that are repeated.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::Grid;
use crate::{Surface, Triangle};
use shiftvox::split_mix::mix;

/// Corners on the lattice, and the bits of the normals.
type Key = ([[i64; 3]; 3], [[u64; 3]; 3]);

/// The sum of equal triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Repeated {
    pub(super) times: u32,
    /// Colours of the corners, averaged by opacity.
    pub(super) colors: [DVec3; 3],
    /// Their opacities, added up.
    pub(super) alpha: f64,
}

/// The triangles that are to be looked at.
#[derive(Debug)]
pub(super) struct Distinct {
    /// Numbers of all, without those that repeat an earlier one; in order.
    pub(super) numbers: Vec<u32>,
    /// By number: what is repeated.
    repeated: HashMap<u32, Repeated>,
}

impl Distinct {
    /// Compares all triangles of a surface on a grid. Takes 8 bytes per triangle in addition to the numbers.
    pub(super) fn of<S: Surface + ?Sized>(surface: &S, grid: &Grid) -> Self {
        // Fewer than 2^32: the grid made sure. Half of a key is for sorting; keys are compared as a whole.
        let count = surface.len() as u32;
        let hash = |number: u32| {
            let corners = grid.corners(surface, number);
            let hash = corners
                .as_flattened()
                .iter()
                .fold(0, |hash, &c| mix(hash ^ c as u64));
            hash & !0xffff_ffff | u64::from(number)
        };
        let mut hashes: Vec<u64> = (0..count).into_par_iter().map(hash).collect();
        hashes.par_sort_unstable();
        let mut repeated = HashMap::new();
        let mut later = Vec::new();
        for alike in hashes.chunk_by(|a, b| a >> 32 == b >> 32) {
            if alike.len() == 1 {
                continue;
            }
            // Without signs of zeros.
            let mut firsts: HashMap<Key, u32> = HashMap::new();
            for number in alike.iter().map(|&hash| hash as u32) {
                let triangle = surface.triangle(number as usize);
                let normals = triangle
                    .normals
                    .map(|n| n.to_array().map(|c| (c + 0.0).to_bits()));
                let key = (grid.corners(surface, number), normals);
                let first = *firsts.entry(key).or_insert(number);
                if first != number {
                    let entry = repeated.entry(first);
                    let all = entry.or_insert_with(|| of_one(&surface.triangle(first as usize)));
                    add(all, &triangle);
                    later.push(number);
                }
            }
        }
        drop(hashes);
        later.sort_unstable();
        let mut later = later.into_iter().peekable();
        let numbers = (0..count).filter(|number| later.next_if_eq(number).is_none());
        Self {
            numbers: numbers.collect(),
            repeated,
        }
    }

    /// The sum of the triangles equal to this one, if there are any.
    pub(super) fn repeated(&self, number: u32) -> Option<&Repeated> {
        self.repeated.get(&number)
    }
}

fn of_one(triangle: &Triangle) -> Repeated {
    Repeated {
        times: 1,
        colors: triangle.colors,
        alpha: triangle.alpha,
    }
}

fn add(all: &mut Repeated, triangle: &Triangle) {
    all.times += 1;
    all.alpha += triangle.alpha;
    // Above 0, as every opacity is.
    let share = triangle.alpha / all.alpha;
    for (color, other) in all.colors.iter_mut().zip(triangle.colors) {
        *color += (other - *color) * share;
    }
}
