//! `bench time`: engines, variants, scenes, sizes and numbers of threads, side by side.

use clap::Args;

use super::check_sizes;
use crate::args::{CameraArgs, RuleArgs, SceneArgs, Size};
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::context::Context;
use crate::experiment::export::{self, ExportArgs, Results};
use crate::experiment::subjects;
use crate::{engines, scenes};
use shiftvox_lab::bench::{Harness, Scan, Schedule, TimePlan, charts, measure, table};
use shiftvox_lab::report::Row;

const DEFAULT_SIDE: u32 = 512;

#[derive(Debug, Args)]
pub(super) struct TimeArgs {
    /// Scenes, as files, generators or `bundled` [default: gen:terrain,depth=10 gen:menger,depth=5
    /// bundled]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Engines to measure
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = engines::names(),
          default_values = engines::MEASURED)]
    engines: Vec<String>,
    /// Techniques to switch off, one at a time. Values are `all` and names of the table with hyphens
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = engines::variant_name)]
    variants: Vec<String>,
    /// Pixels, such as 512 (square) or 640x360 [default: 512]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Growing values, such as size=64..4096*2 or size=100..500+100 (square pictures) and
    /// depth=5..10+1 (generators and meshes)
    #[arg(long, value_name = "NAME=A..B*F", value_parser = size_or_depth)]
    scan: Option<Scan>,
    #[command(flatten)]
    schedule: Schedule,
    #[command(flatten)]
    rules: RuleArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
}

fn size_or_depth(text: &str) -> Result<Scan, String> {
    let scan: Scan = text.parse()?;
    match scan.name() {
        "size" | "depth" => Ok(scan),
        other => Err(format!("`{other}` cannot be scanned, only size and depth")),
    }
}

impl TimeArgs {
    fn sizes_and_depths(&self) -> Result<(Vec<Size>, Vec<u32>), CliError> {
        let one = self.size.unwrap_or(Size::square(DEFAULT_SIDE));
        let (sizes, depths) = match &self.scan {
            Some(scan) if scan.name() == "depth" => (vec![one], scan.values()),
            Some(_) if self.size.is_some() => {
                return Err(CliError::usage(
                    "--size and a --scan of it exclude each other",
                ));
            }
            Some(scan) => (
                scan.values().into_iter().map(Size::square).collect(),
                Vec::new(),
            ),
            None => (vec![one], Vec::new()),
        };
        check_sizes(&sizes, u32::MAX)?;
        Ok((sizes, depths))
    }

    /// A scene's name and how it is read, at a depth.
    fn at_depth(&self, name: &str, depth: u32) -> Result<(String, SceneArgs), CliError> {
        if name.starts_with("gen:") {
            let parts = name.split(',').filter(|part| !part.starts_with("depth="));
            let name = parts.collect::<Vec<_>>().join(",");
            return Ok((format!("{name},depth={depth}"), self.scene.clone()));
        }
        if name == subjects::BUNDLED || !scenes::is_mesh(name)? {
            let message = format!("{name}: only generators and meshes have a depth to scan");
            return Err(CliError::usage(message));
        }
        let scene = SceneArgs {
            depth: Some(depth),
            ..self.scene.clone()
        };
        Ok((name.to_owned(), scene))
    }
}

pub(super) fn run(args: &TimeArgs, threads: &[usize], console: &Console) -> Result<(), CliError> {
    export::check(&args.export, [])?;
    if args.rules.overflow.is_some() {
        return Err(CliError::usage("times are measured with --overflow trap"));
    }
    if args.export.export_svg.is_some() && args.scan.is_none() {
        return Err(CliError::usage(
            "--export-svg plots growth: it needs --scan",
        ));
    }
    let (sizes, depths) = args.sizes_and_depths()?;
    let sizes: Vec<(u32, u32)> = sizes.into_iter().map(Size::pair).collect();
    let families = engines::families(&args.engines, &args.variants)?;
    let (schedule, options) = (args.schedule, args.rules.options(0));
    let context = Context::now();
    context.warn(console);
    let plan = TimePlan {
        sizes: &sizes,
        threads,
        options,
        families: &families,
    };
    let mut harness = Harness::new(schedule, console.progress());
    let mut groups: Vec<(String, Vec<Row>)> = Vec::new();
    for name in subjects::names_or(&args.scenes, &subjects::DEFAULT) {
        let mut named = vec![(name.clone(), args.scene.clone())];
        if !depths.is_empty() {
            let at = depths.iter().map(|&depth| args.at_depth(&name, depth));
            named = at.collect::<Result<_, _>>()?;
        }
        let open = |(name, scene): &(String, SceneArgs)| {
            subjects::open(name, &args.camera, scene, sizes[0], console)
        };
        let opened: Vec<_> = named.iter().map(open).collect::<Result<_, _>>()?;
        groups.push((name, measure(&opened, &plan, &mut harness)?));
    }
    let all: Vec<Row> = groups.iter().flat_map(|(_, rows)| rows.clone()).collect();
    let tables = groups
        .iter()
        .map(|(name, rows)| table(name, rows))
        .collect();
    let fields = context.json(schedule, &options);
    let charts = groups.iter().flat_map(|(_, rows)| charts(rows)).collect();
    let results = Results::of_rows("bench time", fields, &all, tables, charts);
    export::write(&results, &args.export, console)
}
