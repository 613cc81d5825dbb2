//! `.far` files on the command line: `convert` and `info`.

use std::fs;
use std::path::Path;
use std::time::Instant;

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

use super::console::Console;
use super::error::{CliError, Kind};
use super::names;
use super::report::{self, grouped};
use super::scene_files::Conversion;
use super::scenes;
use shiftvox::budget;
use shiftvox::drawing::milliseconds_since;
use shiftvox::project::Up;
use shiftvox::whole;
use shiftvox_mesh::Instances;
use shiftvox_mesh::far::build::{Outside, part_of};
use shiftvox_mesh::far::record::{LISTS, OPACITY_BYTES, OpacityKind, ShaderKind};
use shiftvox_mesh::far::{BuildError, BuildOptions, FarFile, build_outside};

/// Limits of a build, and the places of its temporary files.
pub(super) struct Resources<'r> {
    /// Bytes of memory, of which the mesh is a part.
    pub(super) memory: Option<u64>,
    /// Folder of temporary files, or `None` for the output's folder.
    pub(super) temporary: Option<&'r Path>,
    /// Whether an unfinished file is kept, and used.
    pub(super) resume: bool,
}

/// Builds far voxels of a mesh and writes them.
pub(super) fn convert(
    of: &Conversion<'_>,
    options: &BuildOptions,
    instances: Option<u32>,
    resources: &Resources<'_>,
    console: &Console,
) -> Result<(), CliError> {
    let (mesh, up) = scenes::open_mesh(of.input, of.scene, console)?;
    let started = Instant::now();
    let triangles = mesh.triangles().len() as u64 * u64::from(instances.unwrap_or(1));
    check_room(triangles, resources.memory).map_err(|e| e.at(of.input))?;
    let beside = whole::folder_of(of.output);
    whole::make_folder(beside)?;
    let part = resources.resume.then(|| part_of(of.output));
    let outside = Outside {
        // The mesh and the program itself are resident.
        memory: resources.memory.map(|memory| {
            let loaded = budget::resident().unwrap_or_else(|| mesh.bytes());
            (memory - memory / ALLOCATORS_SHARE).saturating_sub(loaded)
        }),
        folder: resources.temporary.unwrap_or(beside),
        part: part.as_deref(),
    };
    let built = match instances {
        None => build_outside(&mesh, options, &outside, console.progress()),
        Some(count) => {
            let places = in_rows(mesh.bounds(), up, count);
            let fleet = Instances::new(mesh, places);
            build_outside(&fleet, options, &outside, console.progress())
        }
    };
    let mut built = built.map_err(|error| {
        let short = match error {
            BuildError::Memory { needed, given } => Some(needed.saturating_sub(given)),
            _ => None,
        };
        let is_of_mesh = !matches!(error, BuildError::File { .. });
        let error = CliError::from(error);
        let error = if is_of_mesh {
            error.at(of.input)
        } else {
            error
        };
        match resources.memory.zip(short) {
            Some((memory, short)) => {
                let enough = memory + short + short / (ALLOCATORS_SHARE - 1);
                // The resident size differs from run to run.
                let enough = enough.div_ceil(1 << 20) + 1;
                error.advise(format!("give it --memory {enough}M or more"))
            }
            None => error,
        }
    })?;
    built.data.settings.y_up = up == Up::Y;
    let build_ms = milliseconds_since(started);
    whole::write_with(of.output, of.force, |file| built.write_to(file))?;
    if let Some(part) = &part {
        // It is of no use any more; left, it would do no harm.
        let _ = fs::remove_file(part);
    }
    let file = FarFile::open(of.output)?;
    let facts = Facts::of(&file);
    console.note(format!(
        "{}: {} triangles, {} nodes, {} voxels, {} rays, {} bytes, built in {:.1} s",
        of.output.display(),
        grouped(triangles),
        grouped(file.nodes().len() as u64),
        grouped(facts.kept),
        grouped(facts.rays),
        grouped(file.len()),
        build_ms / 1e3
    ));
    if facts.kept > 0 && facts.rays_per_voxel() < LEAST_RAYS_PER_VOXEL {
        console.note(format!(
            "warning: {}: only {:.1} rays passed through a voxel that is kept, and {LEAST_RAYS_PER_VOXEL} \
             are too few for opacities; {} voxels were not tested and are kept: ask for more \
             --rays, or leave it out",
            of.output.display(),
            facts.rays_per_voxel(),
            grouped(facts.untested)
        ));
    }
    if console.json {
        let mut fields = facts.describe(&file, of.input);
        fields["input"] = json!(of.input);
        fields["output"] = json!(names::of_path(of.output));
        fields["build_ms"] = json!(build_ms);
        console.document(&report::document("convert", fields))?;
    }
    Ok(())
}

