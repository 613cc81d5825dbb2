//! Flags of the commands `render` and `model` behind a page's request. They are parsed as on the command line, so that
//! the printed command draws the page's picture.

use clap::parser::ValueSource;
use clap::{ArgMatches, Parser};
use glam::DVec3;
use shiftvox::graph::Crop;
use shiftvox::project::Camera;
use shiftvox_view::{FLAGS, Flags, Request};

use crate::args::{EngineArgs, PictureArgs};
use crate::error::CliError;

pub(super) const MODEL_FLAGS: &str = "bits cage coverage frac lod overflow tolerance";

#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
pub(super) struct Settings {
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
    #[arg(long, allow_hyphen_values = true)]
    pub(super) crop: Option<Crop>,
}

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
    let camera = request.camera.as_ref()?;
    let (points, fov_degrees) = camera.numbers();
    let [eye, target, up] = points.map(DVec3::from_array);
    Some(Camera {
        eye,
        target,
        up,
        fov_degrees,
        ortho: camera.ortho,
        width: request.size[0],
        height: request.size[1],
    })
}

const SCENE_FLAGS: &str = "depth mesh-colors mesh-up opacities voxel-size";

/// Flags of a list that the command line of `view` has, with their values.
fn given<'m>(
    matches: &'m ArgMatches,
    flags: &'static str,
) -> impl Iterator<Item = (&'m str, String)> {
    flags.split(' ').filter_map(|name| {
        let id = name.replace('-', "_");
        let is_given = matches.value_source(&id) == Some(ValueSource::CommandLine);
        let value = matches.get_raw(&id).filter(|_| is_given)?.next()?;
        Some((name, value.to_string_lossy().into_owned()))
    })
}

pub(super) fn first(matches: &ArgMatches) -> Flags {
    let paper = [
        ("cage", "corners"),
        ("tolerance", "inf"),
        ("coverage", "any"),
    ];
    let paper = paper.into_iter().filter(|_| matches.get_flag("paper"));
    let paper = paper.map(|(name, value)| (name, value.to_owned()));
    let first = given(matches, FLAGS).chain(paper);
    first
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

pub(super) fn scene_words(matches: &ArgMatches) -> Vec<String> {
    let word = |(name, value): (&str, String)| match name {
        "opacities" => format!("--{name}"),
        name => format!("--{name}={value}"),
    };
    given(matches, SCENE_FLAGS).map(word).collect()
}
