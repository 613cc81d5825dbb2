//! Data that methods draw: graphs, decimated meshes, far and textured voxels.

use std::time::Instant;

use super::methods::Choice;
use crate::args::SceneArgs;
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::{engines, scenes};
use shiftvox::drawing::milliseconds_since;
use shiftvox::graph::Graph;
use shiftvox_lab::quality::{Method, Triangles, far, hybrid, textured, triangles, voxel_method};
use shiftvox_mesh::Mesh;
use shiftvox_mesh::decimate::{Decimation, compact, decimate};
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::{self, FarFile};
use shiftvox_mesh::textured::view::Erosion;
use shiftvox_mesh::textured::{self, TexturedFile};

/// Grids and texels along a face of automatic erosion. Faces with few texels are off by about a cell.
const GRIDS: [u32; 6] = [4, 8, 16, 32, 64, 128];
const TEXELS: u32 = 4;

type Timed<T> = (T, f64);

pub(super) struct Made {
    pub(super) mesh: Option<Mesh>,
    /// Bytes of the mesh in compact form.
    mesh_bytes: u64,
    /// Voxels without opacities, and with.
    pub(super) graphs: [Option<Timed<Graph>>; 2],
    /// One of so many triangles, the mesh and its bytes.
    decimated: Vec<Timed<(u32, Mesh, u64)>>,
    /// Far voxels, and the hybrid.
    far: [Option<Timed<FarFile>>; 2],
    /// Textured voxels of the paper's grid, and of automatic erosion.
    textured: [Option<Timed<TexturedFile>>; 2],
}

fn timed<T, E>(make: impl FnOnce() -> Result<T, E>) -> Result<Timed<T>, E> {
    let started = Instant::now();
    make().map(|made| (made, milliseconds_since(started)))
}

impl Made {
    pub(super) fn of_mesh(
        name: &str,
        mesh: Mesh,
        choices: &[Choice],
        args: &SceneArgs,
        far_rays: Option<u64>,
        console: &Console,
    ) -> Result<Self, CliError> {
        let mut made = Self::of_graph(None);
        let run = |e: &dyn std::fmt::Display| CliError::new(Kind::Run, e);
        let mut add = |choice: &Choice| {
            match *choice {
                Choice::Voxels(options, _) => {
                    let opacities = args.opacities || options.coverage.blends();
                    let slot = &mut made.graphs[usize::from(opacities)];
                    if slot.is_none() {
                        let args = SceneArgs {
                            opacities,
                            ..args.clone()
                        };
                        let scene = scenes::open(name, &args, console)?;
                        let read_ms = scene.mesh.as_ref().map_or(0.0, |mesh| mesh.load_ms);
                        *slot = Some((scene.graph, scene.load_ms - read_ms));
                    }
                }
                Choice::Triangles { one_of: 1, .. } => made.mesh_bytes = compact(&mesh).1,
                Choice::Triangles { one_of, .. } => {
                    if made.decimated.iter().any(|((of, ..), _)| *of == one_of) {
                        return Ok(());
                    }
                    let how = Decimation::Count(mesh.triangles().len() / one_of as usize);
                    let left = timed(|| decimate(&mesh, how));
                    let (left, ms) = left.map_err(|e| CliError::new(Kind::Limit, e))?;
                    if let Some(left) = left {
                        let (mesh, bytes) = compact(&left);
                        made.decimated.push(((one_of, mesh, bytes), ms));
                    }
                }
                Choice::Far { is_hybrid, .. } => {
                    let slot = &mut made.far[usize::from(is_hybrid)];
                    if slot.is_none() {
                        let options = far::BuildOptions {
                            rays: far_rays.filter(|_| !is_hybrid),
                            hybrid: is_hybrid,
                            ..far::BuildOptions::default()
                        };
                        let built = timed(|| far::build(&mesh, &options, console.progress()));
                        let (data, ms) = built?;
                        let bytes = encode(&data).map_err(|e| run(&e))?;
                        *slot = Some((FarFile::from_bytes(&bytes)?, ms));
                    }
                }
                Choice::Textured { level, .. } => {
                    let slot = &mut made.textured[usize::from(level.is_none())];
                    if slot.is_none() {
                        let mut options = textured::BuildOptions::default();
                        if level.is_none() {
                            (options.grids, options.texels) = (GRIDS.to_vec(), TEXELS);
                        }
                        let built = timed(|| textured::build(&mesh, &options, console.progress()));
                        let (data, ms) = built?;
                        let bytes = textured::store::encode(&data).map_err(|e| run(&e))?;
                        *slot = Some((TexturedFile::from_bytes(&bytes)?, ms));
                    }
                }
            }
            Ok(())
        };
        let mut refused = Vec::new();
        for choice in choices {
            match add(choice).map_err(|error: CliError| error.at(name)) {
                Err(error) if error.kind == Kind::Input => refused.push(error),
                added => added?,
            }
        }
        if refused.len() == choices.len() {
            return Err(refused.remove(0));
        }
        for error in refused {
            console.note(format!("{error}; a method is left out"));
        }
        made.mesh = Some(mesh);
        Ok(made)
    }