/// This share of a budget is left to the allocator's overhead and to fragmentation.
const ALLOCATORS_SHARE: u64 = 8;

/// Fewer rays through a voxel are warned of.
const LEAST_RAYS_PER_VOXEL: f64 = 8.0;

/// Bytes a triangle that a build takes in memory without a budget, or more
/// (`docs/far-voxels.md`).
const LEAST_BYTES: u64 = 64;

/// Refuses what cannot be numbered or does not fit the memory that is free, before copies are
/// placed. A budget is checked when its mesh is loaded.
fn check_room(triangles: u64, budget: Option<u64>) -> Result<(), CliError> {
    if u32::try_from(triangles).is_err() {
        return Err(BuildError::TooMany(format!("{triangles} triangles")).into());
    }
    if budget.is_some() {
        return Ok(());
    }
    // No overflow: 32 bits by 8.
    let needed = triangles * LEAST_BYTES;
    match budget::available() {
        Some(free) if needed > free => Err(CliError::new(
            Kind::Limit,
            format!(
                "{triangles} triangles take at least {needed} bytes of memory while far voxels are \
                 built of them, and {free} are free"
            ),
        )
        .advise("build within a budget with --memory, or ask for fewer --instances")),
        _ => Ok(()),
    }
}

/// Places of copies of what fills a box: in rows on the ground, a tenth of its
/// longest side apart, each a quarter turn on from the one before.
fn in_rows((low, high): (DVec3, DVec3), up: Up, count: u32) -> Vec<DAffine3> {
    let axis = match up {
        Up::Y => DVec3::Y,
        Up::Z => DVec3::Z,
    };
    // The next axes; turned about `axis`, the first becomes the second.
    let (right, ahead) = (
        DVec3::new(axis.y, axis.z, axis.x),
        DVec3::new(axis.z, axis.x, axis.y),
    );
    let step = 1.1 * (high - low).max_element();
    let middle = (low + high) / 2.0;
    let across = (f64::from(count).sqrt().ceil() as u32).max(1);
    (0..count)
        .map(|number| {
            let [column, row] = [number % across, number / across].map(f64::from);
            let quarter = [right, ahead, -right, -ahead];
            let turned = |k: u32| quarter[((k + number) % 4) as usize];
            // Whole quarter turns, without the rounding of sines.
            let columns =
                |v: DVec3| axis * v.dot(axis) + turned(0) * v.dot(right) + turned(1) * v.dot(ahead);
            let turn = DMat3::from_cols(columns(DVec3::X), columns(DVec3::Y), columns(DVec3::Z));
            let place = middle + (right * column + ahead * row) * step;
            DAffine3::from_mat3_translation(turn, place - turn * middle)
        })
        .collect()
}

/// Checks all of a file and describes it: prints that, or with `--json` returns it.
pub(super) fn info(name: &str, console: &Console) -> Result<Option<Value>, CliError> {
    let file = FarFile::open(&names::path(name))?;
    file.verify()?;
    let facts = Facts::of(&file);
    if console.json {
        return Ok(Some(facts.describe(&file, name)));
    }
    console.data(facts.description(&file, name))?;
    Ok(None)
}

