//! The registry of drawing methods: which one draws a scene, and which flags it follows.

use std::path::Path;
use std::time::Instant;

use clap::Args;

use super::args::{CameraArgs, EngineArgs, EngineName, PictureArgs, SceneArgs};
use super::console::Console;
use super::engines;
use super::error::{CliError, Kind};
use super::fatal_signals;
use super::scenes::{self, Scene};
use shiftvox::drawing::{Drawable, GraphDrawing, GraphStyle, Shown, milliseconds_since};
use shiftvox::graph::{Crop, Graph, Silent};
use shiftvox::picture::{self, Buffer};
use shiftvox::project::{Camera, Stop, Up};
use shiftvox::scene::{FileKind, OpenOptions, Source};
use shiftvox_mesh::drawing::{FarStyle, TexturedStyle, of_far, of_textured};
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::textured::TexturedFile;
use shiftvox_mesh::textured::view::Erosion;

/// The flags of all commands that draw.
#[derive(Debug, Default, Args)]
pub(super) struct DrawFlags {
    #[command(flatten)]
    pub(super) camera: CameraArgs,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
}

impl DrawFlags {
    pub(super) fn draw_args(&self, memory: Option<u64>, is_hashed: bool) -> DrawArgs<'_> {
        DrawArgs {
            engine: &self.engine,
            picture: &self.picture,
            scene: &self.scene,
            memory,
            is_hashed,
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct DrawArgs<'a> {
    pub(super) engine: &'a EngineArgs,
    pub(super) picture: &'a PictureArgs,
    pub(super) scene: &'a SceneArgs,
    /// Bytes of a .far file's data that may be in memory.
    pub(super) memory: Option<u64>,
    pub(super) is_hashed: bool,
}

struct FileMethod {
    engine: EngineName,
    name: &'static str,
    file: FileKind,
    buffers: &'static [Buffer],
    /// The flags that it follows, of those that not every engine does.
    flags: &'static [&'static str],
    open: fn(&Path, &DrawArgs<'_>) -> Result<Content, CliError>,
}

const METHODS: [FileMethod; 2] = [
    FileMethod {
        engine: EngineName::Far,
        name: "far",
        file: FileKind::Far,
        buffers: &[Buffer::Depth, Buffer::Node, Buffer::Color],
        flags: &["far-opacity"],
        open: |path, args| {
            Ok(Content::Far(match args.memory {
                Some(memory) => FarFile::open_within(path, memory)?,
                None => FarFile::open(path)?,
            }))
        },
    },
    FileMethod {
        engine: EngineName::Textured,
        name: "textured",
        file: FileKind::Tvx,
        buffers: &[Buffer::Depth, Buffer::Color],
        flags: &["erosion", "erosion-grid"],
        open: |path, args| {
            check_memory(args)?;
            Ok(Content::Textured(TexturedFile::open(path)?))
        },
    },
];

pub(super) struct Opened {
    pub(super) engine: EngineName,
    pub(super) load_ms: f64,
    /// Whether all of the file was checked. Methods of meshes check their data as they read it.
    pub(super) is_verified: bool,
    content: Content,
}

enum Content {
    Graph(Box<Graph>, Up),
    Far(FarFile),
    Textured(TexturedFile),
}

/// Opens a scene for the engine of the flags, or else for the one that draws its kind of file.
pub(super) fn open(name: &str, args: &DrawArgs<'_>, console: &Console) -> Result<Opened, CliError> {
    let started = Instant::now();
    fatal_signals::reads(name);
    let asked = args.engine.engine;
    let source = Source::find(name);
    let kind = source.as_ref().ok().and_then(Source::kind);
    let named = METHODS.iter().find(|method| Some(method.engine) == asked);
    let its = || METHODS.iter().find(|method| Some(method.file) == kind);
    let Some(method) = named.or_else(its) else {
        check_memory(args)?;
        args.engine.check_of_voxels().map_err(CliError::usage)?;
        let rules = args.engine.rules.options(0);
        if !rules.coverage.draws_outlines() && asked != Some(EngineName::Rays) {
            console.note(
                "these rules are drawn by the machine, which takes 100 to 500 times as long as --coverage exact",
            );
        }
        let scene_args = args.engine.rules.scene_args(args.scene);
        let verify_up_to = OpenOptions::default().verify_up_to;
        let source = source?;
        let scene = scenes::open_source(source, name, &scene_args, verify_up_to, started, console)?;
        return Ok(Opened::of_scene(scene, asked));
    };
    method.check(name, kind, args)?;
    let content = (method.open)(Path::new(name), args)?;
    Ok(Opened {
        engine: method.engine,
        load_ms: milliseconds_since(started),
        is_verified: true,
        content,
    })
}

/// Opens the voxels of a file in memory.
pub(super) fn open_bytes(
    name: &str,
    bytes: &[u8],
    args: &DrawArgs<'_>,
) -> Result<Opened, CliError> {
    args.engine.check_of_voxels().map_err(CliError::usage)?;
    let scene = scenes::open_bytes(name, bytes, args.scene)?;
    Ok(Opened::of_scene(scene, args.engine.engine))
}

fn check_memory(args: &DrawArgs<'_>) -> Result<(), CliError> {
    match args.memory {
        Some(_) => Err(CliError::usage("--memory is for .far files")),
        None => Ok(()),
    }
}

impl FileMethod {
    /// Rejects files that this method does not draw, and flags that it does not follow.
    fn check(
        &self,
        scene: &str,
        kind: Option<FileKind>,
        args: &DrawArgs<'_>,
    ) -> Result<(), CliError> {
        let Self { name, file, .. } = self;
        if args.engine.engine.is_some_and(|asked| asked != self.engine) {
            let message = format!("{scene}: this is a {file} file");
            let advice = format!("draw it with --engine {name}, or name no engine");
            return Err(CliError::usage(message).advise(advice));
        }
        if kind != Some(self.file) {
            let refused = (self.open)(Path::new(scene), args).map(|_| ());
            return refused.map_err(|error| {
                error.advise(format!(
                    "--engine {name} draws {file} files: shiftvox convert MESH OUT{file}"
                ))
            });
        }
        let mut given = args.engine.given();
        given.extend(args.scene.given());
        if let Some(idle) = given.iter().find(|flag| !self.flags.contains(flag)) {
            let message = format!("{scene}: --{idle} changes nothing of a {file} file");
            return Err(CliError::usage(message).advise("leave it out"));
        }
        let unknown = |buffer: &&Buffer| !self.buffers.contains(buffer);
        if let Some(unknown) = args.picture.aov.iter().find(unknown) {
            let mut known: Vec<&str> = self.buffers.iter().map(|buffer| buffer.name()).collect();
            let last = known.pop().unwrap_or_default();
            let message = format!("{scene}: --engine {name} has no --aov {}", unknown.name());
            return Err(
                CliError::usage(message).advise(format!("it has {} and {last}", known.join(", ")))
            );
        }
        Ok(())
    }
}

impl Opened {
    fn of_scene(scene: Scene, engine: Option<EngineName>) -> Self {
        Self {
            engine: engine.unwrap_or_default(),
            load_ms: scene.load_ms,
            is_verified: scene.is_verified,
            content: Content::Graph(Box::new(scene.graph), scene.up),
        }
    }

