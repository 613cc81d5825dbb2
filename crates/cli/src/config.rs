//! `--config FILE`: a TOML table of flags by their long names.
//!
//! Each entry becomes a flag at the end of the command line, unless the flag is there already. A
//! camera placed by coordinates on the command line displaces one placed by angles in the file, and
//! the reverse. `scene` means the positional scenes.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::error::CliError;
use shiftvox::bounded;

/// Flags that place the camera by coordinates.
const BY_POINTS: [&str; 3] = ["eye", "target", "up"];
/// Flags that place it by angles.
const BY_ANGLES: [&str; 4] = ["view", "azimuth", "elevation", "zoom"];
/// Flags that `paper` replaces.
const PAPER: [&str; 3] = ["cage", "tolerance", "coverage"];

/// A command line with the entries of its configuration file.
pub(super) struct Expanded {
    pub(super) line: Vec<OsString>,
    /// The scenes that the file names.
    pub(super) scenes: Vec<String>,
    file: Option<Settings>,
}

/// A configuration file.
struct Settings {
    place: String,
    text: String,
    /// Keys that became flags.
    keys: Vec<String>,
}

/// Appends the entries of the configuration file to the command line.
///
/// # Errors
/// A usage error or a bad input that names the file and the entry.
pub(super) fn expand(mut line: Vec<OsString>) -> Result<Expanded, CliError> {
    let Some(path) = find_value(&line, "config") else {
        return Ok(Expanded {
            line,
            scenes: Vec::new(),
            file: None,
        });
    };
    let place = Path::new(&path).display().to_string();
    let at = |message: String| CliError::input(message).at(&place);
    let text = bounded::read_settings(Path::new(&path));
    let text = text.map_err(|e| at(format!("cannot read the file: {e}")))?;
    let table: toml::Table = text
        .parse()
        .map_err(|e| at(format!("not a TOML table: {e}")))?;
    let (flags, scenes) = flags_of(&line, table).map_err(|e| e.at(&place))?;
    let keys = flags.iter().map(|(key, _)| key.clone()).collect();
    // Flags after `--` would be scenes.
    let end = line.iter().position(|a| a == "--").unwrap_or(line.len());
    line.splice(end..end, flags.into_iter().map(|(_, flag)| flag.into()));
    Ok(Expanded {
        line,
        scenes,
        file: Some(Settings { place, text, keys }),
    })
}

/// The long name of a flag.
fn key_of(flag: &str) -> Option<&str> {
    flag.strip_prefix("--")?.split(['=', ' ']).next()
}

impl Expanded {
    /// The error of the file, if a flag that came from it is wrong.
    pub(super) fn blame(&self, error: &clap::Error) -> Option<CliError> {
        let file = self.file.as_ref()?;
        let of = |kind| match error.get(kind) {
            Some(ContextValue::String(flag)) => key_of(flag),
            _ => None,
        };
        let key = of(ContextKind::InvalidArg)?;
        if !file.keys.iter().any(|known| known == key) {
            return None;
        }
        let is_entry = |line: &str| {
            let name = line.split('=').next().unwrap_or_default();
            name.trim().trim_matches(['"', '\'']) == key
        };
        let line = file.text.lines().position(is_entry).map_or(0, |at| at + 1);
        let message = error.render().to_string();
        let first = message.lines().next().unwrap_or_default();
        let reason = first.trim_start_matches("error: ");
        let place = format!("{}, line {line}", file.place);
        if error.kind() != ErrorKind::UnknownArgument {
            return Some(CliError::input(format!("`{key}`: {reason}")).at(place));
        }
        let advice = match of(ContextKind::SuggestedArg) {
            Some(near) => format!("is `{near}` meant?"),
            None => "settings are the long names of flags, which --help lists".to_owned(),
        };
        let failure = CliError::input(format!("there is no setting `{key}` here"));
        Some(failure.at(place).advise(advice))
    }
}

/// The keys of the entries with their flags, and the scenes.
type Flags = (Vec<(String, String)>, Vec<String>);

