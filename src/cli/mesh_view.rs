//! What methods of meshes share on the command line: reading a mesh, telling
//! files by their beginning, camera, background, times, hash, files.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use serde_json::{Value, json};

use super::args::{Aov, DataBudget, EngineArgs, EngineName, PictureArgs, SceneArgs, camera_line};
use super::console::Console;
use super::drawing::{check_samples, milliseconds_since, min_median_max};
use super::error::{CliError, Kind};
use super::fit::{Bounds, Up};
use super::render::RenderArgs;
use super::report::{self, grouped};
use super::{far, outputs, scenes, textured};
use crate::graph::file::FileError;
use crate::lab::mesh_view::view_of;
use crate::mesh::Mesh;
use crate::mesh::raster::View;
use crate::picture::png::Pixels;
use crate::picture::{self, Background, Picture};
use crate::project::Camera;

impl From<FileError> for CliError {
    fn from(error: FileError) -> Self {
        Self::new(Kind::Input, error)
    }
}

/// The camera as the rasteriser wants it, for something within a box.
pub(super) fn view(camera: &Camera, bounds: (DVec3, DVec3)) -> Result<View, CliError> {
    view_of(camera, bounds).map_err(CliError::usage)
}

/// What is behind, sRGB, if anything.
pub(super) fn background(given: Option<Background>) -> Option<[u8; 3]> {
    match given.unwrap_or_default() {
        Background::None => None,
        Background::Color(color) => Some(color),
    }
}

/// Reads a mesh and tells its warnings; and which axis is up, for fitted cameras.
pub(super) fn open(
    name: &str,
    args: &SceneArgs,
    console: &Console,
) -> Result<(Mesh, Up), CliError> {
    let (mesh, up) = scenes::open_mesh(name, args, console.progress())?;
    for warning in mesh.warnings() {
        console.note(format!("{name}: {warning}"));
    }
    Ok((mesh, up))
}

/// Whether a file can be read and its first eight bytes are as they should be.
pub(super) fn begins(name: &str, is_right: impl Fn(&[u8]) -> bool) -> bool {
    let mut beginning = [0; 8];
    let read = File::open(name).and_then(|mut file| file.read_exact(&mut beginning));
    read.is_ok() && is_right(&beginning)
}

/// What a mesh's file is drawn with.
#[derive(Clone, Copy)]
pub(super) struct DrawArgs<'a> {
    pub(super) engine: &'a EngineArgs,
    pub(super) picture: &'a PictureArgs,
    pub(super) scene: &'a SceneArgs,
    /// Of far voxels: how much of the nodes' data may be in memory.
    pub(super) memory: Option<DataBudget>,
}

/// A picture of a file, and what was counted for it.
pub(super) type Counted = (Picture, Vec<(&'static str, Value)>);

/// An open file that an engine of its own draws.
pub(super) trait MeshFile {
    /// The box and what is in it, for a fitted camera.
    fn bounds(&self) -> Bounds;

    /// Which axis is up, as the file says.
    fn up(&self) -> Up;

    /// Draws a frame.
    fn draw(&mut self, camera: &Camera) -> Result<Counted, CliError>;

    /// What a budget of memory came to, null without one; `None` of what has no budgets.
    fn memory(&self) -> Option<Value>;
}

/// What is done with an open file.
pub(super) type Use<'u> = &'u mut dyn FnMut(&mut dyn MeshFile) -> Result<(), CliError>;

/// An engine that draws one kind of file and nothing else draws.
pub(super) struct FileEngine {
    pub(super) engine: EngineName,
    /// As flags name it.
    pub(super) name: &'static str,
    /// The ending of its files, with the dot.
    pub(super) ending: &'static str,
    /// Buffers that it has beside the picture, two or more.
    pub(super) buffers: &'static [Aov],
    /// Flags that it follows of those that not every engine does.
    pub(super) flags: &'static [&'static str],
    /// Whether a name is that of such a file, told by its content.
    pub(super) is_file: fn(&str) -> bool,
    /// Opens a file and hands it on.
    pub(super) with_file: fn(&Path, DrawArgs<'_>, Use<'_>) -> Result<(), CliError>,
}

const ENGINES: [&FileEngine; 2] = [&far::ENGINE, &textured::ENGINE];

/// The engine of a scene, where that is a file of a mesh method or such an engine is asked for.
pub(super) fn engine_of(name: &str, asked: Option<EngineName>) -> Option<&'static FileEngine> {
    let is_named = |engine: &&FileEngine| Some(engine.engine) == asked;
    let is_its = |engine: &&FileEngine| (engine.is_file)(name);
    let named = ENGINES.into_iter().find(is_named);
    named.or_else(|| ENGINES.into_iter().find(is_its))
}

