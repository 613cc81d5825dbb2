//! The `shiftvox` command.
fn main() {}
