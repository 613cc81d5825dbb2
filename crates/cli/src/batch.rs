//! The scenes of one call: files of folders, parts of a batch for several computers, failures that stop no others.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::console::{self, Console};
use super::error::{CliError, Kind};
use super::{outputs, scenes};
use shiftvox::scene::{FORMATS, Source};
use shiftvox::whole;

/// A scene, and the picture to write, if any.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) scene: String,
    pub(super) picture: Option<PathBuf>,
}

/// Every `of`-th picture, beginning with number `first` (from 0).
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    first: usize,
    of: usize,
}

/// `K/N`, with K from 1 to N.
pub(super) fn part(text: &str) -> Result<Part, String> {
    let numbers = text
        .split_once('/')
        .and_then(|(k, n)| Some((k.parse::<usize>().ok()?, n.parse::<usize>().ok()?)));
    match numbers {
        Some((k, of)) if (1..=of).contains(&k) => Ok(Part { first: k - 1, of }),
        _ => Err("expected K/N, such as 1/16 to 16/16".to_owned()),
    }
}

/// The scenes of a call and their pictures, in order. Without `output` a picture is `{stem}.png` if one `is_needed`,
/// otherwise none. Errors: no scene in a folder, two scenes of one picture, a name that cannot be a picture's.
pub(super) fn jobs(
    names: &[String],
    output: Option<&Path>,
    is_needed: bool,
    part: Option<Part>,
) -> Result<Vec<Job>, CliError> {
    let mut all = Vec::new();
    for name in names {
        match !Source::is_generated(name) && Path::new(name).is_dir() {
            true if output.is_none() && is_needed => {
                let error =
                    CliError::usage(format!("{name}: no folder for the pictures was given"));
                return Err(error.advise("name it with -o FOLDER/"));
            }
            true => all.extend(files(name)?),
            false => all.push(name.clone()),
        }
    }
    let pattern = match output {
        Some(path) if is_folder(path) => Some(path.join("{stem}.png")),
        None if is_needed => Some(PathBuf::from("{stem}.png")),
        other => other.map(Path::to_owned),
    };
    let Some(pattern) = pattern else {
        let bare = |scene| Job {
            scene,
            picture: None,
        };
        return Ok(taken(part, all.into_iter().map(bare).collect()));
    };
    outputs::check_picture_name(&pattern)?;
    let pattern = outputs::check_text(&pattern)?;
    if all.len() > 1 && !pattern.contains("{stem}") {
        let names = match &all[..] {
            [one, other] => format!("{one} and {other}"),
            _ => format!("{} scenes", all.len()),
        };
        let message = format!("{pattern}: {names} would be written to one file");
        let advice = "name a folder with -o FOLDER/, or put {stem} into the name";
        return Err(CliError::usage(message).advise(advice));
    }
    let folder = whole::folder_of(Path::new(pattern));
    if !folder.to_string_lossy().contains("{stem}") {
        whole::check_folder(folder)?;
    }
    let named = |name: &str| PathBuf::from(pattern.replace("{stem}", name));
    let mut stems = HashMap::new();
    for scene in &all {
        *stems.entry(scenes::stem(scene)).or_insert(0) += 1;
    }
    let mut pictures = HashSet::new();
    let mut jobs = Vec::new();
    for scene in all {
        let stem = scenes::stem(&scene);
        // `a.obj` and `a.vox` both keep their endings: a picture `a.png` may be of an earlier call, and of either.
        let picture = match Path::new(&scene).file_name() {
            Some(name) if stems[&stem] > 1 => named(&name.to_string_lossy()),
            _ => named(&stem),
        };
        if !pictures.insert(picture.clone()) {
            let message = format!("two scenes would both be drawn to {}", picture.display());
            let advice = "draw them into different folders, one after the other";
            return Err(CliError::usage(message).advise(advice));
        }
        let picture = Some(picture);
        jobs.push(Job { scene, picture });
    }
    Ok(taken(part, jobs))
}

/// Reports what is made of each scene, as `command`. A scene that fails is reported and does not stop the others.
pub(super) fn each<S>(
    command: &str,
    scenes: &[S],
    name: fn(&S) -> &str,
    console: &Console,
    of_one: impl Fn(&S) -> Result<Value, CliError>,
) -> Result<(), CliError> {
    let mut results = Vec::new();
    let mut failures = Vec::new();
    for scene in scenes {
        match of_one(scene) {
            Ok(result) => results.push(result),
            Err(error) if scenes.len() == 1 || error.kind == Kind::Pipe => return Err(error),
            Err(error) => {
                console::report_error(&error);
                failures.push(error.kind);
                results.push(json!({ "scene": name(scene), "error": error.message }));
            }
        }
    }
    let is_left_out = |result: &&Value| result["is_left_out"] == true;
    let left_out = results.iter().filter(is_left_out).count();
    if left_out > 0 {
        let drawn = scenes.len() - left_out - failures.len();
        console.note(format!(
            "{drawn} drawn, {left_out} left out because their pictures exist"
        ));
    }
    console.report(command, json!({ "scenes": results }));
    match failures.first() {
        None => Ok(()),
        Some(&first) => {
            let (failed, all) = (failures.len(), scenes.len());
            let message = format!("{failed} of {all} scenes failed; see above");
            Err(CliError::new(first, message))
        }
    }
}

fn taken(part: Option<Part>, jobs: Vec<Job>) -> Vec<Job> {
    let Part { first, of } = part.unwrap_or(Part { first: 0, of: 1 });
    jobs.into_iter().skip(first).step_by(of).collect()
}

fn is_folder(path: &Path) -> bool {
    path.as_os_str()
        .to_string_lossy()
        .ends_with(['/', std::path::MAIN_SEPARATOR])
        || path.is_dir()
}

/// The files of a folder whose names end like a format's, without hidden ones, sorted by name.
fn files(folder: &str) -> Result<Vec<String>, CliError> {
    let failed = |error| CliError::input(format!("{folder}: {error}"));
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        // A name that is not UTF-8 is not found later, like a file that has been removed.
        let name = path.to_string_lossy().into_owned();
        let is_scene = |name: &str| FORMATS.iter().any(|format| name.ends_with(format.ending));
        let is_hidden = path
            .file_name()
            .is_some_and(|of| of.to_string_lossy().starts_with('.'));
        // A link to nothing is a scene that fails.
        let is_file = path.is_file() || fs::metadata(&path).is_err();
        if is_scene(&name.to_lowercase()) && !is_hidden && is_file {
            found.push(name);
        }
    }
    found.sort();
    match found.is_empty() {
        false => Ok(found),
        true => Err(
            CliError::input(format!("{folder}: no file here has the ending of a format"))
                .advise("`shiftvox --help` lists the formats"),
        ),
    }
}
