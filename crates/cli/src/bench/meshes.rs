//! The methods of meshes in `bench error` and `bench flicker`: triangles, whole and decimated, and
//! far voxels; and how these are made for an experiment.

use std::time::Instant;

use clap::{Args, ValueEnum};

use crate::args::SceneArgs;
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::experiment::subjects::BUNDLED;
use crate::scenes;
use shiftvox::drawing::milliseconds_since;
use shiftvox_lab::error::{Method, PixelStyle};
use shiftvox_lab::methods;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::decimate::{Decimation, compact, decimate};
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::far::{BuildOptions, FarFile, build};

/// Samples a pixel that triangles are drawn with.
pub(super) const TRIANGLE_SAMPLES: [u32; 3] = [1, 4, 16];

/// A family of methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FamilyName {
    /// The image-order engine, on voxels; a mesh is voxelised at --depth.
    Voxels,
    /// The triangle rasteriser at 1, 4 and 16 samples a pixel.
    Triangles,
    /// Decimated triangles at as many samples.
    Decimated,
    /// Far voxels, built of the mesh.
    Far,
}

/// Which methods of meshes take part.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Meshes")]
pub(super) struct MeshMethodArgs {
    /// Which families draw a scene that is a mesh [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    families: Vec<FamilyName>,
    /// Rays of far voxels [default: as of convert]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    far_rays: Option<u64>,
    /// Largest voxels of far voxels, pixels
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "PX,...",
        default_value = "1,2"
    )]
    far_lods: Vec<f64>,
}

impl MeshMethodArgs {
    fn has(&self, family: FamilyName) -> bool {
        self.families.is_empty() || self.families.contains(&family)
    }

    /// Whether the image-order engine draws a scene.
    pub(super) fn has_voxels(&self, is_mesh: bool) -> bool {
        !is_mesh || self.has(FamilyName::Voxels)
    }

    /// Reads a scene that is a mesh and builds its far voxels; `None` of another scene.
    pub(super) fn open(
        &self,
        name: &str,
        args: &SceneArgs,
        console: &Console,
    ) -> Result<Option<MeshScene>, CliError> {
        if name == BUNDLED || !scenes::is_mesh(name)? {
            return Ok(None);
        }
        let (mesh, _) = scenes::read_mesh(name, args, console.progress())?;
        let mut decimated = Vec::new();
        if self.has(FamilyName::Decimated) {
            decimated = decimated_of(&mesh, &BUDGETS)?;
        }
        let mut far = None;
        if self.has(FamilyName::Far) {
            let options = BuildOptions {
                rays: self.far_rays,
                ..BuildOptions::default()
            };
            far = Some(far_of(&mesh, &options, console)?.0);
        }
        Ok(Some(MeshScene {
            mesh,
            decimated,
            far,
        }))
    }

    /// The methods of a mesh but for the image-order engine's.
    ///
    /// # Errors
    /// None: triangles can be drawn with these samples.
    pub(super) fn methods<'m>(
        &self,
        scene: &'m MeshScene,
        style: PixelStyle,
    ) -> Result<Vec<Method<'m>>, CliError> {
        let mut all: Vec<Method<'m>> = Vec::new();
        if self.has(FamilyName::Triangles) {
            for samples in TRIANGLE_SAMPLES {
                let method = methods::triangles(&scene.mesh, samples, style);
                all.push(method.map_err(|e| CliError::new(Kind::Run, e))?);
            }
        }
        for decimated in &scene.decimated {
            for samples in TRIANGLE_SAMPLES {
                let method = methods::decimated(&decimated.mesh, decimated.one_of, samples, style);
                all.push(method.map_err(|e| CliError::new(Kind::Run, e))?);
            }
        }
        if let Some(file) = &scene.far {
            for &voxel_px in &self.far_lods {
                let opacities = [Opacity::None, Opacity::Scalar, Opacity::Six].into_iter();
                all.extend(
                    opacities.map(|opacity| methods::far(file, opacity, voxel_px, 0, style)),
                );
            }
        }
        Ok(all)
    }
}

/// Far voxels of a mesh, as a file in memory, and how many milliseconds building them took.
pub(super) fn far_of(
    mesh: &Mesh,
    options: &BuildOptions,
    console: &Console,
) -> Result<(FarFile, f64), CliError> {
    let started = Instant::now();
    let data = build(mesh, options, console.progress())?;
    let ms = milliseconds_since(started);
    let bytes = encode(&data).map_err(|e| CliError::new(Kind::Run, e))?;
    Ok((FarFile::from_bytes(&bytes)?, ms))
}

/// Of how many triangles a decimated mesh keeps one.
pub(super) const BUDGETS: [u32; 4] = [4, 16, 64, 256];

/// A decimated mesh.
pub(super) struct Decimated {
    pub(super) mesh: Mesh,
    pub(super) one_of: u32,
    /// As a compact mesh.
    pub(super) bytes: u64,
    /// What making it took, milliseconds.
    pub(super) ms: f64,
}

/// Meshes of ever fewer triangles, as far as any are left.
pub(super) fn decimated_of(mesh: &Mesh, budgets: &[u32]) -> Result<Vec<Decimated>, CliError> {
    let mut all = Vec::new();
    for &one_of in budgets {
        let started = Instant::now();
        let how = Decimation {
            triangles: mesh.triangles().len() / one_of as usize,
            error: None,
            prunes: true,
        };
        let left = decimate(mesh, &how).map_err(|e| CliError::new(Kind::Limit, e))?;
        let ms = milliseconds_since(started);
        if let Some(left) = left {
            let (mesh, bytes) = compact(&left);
            all.push(Decimated {
                mesh,
                one_of,
                bytes,
                ms,
            });
        }
    }
    Ok(all)
}

/// A scene that is a mesh, and what was made of it.
pub(super) struct MeshScene {
    pub(super) mesh: Mesh,
    decimated: Vec<Decimated>,
    far: Option<FarFile>,
}
