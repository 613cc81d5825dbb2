//! Flags of `model`.

use std::path::{Path, PathBuf};

use clap::Args;
use hwmodel::cost::{CostTable, Costing, Goal, ShiftUnits};
use hwmodel::cycles::{Hardware, PRESETS};

use super::explore::args::ExploreArgs;
use crate::args::{CameraArgs, RuleArgs, SceneArgs, Size};
use crate::error::{CliError, Kind};
use crate::experiment::export::ExportArgs;
use shiftvox::bounded;
use shiftvox::project::SetupOptions;
use shiftvox_lab::float_rays::RayOrder;
use shiftvox_lab::model::cost::Prices;

/// Arguments of `model`.
#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    /// Scene: a file, a generator, or `bundled` [default: bundled]
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    pub(super) scenes: Vec<String>,
    /// Pixels: 512 for a square, or 640x360
    #[arg(long, value_name = "N|WxH", default_value = "512")]
    pub(super) size: Size,
    #[command(flatten)]
    pub(super) hardware: HardwareArgs,
    #[command(flatten)]
    pub(super) explore: ExploreArgs,
    #[command(flatten)]
    pub(super) files: FileArgs,
    #[command(flatten)]
    pub(super) export: ExportArgs,
    #[command(flatten)]
    pub(super) camera: CameraArgs,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    #[command(flatten)]
    pub(super) rules: RuleArgs,
}

/// The hardware, and the prices of its parts.
#[derive(Debug, Args)]
#[command(next_help_heading = "Hardware")]
pub(super) struct HardwareArgs {
    /// Hardware: tiny, paper, light, wide, or a TOML file like those (--print-hw shows one) [default: light;
    /// paper with --coverage any or center; with --explore, the space's]
    #[arg(long = "hw", value_name = "NAME|FILE")]
    pub(super) hw: Option<String>,
    /// Print the description of the hardware and exit
    #[arg(long)]
    pub(super) print_hw: bool,
    /// TOML file with costs that replace shipped ones
    #[arg(long, value_name = "FILE")]
    costs: Option<PathBuf>,
    /// Whether gates are chosen for small area or short delay
    #[arg(long, value_enum, default_value_t)]
    goal: Goal,
    /// Count shifts by constants as shifters, not as wires
    #[arg(long)]
    shifters: bool,
    /// Order of the ray caster's rays [default: the one of least energy]
    #[arg(long, value_enum, value_name = "ORDER")]
    pub(super) ray_order: Option<RayOrder>,
}

/// Files beside those of every experiment.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct FileArgs {
    /// Web page of one file: tables, plots, picture and heat map
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,
    /// Heat map of records per pixel, PNG
    #[arg(long, value_name = "FILE")]
    pub(super) heat: Option<PathBuf>,
    /// Trace of the first records, JSON for Perfetto
    #[arg(long, value_name = "FILE")]
    pub(super) trace: Option<PathBuf>,
    /// Records of the trace
    #[arg(long, value_name = "N", default_value_t = 2000)]
    pub(super) trace_records: u64,
    /// Folder of test vectors: JSON lines with the inputs and outputs of each block, and a manifest
    #[arg(long, value_name = "DIR")]
    pub(super) vectors: Option<PathBuf>,
    /// Records of the test vectors
    #[arg(long, value_name = "N", default_value_t = 1000,
          value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) vector_records: u64,
}

/// Reads a file that the user names.
pub(super) fn read(path: &Path) -> Result<String, CliError> {
    bounded::read_settings(path)
        .map_err(|error| CliError::new(Kind::Input, error).at(path.display().to_string()))
}

/// The description with a name: a shipped one, or a file relative to a folder.
fn text_named(name: &str, folder: &Path) -> Result<String, CliError> {
    if let Some((_, text)) = PRESETS.iter().find(|(of, _)| *of == name) {
        return Ok((*text).to_owned());
    }
    let path = folder.join(name);
    if !path.exists() {
        let names: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
        return Err(CliError::new(
            Kind::Input,
            format!("no hardware and no file is called {name}"),
        )
        .advise(format!(
            "take one of {}, or print one with --print-hw and change it",
            names.join(", ")
        )));
    }
    read(&path)
}

/// The hardware of a name: see [`text_named`].
pub(super) fn hardware_named(name: &str, folder: &Path) -> Result<Hardware, CliError> {
    Hardware::from_toml(&text_named(name, folder)?)
        .map_err(|error| CliError::new(Kind::Input, error).at(name))
}

/// Width of a word, bits, where no flag sets it: the width for which the shipped hardware is built.
const BITS: u32 = 32;

impl ModelArgs {
    /// The rules and the words of the frame.
    pub(super) fn setup_options(&self) -> SetupOptions {
        SetupOptions {
            bits: self.rules.bits.unwrap_or(BITS),
            ..self.rules.options(0)
        }
    }

    /// The hardware's name or file; by default the best one known for the rule. Tiles help only rules that draw outlines.
    fn hardware_name(&self) -> &str {
        let best = match self.rules.options(0).coverage.draws_outlines() {
            true => "light",
            false => "paper",
        };
        self.hardware.hw.as_deref().unwrap_or(best)
    }

    /// The hardware's description as TOML: a shipped one with its comments, or the user's.
    pub(super) fn hardware_text(&self) -> Result<String, CliError> {
        text_named(self.hardware_name(), Path::new(""))
    }

    /// The hardware.
    pub(super) fn hardware(&self) -> Result<Hardware, CliError> {
        hardware_named(self.hardware_name(), Path::new(""))
    }
}

impl HardwareArgs {
    /// The cost tables and choices.
    pub(super) fn prices(&self) -> Result<Prices, CliError> {
        let wrong = |error| CliError::new(Kind::Input, error);
        let mut table = CostTable::load_shipped().map_err(wrong)?;
        if let Some(path) = &self.costs {
            let name = path.display().to_string();
            let text = read(path)?;
            let own = CostTable::empty()
                .with_overrides(&name, &text)
                .map_err(wrong)?;
            // An operation that the model never prices is a typing error.
            let known = table.operations();
            let own = own.operations();
            if let Some(stranger) = own.iter().find(|name| !known.contains(name)) {
                let known = known.join(", ");
                let message = format!("there is no operation `{stranger}`; there are {known}");
                return Err(CliError::new(Kind::Input, message).at(name));
            }
            table = table.with_overrides(&name, &text).map_err(wrong)?;
        }
        Ok(Prices {
            table,
            costing: Costing {
                shifts: if self.shifters {
                    ShiftUnits::Variable
                } else {
                    ShiftUnits::Wires
                },
            },
            goal: self.goal,
        })
    }
}
