//! `bench engines`: the engines and a ray caster in floating point, side by side.

use serde_json::json;

use super::args::SceneBenchArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::context::Context;
use crate::experiment::export::{self, Results};
use crate::experiment::subjects;
use crate::{engines, report};
use shiftvox_lab::bench::{BenchPlan, Harness, engines as experiment, measure};

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 1024;

pub(super) fn run(
    args: &SceneBenchArgs,
    from_config: Vec<String>,
    threads: &[usize],
    console: &Console,
) -> Result<(), CliError> {
    export::check(&args.export)?;
    let sizes = args.measure.sizes(DEFAULT_SIDE)?;
    let all: Vec<&str> = engines::CANDIDATES.iter().map(|c| c.name).collect();
    let candidates = args.measure.choose(engines::CANDIDATES, &all)?;
    let (schedule, options) = (args.measure.schedule(), args.measure.options());
    let context = Context::now();
    context.warn(console);
    let plan = BenchPlan {
        sizes: &sizes,
        threads,
        options,
        candidates: &candidates,
        reference: Some(&engines::REFERENCE),
    };
    let mut harness = Harness::new(schedule, console.progress());
    let mut timings = Vec::new();
    for name in subjects::names(&args.scenes, from_config) {
        let subject = subjects::open(&name, &args.camera, &args.scene, sizes[0], console)?;
        timings.extend(measure(&[subject], &plan, &mut harness)?);
    }
    let mut fields = context.json(schedule, &options);
    fields["results"] = json!(timings);
    let rows = experiment::table(&timings);
    let results = Results {
        document: report::document("bench engines", fields),
        tables: vec![rows.clone()],
        rows,
        more_tables: Vec::new(),
        preface: context.markdown(schedule),
        panels: experiment::panels(&timings),
    };
    export::write(&results, &args.export, console)
}
