//! `--config FILE`: a TOML table of flags by their long names.
//!
//! Each entry becomes a flag at the end of the command line, unless the flag is
//! there already. A camera given one way on the command line displaces one
//! given the other way in the file. `scene` stands for the positional scenes.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::error::CliError;
use shiftvox::bounded;

/// Flags that place the camera by coordinates.
const BY_POINTS: [&str; 3] = ["eye", "target", "up"];
/// Flags that place it by angles.
const BY_ANGLES: [&str; 4] = ["view", "azimuth", "elevation", "zoom"];
/// Flags for which `paper` stands.
const PAPER: [&str; 3] = ["cage", "tolerance", "coverage"];

/// A command line with the entries of its configuration file.
pub(super) struct Expanded {
    pub(super) line: Vec<OsString>,
    /// The scenes that the file names.
    pub(super) scenes: Vec<String>,
    file: Option<Settings>,
}

/// A configuration file that was read.
struct Settings {
    place: String,
    text: String,
    /// Keys that became flags.
    keys: Vec<String>,
}

/// Puts the entries of the configuration file on the command line.
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
    let path = Path::new(&path);
    let place = path.display().to_string();
    let text = bounded::read_settings(path)
        .map_err(|e| CliError::input(format!("cannot read the file: {e}")).at(&place))?;
    let table: toml::Table = text
        .parse()
        .map_err(|e| CliError::input(format!("not a TOML table: {e}")).at(&place))?;
    let (flags, scenes) = flags_of(&line, table).map_err(|e| e.at(&place))?;
    let keys = flags.iter().filter_map(|flag| key_of(flag.to_str()?));
    let keys = keys.map(str::to_owned).collect();
    // Flags after `--` would be scenes.
    let end = line.iter().position(|a| a == "--").unwrap_or(line.len());
    line.splice(end..end, flags);
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
    /// What is wrong with the file, where a flag that came from it is at fault.
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
        let place = format!("{}, line {line}", file.place);
        if error.kind() == ErrorKind::UnknownArgument {
            let refusal = CliError::input(format!("there is no setting `{key}` here")).at(place);
            return Some(match of(ContextKind::SuggestedArg) {
                Some(near) => refusal.advise(format!("is `{near}` meant?")),
                None => refusal.advise(
                    "`--help` of the command lists its flags: a setting is a flag's long name",
                ),
            });
        }
        let message = error.render().to_string();
        let first = message.lines().next().unwrap_or_default();
        let reason = first.strip_prefix("error: ").unwrap_or(first);
        Some(CliError::input(format!("`{key}`: {reason}")).at(place))
    }
}

fn flags_of(
    line: &[OsString],
    table: toml::Table,
) -> Result<(Vec<OsString>, Vec<String>), CliError> {
    let any = |names: &[&str]| names.iter().any(|name| has_flag(line, name));
    let mut flags = Vec::new();
    let mut scenes = Vec::new();
    for (key, value) in table {
        if key == "scene" {
            scenes = texts(&key, value)?;
            continue;
        }
        if key == "config" {
            return Err(CliError::input(
                "a configuration file cannot name another one",
            ));
        }
        let name = key.as_str();
        let displaced = has_flag(line, name)
            || (BY_POINTS.contains(&name) && any(&BY_ANGLES))
            || (BY_ANGLES.contains(&name) && any(&BY_POINTS))
            || (PAPER.contains(&name) && has_flag(line, "paper"))
            || (name == "paper" && any(&PAPER));
        if displaced {
            continue;
        }
        match value {
            toml::Value::Boolean(true) => flags.push(format!("--{key}").into()),
            toml::Value::Boolean(false) => {}
            value => flags.push(format!("--{key}={}", texts(&key, value)?.join(",")).into()),
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

/// The arguments that may be flags.
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

    fn flags(line: &[&str], toml: &str) -> Vec<String> {
        let line: Vec<OsString> = line.iter().map(Into::into).collect();
        let (flags, _) = flags_of(&line, toml.parse().unwrap()).unwrap();
        flags
            .iter()
            .map(|f| f.to_str().unwrap().to_owned())
            .collect()
    }

    #[test]
    fn entries_become_flags() {
        let toml = "size = 64\naov = [\"depth\", \"node\"]\nhash = true\nforce = false\nfov = 40.5";
        let found = flags(&["x", "render", "a.vox"], toml);
        let mut sorted = found.clone();
        sorted.sort();
        assert_eq!(
            sorted,
            ["--aov=depth,node", "--fov=40.5", "--hash", "--size=64"]
        );
    }

    #[test]
    fn the_command_line_comes_first() {
        let toml = "size = 64\neye = \"1,2,3\"\ntarget = \"0,0,0\"\nview = \"iso\"";
        assert_eq!(
            flags(&["x", "--size=8", "--zoom", "2"], toml),
            ["--view=iso"]
        );
        assert!(
            flags(&["x", "--size", "8", "--eye=0,0,1"], toml).contains(&"--target=0,0,0".into())
        );
        assert_eq!(flags(&["x", "--paper"], "cage = \"frame\""), [""; 0]);
    }

    #[test]
    fn the_flag_is_found_either_way() {
        let line = |words: &[&str]| words.iter().map(Into::into).collect::<Vec<OsString>>();
        assert_eq!(
            find_value(&line(&["x", "--config", "a"]), "config"),
            Some("a".into())
        );
        assert_eq!(
            find_value(&line(&["x", "--config=a"]), "config"),
            Some("a".into())
        );
        assert_eq!(
            find_value(&line(&["x", "--", "--config=a"]), "config"),
            None
        );
    }
}
