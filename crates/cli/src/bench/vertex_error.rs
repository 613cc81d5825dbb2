//! `bench vertex-error`: the image-order paper's midpoints against exact projection.

use serde_json::json;

use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::report;
use shiftvox_lab::vertex_error;

pub(super) fn run(console: &Console) -> Result<(), CliError> {
    let table = vertex_error::standard_table().map_err(|e| CliError::new(Kind::Run, e))?;
    if console.json {
        return console.document(&report::document(
            "bench vertex-error",
            json!({ "table": table }),
        ));
    }
    console.data(table.to_string())
}
