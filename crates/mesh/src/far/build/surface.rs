//! The candidates for an inner node of a hybrid (`spec/far.md`), of which `compare.rs` chooses.

use std::ops::Range;

use glam::DVec3;

use super::compare::{ACROSS, Candidate, Comparison, Judged};
use super::ordered::Ordered;
use super::parts::Parts;
use super::split::Branch;
use super::spool::Made;
use super::{BuildError, BuildOptions};
use crate::Mesh;
use crate::decimate::{DecimateError, Decimation, decimate_between};
use crate::far::record::{LeafTriangle, Node};
use crate::far::store::pack::pack;
use crate::far::store::surface;
use crate::geometry::point;
use crate::material::to_light;
use crate::texture::paint::{Paint, Textures};
use shiftvox::graph::PackedNormal;

/// Parts narrower than so many voxels of a node are thin.
const THIN: f64 = 2.0;
/// In voxels of the node.
const ERROR: f64 = 0.3;
/// Shares of this error to which finer candidates are decimated; thin parts to the last.
const FINER: f64 = 1.0 / 3.0;
const FINEST: f64 = 0.1;
/// Half a decibel: a node may err so many times as much as with voxels of its thin parts, and voxels as all triangles.
const WORSE: f64 = 1.06;
/// A node that loses more of its coverage may have voxels of all triangles.
const MOST_LOST: f64 = 0.05;
/// One that loses more is not chosen if another loses less.
const BLANK: f64 = 0.25;
/// Fewer halves of a voxel across a pixel, where voxels may look well, too.
const LESS_ACROSS: [u16; 2] = [2, 3];
/// Bytes of a file that count as nothing, in equal parts for all nodes: a small mesh needs no coarse nodes.
const FREE_BYTES: f64 = (1 << 19) as f64;
/// Larger nodes have voxels alone: decimating takes memory.
pub(super) const MOST_TRIANGLES: usize = 1 << 21;

/// Of a triangle.
struct Kind {
    is_thin: bool,
    /// It has a texture or an opacity.
    is_painted: bool,
    /// Something may show through it.
    is_clear: bool,
}

impl Kind {
    fn counts_as_thin(&self) -> bool {
        self.is_thin || self.is_painted
    }
}

pub(super) struct Surfaces<'s> {
    triangles: &'s Ordered<'s>,
    options: &'s BuildOptions,
    parts: Parts,
    /// Bytes of a node that cost nothing.
    free: f64,
    textures: &'s Textures,
}

impl<'s> Surfaces<'s> {
    pub(super) fn new(
        triangles: &'s Ordered<'s>,
        options: &'s BuildOptions,
        branches: &[Branch],
        textures: &'s Textures,
    ) -> Self {
        let Ordered {
            surface,
            order,
            centre,
            ..
        } = *triangles;
        let corners = |place: usize| {
            let corners = surface.corners(order[place] as usize);
            corners.map(|p| (p - centre).as_vec3().to_array())
        };
        let normals = |place: usize| surface.triangle(order[place] as usize).normals;
        let leaves = branches.iter().filter(|branch| branch.children.is_none());
        let leaves: Vec<usize> = leaves.map(|leaf| leaf.count).collect();
        Self {
            triangles,
            options,
            free: FREE_BYTES / branches.len() as f64,
            parts: Parts::of(&leaves, corners, normals),
            textures,
        }
    }

    pub(super) fn leaf(&self, node: &mut Node, own: Range<usize>) -> Vec<u8> {
        let bytes = surface::lay_out(node, &self.stored(&own), |p| {
            self.parts.shared(&own, p).is_some()
        });
        pack(&Default::default(), &bytes)
    }

    fn stored(&self, own: &Range<usize>) -> Vec<LeafTriangle> {
        self.triangles.stored(own.clone(), Some(self.textures))
    }

