//! Flags of the commands `render` and `model` behind a page's request.
//!
//! Flags are parsed as on the command line, so that the printed command draws the page's picture.

use clap::Parser;
use glam::DVec3;
use shiftvox::project::Camera;
use shiftvox_view::{FLAGS, Flags, Request};

use super::ViewArgs;
use crate::args::{EngineArgs, EngineName, PictureArgs, SceneArgs, Setting};
use crate::error::CliError;
use crate::names;

/// The flags of a page that `model` has, too.
pub(super) const MODEL_FLAGS: &str = "bits cage coverage frac lod overflow tolerance";

/// The settings of a picture.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
pub(super) struct Settings {
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
}

/// Parses a request as flags of `render`.
///
/// # Errors
/// Values that a flag does not have.
pub(super) fn settings(request: &Request) -> Result<Settings, CliError> {
    let [width, height] = request.size;
    let mut words: Vec<String> = request.words(FLAGS).collect();
    words.push(format!("--size={width}x{height}"));
    words.push(format!("--aa={}", request.aa));
    let show = request.show.iter().filter(|show| *show != "color");
    words.extend(show.map(|show| format!("--aov={show}")));
    Settings::try_parse_from(words).map_err(CliError::of_words)
}

/// The camera of a request, if it has one. Drawing rejects cameras that see nothing.
pub(super) fn camera(request: &Request) -> Option<Camera> {
    let place = request.camera.as_ref()?;
    let number = |number: Option<f64>| number.unwrap_or(f64::NAN);
    let point = |point: [Option<f64>; 3]| DVec3::from_array(point.map(number));
    Some(Camera {
        eye: point(place.eye),
        target: point(place.target),
        up: point(place.up),
        fov_degrees: number(place.fov),
        width: request.size[0],
        height: request.size[1],
    })
}

/// The flags of `shiftvox view` with which pages begin.
pub(super) fn first(args: &ViewArgs) -> Flags {
    let EngineArgs { engine, rules, .. } = &args.engine;
    let mut given = args.engine.given();
    if rules.paper {
        given.extend(["cage", "tolerance", "coverage"]);
    }
    given.extend(rules.lod.map(|_| "lod"));
    given.extend(engine.map(|_| "engine"));
    let first = PictureArgs::default();
    given.extend((args.picture.shade != first.shade).then_some("shade"));
    given.extend(args.picture.background.map(|_| "background"));
    let engines = [EngineName::Far, EngineName::Textured, EngineName::Fast];
    let engines = engines.into_iter().chain(*engine);
    let settings = engines.flat_map(|engine| args.engine.settings(Some(engine)));
    settings
        .chain(args.picture.settings())
        .filter(|(name, _)| given.contains(name) && FLAGS.split(' ').any(|flag| flag == *name))
        .map(|(name, value)| (name.to_owned(), text(&value)))
        .collect()
}

/// A setting's value as a flag has it.
fn text(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        // The shortest: 2, and not 2.0.
        toml::Value::Float(number) => number.to_string(),
        other => other.to_string(),
    }
}

/// The flags with which scenes were read.
pub(super) fn scene_words(args: &SceneArgs) -> impl Iterator<Item = String> {
    let mut given: Vec<&str> = args.given().collect();
    given.extend(args.mesh_up.map(|_| "mesh-up"));
    let settings = args.settings().into_iter();
    settings
        .filter(move |(name, _)| given.contains(name))
        .map(|(name, value): Setting| match value {
            toml::Value::Boolean(_) => format!("--{name}"),
            value => format!("--{name}={}", text(&value)),
        })
}

/// A scene's name, quoted for a shell.
pub(super) fn quoted(name: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+:,=".contains(letter);
    if !name.is_empty() && !name.starts_with('-') && name.chars().all(is_plain) {
        return name.to_owned();
    }
    let is_text = |letter: char| names::byte_of(letter).is_none() && !letter.is_control();
    if name.chars().all(is_text) {
        let begin = if name.starts_with('-') { "./" } else { "" };
        return format!("'{begin}{}'", name.replace('\'', r"'\''"));
    }
    // Bytes that are not text, as bash and zsh read them.
    let mut words = String::from("$'");
    for letter in name.chars() {
        match names::byte_of(letter) {
            Some(byte) => words.push_str(&format!("\\x{byte:02x}")),
            None if letter.is_control() || letter == '\'' || letter == '\\' => {
                words.push_str(&format!("\\x{:02x}", u32::from(letter)));
            }
            None => words.push(letter),
        }
    }
    words + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(flags: &str) -> Request {
        let message = format!(
            r#"{{"seq":1,"ask":"picture","scene":0,"size":[64,32],"aa":2,"flags":{flags}}}"#
        );
        serde_json::from_str(&message).unwrap()
    }

    #[test]
    fn flags_are_those_of_the_command_line() {
        let settings = settings(&request(r#"{"coverage":"any","lod":"2"}"#)).unwrap();
        assert_eq!(settings.engine.given(), ["coverage"]);
        assert_eq!(settings.engine.rules.lod, Some(2.0));
        assert_eq!(settings.picture.aa_log2(), 1);
        assert_eq!(settings.picture.size(), (64, 32));
        for wrong in [r#"{"coverage":"some"}"#, r#"{"bits":"-3"}"#] {
            assert!(super::settings(&request(wrong)).is_err(), "{wrong}");
        }
    }

    #[test]
    fn names_come_through_a_shell() {
        assert_eq!(quoted("a/b.vox"), "a/b.vox");
        assert_eq!(quoted("gen:menger,depth=3"), "gen:menger,depth=3");
        assert_eq!(quoted("it's $HOME.vox"), r"'it'\''s $HOME.vox'");
        assert_eq!(quoted("-o.vox"), "'./-o.vox'");
        assert_eq!(quoted("\u{10ffff}'\n.vox"), r"$'\xff\x27\x0a.vox'");
    }
}
