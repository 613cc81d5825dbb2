//! What a page may ask, and the flags of `render` that it means.
//!
//! A page names scenes by their place in the list, and settings by a few flags of `render`. They
//! are read as on the command line, so that the command that a page is given draws its picture.

use std::collections::BTreeMap;
use std::ffi::OsString;

use clap::Parser;
use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::ViewArgs;
use crate::args::{EngineArgs, EngineName, PictureArgs, SceneArgs, Setting, camera_line};
use crate::error::{CliError, Kind};
use crate::names;
use shiftvox::picture::Buffer;
use shiftvox::project::Camera;

/// Most pixels of a picture: 2048 x 2048.
pub(super) const MOST_PIXELS: u64 = 1 << 22;
/// Most samples of a picture: 16 a pixel at 1024 x 1024.
pub(super) const MOST_SAMPLES: u64 = 1 << 24;
/// Longer side of the pictures that the hardware model draws: larger ones take it many seconds.
pub(super) const MODEL_SIDE: u32 = 256;
/// Most letters of a flag's value.
const MOST_LETTERS: usize = 24;

/// Flags of `render` that a page may set. None of them names a file.
const FLAGS: [&str; 14] = [
    "background",
    "bits",
    "cage",
    "coverage",
    "engine",
    "erosion",
    "erosion-grid",
    "far-opacity",
    "frac",
    "isa",
    "lod",
    "overflow",
    "shade",
    "tolerance",
];
/// Those that `model` has too.
const MODEL_FLAGS: [&str; 7] = [
    "bits",
    "cage",
    "coverage",
    "frac",
    "lod",
    "overflow",
    "tolerance",
];

/// Flags by their long names.
pub(super) type Flags = BTreeMap<String, String>;

/// A question.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Request {
    /// The page's own number, which the answer repeats.
    pub(super) seq: u64,
    pub(super) ask: Ask,
    /// Place in the list of scenes.
    pub(super) scene: usize,
    /// Pixels across and down.
    size: [u32; 2],
    /// Samples per pixel and axis.
    aa: u32,
    /// `None`: the one that is fitted to the scene.
    #[serde(default)]
    camera: Option<Standpoint>,
    #[serde(default)]
    pub(super) flags: Flags,
    #[serde(default)]
    pub(super) show: Show,
    /// Whether the picture's hash is wanted.
    #[serde(default)]
    pub(super) hash: bool,
    /// Whether the picture comes as a PNG file, and not as plain bytes.
    #[serde(default)]
    pub(super) png: bool,
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Ask {
    /// A picture.
    Picture,
    /// Figures of the hardware model.
    Figures,
}

/// What a picture shows of its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Show {
    #[default]
    Color,
    Records,
    Level,
    Depth,
    Normal,
}

impl Show {
    /// The buffer of `render` that holds it, beside the colours.
    pub(super) fn buffer(self) -> Option<Buffer> {
        match self {
            Self::Color => None,
            Self::Records => Some(Buffer::Records),
            Self::Level => Some(Buffer::Voxel),
            Self::Depth => Some(Buffer::Depth),
            Self::Normal => Some(Buffer::Normal),
        }
    }
}

/// A placed camera. A number that JSON does not have (infinity, none) comes as `null`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Standpoint {
    eye: [Option<f64>; 3],
    target: [Option<f64>; 3],
    up: [Option<f64>; 3],
    fov: Option<f64>,
}

/// What a picture is drawn with.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
pub(super) struct Settings {
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
}

/// Refuses a picture of so many samples a pixel across that is too large for a page.
fn check_size((width, height): (u32, u32), aa: u32) -> Result<(), CliError> {
    let pixels = u64::from(width) * u64::from(height);
    let samples = pixels.saturating_mul(u64::from(aa).pow(2));
    if pixels <= MOST_PIXELS && samples <= MOST_SAMPLES {
        return Ok(());
    }
    Err(CliError::new(
        Kind::Limit,
        format!("a page's picture has at most {MOST_PIXELS} pixels and {MOST_SAMPLES} samples"),
    ))
}

/// Refuses what the command line would have a page begin with, if that is too large. A size that follows the window
/// is made small enough there.
///
/// # Errors
/// A picture that is too large.
pub(super) fn check_first(picture: &PictureArgs) -> Result<(), CliError> {
    match picture.size {
        Some(size) => check_size((size.width, size.height), 1 << picture.aa_log2()),
        None => Ok(()),
    }
}

impl Request {
    /// Reads a message.
    ///
    /// # Errors
    /// When it is none that a page sends.
    pub(super) fn read(message: &str) -> Result<Self, CliError> {
        serde_json::from_str(message)
            .map_err(|error| CliError::input(format!("this message is not understood: {error}")))
    }

