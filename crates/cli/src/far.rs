//! `.far` files on the command line: `convert` and `info`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

use super::console::Console;
use super::convert::ConvertArgs;
use super::error::{CliError, Kind};
use super::report::{self, grouped};
use super::scenes;
use shiftvox::budget;
use shiftvox::drawing::milliseconds_since;
use shiftvox::project::Up;
use shiftvox::whole;
use shiftvox_mesh::far::build::Outside;
use shiftvox_mesh::far::record::{Node, OPACITY_BYTES};
use shiftvox_mesh::far::{BuildError, FarFile, build_outside};
use shiftvox_mesh::{Instances, ListFolder};

pub(super) fn convert(args: &ConvertArgs, console: &Console) -> Result<(), CliError> {
    let ConvertArgs { input, output, .. } = args;
    let options = &args.far_options();
    let beside = whole::folder_of(output);
    let folder = args.temp.as_deref().unwrap_or(beside);
    let is_new = !beside.exists();
    let within = args.memory.map(|memory| {
        // A missing file makes no folder.
        scenes::is_mesh(input)?;
        whole::make_folder(beside)?;
        Ok::<_, CliError>(ListFolder::new(folder, memory / MAPPED_SHARE))
    });
    let within = within.transpose()?;
    let opened = scenes::open_mesh(input, &args.scene, within.as_ref(), console);
    if opened.is_err() && is_new {
        // As without a budget. Only an empty folder goes.
        let _ = fs::remove_dir(beside);
    }
    let (mesh, up) = opened?;
    let started = Instant::now();
    let triangles = mesh.triangles().len() as u64 * u64::from(args.instances.unwrap_or(1));
    check_room(triangles, args.memory).map_err(|e| e.at(input))?;
    whole::make_folder(beside)?;
    let unfinished = args.resume.then(|| {
        let mut name = output.as_os_str().to_owned();
        name.push(".unfinished");
        PathBuf::from(name)
    });
    let mapped = within.as_ref().map_or(0, |within| {
        within.release();
        within.bytes()
    });
    let loaded = budget::resident().unwrap_or_else(|| mesh.bytes());
    let left = |memory| memory - memory / ALLOCATORS_SHARE - mapped.min(memory / MAPPED_SHARE);
    let outside = Outside {
        memory: args
            .memory
            .map(|memory| left(memory).saturating_sub(loaded)),
        folder,
        unfinished: unfinished.as_deref(),
    };
    let built = match args.instances {
        None => build_outside(&mesh, options, &outside, console.progress()),
        Some(count) => {
            let places = in_rows(mesh.bounds(), up, count);
            let fleet = Instances::new(mesh, places);
            build_outside(&fleet, options, &outside, console.progress())
        }
    };
    let mut built = built.map_err(|error| match error {
        BuildError::Memory { needed, .. } => {
            let all = needed + loaded;
            let enough = ((all + mapped) * 8 / 7).min(all * 4 / 3);
            let enough = enough.div_ceil(1 << 20) + 1;
            let error = CliError::from(error).at(input);
            error.advise(format!("give it --memory {enough}M or more"))
        }
        error @ BuildError::File { .. } => CliError::from(error),
        error => CliError::from(error).at(input),
    })?;
    if built.taken() > 0 {
        let all = built.data.nodes.len();
        console.note(format!(
            "{}: {} of {all} nodes were built before",
            output.display(),
            built.taken()
        ));
    }
    built.data.settings.y_up = up == Up::Y;
    let build_ms = milliseconds_since(started);
    whole::write_with(output, args.force, |file| built.write_to(file))?;
    if let Some(unfinished) = &unfinished {
        // Left, it would do no harm.
        let _ = fs::remove_file(unfinished);
    }
    let file = FarFile::open(output)?;
    let described = describe(&file, input);
    let n = |key: &str| report::figure(&described[key]);
    console.note(format!(
        "{}: {} triangles, {} nodes, {} voxels, {} rays, {} bytes, built in {:.1} s",
        output.display(),
        grouped(triangles),
        n("nodes"),
        n("voxels_kept"),
        n("rays"),
        n("bytes"),
        build_ms / 1e3
    ));
    if built.data.undecimated > 0 {
        console.note(format!(
            "warning: {}: the triangles of {} nodes could not be decimated; these have voxels",
            output.display(),
            built.data.undecimated
        ));
    }
    let per_voxel = described["rays_per_voxel"].as_f64().unwrap_or_default();
    if described["voxels_kept"] != 0 && per_voxel < LEAST_RAYS_PER_VOXEL {
        console.note(format!(
            "warning: {}: only {per_voxel:.1} rays passed through a voxel that is kept, and {LEAST_RAYS_PER_VOXEL} \
             are too few for opacities; {} voxels were not tested and are kept: ask for more \
             --rays, or leave it out",
            output.display(),
            n("voxels_untested")
        ));
    }
    args.report(described, build_ms, console);
    Ok(())
}

