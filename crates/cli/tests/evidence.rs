//! The pages against the registry. Figures that take seconds are checked by `.ci/run`, the README's first table among
//! them.
#![allow(clippy::unwrap_used, reason = "tests fail by it")]
#![allow(dead_code, reason = "the tool's other half is used by the example")]

#[path = "../examples/evidence/tool/mod.rs"]
mod tool;

use std::path::Path;

fn tool() -> tool::Tool {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    tool::Tool::open(root, Path::new(env!("CARGO_BIN_EXE_shiftvox"))).unwrap()
}

#[test]
fn pages_are_as_the_registry_says() {
    let faults = tool().text_faults().unwrap();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