/// Why a scene could not be opened, unless it is a file that only an engine of its own draws.
pub(super) fn or_own_file(name: &str, error: CliError) -> CliError {
    let Some(engine) = ENGINES.into_iter().find(|engine| (engine.is_file)(name)) else {
        return error;
    };
    let FileEngine { ending, .. } = engine;
    let message =
        format!("{name}: this is a {ending} file: render and turntable draw it, info tells of it");
    CliError::input(message).advise("for anything else take the mesh that it was made of")
}

/// The engine that draws all of these scenes, unless they have different ones.
pub(super) fn one_engine(names: &[String], asked: Option<EngineName>) -> Option<EngineName> {
    let mut engines = names.iter().map(|name| {
        let of_file = engine_of(name, asked).map(|engine| engine.engine);
        of_file.unwrap_or_else(|| asked.unwrap_or_default())
    });
    let first = engines.next()?;
    engines.all(|engine| engine == first).then_some(first)
}

impl FileEngine {
    /// Opens a scene that it draws: after asking whether it does, and does all that is wanted.
    pub(super) fn open(
        &self,
        scene: &str,
        args: DrawArgs<'_>,
        then: Use<'_>,
    ) -> Result<(), CliError> {
        let Self { name, ending, .. } = self;
        if args.engine.engine.is_some_and(|asked| asked != self.engine) {
            let message = format!("{scene}: this is a {ending} file");
            let advice = format!("draw it with --engine {name}, or name no engine");
            return Err(CliError::usage(message).advise(advice));
        }
        if !(self.is_file)(scene) {
            // A file that is not there, or is something else, is told as such.
            let refused = (self.with_file)(Path::new(scene), args, &mut |_| Ok(()));
            return refused.map_err(|error| {
                error.advise(format!(
                    "--engine {name} draws {ending} files: shiftvox convert MESH OUT{ending}"
                ))
            });
        }
        let mut given = args.engine.given();
        given.extend(args.scene.of_meshes());
        if let Some(idle) = given.iter().find(|flag| !self.flags.contains(flag)) {
            let message = format!("{scene}: --{idle} changes nothing of a {ending} file");
            return Err(CliError::usage(message).advise("leave it out"));
        }
        let unknown = |aov: &&Aov| !self.buffers.contains(aov);
        if let Some(unknown) = args.picture.aov.iter().find(unknown) {
            let mut known: Vec<&str> = self.buffers.iter().map(|aov| aov.name()).collect();
            let last = known.pop().unwrap_or_default();
            let message = format!("{scene}: --engine {name} has no --aov {}", unknown.name());
            return Err(
                CliError::usage(message).advise(format!("it has {} and {last}", known.join(", ")))
            );
        }
        check_samples(args.picture.size(), args.picture.aa_log2())?;
        (self.with_file)(Path::new(scene), args, then)
    }

    /// Draws a picture of a scene, as `render` does: `of` is the number of scenes.
    pub(super) fn render_one(
        &self,
        args: &RenderArgs,
        name: &str,
        of: usize,
        output: Option<&Path>,
        console: &Console,
    ) -> Result<(Camera, Value), CliError> {
        let draw_args = DrawArgs {
            engine: &args.engine,
            picture: &args.picture,
            scene: &args.scene,
            memory: args.memory,
        };
        let started = Instant::now();
        let mut result = Err(CliError::new(Kind::Run, "nothing was drawn"));
        self.open(name, draw_args, &mut |file| {
            let load_ms = milliseconds_since(started);
            if let Some(path) = output {
                outputs::check_free(&outputs::paths(path, &args.picture.aov), args.out.force)?;
            }
            let up = args.scene.up_or(file.up());
            let size = args.picture.size();
            let camera = args.camera.camera(&file.bounds(), up, size, 0.0);
            let ((picture, counters), times_ms) = repeated(args.repeat, || file.draw(&camera))?;
            let drawn = MeshDrawn {
                name,
                engine: self.name,
                camera: &camera,
                picture: &picture,
                load_ms,
                times_ms: &times_ms,
                counters,
                memory: file.memory(),
            };
            result = drawn
                .finish(args, of, output, console)
                .map(|told| (camera, told));
            Ok(())
        })?;
        result
    }
}