/// One of so many parts of a budget is left to the allocator.
const ALLOCATORS_SHARE: u64 = 8;
/// And one, or less, to pages of the mesh.
const MAPPED_SHARE: u64 = 8;

const LEAST_RAYS_PER_VOXEL: f64 = 8.0;

/// Least bytes of memory per triangle of a build without a budget.
const LEAST_BYTES: u64 = 64;

/// Refuses too many triangles for their numbers or for the free memory. A budget is checked when its mesh is loaded.
fn check_room(triangles: u64, budget: Option<u64>) -> Result<(), CliError> {
    if u32::try_from(triangles).is_err() {
        return Err(BuildError::TooMany(format!("{triangles} triangles")).into());
    }
    if budget.is_some() {
        return Ok(());
    }
    let needed = triangles * LEAST_BYTES;
    match budget::available() {
        Some(free) if needed > free => Err(CliError::new(
            Kind::Limit,
            format!(
                "{triangles} triangles take at least {}M of memory while far voxels are built of \
                 them, and {}M are free",
                needed.div_ceil(1 << 20),
                free >> 20
            ),
        )
        .advise("build within a budget with --memory, or ask for fewer --instances")),
        _ => Ok(()),
    }
}

/// Places of copies in rows on the ground, a tenth of the longest side apart, each a quarter turn further.
fn in_rows((low, high): (DVec3, DVec3), up: Up, count: u32) -> Vec<DAffine3> {
    let axis = up.axis();
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

pub(super) fn info(name: &str) -> Result<Value, CliError> {
    let file = FarFile::open(Path::new(name))?;
    file.verify()?;
    Ok(describe(&file, name))
}

fn describe(file: &FarFile, name: &str) -> Value {
    let nodes = file.nodes();
    let sum = |of: &dyn Fn(&Node) -> u64| -> u64 { nodes.iter().map(of).sum() };
    let (touched, kept) = (sum(&|n| n.touched.into()), sum(&Node::voxels));
    let untested = sum(&|n| n.untested.into());
    let per_voxel = |count: u64| count as f64 / kept.max(1) as f64;
    let list = |number: usize| sum(&|n| n.counts[number].into());
    // Lists are of flat and of complex shaders, each with three kinds of opacities.
    let share = |lists: &[usize]| per_voxel(lists.iter().map(|&number| list(number)).sum());
    let surface = |n: &Node| if n.is_leaf() { 0 } else { u64::from(n.surface) };
    let occluded = touched - kept;
    let last = nodes.iter().map(|n| n.level).max().unwrap_or(0);
    let levels = (0..=last).map(|level| {
        let own = || nodes.iter().filter(|n| n.level == level);
        let voxels: u64 = own().map(Node::voxels).sum();
        let squares = own().map(|n| f64::from(n.error).powi(2) * n.voxels() as f64);
        json!({
            "level": level,
            "nodes": own().count(),
            "leaves": own().filter(|n| n.is_leaf()).count(),
            "voxels": voxels,
            "surface_triangles": own().map(surface).sum::<u64>(),
            "greatest_voxel_world": own().map(|n| n.voxel).fold(0.0, f32::max),
            "fit_error": libm::sqrt(squares.sum::<f64>() / voxels.max(1) as f64),
        })
    });
    let (low, high) = file.bounds();
    json!({
        "scene": name,
        "format": ".far",
        "low": low.to_array(),
        "high": high.to_array(),
        "triangles": nodes[0].triangles,
        "nodes": nodes.len(),
        "levels": levels.collect::<Vec<Value>>(),
        "leaf_triangles": file.settings.leaf_triangles,
        "grid": file.settings.grid,
        "distance_voxels": file.settings.distance_voxels,
        "voxels_touched": touched,
        "voxels_seen": kept - untested,
        "voxels_untested": untested,
        "voxels_occluded": occluded,
        "voxels_kept": kept,
        "voxels_dropped": occluded,
        "voxels_dropped_share": occluded as f64 / touched.max(1) as f64,
        "rays": sum(&|n| n.rays.into()),
        "rays_hit": sum(&|n| n.hits.into()),
        "rays_per_voxel": per_voxel(sum(&|n| n.crossings.into())),
        "opaque_share": share(&[0, 3]),
        "scalar_share": share(&[1, 4]),
        "six_share": share(&[2, 5]),
        "complex_share": share(&[3, 4, 5]),
        "bytes": file.file_bytes(),
        "voxel_bytes": sum(&Node::voxel_bytes),
        "opacity_bytes": (0..OPACITY_BYTES.len()).map(|n| list(n) * OPACITY_BYTES[n] as u64).sum::<u64>(),
        "surface_triangles": sum(&surface),
        "surface_bytes": sum(&Node::surface_bytes),
        "texture_bytes": file.texture_bytes(),
    })
}
