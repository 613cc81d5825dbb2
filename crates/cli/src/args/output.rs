//! Where results go.

use std::path::PathBuf;

use clap::Args;

/// Where results go.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
    /// Folder for the resolved config.toml and for stats.json
    #[arg(long, value_name = "DIR")]
    pub outdir: Option<PathBuf>,
}