fn flags_of(line: &[OsString], table: toml::Table) -> Result<Flags, CliError> {
    let any = |names: &[&str]| names.iter().any(|name| has_flag(line, name));
    let (mut flags, mut scenes) = (Vec::new(), Vec::new());
    for (key, value) in table {
        let name = key.as_str();
        let is_displaced = has_flag(line, name)
            || (BY_POINTS.contains(&name) && any(&BY_ANGLES))
            || (BY_ANGLES.contains(&name) && any(&BY_POINTS))
            || (PAPER.contains(&name) && has_flag(line, "paper"))
            || (name == "paper" && any(&PAPER));
        match (name, value) {
            ("config", _) => {
                let message = "a configuration file cannot name another one";
                return Err(CliError::input(message));
            }
            ("scene", value) => scenes = texts(&key, value)?,
            (_, toml::Value::Boolean(false)) => {}
            _ if is_displaced => {}
            (_, toml::Value::Boolean(true)) => flags.push((key.clone(), format!("--{key}"))),
            (_, value) => {
                let flag = format!("--{key}={}", texts(&key, value)?.join(","));
                flags.push((key, flag));
            }
        }
    }
    Ok((flags, scenes))
}

fn texts(key: &str, value: toml::Value) -> Result<Vec<String>, CliError> {
    match value {
        toml::Value::String(text) => Ok(vec![text]),
        toml::Value::Integer(number) => Ok(vec![number.to_string()]),
        toml::Value::Float(number) => Ok(vec![number.to_string()]),
        toml::Value::Array(items) => {
            let nested: Result<Vec<_>, _> = items.into_iter().map(|v| texts(key, v)).collect();
            Ok(nested?.concat())
        }
        other => Err(CliError::input(format!(
            "`{key}`: expected text, a number, true, false or a list, found a {}",
            other.type_str()
        ))),
    }
}

/// Arguments before `--`.
fn flags_part(line: &[OsString]) -> impl Iterator<Item = &OsStr> {
    let words = line.iter().map(OsString::as_os_str);
    words.take_while(|word| *word != "--")
}

fn has_flag(line: &[OsString], name: &str) -> bool {
    flags_part(line).any(|word| word.to_str().and_then(key_of) == Some(name))
}

fn find_value(line: &[OsString], name: &str) -> Option<OsString> {
    let mut words = flags_part(line);
    while let Some(word) = words.next() {
        let Some(flag) = word.to_str().and_then(|word| word.strip_prefix("--")) else {
            continue;
        };
        match flag.split_once('=') {
            Some((found, value)) if found == name => return Some(value.into()),
            None if flag == name => return words.next().map(OsStr::to_owned),
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_become_flags_unless_the_command_line_has_them() {
        let camera = "size = 64\neye = \"1,2,3\"\ntarget = \"0,0,0\"\nview = \"iso\"";
        let all = "size = 64\naov = [\"depth\", \"node\"]\nhash = true\nforce = false\nfov = 40.5";
        let cases = [
            (
                "x render a.vox",
                all,
                "--aov=depth,node --fov=40.5 --hash --size=64",
            ),
            ("x --size=8 --zoom 2", camera, "--view=iso"),
            ("x --size 8 --eye=0,0,1", camera, "--target=0,0,0"),
            ("x --paper", "cage = \"frame\"", ""),
            ("x -- --size=8", "size = 64", "--size=64"),
        ];
        for (line, toml, expected) in cases {
            let line: Vec<OsString> = line.split(' ').map(Into::into).collect();
            let (flags, _) = flags_of(&line, toml.parse().unwrap()).unwrap();
            let mut flags: Vec<String> = flags.into_iter().map(|(_, flag)| flag).collect();
            flags.sort();
            assert_eq!(flags.join(" "), expected, "{line:?}");
        }
    }

    #[test]
    fn the_file_is_found_either_way() {
        for (line, found) in [
            ("x --config a", Some("a")),
            ("x --config=a", Some("a")),
            ("x -- --config=a", None),
        ] {
            let line: Vec<OsString> = line.split(' ').map(Into::into).collect();
            assert_eq!(
                find_value(&line, "config"),
                found.map(Into::into),
                "{line:?}"
            );
        }
    }
}
