//! Flags of `model --explore`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(next_help_heading = "Explore")]
pub(in crate::model) struct ExploreArgs {
    /// Measure many designs and find the Pareto-optimal ones in time, area, energy and wrong samples. SPACE is bundled,
    /// lanes, map, rules, sizes, steps, words, or a TOML file like those (--print-space). Takes several scenes. --json
    /// prints one line per point
    #[arg(long, value_name = "SPACE", conflicts_with_all = ["vectors", "export_ramulator", "export_accelergy", "export_ert"])]
    pub(in crate::model) explore: Option<String>,
    /// Print the space and exit
    #[arg(long, requires = "explore")]
    pub(super) print_space: bool,
    /// Points by number, such as 7, or 7..12 with both ends
    #[arg(long, value_name = "FROM..TO", requires = "explore", value_parser = points)]
    pub(super) points: Option<RangeInclusive<usize>>,
    /// File to which results are appended, one line per point. Points in the file are not measured again; several
    /// such files can be concatenated
    #[arg(long, value_name = "FILE", requires = "explore")]
    pub(super) results: Option<PathBuf>,
}

fn points(text: &str) -> Result<RangeInclusive<usize>, String> {
    let (from, to) = text.split_once("..").unwrap_or((text, text));
    match (from.parse(), to.parse()) {
        (Ok(from), Ok(to)) if from <= to => Ok(from..=to),
        _ => Err("expected the number of a point, or FROM..TO, such as 7..12".to_owned()),
    }
}
