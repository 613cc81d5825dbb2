//! `stress`: the numerical stability sweep.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::console::Console;
use super::error::{CliError, Kind};
use super::experiment::context::Context;
use super::experiment::export;
use super::{document, report};
use shiftvox::whole;
use shiftvox_lab::report::Table;
use shiftvox_lab::stress::{self, Case, Failed, Hold, SweepPlan};

#[derive(Debug, Args)]
pub(super) struct StressArgs {
    /// Scenes, as generators, plane:depth,a,b,c, solid:depth or
    /// cyclic:depth,seed [default: thirteen of them]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Seed of viewpoints and rules; the same seed gives the same sweep
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// All widths from 16 to 64 bits, more scenes, larger pictures, most rules: hours
    #[arg(long)]
    thorough: bool,
    /// Word widths in bits
    #[arg(long, value_name = "LIST", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(16..=64))]
    bits: Vec<u32>,
    /// Pictures' sides, pixels
    #[arg(long, value_name = "LIST", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(1..=2048))]
    size: Vec<u32>,
    /// Random rules (coverage, tolerance, cage, level of detail) per scene, viewpoint and format
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    rules: Option<u32>,
    /// Random viewpoints beside the thirteen standard ones
    #[arg(long, value_name = "N")]
    viewpoints: Option<u32>,
    /// Draw one case alone: a line that a failing sweep prints
    #[arg(long, value_name = "CASE", conflicts_with_all = ["scenes", "thorough", "bits", "size", "rules", "viewpoints"])]
    case: Option<Case>,
    /// All results, as --json prints them
    #[arg(long, value_name = "FILE")]
    export_json: Option<PathBuf>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &StressArgs, console: &Console) -> Result<(), CliError> {
    if let Some(case) = &args.case {
        return run_case(case, console);
    }
    if let Some(path) = &args.export_json {
        whole::check_free(path, args.force)?;
    }
    let plan = plan(args)?;
    let started = std::time::Instant::now();
    let findings = stress::sweep(&plan, console.progress()).map_err(CliError::input)?;
    let seconds = started.elapsed().as_secs_f64();
    let mut fields = findings.document(&plan);
    fields["command"] = json!(Context::now().command);
    let document = document::document("stress", fields);
    if let Some(path) = &args.export_json {
        console.write(path, format!("{document:#}\n"), args.force)?;
    }
    match console.json {
        true => console.hold(document),
        false => {
            let tables: Vec<Table> = stress::TABLES.iter().map(|of| of.of(&document)).collect();
            export::print(&tables, console)?;
        }
    }
    let total = findings.total();
    console.note(format!(
        "{} frames in {seconds:.0} s",
        report::grouped(total.cases)
    ));
    if total.failed == 0 {
        return Ok(());
    }
    for of_check in findings.failed.chunk_by(|a, b| a.check == b.check) {
        let Failed {
            check,
            detail,
            case,
        } = &of_check[0];
        let name = check.name();
        console.note(format!(
            "{name}: {detail}\n  shiftvox stress --case '{case}'"
        ));
    }
    let (failed, all) = (report::grouped(total.failed), report::grouped(total.cases));
    let message = format!("{failed} of {all} frames violate a check");
    Err(CliError::new(Kind::Failed, message))
}

fn plan(args: &StressArgs) -> Result<SweepPlan, CliError> {
    let mut plan = SweepPlan::new(args.seed, args.thorough);
    if !args.scenes.is_empty() {
        let scenes = args.scenes.iter().map(|text| text.parse());
        plan.scenes = scenes
            .collect::<Result<_, String>>()
            .map_err(CliError::input)?;
    }
    if !args.bits.is_empty() {
        plan.bits.clone_from(&args.bits);
        plan.bits.sort_unstable();
        plan.bits.dedup();
    }
    if !args.size.is_empty() {
        plan.pixels.clone_from(&args.size);
    }
    if let Some(rules) = args.rules {
        plan.rules = rules as usize;
    }
    if let Some(viewpoints) = args.viewpoints {
        plan.random_viewpoints = viewpoints;
    }
    Ok(plan)
}

fn run_case(case: &Case, console: &Console) -> Result<(), CliError> {
    let outcome = stress::run_case(case, stress::PATIENCE).map_err(CliError::input)?;
    let mut fields = json!({ "case": case.to_string(), "outcome": outcome });
    match console.json {
        true => console.report("stress case", fields),
        false => {
            for (hold, worst) in Hold::ALL.iter().enumerate() {
                fields["outcome"]["worst"][hold]["vertices of"] = json!(worst.name());
            }
            console.data(case.to_string() + "\n" + &report::description(&fields["outcome"]))?;
        }
    }
    match outcome.failures.first() {
        None => Ok(()),
        Some(first) => {
            let message = format!("{}: {}", first.check.name(), first.detail);
            Err(CliError::new(Kind::Failed, message))
        }
    }
}