    /// An inner node, whose grid is set, and its bytes. `voxels` makes voxels of some triangles.
    pub(super) fn inner(
        &self,
        node: &Node,
        own: Range<usize>,
        voxels: impl Fn(&mut Node, &[bool]) -> Result<[Vec<u8>; 6], BuildError>,
    ) -> Result<Made, BuildError> {
        let all = self.stored(&own);
        let comparison = self.comparison(node, &all, ACROSS)?;
        let kinds: Vec<Kind> = own
            .clone()
            .zip(&all)
            .map(|(place, triangle)| {
                let width = f64::from(self.parts.sizes[place].width);
                Kind {
                    is_thin: width < THIN * f64::from(node.voxel),
                    is_painted: triangle.paint != Paint::NONE,
                    is_clear: !triangle.paint.is_opaque(&self.textures.list),
                }
            })
            .collect();
        let mut thin: Vec<bool> = kinds.iter().map(Kind::counts_as_thin).collect();
        let decimated = self.decimations(node, &own, &all, &kinds);
        let is_undecimated = decimated.is_err();
        let (surfaces, mut wide) = decimated.unwrap_or_else(|_| {
            thin.fill(true);
            (Vec::new(), Some(Vec::new()))
        });
        let judged = surfaces.into_iter().map(|one| comparison.judge(one));
        let mut judged = judged.collect::<Result<Vec<Judged>, BuildError>>()?;
        let mut most_error = f64::INFINITY;
        let chosen = loop {
            if let Some(triangles) = wide.take() {
                let mut node = *node;
                let lists = voxels(&mut node, &thin)?;
                let one = comparison.judge(Candidate {
                    node,
                    lists,
                    triangles,
                })?;
                most_error = most_error.min(one.error * WORSE);
                judged.push(one);
            }
            let able = judged.iter().filter(|one| one.error <= most_error);
            let least_lost = able.map(|one| one.lost).fold(f64::INFINITY, f64::min);
            let is_able =
                |one: &Judged| one.error <= most_error && one.lost <= least_lost.max(BLANK);
            let able = (0..judged.len()).filter(|&n| is_able(&judged[n]));
            let best = able.min_by(|&a, &b| judged[a].cost.total_cmp(&judged[b].cost));
            let best = best.unwrap_or(0);
            // Voxels of all may be better than thin parts as they are.
            let is_whole = judged[best].candidate.triangles.len() == all.len();
            let is_thin_whole = is_whole && thin.contains(&true);
            if judged[best].lost <= MOST_LOST && !is_thin_whole || !thin.contains(&false) {
                break judged.swap_remove(best).candidate;
            }
            // A lattice is one wide part of thin bars.
            thin.fill(true);
            wide = Some(Vec::new());
        };
        let across = match chosen.node.voxels() {
            0 => node.across,
            _ => self.across(node, &all, &chosen)?,
        };
        let mut node = Node {
            across,
            ..chosen.node
        };
        let is_shared = |p| self.parts.shared(&own, p).is_some();
        let bytes = surface::lay_out(&mut node, &chosen.triangles, is_shared);
        Ok(Made {
            node,
            data: pack(&chosen.lists, &bytes),
            is_undecimated,
        })
    }

