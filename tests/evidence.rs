//! The pages against the rules that need no drawing; `.ci/run` checks their figures too.
#![allow(clippy::unwrap_used, reason = "tests fail by it")]
#![allow(dead_code, reason = "the tool's other half is used by the example")]

#[path = "../examples/evidence/tool/mod.rs"]
mod tool;

use std::path::Path;

#[test]
fn pages_are_as_the_registry_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tool = tool::Tool::open(root, Path::new(env!("CARGO_BIN_EXE_shiftvox"))).unwrap();
    let faults = tool.text_faults().unwrap();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