    pub(super) fn of_graph(graph: Option<Graph>) -> Self {
        let graph = graph.map(|graph| (graph, 0.0));
        Self {
            mesh: None,
            mesh_bytes: 0,
            graphs: [graph, None],
            decimated: Vec::new(),
            far: [None, None],
            textured: [None, None],
        }
    }

    /// The methods, except those of empty decimated meshes.
    pub(super) fn methods<'m>(&'m self, choices: &[Choice]) -> Vec<Method<'m>> {
        choices.iter().filter_map(|of| self.method(of)).collect()
    }

    fn method<'m>(&'m self, choice: &Choice) -> Option<Method<'m>> {
        fn file<T>(slot: &Option<Timed<T>>) -> Option<(&T, f64)> {
            slot.as_ref().map(|(file, ms)| (file, *ms))
        }
        match *choice {
            Choice::Voxels(options, engine) => {
                let wanted = usize::from(options.coverage.blends());
                let graph = file(&self.graphs[wanted]);
                let graph = graph.or_else(|| self.graphs.iter().find_map(file));
                let make = match engine == engines::MACHINE.name {
                    true => engines::MACHINE.make,
                    false => engines::FAST.make,
                };
                graph.map(|(graph, ms)| {
                    let mut method = voxel_method(graph, (engine, make), options);
                    method.build_ms = self.mesh.is_some().then_some(ms);
                    method
                })
            }
            Choice::Triangles { one_of, aa_log2 } => {
                let whole = self.mesh.iter().filter(|_| one_of == 1);
                let whole = whole.map(|mesh| (mesh, self.mesh_bytes, 0.0));
                let decimated = self.decimated.iter().filter(|((of, ..), _)| *of == one_of);
                let decimated = decimated.map(|((_, mesh, bytes), ms)| (mesh, *bytes, *ms));
                let found = whole.chain(decimated).next();
                let of = found.map(|(mesh, bytes, build_ms)| Triangles {
                    mesh,
                    one_of,
                    bytes,
                    build_ms,
                });
                of.map(|of| triangles(of, aa_log2))
            }
            Choice::Far {
                is_hybrid,
                opacity,
                voxel_px,
                aa_log2,
            } => file(&self.far[usize::from(is_hybrid)]).map(|of| match is_hybrid {
                true => hybrid(of, voxel_px, aa_log2),
                false => far(of, opacity, voxel_px, aa_log2),
            }),
            Choice::Textured { level, aa_log2 } => {
                file(&self.textured[usize::from(level.is_none())]).map(|of| {
                    let erosion = match level {
                        None => Erosion::Auto { texel_px: 1.0 },
                        Some(level) => Erosion::Level {
                            level,
                            cells: Some(of.0.grid(0).cell_grid().cells),
                        },
                    };
                    textured(of, erosion, aa_log2)
                })
            }
        }
    }
}