    pub(super) fn graph(&self) -> Option<&Graph> {
        match &self.content {
            Content::Graph(graph, _) => Some(graph),
            Content::Far(_) | Content::Textured(_) => None,
        }
    }

    /// The part of a scene of voxels within a box.
    pub(super) fn cropped(&self, name: &str, crop: &Crop) -> Result<Self, CliError> {
        let Content::Graph(graph, up) = &self.content else {
            return Err(CliError::usage(
                "--crop is for voxels, and this scene has none",
            ));
        };
        let part = scenes::cropped(graph, name, crop, &Silent)?;
        Ok(Self {
            content: Content::Graph(Box::new(part), *up),
            ..*self
        })
    }

    /// Rejects flags that the scene's method does not follow, as [`open`] does.
    pub(super) fn check(&self, name: &str, args: &DrawArgs<'_>) -> Result<(), CliError> {
        match METHODS.iter().find(|method| method.engine == self.engine) {
            Some(method) => method.check(name, Some(method.file), args),
            None => args.engine.check_of_voxels().map_err(CliError::usage),
        }
    }

    /// `stop` ends drawings of voxels.
    pub(super) fn drawable(
        &self,
        args: &DrawArgs<'_>,
        stop: &Stop,
    ) -> Result<Box<dyn Drawable + '_>, CliError> {
        let picture = args.picture;
        let (shading, background) = (picture.shade, picture.background.unwrap_or_default());
        let aa_log2 = picture.aa_log2();
        Ok(match &self.content {
            Content::Graph(graph, up) => Box::new(of_graph(graph, *up, args, stop)?),
            Content::Far(file) => {
                let style = FarStyle {
                    voxel_px: args.engine.rules.lod.unwrap_or(1.0),
                    aa_log2,
                    opacity: args.engine.far_opacity.unwrap_or_default(),
                    shading,
                    background,
                };
                Box::new(of_far(file, style))
            }
            Content::Textured(file) => {
                let style = TexturedStyle {
                    erosion: erosion(args.engine)?,
                    aa_log2,
                    shading,
                    background,
                };
                Box::new(of_textured(file, style))
            }
        })
    }
}

pub(super) fn frame<'d>(
    drawable: &'d mut dyn Drawable,
    camera: &Camera,
    repeat: u32,
) -> Result<Shown<'d>, CliError> {
    drawable.draw(camera, repeat)?;
    let shown = drawable.shown()?;
    shown.ok_or_else(|| CliError::new(Kind::Run, "nothing was drawn"))
}

/// The hash of a picture, where one is wanted.
pub(super) fn hash(shown: &Shown<'_>, is_hashed: bool) -> Result<Option<String>, CliError> {
    let hash = is_hashed.then(|| picture::hash_rows(&shown.buffers));
    Ok(hash.transpose()?)
}

pub(super) fn of_graph<'g>(
    graph: &'g Graph,
    up: Up,
    args: &DrawArgs<'_>,
    stop: &Stop,
) -> Result<GraphDrawing<'g>, CliError> {
    let style = GraphStyle {
        options: args.engine.rules.options(args.picture.aa_log2()),
        shading: args.picture.shade,
        background: args.picture.background.unwrap_or_default(),
        buffers: args.picture.aov.clone(),
        is_hashed: args.is_hashed,
    };
    let maker = engines::maker(args.engine, stop)?;
    Ok(GraphDrawing::new(graph, up, style, maker))
}

fn erosion(args: &EngineArgs) -> Result<Erosion, CliError> {
    match (args.erosion, args.erosion_grid) {
        (Some(Erosion::Level { .. }), _) if args.rules.lod.is_some() => Err(CliError::usage(
            "--lod says how large texels are with --erosion auto, not with a number of erosions",
        )),
        (Some(Erosion::Level { level, .. }), cells) => Ok(Erosion::Level { level, cells }),
        (_, Some(_)) => Err(CliError::usage(
            "--erosion-grid needs --erosion K; auto chooses the grid too",
        )),
        (_, None) => Ok(Erosion::Auto {
            texel_px: args.rules.lod.unwrap_or(1.0),
        }),
    }
}
