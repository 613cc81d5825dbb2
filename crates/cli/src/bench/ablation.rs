//! `bench ablation`: techniques switched off in turn. Always on one thread.

use serde_json::json;

use super::args::{MeasureArgs, SceneBenchArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::context::Context;
use crate::experiment::export::{self, Results};
use crate::experiment::subjects;
use crate::{engines, report};
use shiftvox_lab::bench::{Candidate, Family, Harness, ablation as experiment};

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 512;

pub(super) fn run(
    args: &SceneBenchArgs,
    from_config: Vec<String>,
    threads: &[usize],
    console: &Console,
) -> Result<(), CliError> {
    export::check(&args.export)?;
    if threads != [1] {
        return Err(CliError::usage("an ablation is measured on one thread"));
    }
    let sizes = args.measure.sizes(DEFAULT_SIDE)?;
    let [size] = sizes[..] else {
        return Err(CliError::usage("an ablation is measured at one size")
            .advise("give --size in place of --scan"));
    };
    let families = families(&args.measure)?;
    let (schedule, options) = (args.measure.schedule(), args.measure.options());
    let context = Context::now();
    context.warn(console);
    let mut harness = Harness::new(schedule, console.progress());
    let mut rows = Vec::new();
    for name in subjects::names(&args.scenes, from_config) {
        let subject = subjects::open(&name, &args.camera, &args.scene, size, console)?;
        rows.extend(experiment::run(
            &subject,
            size,
            &options,
            &families,
            &engines::REFERENCE,
            &mut harness,
        )?);
    }
    let mut fields = context.json(schedule, &options);
    fields["results"] = json!(rows);
    let table = experiment::table(&rows);
    let results = Results {
        document: report::document("bench ablation", fields),
        tables: vec![table.clone(), experiment::legend(&families)],
        rows: table,
        more_tables: Vec::new(),
        preface: context.markdown(schedule),
        panels: experiment::panels(&rows),
    };
    export::write(&results, &args.export, console)
}

/// The families whose engine was asked for; all if none was.
fn families(args: &MeasureArgs) -> Result<Vec<Family>, CliError> {
    let wholes: Vec<Candidate> = engines::FAMILIES.iter().map(|f| f.whole).collect();
    let all: Vec<&str> = wholes.iter().map(|whole| whole.name).collect();
    let chosen: Vec<&str> = args.choose(&wholes, &all)?.iter().map(|c| c.name).collect();
    let families = engines::FAMILIES.iter().copied();
    Ok(families
        .filter(|f| chosen.contains(&f.whole.name))
        .collect())
}