/// Draws a frame so many times; the last one, and how long each took, milliseconds.
fn repeated<T>(
    times: u32,
    mut draw: impl FnMut() -> Result<T, CliError>,
) -> Result<(T, Vec<f64>), CliError> {
    let mut times_ms = Vec::new();
    loop {
        let started = Instant::now();
        let drawn = draw()?;
        times_ms.push(milliseconds_since(started));
        if times_ms.len() >= times as usize {
            return Ok((drawn, times_ms));
        }
    }
}

/// A picture that was drawn without the voxel engines, and what it took.
pub(super) struct MeshDrawn<'d> {
    pub(super) name: &'d str,
    pub(super) engine: &'static str,
    pub(super) camera: &'d Camera,
    pub(super) picture: &'d Picture,
    pub(super) load_ms: f64,
    pub(super) times_ms: &'d [f64],
    pub(super) counters: Vec<(&'static str, Value)>,
    /// What a budget of memory came to, null without one; `None` of what has no budgets.
    pub(super) memory: Option<Value>,
}

impl MeshDrawn<'_> {
    /// Writes the picture and says what is asked for: `of` is the number of scenes.
    pub(super) fn finish(
        &self,
        args: &RenderArgs,
        of: usize,
        output: Option<&Path>,
        console: &Console,
    ) -> Result<Value, CliError> {
        let Self { name, picture, .. } = self;
        if args.print_camera && !console.json {
            console.data(camera_line(self.camera))?;
        }
        let hash = picture::hash(picture);
        if args.hash && !console.json {
            console.data(if of > 1 {
                format!("{hash}  {name}")
            } else {
                hash.clone()
            })?;
        }
        if let Some(path) = output {
            let pixels = Pixels::new(picture.width, picture.height, picture.rgba.clone());
            outputs::write(&pixels, *picture, path, &args.picture.aov, args.out.force)?;
        }
        let (min, median, max) = min_median_max(self.times_ms);
        if args.repeat > 1 && !console.json {
            let times = [("min ms", min), ("median ms", median), ("max ms", max)];
            let times = times.map(|(name, ms)| vec![name.to_owned(), format!("{ms:.3}")]);
            let counted = self.counters.iter();
            let counted = counted.map(|(name, count)| vec![(*name).to_owned(), told(count)]);
            let rows = times.into_iter().chain(counted).collect();
            let head = vec![(*name).to_owned(), "one frame".to_owned()];
            console.data(report::table(head, rows))?;
        }
        if let Some(path) = output {
            console.note(format!("{}: drawn in {median:.1} ms", path.display()));
        }
        for (name, count) in &self.counters {
            console.detail(format!("  {name}: {}", told(count)));
        }
        if let Some(expected) = &args.expect_hash
            && !expected.eq_ignore_ascii_case(&hash)
        {
            return Err(CliError::new(
                Kind::Failed,
                format!("{name}: the picture's hash is {hash}, expected {expected}"),
            ));
        }
        let mut result = self.describe(Some(&hash));
        result["output"] = json!(output);
        Ok(result)
    }

    /// What was drawn, as JSON.
    pub(super) fn describe(&self, hash: Option<&str>) -> Value {
        let Self { name, picture, .. } = self;
        let (min, median, max) = min_median_max(self.times_ms);
        let counters = self.counters.iter();
        let counters: serde_json::Map<String, Value> = counters
            .map(|(name, count)| ((*name).to_owned(), count.clone()))
            .collect();
        let mut result = json!({
            "scene": name,
            "engine": self.engine,
            "width": picture.width,
            "height": picture.height,
            "pixels_drawn": picture.drawn(),
            "camera": report::camera(self.camera),
            "load_ms": self.load_ms,
            "render_ms": { "runs": self.times_ms.len(), "min": min, "median": median, "max": max },
            "counters": counters,
            "hash": hash,
        });
        if let Some(memory) = &self.memory {
            result["memory"] = memory.clone();
        }
        result
    }
}

fn told(count: &Value) -> String {
    count.as_u64().map_or_else(|| count.to_string(), grouped)
}
