//! `bench scaling`: growth with pixels and with voxels.

use clap::Args;
use serde_json::json;

use super::args::{MeasureArgs, check_sizes, squares};
use crate::args::{CameraArgs, SceneArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::context::Context;
use crate::experiment::export::ExportArgs;
use crate::experiment::export::{self, Results};
use crate::experiment::subjects;
use crate::{engines, report};
use shiftvox_lab::bench::scaling::{self as experiment, Growing, Growth};
use shiftvox_lab::bench::{BenchPlan, Harness, Scan, measure};

/// Arguments of `bench scaling`.
#[derive(Debug, Args)]
pub(super) struct ScalingArgs {
    /// Scenes whose picture grows: files, generators, or `bundled`
    /// [default: gen:terrain,depth=10 gen:menger,depth=5 bundled]
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    scenes: Vec<String>,
    /// Most voxels of a scene that grows; a terrain takes about 10 bytes a voxel, and 28 while it
    /// is made
    #[arg(long, value_name = "N", default_value = "1e7", value_parser = voxel_count)]
    max_voxels: u64,
    #[command(flatten)]
    measure: MeasureArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
}

/// Sides of the growing picture, pixels.
const LEAST_SIDE: u32 = 64;
const MOST_SIDE: u32 = 4096;
/// Side of the picture of growing scenes.
const VOXEL_SIDE: u32 = 1024;

/// Scenes of growing depth, and about how many voxels each has.
struct Ladder {
    kind: &'static str,
    depths: std::ops::RangeInclusive<u32>,
    voxels: fn(u32) -> u64,
}

const LADDERS: [Ladder; 2] = [
    Ladder {
        kind: "terrain",
        depths: 5..=12,
        // 3.74 to 3.71 for each column, from depth 9 on.
        voxels: |depth| 15 * (1 << (2 * depth)) / 4,
    },
    Ladder {
        kind: "menger",
        depths: 2..=6,
        voxels: |depth| 20u64.pow(depth),
    },
];

fn voxel_count(text: &str) -> Result<u64, String> {
    if let Ok(count) = text.parse() {
        return Ok(count);
    }
    match text.parse::<f64>() {
        Ok(count) if (1.0..1e15).contains(&count) => Ok(count as u64),
        _ => Err("expected a number of voxels, such as 10000000 or 1e7".to_owned()),
    }
}

pub(super) fn run(
    args: &ScalingArgs,
    from_config: Vec<String>,
    threads: &[usize],
    console: &Console,
) -> Result<(), CliError> {
    export::check(&args.export)?;
    let picture_sizes = picture_sizes(&args.measure);
    let voxel_size = match args.measure.size {
        Some(size) => (size.width, size.height),
        None => (VOXEL_SIDE, VOXEL_SIDE),
    };
    check_sizes(&picture_sizes)?;
    check_sizes(&[voxel_size])?;
    let candidates = args.measure.choose(engines::CANDIDATES, engines::SCALED)?;
    let (schedule, options) = (args.measure.schedule(), args.measure.options());
    let context = Context::now();
    context.warn(console);
    let mut plan = BenchPlan {
        sizes: &picture_sizes,
        threads,
        options,
        candidates: &candidates,
        reference: None,
    };
    let mut harness = Harness::new(schedule, console.progress());
    let mut growths = Vec::new();
    for name in subjects::names(&args.scenes, from_config) {
        let subject = subjects::open(&name, &args.camera, &args.scene, picture_sizes[0], console)?;
        let timings = measure(&[subject], &plan, &mut harness)?;
        growths.extend(Growth::collect(Growing::Pixels, &name, timings));
    }
    harness.release_buffers();
    let voxel_sizes = [voxel_size];
    plan.sizes = &voxel_sizes;
    for ladder in &LADDERS {
        let mut scenes = Vec::new();
        for depth in ladder.depths.clone() {
            if (ladder.voxels)(depth) > args.max_voxels {
                break;
            }
            let name = format!("gen:{},depth={depth}", ladder.kind);
            // Always from the standard camera: it keeps its place in the object's cube.
            let camera = CameraArgs::default();
            let subject = subjects::open(&name, &camera, &args.scene, voxel_size, console)?;
            scenes.push(subject);
        }
        let timings = measure(&scenes, &plan, &mut harness)?;
        growths.extend(Growth::collect(Growing::Voxels, ladder.kind, timings));
    }
    let mut fields = context.json(schedule, &options);
    fields["growths"] = json!(growths);
    let paper = experiment::PAPER_TABLE_I.iter();
    fields["paper_table_1"] = paper
        .map(|(side, time)| json!({ "side": side, "ms": time }))
        .collect();
    let rows = experiment::points_table(&growths);
    let results = Results {
        document: report::document("bench scaling", fields),
        tables: vec![rows.without(&["pixels"]), experiment::laws_table(&growths)],
        rows,
        more_tables: Vec::new(),
        preface: context.markdown(schedule),
        panels: experiment::panels(&growths),
    };
    export::write(&results, &args.export, console)
}

/// Sizes of the growing picture: those of `--scan`, else doubling up to `--size`, else up to the
/// most.
fn picture_sizes(args: &MeasureArgs) -> Vec<(u32, u32)> {
    if let Some(scan) = &args.scan {
        return squares(scan);
    }
    let most = args.size.map_or(MOST_SIDE, |s| s.width.max(s.height));
    squares(&Scan::by_factor("size", LEAST_SIDE.min(most), most, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_voxels() {
        assert_eq!(voxel_count("1e7"), Ok(10_000_000));
        assert_eq!(voxel_count("12345"), Ok(12_345));
        for bad in ["", "0.5", "-1", "nan", "inf", "1e99", "many"] {
            assert!(voxel_count(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn ladders_know_their_voxels() {
        // Depth 10 of the terrain and five steps of the sponge are the benchmark's.
        let [terrain, menger] = &LADDERS;
        let off = (terrain.voxels)(10) as f64 / 3_892_443.0 - 1.0;
        assert!(off.abs() < 0.02, "{off}");
        assert_eq!((menger.voxels)(5), 3_200_000);
    }
}
