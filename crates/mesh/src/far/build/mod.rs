//! Triangles into far voxels: hierarchy, rays, fitting.
//!
//! A node's rays depend on its number alone, so any number of threads gives the same bytes.

mod bvh;
mod clusters;
mod compare;
mod count;
mod grid;
mod levels;
mod node;
mod ordered;
mod parts;
mod rays;
mod room;
mod sample;
mod shader_fit;
mod shot;
mod split;
mod spool;
mod surface;
mod touch;

use std::collections::HashMap;
use std::fs::{File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;
use xxhash_rust::xxh3::Xxh3;

use super::record::{Node, Opacity};
use super::store::{VERSION, write_parts};
use super::{FarData, FarSettings};
use crate::list::lock;
use crate::texture::paint::Textures;
use crate::{Sampler, Surface, mesh_box};
use clusters::{CLUSTER, Occluders, Part, Stops};
use node::Maker;
use ordered::Ordered;
use rays::Around;
use room::{Room, shares};
use shiftvox::graph::{Progress, place};
use split::{Branch, split};
use spool::{Head, Spool};
use surface::Surfaces;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BuildOptions {
    /// Rays of all nodes together. `None`: as many as needed.
    pub rays: Option<u64>,
    /// Nodes with fewer triangles are leaves; 2 or more.
    pub leaf_triangles: u32,
    /// Voxels along the longest side of a node, 2 to 255.
    pub grid: u32,
    /// Least distance from which a node is used, in its voxels.
    pub distance_voxels: f64,
    pub opacity: Opacity,
    /// Whether what is wider than a voxel stays a decimated surface.
    pub hybrid: bool,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            rays: None,
            leaf_triangles: 1000,
            grid: 64,
            distance_voxels: 256.0,
            opacity: Opacity::Six,
            hybrid: false,
        }
    }
}

impl BuildOptions {
    pub(super) fn settings(&self, centre: DVec3) -> FarSettings {
        FarSettings {
            centre,
            distance_voxels: self.distance_voxels,
            leaf_triangles: self.leaf_triangles,
            grid: self.grid,
            y_up: true,
            bevels: [0; 8],
        }
    }
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    #[error("there are no triangles to build far voxels of")]
    Empty,
    #[error("{0} are more than 32 bits can number")]
    TooMany(String),
    #[error("{0}")]
    Option(&'static str),
    #[error("the surface of a node could not be made: {0}")]
    Surface(String),
    #[error("the mesh is too large or too small for numbers of single precision")]
    Range,
    #[error(
        "the mesh spans {extent} units {distance} units from the origin: too little for its coordinates; \
         move it to the origin"
    )]
    FarAway { extent: f64, distance: f64 },
    #[error(
        "the build takes {}M at the least beside what is loaded, and {}M are left",
        needed.div_ceil(1 << 20),
        given >> 20
    )]
    Memory { needed: u64, given: u64 },
    /// A temporary or unfinished file, or its folder.
    #[error("{}: {problem}", file.display())]
    File { file: PathBuf, problem: String },
}

/// Where a build keeps what is not in memory.
#[derive(Debug, Clone, Copy)]
pub struct Outside<'o> {
    /// Memory budget, bytes, beside the surface.
    pub memory: Option<u64>,
    /// Folder of temporary files.
    pub folder: &'o Path,
    /// File that keeps finished nodes, also of a build that is stopped; or none.
    pub unfinished: Option<&'o Path>,
}

/// Far voxels whose data is in a file.
#[derive(Debug)]
pub struct Spooled {
    /// All but the data: `packed` is empty.
    pub data: FarData,
    spool: Spool,
}

impl Spooled {
    /// Nodes of an earlier build that was stopped.
    pub fn taken(&self) -> usize {
        self.spool.taken()
    }

    /// Writes a `.far` file.
    pub fn write_to(&mut self, out: &mut dyn Write) -> io::Result<()> {
        let bytes = self.spool.bytes();
        write_parts(&self.data, bytes, out, |out| self.spool.copy_to(out))
    }
}