    fn comparison(
        &self,
        node: &Node,
        all: &[LeafTriangle],
        across: u16,
    ) -> Result<Comparison<'s>, BuildError> {
        let (options, textures) = (self.options, &self.textures.list);
        Comparison::of(node, all, options, textures, self.free, across)
    }

    /// Halves of voxels across a pixel from which on a candidate does not look worse than all triangles.
    fn across(
        &self,
        node: &Node,
        all: &[LeafTriangle],
        chosen: &Candidate,
    ) -> Result<u16, BuildError> {
        let whole = Candidate {
            node: *node,
            lists: Default::default(),
            triangles: all.to_vec(),
        };
        for across in LESS_ACROSS {
            let comparison = self.comparison(node, all, across)?;
            if comparison.error(chosen)? <= WORSE * comparison.error(&whole)? {
                return Ok(across);
            }
        }
        Ok(ACROSS)
    }

    /// Candidates without voxels; and, where some part is thin or painted, the wide ones. Decimated surfaces have
    /// neither textures nor holes: clear triangles stay as they are, others with textures in one candidate, and all in
    /// one.
    fn decimations(
        &self,
        node: &Node,
        own: &Range<usize>,
        all: &[LeafTriangle],
        kinds: &[Kind],
    ) -> Result<(Vec<Candidate>, Option<Vec<LeafTriangle>>), DecimateError> {
        let voxel = f64::from(node.voxel);
        let kept = |is_kept: fn(&Kind) -> bool| {
            let both = all.iter().zip(kinds);
            let kept = both.filter(|(_, kind)| is_kept(kind));
            kept.map(|(triangle, _)| *triangle).collect::<Vec<_>>()
        };
        // Small parts are left out whole.
        let is_seen =
            |place: usize, error: f64| f64::from(self.parts.sizes[place].radius) >= error * voxel;
        let candidate = |parts: &[&[LeafTriangle]]| Candidate {
            node: *node,
            lists: Default::default(),
            triangles: parts.concat(),
        };
        let decimated = |error: f64, is_taken: &dyn Fn(&Kind, usize) -> bool| {
            let taken = own.clone().zip(kinds);
            let taken = taken.filter(|&(place, kind)| is_taken(kind, place));
            let taken: Vec<usize> = taken.map(|(place, _)| place).collect();
            self.decimated(own, &taken, error * voxel)
        };
        let clear = kept(|kind| kind.is_clear);
        let mut candidates = Vec::new();
        for error in [ERROR, ERROR * FINER, ERROR * FINEST] {
            let solid = |kind: &Kind, place| !kind.is_clear && is_seen(place, error);
            candidates.push(candidate(&[&decimated(error, &solid)?, &clear]));
            if clear.len() == all.len() {
                break;
            }
        }
        candidates.push(candidate(&[all]));
        if !kinds.iter().any(Kind::counts_as_thin) {
            return Ok((candidates, None));
        }
        let is_wide = |kind: &Kind, place| !kind.counts_as_thin() && is_seen(place, ERROR);
        let wide = decimated(ERROR, &is_wide)?;
        let finest = ERROR * FINEST;
        let lines = decimated(finest, &|kind, _| kind.counts_as_thin() && !kind.is_clear)?;
        candidates.push(candidate(&[&wide, &lines, &clear]));
        let painted = kept(|kind| kind.is_painted);
        if painted.len() > clear.len() {
            let lines = decimated(finest, &|kind, _| kind.is_thin && !kind.is_painted)?;
            candidates.push(candidate(&[&wide, &lines, &painted]));
        }
        Ok((candidates, Some(wide)))
    }

    fn decimated(
        &self,
        own: &Range<usize>,
        taken: &[usize],
        error: f64,
    ) -> Result<Vec<LeafTriangle>, DecimateError> {
        if taken.is_empty() {
            return Ok(Vec::new());
        }
        let Ordered { surface, order, .. } = *self.triangles;
        let tinted = taken
            .iter()
            .map(|&place| surface.tinted_material(order[place] as usize));
        let tinted: Option<Vec<u32>> = tinted.collect();
        let stored = self.triangles.stored(taken.iter().copied(), None);
        let mesh = mesh_of(&stored, tinted);
        let shared = |p: [f64; 3]| self.parts.shared(own, p.map(|c| c as f32));
        let few = decimate_between(&mesh, Decimation::Error(error), shared)?;
        Ok(few.map_or(Vec::new(), |mesh| triangles_of(&mesh)))
    }
}

/// Triangles with colours at their corners; or, of textures, with one colour each, blended within a material.
fn mesh_of(triangles: &[LeafTriangle], tinted: Option<Vec<u32>>) -> Mesh {
    let is_tinted = tinted.is_some();
    let mut mesh = Mesh {
        material_of: tinted.unwrap_or_else(|| vec![0; triangles.len()]).into(),
        ..Mesh::default()
    };
    for (number, triangle) in (0u32..).zip(triangles) {
        mesh.triangles.push([0, 1, 2].map(|k| 3 * number + k));
        for k in 0..3 {
            let position = triangle.corners[k].map(f64::from);
            mesh.positions.push(position);
            if !is_tinted {
                mesh.vertex_colors.push(triangle.colors[k]);
            }
        }
        if is_tinted {
            let light = triangle.colors.map(to_light).into_iter().sum::<DVec3>() / 3.0;
            mesh.tints.push(light.as_vec3().to_array());
        }
        mesh.corner_normals.push(triangle.normals.map(|normal| {
            let normal = PackedNormal(normal).decode().unwrap_or(DVec3::Z);
            normal.as_vec3().to_array()
        }));
    }
    mesh.find_bounds();
    mesh
}

fn triangles_of(mesh: &Mesh) -> Vec<LeafTriangle> {
    let triangle = |number: usize| {
        let corners = mesh.triangles()[number].map(|vertex| vertex as usize);
        LeafTriangle {
            corners: corners.map(|vertex| mesh.positions()[vertex].map(|c| c as f32)),
            normals: mesh.corner_normals()[number].map(|n| PackedNormal::encode(point(n)).0),
            colors: corners.map(|vertex| mesh.vertex_colors()[vertex]),
            paint: Paint::NONE,
        }
    };
    (0..mesh.triangles().len()).map(triangle).collect()
}
