//! A node's record and its bytes.

use std::io;
use std::path::Path;

use glam::DVec3;

use super::clusters::Occluders;
use super::count::Seen;
use super::grid::Grid;
use super::ordered::Ordered;
use super::room::Room;
use super::sample::Rays;
use super::shader_fit::{self, ShaderFit};
use super::shot::Target;
use super::split::Branch;
use super::spool::Made;
use super::surface::{MOST_TRIANGLES, Surfaces};
use super::{BuildError, BuildOptions, failed};
use crate::far::record::Node;
use crate::far::store::pack::pack;
use crate::far::store::surface::lay_out;
use crate::texture::paint::Textures;

pub(super) const MOST_RAYS: u32 = 1 << 22;
/// Bytes per ray of a node that is sampled, or less: 40 of its own, and 20 per voxel that it crosses.
const RAY_BYTES: u64 = 160;
const RAYS_AT_VOXEL: u64 = 32;

/// Makes nodes, each from its number alone.
pub(super) struct Maker<'m> {
    pub(super) options: &'m BuildOptions,
    pub(super) triangles: &'m Ordered<'m>,
    pub(super) textures: &'m Textures,
    /// Of a hybrid.
    pub(super) surfaces: Option<Surfaces<'m>>,
    pub(super) occluders: &'m Occluders<'m>,
    pub(super) room: Room,
    /// Of the occluders' file.
    pub(super) folder: &'m Path,
    /// Nodes above the root of the hierarchy.
    pub(super) coarser: usize,
}

impl Maker<'_> {
    pub(super) fn grid(&self, number: usize, branch: &Branch) -> Grid {
        let low = self.triangles.place(branch.low);
        let high = self.triangles.place(branch.high);
        let halvings = self.coarser.saturating_sub(number);
        Grid::around(low, high, self.options.grid >> halvings)
    }

    /// A leaf's triangles, or voxels if there are rays to make them of.
    pub(super) fn node(
        &self,
        number: usize,
        branch: &Branch,
        rays: Option<Rays>,
    ) -> Result<Made, BuildError> {
        let mut node = outline(branch, self.triangles.centre);
        let own = branch.triangles();
        if branch.children.is_none() {
            let data = match &self.surfaces {
                Some(surfaces) => surfaces.leaf(&mut node, own),
                None => {
                    let all = self.triangles.stored(own, Some(self.textures));
                    pack(&Default::default(), &lay_out(&mut node, &all, |_| true))
                }
            };
            return Ok(made(node, data));
        }
        let Some(rays) = rays else {
            return Ok(made(node, pack(&Default::default(), &[])));
        };
        let grid = self.grid(number, branch);
        set_grid(&mut node, &grid, self.triangles.scale);
        // The root has seed 0, whatever its number.
        let seed = (number as u64).wrapping_sub(self.coarser as u64);
        let voxels = |node: &mut Node, taken: Option<&[bool]>| {
            let target = Target {
                occluders: self.occluders,
                grid,
                own: own.clone(),
                taken,
                distance: self.options.distance_voxels,
            };
            let lists = self.fit(node, &target, rays, seed);
            lists.map_err(|e| failed(self.folder, &e))
        };
        match &self.surfaces {
            Some(surfaces) if branch.count <= MOST_TRIANGLES => {
                let some = |node: &mut Node, taken: &[bool]| voxels(node, Some(taken));
                surfaces.inner(&node, own.clone(), some)
            }
            _ => {
                let lists = voxels(&mut node, None)?;
                Ok(made(node, pack(&lists, &[])))
            }
        }
    }

    /// Makes voxels, and counts them in the record.
    fn fit(
        &self,
        node: &mut Node,
        target: &Target<'_>,
        rays: Rays,
        seed: u64,
    ) -> io::Result<[Vec<u8>; 6]> {
        let mut lists: [Vec<u8>; 6] = Default::default();
        let (mut square_error, mut all_samples) = (0.0, 0);
        let keep = |seen: &Seen, shown: &ShaderFit, samples: usize| {
            let voxel = shader_fit::fit(seen, shown.shader, self.options.opacity);
            let list = voxel.list();
            voxel.write(&mut lists[list]);
            node.counts[list] += 1;
            square_error += shown.square_error;
            all_samples += samples;
            node.crossings = node.crossings.saturating_add(seen.crossings);
        };
        let admit = |touched: usize| {
            let rays = match rays {
                Rays::PerVoxel(_) => (touched as u64 * RAYS_AT_VOXEL).min(u64::from(MOST_RAYS)),
                Rays::InAll(rays) => u64::from(rays),
            };
            self.room.take(rays * RAY_BYTES)
        };
        let sampled = target.sample(rays, MOST_RAYS, seed, self.triangles, admit, keep)?;
        node.touched = sampled.touched;
        node.untested = sampled.untested;
        node.rays = sampled.rays;
        node.hits = sampled.hits;
        let mean = square_error / f64::from(all_samples.max(1) as u32);
        node.error = libm::sqrt(mean) as f32;
        Ok(lists)
    }
}

fn made(node: Node, data: Vec<u8>) -> Made {
    Made {
        node,
        data,
        is_undecimated: false,
    }
}

fn outline(branch: &Branch, centre: DVec3) -> Node {
    let single = |p: DVec3| (p - centre).as_vec3().to_array();
    Node {
        low: single(branch.low),
        high: single(branch.high),
        is_leaf: u8::from(branch.children.is_none()),
        level: branch.level as u16,
        children: branch.children.map_or([0; 2], |c| c.map(|c| c as u32)),
        first_triangle: branch.first as u32,
        triangles: branch.count as u32,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Exact: the scale is a power of two.
fn set_grid(node: &mut Node, grid: &Grid, scale: f64) {
    node.origin = (grid.origin / scale).as_vec3().to_array();
    node.voxel = (grid.voxel / scale) as f32;
    node.cells = grid.cells;
    node.across = 2;
}