/// Far voxels in memory. Finished nodes are in the system's folder of temporary files until the last one is.
pub fn build(
    surface: &dyn Surface,
    options: &BuildOptions,
    progress: &dyn Progress,
) -> Result<FarData, BuildError> {
    let folder = std::env::temp_dir();
    let outside = Outside {
        memory: None,
        folder: &folder,
        unfinished: None,
    };
    let Spooled {
        mut data,
        mut spool,
    } = build_outside(surface, options, &outside, progress)?;
    data.packed.reserve_exact(spool.bytes() as usize);
    let copied = spool.copy_to(&mut data.packed);
    copied.map_err(|e| failed(&folder, &e))?;
    Ok(data)
}

/// The same as [`build()`], outside of memory.
pub fn build_outside(
    surface: &dyn Surface,
    options: &BuildOptions,
    outside: &Outside<'_>,
    progress: &dyn Progress,
) -> Result<Spooled, BuildError> {
    check(surface, options)?;
    let (centre, scale) = centre(surface)?;
    let Outside {
        memory,
        folder,
        unfinished,
    } = *outside;
    let shares = shares(surface.len(), options.hybrid, memory)?;
    progress.begin("split triangles", 0);
    let corners = |number: usize| surface.corners(number);
    let fewest = options.leaf_triangles as usize;
    let (mut branches, order) = split(surface.len(), corners, fewest);
    let coarser = levels::put_above(&mut branches, options.grid);
    progress.end();
    if u32::try_from(branches.len()).is_err() {
        return Err(BuildError::TooMany(format!("{} nodes", branches.len())));
    }
    let triangles = Ordered {
        surface,
        order: &order,
        centre,
        scale,
    };
    progress.begin("prepare rays", 0);
    let within = shares
        .clusters
        .map(|most| Ok((temporary_file(folder)?, most)));
    let within = within.transpose()?;
    let corners = |number: usize| triangles.corners(number);
    let parts = parts(&branches, |point| triangles.place(point));
    let stops = |number: usize, point: DVec3| triangles.stops(number, point);
    let is_clear = (0..surface.len()).any(|number| !surface.is_opaque(number));
    let stops = is_clear.then_some(&stops as &Stops<'_>);
    let occluders = Occluders::new(parts, corners, stops, within);
    let occluders = occluders.map_err(|e| failed(folder, &e))?;
    progress.end();
    let textures = Textures::new(surface.textures());
    let surfaces = || Surfaces::new(&triangles, options, &branches, &textures);
    let maker = Maker {
        options,
        triangles: &triangles,
        textures: &textures,
        surfaces: options.hybrid.then(surfaces),
        occluders: &occluders,
        room: Room::new(shares.nodes),
        folder,
        coarser,
    };
    let rays = levels::rays(&maker, &branches, progress);
    let key = unfinished.map_or(0, |_| key_of(surface, options));
    let kept_in = unfinished.unwrap_or(folder);
    let file = match unfinished {
        Some(unfinished) => unfinished_file(unfinished)?,
        None => temporary_file(folder)?,
    };
    let spool = Spool::open(file, key, branches.len()).map_err(|e| failed(kept_in, &e))?;
    let spool = spool.ok_or_else(|| BuildError::File {
        file: kept_in.to_owned(),
        problem: "it was begun of another mesh, or with other options: remove it".to_owned(),
    })?;
    progress.begin("shoot rays", order.len() as u64);
    let is_done: Vec<bool> = (0..branches.len()).map(|n| spool.is_done(n)).collect();
    let spool = Mutex::new(spool);
    branches
        .par_iter()
        .enumerate()
        .try_for_each(|(number, branch)| {
            if !is_done[number] {
                let made = maker.node(number, branch, rays[number])?;
                let mut spool = lock(&spool);
                let added = spool.add(number, &made);
                added.map_err(|e| failed(kept_in, &e))?;
            }
            if branch.children.is_none() {
                progress.advance(branch.count as u64);
            }
            Ok(())
        })?;
    progress.end();
    let spool = spool.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut data = assemble(&spool, centre, options)?;
    data.undecimated = spool.nodes().map(|done| done.is_undecimated).sum();
    data.settings.bevels = mesh_box(surface, data.settings.y_up).bevels;
    drop(maker);
    data.textures = textures.list;
    Ok(Spooled { data, spool })
}

fn temporary_file(folder: &Path) -> Result<File, BuildError> {
    tempfile::tempfile_in(folder).map_err(|e| failed(folder, &e))
}

fn unfinished_file(path: &Path) -> Result<File, BuildError> {
    let mut open = File::options();
    let open = open.read(true).write(true).create(true).truncate(false);
    let file = open.open(path).map_err(|e| failed(path, &e))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(BuildError::File {
            file: path.to_owned(),
            problem: "another build is using it".to_owned(),
        }),
        Err(TryLockError::Error(e)) => Err(failed(path, &e)),
    }
}