/// Counts of one level of a hierarchy.
#[derive(Debug, Clone, Copy, Default)]
struct LevelFacts {
    nodes: u64,
    leaves: u64,
    voxels: u64,
    /// Triangles of inner nodes.
    surface: u64,
    greatest_voxel: f32,
    square_error: f64,
}

/// The described numbers of a file.
struct Facts {
    levels: Vec<LevelFacts>,
    lists: [u64; 6],
    touched: u64,
    kept: u64,
    untested: u64,
    rays: u64,
    hits: u64,
    crossings: u64,
    voxel_bytes: u64,
    opacity_bytes: u64,
    /// Triangles of inner nodes.
    surface: u64,
    surface_bytes: u64,
}

impl Facts {
    fn of(file: &FarFile) -> Self {
        let mut facts = Self {
            levels: Vec::new(),
            lists: [0; 6],
            touched: 0,
            kept: 0,
            untested: 0,
            rays: 0,
            hits: 0,
            crossings: 0,
            voxel_bytes: 0,
            opacity_bytes: 0,
            surface: 0,
            surface_bytes: 0,
        };
        for node in file.nodes() {
            let level = node.level as usize;
            if facts.levels.len() <= level {
                // Levels of nodes grow by one from a parent to its children.
                facts.levels.resize(level + 1, LevelFacts::default());
            }
            let at = &mut facts.levels[level];
            at.nodes += 1;
            if !node.is_leaf() {
                at.surface += u64::from(node.surface);
                facts.surface += u64::from(node.surface);
            }
            facts.surface_bytes += node.surface_bytes();
            at.leaves += u64::from(node.is_leaf());
            at.voxels += node.voxels();
            at.greatest_voxel = at.greatest_voxel.max(node.voxel);
            at.square_error += f64::from(node.error).powi(2) * node.voxels() as f64;
            for (list, &count) in node.counts.iter().enumerate() {
                facts.lists[list] += u64::from(count);
                facts.opacity_bytes += u64::from(count) * OPACITY_BYTES[list] as u64;
            }
            facts.touched += u64::from(node.touched);
            facts.kept += node.voxels();
            facts.untested += u64::from(node.untested);
            facts.rays += u64::from(node.rays);
            facts.hits += u64::from(node.hits);
            facts.crossings += u64::from(node.crossings);
            facts.voxel_bytes += node.voxel_bytes();
        }
        facts
    }

    /// Occluded voxels: rays were aimed at them, and all ended before. They are dropped.
    fn occluded(&self) -> u64 {
        // A file is opened only if it keeps no more than triangles touch.
        self.touched - self.kept
    }

    fn dropped_share(&self) -> f64 {
        self.occluded() as f64 / self.touched.max(1) as f64
    }

    fn rays_per_voxel(&self) -> f64 {
        self.crossings as f64 / self.kept.max(1) as f64
    }

    /// Share of voxels whose list has a property.
    fn share(&self, has: impl Fn(ShaderKind, OpacityKind) -> bool) -> f64 {
        let lists = LISTS.iter().zip(self.lists);
        let having = lists.filter(|((shader, opacity), _)| has(*shader, *opacity));
        having.map(|(_, count)| count).sum::<u64>() as f64 / self.kept.max(1) as f64
    }

