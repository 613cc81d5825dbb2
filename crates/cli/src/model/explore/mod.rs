//! `model --explore`: the best of many designs.

pub(super) mod args;
mod output;
mod results;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use serde_json::{Value, json};
use xxhash_rust::xxh3::xxh3_64;

use args::ExploreArgs;

use super::args::{ModelArgs, hardware_named};
use crate::console::Console;
use crate::document;
use crate::error::{CliError, Kind};
use crate::experiment::subjects;
use crate::report;
use results::ResultsFile;
use shiftvox::whole;
use shiftvox_lab::bench::Subject;
use shiftvox_lab::model::cost::Prices;
use shiftvox_lab::model::explore::front::{self, FrontPoint};
use shiftvox_lab::model::explore::lines::{PointLine, kind_first};
use shiftvox_lab::model::explore::space::{Point, SPACES, Space};
use shiftvox_lab::model::explore::{self, Explored};
use shiftvox_lab::rival::Rival;

struct Explorations {
    scene: String,
    all: usize,
    points: Vec<PointLine>,
    front: Vec<FrontPoint>,
}

pub(super) fn run(space: &str, args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    let told = ["space", "write one like those that --print-space prints"];
    let text = document::named_settings(space, &SPACES, Path::new(""), told)?;
    if args.explore.print_space {
        return console.data(text.trim_end());
    }
    let space = open_space(space, &text, args.hardware.hw.as_deref())?;
    let picked = picked(&args.explore, space.points())?;
    if args.hardware.print_hw {
        return print_hardware(&space, picked, console);
    }
    let has_bits = |point: Result<Point, _>| point.is_ok_and(|of| of.drawing.bits.is_some());
    if args.rules.bits.is_some() && has_bits(space.point(0)) {
        return Err(CliError::usage(
            "the space has a range of bits: leave --bits out",
        ));
    }
    super::output::check(args)?;
    let prices = args.hardware.prices()?;
    let rival = args.hardware.rival()?;
    let names = subjects::names_or(&args.scenes, &[subjects::BUNDLED]);
    let size = args.size.pair();
    let scene_args = args.rules.scene_args(&args.scene);
    let mut scenes: Vec<(Subject, Value)> = Vec::new();
    for name in &names {
        if scenes.iter().any(|(subject, _)| subject.name == *name) {
            return Err(CliError::usage(format!("{name}: a scene twice")));
        }
        let subject = subjects::open(name, &args.camera, &scene_args, size, console)?;
        let header = header(&subject, args, &space, (&prices, &rival));
        scenes.push((subject, header));
    }
    let headers: Vec<Value> = scenes.iter().map(|(_, header)| header.clone()).collect();
    let (mut file, mut recorded) = match &args.explore.results {
        None => (None, Default::default()),
        Some(path) => {
            let (file, recorded) = ResultsFile::open(path, &headers)?;
            let mut numbers = recorded.points.keys().map(|(_, number)| number);
            if let Some(stranger) = numbers.find(|&&number| number >= space.points()) {
                let told = format!("there is no point {stranger}");
                return Err(CliError::input(told).at(path.display()));
            }
            (Some(file), recorded)
        }
    };
    let options = args.setup_options();
    let mut found = Vec::new();
    for (subject, header) in &scenes {
        let name = &subject.name;
        let header = kind_first("space", header);
        if let Some(file) = file
            .as_mut()
            .filter(|_| recorded.scenes.insert(name.clone()))
        {
            file.append(&header)?;
        }
        console.line(&header)?;
        let known = recorded
            .points
            .range((name.clone(), 0)..=(name.clone(), usize::MAX));
        let known = known
            .map(|((_, number), line)| (*number, line.clone()))
            .collect();
        let explored = Explored {
            graph: &subject.graph,
            camera: &subject.camera,
            options: &options,
            overflow: args.rules.overflow(),
            rival: &rival,
            prices: &prices,
        };
        let of_space = (&space, picked.clone());
        let points = measure(explored, name, of_space, known, &mut file, console);
        let points = points.map_err(|error| error.at(name))?;
        found.push(Explorations {
            scene: name.clone(),
            all: space.points(),
            front: front::front(&points),
            points,
        });
    }
    output::write(&found, args, console)
}