/// A hash of triangles, textures, options and version, from which all nodes follow.
fn key_of(surface: &dyn Surface, options: &BuildOptions) -> u64 {
    let mut hash = Xxh3::new();
    let program = env!("CARGO_PKG_VERSION");
    hash.update(format!("{program} {VERSION} {options:?}").as_bytes());
    let mut textures = HashMap::new();
    for number in 0..surface.len() {
        let triangle = surface.triangle(number);
        let corners = [triangle.corners, triangle.normals, triangle.colors];
        for point in corners.as_flattened() {
            hash.update(bytemuck::bytes_of(&point.to_array()));
        }
        hash.update(&triangle.alpha.to_le_bytes());
        if let Some(Sampler { texture, places }) = triangle.sampler {
            let of = textures.entry(std::ptr::from_ref(texture));
            hash.update(&of.or_insert_with(|| texture.hash()).to_le_bytes());
            hash.update(bytemuck::cast_slice(places.as_flattened()));
        }
    }
    hash.digest()
}

fn failed(file: &Path, problem: &io::Error) -> BuildError {
    BuildError::File {
        file: file.to_owned(),
        problem: problem.to_string(),
    }
}

fn parts(branches: &[Branch], place: impl Fn(DVec3) -> DVec3) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut waiting = vec![0];
    while let Some(number) = waiting.pop() {
        let branch: &Branch = &branches[number];
        match branch.children {
            Some([near, far]) if branch.count > CLUSTER => {
                waiting.extend([far, near].into_iter().filter(|&child| child != 0));
            }
            _ => parts.push(Part {
                triangles: branch.triangles(),
                around: Around::of(place(branch.low), place(branch.high)),
            }),
        }
    }
    parts
}

fn check(surface: &dyn Surface, options: &BuildOptions) -> Result<(), BuildError> {
    if surface.is_empty() {
        return Err(BuildError::Empty);
    }
    if u32::try_from(surface.len()).is_err() {
        return Err(BuildError::TooMany(format!("{} triangles", surface.len())));
    }
    for (holds, expected) in [
        (
            (2..=255).contains(&options.grid),
            "a grid has 2 to 255 voxels a side",
        ),
        (
            options.leaf_triangles >= 2,
            "leaves have fewer than 2 triangles or more",
        ),
        (
            (1.0..=1e6).contains(&options.distance_voxels),
            "the least distance is 1 to 1,000,000 voxels",
        ),
    ] {
        if !holds {
            return Err(BuildError::Option(expected));
        }
    }
    Ok(())
}

fn centre(surface: &dyn Surface) -> Result<(DVec3, f64), BuildError> {
    let (low, high) = surface.bounds();
    let extent = (high - low).max_element();
    let farthest = low.abs().max(high.abs()).max_element();
    if !(farthest < 1e30 && extent > 1e-30) {
        return Err(BuildError::Range);
    }
    let finest = 0.99 * extent / place::MOST_PARTS;
    if !place::can_be_seen(low.to_array(), high.to_array(), finest) {
        return Err(BuildError::FarAway {
            extent,
            distance: farthest,
        });
    }
    let centre = place::centre(low.to_array(), high.to_array()).into();
    let (_, power) = libm::frexp(extent);
    Ok((centre, libm::ldexp(1.0, -power)))
}

fn assemble(spool: &Spool, centre: DVec3, options: &BuildOptions) -> Result<FarData, BuildError> {
    let items = |done: &Head| done.node.voxels() + u64::from(done.node.surface);
    let numbered: u64 = spool.nodes().map(items).sum();
    if numbered >= u64::from(u32::MAX) {
        let what = format!("{numbered} voxels and triangles");
        return Err(BuildError::TooMany(what));
    }
    let mut data = FarData {
        settings: options.settings(centre),
        nodes: Vec::new(),
        textures: Vec::new(),
        packed: Vec::new(),
        undecimated: 0,
    };
    let mut data_at = 0;
    for Head { node, bytes, .. } in spool.nodes() {
        data.nodes.push(Node { data_at, ..*node });
        data_at += bytes;
    }
    Ok(data)
}