    fn describe(&self, file: &FarFile, name: &str) -> Value {
        let levels: Vec<Value> = self
            .levels
            .iter()
            .enumerate()
            .map(|(number, level)| {
                json!({
                    "level": number,
                    "nodes": level.nodes,
                    "leaves": level.leaves,
                    "voxels": level.voxels,
                    "surface_triangles": level.surface,
                    "greatest_voxel_world": level.greatest_voxel,
                    "fit_error": libm::sqrt(level.square_error / level.voxels.max(1) as f64),
                })
            })
            .collect();
        let (low, high) = file.bounds();
        json!({
            "scene": name,
            "format": ".far",
            "low": low.to_array(),
            "high": high.to_array(),
            "triangles": file.nodes()[0].triangles,
            "nodes": file.nodes().len(),
            "levels": levels,
            "leaf_triangles": file.settings.leaf_triangles,
            "grid": file.settings.grid,
            "distance_voxels": file.settings.distance_voxels,
            "voxels_touched": self.touched,
            "voxels_seen": self.kept - self.untested,
            "voxels_untested": self.untested,
            "voxels_occluded": self.occluded(),
            "voxels_kept": self.kept,
            "voxels_dropped": self.occluded(),
            "voxels_dropped_share": self.dropped_share(),
            "rays": self.rays,
            "rays_hit": self.hits,
            "rays_per_voxel": self.rays_per_voxel(),
            "opaque_share": self.share(|_, o| o == OpacityKind::Opaque),
            "scalar_share": self.share(|_, o| o == OpacityKind::Scalar),
            "six_share": self.share(|_, o| o == OpacityKind::Six),
            "complex_share": self.share(|s, _| s == ShaderKind::Complex),
            "bytes": file.len(),
            "voxel_bytes": self.voxel_bytes,
            "opacity_bytes": self.opacity_bytes,
            "surface_triangles": self.surface,
            "surface_bytes": self.surface_bytes,
        })
    }

    fn description(&self, file: &FarFile, name: &str) -> String {
        let (low, high) = file.bounds();
        let percent = |share: f64| format!("{:.1} %", share * 100.0);
        let lines = [
            ("scene", name.to_owned()),
            ("format", "far voxels (.far)".to_owned()),
            ("box", format!("{low} to {high}")),
            ("triangles", grouped(file.nodes()[0].triangles)),
            (
                "voxels",
                format!(
                    "{} that triangles touch: {} seen, {} not tested and kept, {} occluded and \
                     dropped ({})",
                    grouped(self.touched),
                    grouped(self.kept - self.untested),
                    grouped(self.untested),
                    grouped(self.occluded()),
                    percent(self.dropped_share())
                ),
            ),
            (
                "surface",
                format!(
                    "{} decimated triangles of inner nodes",
                    grouped(self.surface)
                ),
            ),
            (
                "rays",
                format!(
                    "{}, {} of them hits; {:.1} through a kept voxel",
                    grouped(self.rays),
                    grouped(self.hits),
                    self.rays_per_voxel()
                ),
            ),
            (
                "opacity",
                format!(
                    "{} opaque, {} one number, {} six",
                    percent(self.share(|_, o| o == OpacityKind::Opaque)),
                    percent(self.share(|_, o| o == OpacityKind::Scalar)),
                    percent(self.share(|_, o| o == OpacityKind::Six))
                ),
            ),
            (
                "shaders",
                format!(
                    "{} complex",
                    percent(self.share(|s, _| s == ShaderKind::Complex))
                ),
            ),
            (
                "bytes",
                format!(
                    "{}, {:.1} a triangle; unpacked voxels {}, of which opacities {}, and \
                     triangles {}",
                    grouped(file.len()),
                    file.len() as f64 / f64::from(file.nodes()[0].triangles),
                    grouped(self.voxel_bytes),
                    grouped(self.opacity_bytes),
                    grouped(self.surface_bytes)
                ),
            ),
        ];
        let text: Vec<String> = lines
            .iter()
            .map(|(name, value)| format!("{name:<9} {value}"))
            .collect();
        let rows = self.levels.iter().enumerate().map(|(number, level)| {
            let error = libm::sqrt(level.square_error / level.voxels.max(1) as f64);
            vec![
                number.to_string(),
                grouped(level.nodes),
                grouped(level.leaves),
                grouped(level.voxels),
                grouped(level.surface),
                format!("{:.4}", level.greatest_voxel),
                format!("{error:.4}"),
            ]
        });
        let head = [
            "level",
            "nodes",
            "leaves",
            "voxels",
            "triangles",
            "voxel size",
            "fit error",
        ];
        let head = head.map(String::from).into();
        format!(
            "{}\n\n{}",
            text.join("\n"),
            report::table(head, rows.collect())
        )
    }
}
