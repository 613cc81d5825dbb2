//! Flags of `model`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use hwmodel::cost::{CostTable, Estimator, Goal};
use hwmodel::cycles::{Hardware, PRESETS};

use super::explore::args::ExploreArgs;
use crate::args::{CameraArgs, RuleArgs, SceneArgs, Size};
use crate::document::{named_settings, read_settings};
use crate::error::CliError;
use crate::experiment::export::ExportArgs;
use shiftvox::machine::check_hardware;
use shiftvox::project::SetupOptions;
use shiftvox_lab::model::accelergy::EnergyTable;
use shiftvox_lab::model::cost::Prices;
use shiftvox_lab::rival::Rival;

#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    /// Scene, as a file, a generator, or `bundled` [default: bundled]
    #[arg(value_name = "SCENE")]
    pub(super) scenes: Vec<String>,
    /// Pixels, such as 512 (square) or 640x360
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

#[derive(Debug, Args)]
#[command(next_help_heading = "Hardware")]
pub(super) struct HardwareArgs {
    /// Hardware tiny, paper, light or wide, or a TOML file like those [default: light, or paper with --coverage any or
    /// center, or with --explore the space's]
    #[arg(long = "hw", value_name = "NAME|FILE")]
    pub(super) hw: Option<String>,
    /// Print the description of the hardware and exit
    #[arg(long)]
    pub(super) print_hw: bool,
    /// TOML file of costs that replace shipped ones
    #[arg(long, value_name = "FILE")]
    costs: Option<PathBuf>,
    /// Energy reference table of Accelergy (ERT, YAML) that prices operations and accesses
    #[arg(long, value_name = "FILE")]
    ert: Option<PathBuf>,
    /// Choose gates for small area or short delay
    #[arg(long, value_enum, default_value_t)]
    goal: Goal,
    /// TOML file of the ray caster beside which designs are measured
    #[arg(long, value_name = "FILE")]
    rival: Option<PathBuf>,
    /// Print the description of the ray caster and exit
    #[arg(long)]
    pub(super) print_rival: bool,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct FileArgs {
    /// Requests to outer memory, a memory trace for Ramulator
    #[arg(long, value_name = "FILE")]
    pub(super) export_ramulator: Option<PathBuf>,
    /// Components and action counts of both designs, YAML for Accelergy
    #[arg(long, value_name = "FILE")]
    pub(super) export_accelergy: Option<PathBuf>,
    /// Energies of these actions, an energy reference table of Accelergy (ERT, YAML)
    #[arg(long, value_name = "FILE")]
    pub(super) export_ert: Option<PathBuf>,
    /// Folder of test vectors for hardware designers
    #[arg(long, value_name = "DIR")]
    pub(super) vectors: Option<PathBuf>,
    /// Records of the test vectors
    #[arg(long, value_name = "N", default_value_t = 1000,
          value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) vector_records: u64,
}

fn text_named(name: &str, folder: &Path) -> Result<String, CliError> {
    let told = ["hardware", "print one with --print-hw and change it"];
    named_settings(name, &PRESETS, folder, told)
}

pub(super) fn hardware_named(name: &str, folder: &Path) -> Result<Hardware, CliError> {
    let text = text_named(name, folder)?;
    let hardware = Hardware::from_toml(&text)
        .and_then(|hardware| check_hardware(&hardware).map(|()| hardware))
        .map_err(|error| CliError::input(error).at(name))?;
    if hardware.node_buffer.is_some() {
        let why = "node_buffer: only a ray caster has one (--rival)";
        return Err(CliError::input(why).at(name));
    }
    Ok(hardware)
}

const BITS: u32 = 32;

impl ModelArgs {
    pub(super) fn setup_options(&self) -> SetupOptions {
        SetupOptions {
            bits: self.rules.bits.unwrap_or(BITS),
            ..self.rules.options(0)
        }
    }

    /// The hardware's name or file, by default the best one for the rule. Tiles help only rules that draw outlines.
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

    pub(super) fn hardware(&self) -> Result<Hardware, CliError> {
        hardware_named(self.hardware_name(), Path::new(""))
    }
}

impl HardwareArgs {
    /// The ray caster's description as TOML: the shipped one with its comments, or the user's.
    pub(super) fn rival_text(&self) -> Result<String, CliError> {
        match &self.rival {
            Some(path) => read_settings(path),
            None => Ok(Rival::SHIPPED.to_owned()),
        }
    }

    pub(super) fn rival(&self) -> Result<Rival, CliError> {
        Rival::from_toml(&self.rival_text()?).map_err(|error| {
            let error = CliError::input(error);
            match &self.rival {
                Some(path) => error.at(path.display()),
                None => error,
            }
        })
    }

    fn estimator(&self) -> Result<Option<Arc<dyn Estimator>>, CliError> {
        let Some(path) = &self.ert else {
            return Ok(None);
        };
        let table = EnergyTable::parse(&path.display().to_string(), &read_settings(path)?);
        Ok(Some(Arc::new(table.map_err(CliError::input)?)))
    }

    pub(super) fn prices(&self) -> Result<Prices, CliError> {
        let mut table = CostTable::load_shipped().map_err(CliError::input)?;
        if let Some(path) = &self.costs {
            let name = path.display().to_string();
            let text = read_settings(path)?;
            let own = CostTable::default()
                .with_overrides(&name, &text)
                .map_err(CliError::input)?;
            // An operation that the model never prices is a typing error.
            let known = table.operations();
            let own = own.operations();
            if let Some(stranger) = own.iter().find(|name| !known.contains(name)) {
                let known = known.join(", ");
                let message = format!("there is no operation `{stranger}`; there are {known}");
                return Err(CliError::input(message).at(name));
            }
            table = table
                .with_overrides(&name, &text)
                .map_err(CliError::input)?;
        }
        Ok(Prices {
            estimator: self.estimator()?,
            table,
            goal: self.goal,
        })
    }
}
