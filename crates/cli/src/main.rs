//! The `shiftvox` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    shiftvox_cli::main()
}
