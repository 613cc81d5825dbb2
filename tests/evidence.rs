//! The pages against the registry, and the figures of the README's first table; `.ci/run` checks all that take seconds.
#![allow(clippy::unwrap_used, reason = "tests fail by it")]
#![allow(dead_code, reason = "the tool's other half is used by the example")]

#[path = "../examples/evidence/tool/mod.rs"]
mod tool;

use std::path::Path;

fn tool() -> tool::Tool {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    tool::Tool::open(root, Path::new(env!("CARGO_BIN_EXE_shiftvox"))).unwrap()
}

#[test]
fn pages_are_as_the_registry_says() {
    let faults = tool().text_faults().unwrap();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_first_table_of_the_readme_is_what_is_drawn() {
    let wanted = tool::Wanted {
        names: vec!["readme-exact".to_owned()],
        ..tool::Wanted::default()
    };
    let faults = tool().figure_faults(&wanted, 2).unwrap();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