fn open_space(name: &str, text: &str, hardware: Option<&str>) -> Result<Space, CliError> {
    // Descriptions are files beside the space; those of the command line are not.
    let folder = match hardware {
        Some(_) => Path::new(""),
        None => whole::folder_of(Path::new(name)),
    };
    let open = |name: &str| hardware_named(name, folder).map_err(|error| error.to_string());
    Space::from_toml(text, hardware, open).map_err(|error| CliError::input(error).at(name))
}

fn picked(args: &ExploreArgs, all: usize) -> Result<Range<usize>, CliError> {
    match &args.points {
        Some(points) if *points.end() >= all => Err(CliError::usage(format!(
            "--points: the space has points 0 to {}",
            all - 1
        ))),
        Some(points) => Ok(*points.start()..points.end() + 1),
        None => Ok(0..all),
    }
}

fn print_hardware(space: &Space, picked: Range<usize>, console: &Console) -> Result<(), CliError> {
    if picked.len() != 1 {
        let message = "--print-hw prints one hardware: say which with --points";
        return Err(CliError::usage(message));
    }
    let point = space.point(picked.start).map_err(CliError::input)?;
    let text = toml::to_string(&point.hardware).map_err(|e| CliError::new(Kind::Run, e))?;
    let bits = point.drawing.bits.map_or_else(String::new, |bits| {
        format!("# to be drawn with --bits {bits}\n")
    });
    let number = point.number;
    console.data(format!(
        "# Point {number}: {point}\n{bits}\n{}",
        text.trim_end()
    ))
}

/// The header of results, which must be equal for results to be reused.
fn header(
    subject: &Subject,
    args: &ModelArgs,
    space: &Space,
    (prices, rival): (&Prices, &Rival),
) -> Value {
    let graph = &subject.graph;
    let digest = |of: &[u8]| format!("{:016x}", xxh3_64(of));
    document::document(
        "explore",
        json!({
            "space": digest(format!("{space:?}").as_bytes()),
            "space_points": space.points(),
            "prices": digest(format!("{prices:?}").as_bytes()),
            "scene": {
                "name": subject.name,
                "voxels": graph.voxels,
                "nodes": graph.len(),
                "masks": digest(&graph.mask),
                "camera": report::camera(&subject.camera),
            },
            "width": args.size.width,
            "height": args.size.height,
            "options": format!("{:?}", args.setup_options()),
            "overflow": format!("{:?}", args.rules.overflow()),
            "rival": digest(format!("{rival:?}").as_bytes()),
        }),
    )
}

fn measure(
    explored: Explored<'_>,
    scene: &str,
    (space, picked): (&Space, Range<usize>),
    mut known: BTreeMap<usize, PointLine>,
    file: &mut Option<ResultsFile>,
    console: &Console,
) -> Result<Vec<PointLine>, CliError> {
    let wanted = picked.clone().filter(|number| !known.contains_key(number));
    let points = wanted.map(|number| space.point(number));
    let points = points
        .collect::<Result<Vec<Point>, _>>()
        .map_err(CliError::input)?;
    if points.len() < picked.len() {
        let there = picked.len() - points.len();
        console.note(format!("{scene}: {there} points are there already"));
    }
    let mut next = picked.start;
    let mut print_up_to = |known: &BTreeMap<usize, PointLine>, end: usize| {
        for line in known.range(next..end).map(|(_, line)| line) {
            console.line(&line.to_json())?;
        }
        next = end;
        Ok::<(), CliError>(())
    };
    if !points.is_empty() {
        let (known, print_up_to) = (&mut known, &mut print_up_to);
        explore::explore(explored, &points, console.progress(), |point, outcome| {
            let line = PointLine::new(scene, point, outcome);
            if let Some(file) = file {
                file.append(&line.to_json())?;
            }
            known.insert(point.number, line);
            print_up_to(known, point.number + 1)
        })?;
    }
    print_up_to(&known, picked.end)?;
    Ok(known.into_values().collect())
}
