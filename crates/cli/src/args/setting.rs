//! Settings as a configuration file has them.

/// A flag's long name and its value.
pub type Setting = (&'static str, toml::Value);

/// A choice among names, in the words of the command line.
pub(crate) fn word(value: &impl clap::ValueEnum) -> toml::Value {
    let name = value
        .to_possible_value()
        .map_or_else(String::new, |possible| possible.get_name().to_owned());
    toml::Value::String(name)
}
