//! Equal triangles, looked at once: those with corners at the same points of the lattice, and the same normals and places
//! in one texture there, in the same order. The first counts with the opacities of all added up and their colours,
//! averaged by opacity.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::Grid;
use crate::{Sampler, Surface, Triangle};
use shiftvox::split_mix::mix;

/// Corners, normals, the address of a texture and places in it.
type Key = ([[i64; 3]; 3], [[u64; 3]; 3], Option<(usize, [[u32; 2]; 3])>);

pub(super) struct Distinct<'s> {
    /// Numbers of all triangles that repeat no earlier one, rising.
    pub(super) numbers: Vec<u32>,
    /// The sum of equal triangles and their count, by the number of the first.
    pub(super) repeated: HashMap<u32, (Triangle<'s>, u32)>,
}

impl<'s> Distinct<'s> {
    /// Takes 9 bytes per triangle in addition to the numbers.
    pub(super) fn of(surface: &'s dyn Surface, grid: &Grid) -> Self {
        let count = surface.len() as u32;
        let hash = |number: u32| {
            let corners = grid.corners(surface, number);
            hash_of(corners.as_flattened()) & !0xffff_ffff | u64::from(number)
        };
        let mut hashes: Vec<u64> = (0..count).into_par_iter().map(hash).collect();
        hashes.par_sort_unstable();
        let mut repeated = HashMap::new();
        let mut is_later = vec![false; surface.len()];
        for alike in hashes.chunk_by(|a, b| a >> 32 == b >> 32) {
            if alike.len() == 1 {
                continue;
            }
            let mut firsts: HashMap<Key, u32> = HashMap::new();
            for number in alike.iter().map(|&hash| hash as u32) {
                let triangle = surface.triangle(number as usize);
                let bits = |n: DVec3| n.to_array().map(|c| (c + 0.0).to_bits());
                let texture = triangle.sampler.map(|Sampler { texture, places }| {
                    let places = places.map(|place| place.map(f32::to_bits));
                    (std::ptr::from_ref(texture).addr(), places)
                });
                let corners = grid.corners(surface, number);
                let key = (corners, triangle.normals.map(bits), texture);
                let first = *firsts.entry(key).or_insert(number);
                if first == number {
                    continue;
                }
                let (all, times): &mut (Triangle<'_>, u32) = repeated
                    .entry(first)
                    .or_insert_with(|| (surface.triangle(first as usize), 1));
                *times += 1;
                all.alpha += triangle.alpha;
                let share = triangle.alpha / all.alpha;
                for (color, other) in all.colors.iter_mut().zip(triangle.colors) {
                    *color += (other - *color) * share;
                }
                is_later[number as usize] = true;
            }
        }
        let numbers = (0..count).filter(|&number| !is_later[number as usize]);
        Self {
            numbers: numbers.collect(),
            repeated,
        }
    }
}

pub(super) fn hash_of(numbers: &[i64]) -> u64 {
    numbers.iter().fold(0, |hash, &c| mix(hash ^ c as u64))
}