    /// The flags of `render`, read as on the command line.
    ///
    /// # Errors
    /// Flags that a page may not set, wrong values, or a picture that is too large.
    pub(super) fn settings(&self) -> Result<Settings, CliError> {
        for (name, value) in &self.flags {
            if !FLAGS.contains(&name.as_str()) {
                return Err(CliError::usage("a page may not set this flag"));
            }
            let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "+-.,".contains(letter);
            if value.len() > MOST_LETTERS || !value.chars().all(is_plain) {
                return Err(CliError::usage(format!("--{name} has no such value")));
            }
        }
        let [width, height] = self.size;
        check_size((width, height), self.aa)?;
        let mut words: Vec<String> = self.words(&FLAGS).collect();
        words.push(format!("--size={width}x{height}"));
        words.push(format!("--aa={}", self.aa));
        words.extend(
            self.show
                .buffer()
                .map(|buffer| format!("--aov={}", buffer.name())),
        );
        Settings::try_parse_from(words).map_err(CliError::of_words)
    }

    /// The flags that are set, of these.
    fn words(&self, of: &[&str]) -> impl Iterator<Item = String> {
        let flags = self.flags.iter();
        let flags = flags.filter(|(name, _)| of.contains(&name.as_str()));
        flags.map(|(name, value)| format!("--{name}={value}"))
    }

    /// The flags of `model`.
    pub(super) fn model_words(&self) -> impl Iterator<Item = OsString> {
        self.words(&MODEL_FLAGS).map(OsString::from)
    }

    /// The camera that is asked for, if one is. Whether it sees anything is found when it draws.
    pub(super) fn camera(&self) -> Option<Camera> {
        let place = self.camera.as_ref()?;
        let number = |number: Option<f64>| number.unwrap_or(f64::NAN);
        let point = |point: [Option<f64>; 3]| DVec3::from_array(point.map(number));
        Some(Camera {
            eye: point(place.eye),
            target: point(place.target),
            up: point(place.up),
            fov_degrees: number(place.fov),
            width: self.size[0],
            height: self.size[1],
        })
    }

    /// The command that draws the picture.
    pub(super) fn render_command(&self, scene: &str, args: &SceneArgs, camera: &Camera) -> String {
        let [width, height] = self.size;
        let aa = (self.aa != 1).then(|| format!("--aa={}", self.aa));
        let mut words = vec!["shiftvox render".to_owned(), quoted(scene)];
        words.extend(scene_words(args).chain(self.words(&FLAGS)).chain(aa));
        words.push(format!("--size={width}x{height}"));
        words.push(camera_line(camera));
        words.push("-o picture.png".to_owned());
        words.join(" ")
    }

    /// The command that finds the figures.
    pub(super) fn model_command(&self, scene: &str, args: &SceneArgs, camera: &Camera) -> String {
        let mut words = vec!["shiftvox model".to_owned(), quoted(scene)];
        words.extend(scene_words(args).chain(self.words(&MODEL_FLAGS)));
        words.push(format!("--size={}x{}", camera.width, camera.height));
        words.push(camera_line(camera));
        words.join(" ")
    }
}

/// The flags of the command line that pages begin with.
pub(super) fn first_flags(args: &ViewArgs) -> Flags {
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
        .filter(|(name, _)| given.contains(name) && FLAGS.contains(name))
        .map(|(name, value)| (name.to_owned(), text(&value)))
        .collect()
}

/// A setting's value as flags have it.
fn text(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        // The shortest: 2, and not 2.0.
        toml::Value::Float(number) => number.to_string(),
        other => other.to_string(),
    }
}

/// The flags with which scenes were read.
fn scene_words(args: &SceneArgs) -> impl Iterator<Item = String> {
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

/// A scene's name as a shell takes it.
fn quoted(name: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+:,=".contains(letter);
    if !name.is_empty() && !name.starts_with('-') && name.chars().all(is_plain) {
        return name.to_owned();
    }
    let is_text = |letter: char| names::byte_of(letter).is_none() && !letter.is_control();
    if name.chars().all(is_text) {
        let begin = if name.starts_with('-') { "./" } else { "" };
        return format!("'{begin}{}'", name.replace('\'', r"'\''"));
    }
    // Bytes that are no text, as bash and zsh take them.
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

    fn request(flags: &str) -> Result<Request, CliError> {
        Request::read(&format!(
            r#"{{"seq":1,"ask":"picture","scene":0,"size":[64,32],"aa":2,"flags":{flags}}}"#
        ))
    }

    #[test]
    fn flags_are_those_of_the_command_line() {
        let settings = request(r#"{"coverage":"any","lod":"2"}"#).unwrap();
        let settings = settings.settings().unwrap();
        assert_eq!(settings.engine.given(), ["coverage"]);
        assert_eq!(settings.engine.rules.lod, Some(2.0));
        assert_eq!(settings.picture.aa_log2(), 1);
        assert_eq!(settings.picture.size(), (64, 32));
        for wrong in [
            r#"{"output":"a.png"}"#,
            r#"{"config":"a.toml"}"#,
            r#"{"coverage":"/etc/passwd"}"#,
            r#"{"coverage":"some"}"#,
            r#"{"lod":"1 --outdir=x"}"#,
            r#"{"bits":"-3"}"#,
        ] {
            assert!(request(wrong).unwrap().settings().is_err(), "{wrong}");
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
