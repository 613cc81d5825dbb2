//! `model`: what a frame costs on the light hardware.

mod args;
#[cfg(feature = "view")]
mod brief;
mod explore;
mod find;
mod output;
mod vectors;

pub(super) use args::ModelArgs;
#[cfg(feature = "view")]
pub(super) use brief::brief;

use super::console::Console;
use super::error::CliError;
use super::experiment::subjects;

pub(super) fn run(
    args: &ModelArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    if let Some(space) = &args.explore.explore {
        return explore::run(space, args, from_config, console);
    }
    if args.hardware.print_hw {
        return console.data(args.hardware_text()?.trim_end());
    }
    output::check(args)?;
    vectors::check(args)?;
    let hardware = args.hardware()?;
    let prices = args.hardware.prices()?;
    let mut names = args.scenes.clone();
    if names.is_empty() {
        names = from_config;
    }
    if names.is_empty() {
        names = vec![subjects::BUNDLED.to_owned()];
    }
    let [name] = names.as_slice() else {
        return Err(CliError::usage("model looks at one scene at a time"));
    };
    let found = find::find(args, name, hardware, &prices, console).map_err(|e| e.at(name))?;
    output::write(&found, args, console)
}
