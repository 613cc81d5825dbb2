//! Draws what a page asks for, with the engines and files of the command line.

use std::sync::PoisonError;

use clap::ValueEnum;
use serde_json::{Value, json};
use shiftvox::drawing::{Drawable, Shown};
use shiftvox::graph::{Graph, Placement};
use shiftvox::picture::npy::Values;
use shiftvox::picture::{Buffer, Pixels, Rows};
use shiftvox::project::{Camera, Stop};
use shiftvox_view::{Answer, Ask, FLAGS, Flags, Program, Request, command, picked};

use super::flags::{self, MODEL_FLAGS};
use super::{Chosen, Listed, MOST_DROPPED, Shared, overlay};
use crate::error::{CliError, Kind};
use crate::methods::{self, DrawArgs};
use crate::{model, report};

/// Drawings that are kept: one of the moving picture, and one of the picture that stands still.
const KEPT: usize = 2;
/// Longer side of the pictures that the hardware model draws. Larger ones take many seconds.
const MODEL_SIDE: u32 = 256;

/// The settings that a drawing depends on. Camera and size change without a new drawing.
#[derive(PartialEq)]
struct Key {
    scene: usize,
    flags: Flags,
    aa: u32,
    show: Option<Buffer>,
    hash: bool,
}

type Kept<'s> = Vec<(Key, Box<dyn Drawable + 's>)>;

impl Program for Shared {
    fn hello(&self) -> Value {
        let names: Vec<&str> = self.scenes().iter().map(|s| s.name.as_str()).collect();
        let picture = &self.args.flags.picture;
        json!({
            "scenes": names,
            "flags": self.first,
            "size": picture.size.map(|size| [size.width, size.height]),
            "aa": 1 << picture.aa_log2(),
        })
    }

    fn open(&self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let count = self.scenes().len();
        if count >= self.args.scenes.len() + MOST_DROPPED {
            return Err("too many files were dropped: start the program again".to_owned());
        }
        let scene = Listed::dropped(name, bytes, &self.args).map_err(|error| error.to_string())?;
        let mut scenes = self.scenes.write().unwrap_or_else(PoisonError::into_inner);
        scenes.push(Box::leak(Box::new(scene)));
        Ok(())
    }

    fn drawer(
        &self,
        is_stale: impl Fn() -> bool + Send + Sync + 'static,
    ) -> impl FnMut(&Request) -> Result<Answer, String> {
        let mut kept = Kept::new();
        let stop = Stop::when(is_stale);
        move |request| {
            let answer = match request.ask {
                Ask::Picture | Ask::Pick => self.picture(request, &mut kept, &stop),
                Ask::Figures => self.figures(request),
            };
            answer.map_err(|error| error.to_string())
        }
    }
}

impl Shared {
    fn scenes(&self) -> Vec<&'static Listed> {
        let scenes = self.scenes.read();
        scenes.unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn scene(&self, number: usize) -> Result<&'static Listed, CliError> {
        let scene = self.scenes().get(number).copied();
        scene.ok_or_else(|| CliError::usage("there is no scene of this number"))
    }

    fn picture<'s>(
        &'s self,
        request: &Request,
        kept: &mut Kept<'s>,
        stop: &Stop,
    ) -> Result<Answer, CliError> {
        let settings = flags::settings(request)?;
        let listed = self.scene(request.scene)?;
        // All buffers are kept for the hash, and one of them has the picked voxel.
        let is_hashed = request.hash || request.ask == Ask::Pick;
        let args = DrawArgs {
            engine: &settings.engine,
            picture: &settings.picture,
            ..self.args.flags.draw_args(None, is_hashed)
        };
        let show = settings.picture.aov.first().copied();
        let key = Key {
            scene: request.scene,
            flags: request.flags.clone(),
            aa: request.aa,
            show,
            hash: is_hashed,
        };
        let opened = listed.chosen(&args, settings.crop.as_ref())?;
        let mut of_part;
        let drawable: &mut (dyn Drawable + '_) = match &opened {
            // A drawing of a part is not kept from one request to the next.
            Chosen::Part(part) => {
                part.check(&listed.name, &args)?;
                of_part = part.drawable(&args, stop)?;
                &mut *of_part
            }
            Chosen::Whole(whole) => {
                let drawable = match kept.iter().position(|(of, _)| *of == key) {
                    Some(at) => kept.remove(at).1,
                    None => {
                        whole.check(&listed.name, &args)?;
                        kept.truncate(KEPT - 1);
                        whole.drawable(&args, stop)?
                    }
                };
                kept.insert(0, (key, drawable));
                &mut *kept[0].1
            }
        };
        let up = self.args.flags.scene.up_or(drawable.up());
        let (width, height) = settings.picture.size();
        let camera = flags::camera(request).unwrap_or_else(|| {
            let args = &self.args.flags.camera;
            args.camera(&drawable.bounds(), up, (width, height), 0.0)
        });
        let shown = methods::frame(drawable, &camera, 1)?;
        if request.ask == Ask::Pick {
            let graph = opened
                .graph()
                .ok_or_else(|| CliError::usage("this scene has no voxels that can be picked"))?;
            return pick(&shown, graph, request.at);
        }
        let hash = methods::hash(&shown, request.hash)?;
        let overlay = show.map(|buffer| overlay::colors(&shown.buffers, buffer));
        let overlay = overlay.transpose()?;
        let (colors, legend) = overlay.unzip();
        let made = colors.map(|colors| Pixels::new(width, height, colors));
        let pixels = made.as_ref().unwrap_or(&*shown.pixels);
        let picture = if request.png {
            let mut file = Vec::new();
            let failed = |error| CliError::new(Kind::Run, format!("no PNG: {error}"));
            pixels.write(&mut file).map_err(failed)?;
            file
        } else {
            pixels.rgba().into_flattened()
        };
        let aa = (request.aa != 1).then(|| format!("--aa={}", request.aa));
        let words = request.words(FLAGS).chain(aa);
        let engine = opened.engine.to_possible_value();
        let head = json!({
            "width": width,
            "height": height,
            "png": request.png,
            "camera": report::camera(&camera),
            "axis": up.axis().to_array(),
            "extent": listed.extent(),
            "engine": engine.as_ref().map(clap::builder::PossibleValue::get_name),
            "command": self.command("render", &listed.name, words, &camera) + " -o picture.png --force",
            "hash": hash,
            "counters": shown.counters,
            "pixels_drawn": shown.pixels_drawn,
            "legend": legend,
            "draw_ms": shown.times_ms.last(),
        });
        Ok((head, picture))
    }

    fn figures(&self, request: &Request) -> Result<Answer, CliError> {
        let settings = flags::settings(request)?;
        let listed = self.scene(request.scene)?;
        let args = DrawArgs {
            engine: &settings.engine,
            picture: &settings.picture,
            ..self.args.flags.draw_args(None, false)
        };
        let opened = listed.chosen(&args, settings.crop.as_ref())?;
        let graph = opened.graph().ok_or_else(|| {
            CliError::usage("the hardware model is of voxels, and this scene has none")
        })?;
        let camera = flags::camera(request)
            .ok_or_else(|| CliError::usage("figures are of a placed camera"))?;
        let camera = of_model_size(camera);
        let crop = request.words("crop");
        let words = request.words(MODEL_FLAGS);
        let head = json!({
            "figures": model::brief(words.map(Into::into), graph, &camera)?,
            "width": camera.width,
            "height": camera.height,
            "command": self.command("model", &listed.name, request.words(MODEL_FLAGS).chain(crop), &camera),
        });
        Ok((head, Vec::new()))
    }

    fn command(
        &self,
        verb: &str,
        scene: &str,
        words: impl Iterator<Item = String>,
        camera: &Camera,
    ) -> String {
        let words = self.scene_words.iter().cloned().chain(words);
        let size = [camera.width, camera.height];
        command(verb, scene, words, size, &camera.flags())
    }
}

/// The voxel at a pixel, as `--aov voxel` of `render` has it.
fn pick(shown: &Shown<'_>, graph: &Graph, [x, y]: [u32; 2]) -> Result<Answer, CliError> {
    let (width, height) = shown.buffers.size();
    if x >= width || y >= height {
        return Err(CliError::usage("this pixel is outside the picture"));
    }
    let row = |buffer| match shown.buffers.rows(buffer, y..y + 1)? {
        Values::I32(values) => Ok(values),
        _ => Err(CliError::usage("this buffer has no integers")),
    };
    let voxel = row(Buffer::Voxel)?.as_chunks().0[x as usize];
    let node = row(Buffer::Node)?[x as usize] as u32;
    let Placement {
        world_origin,
        voxel_size,
        ..
    } = graph.placement;
    let color = graph.color_of(node);
    Ok(picked(voxel, color, graph.depth, world_origin, voxel_size))
}

fn of_model_size(camera: Camera) -> Camera {
    let longer = camera.width.max(camera.height).max(MODEL_SIDE);
    let side = |side: u32| (u64::from(side) * u64::from(MODEL_SIDE) / u64::from(longer)).max(1);
    camera.of_size(side(camera.width) as u32, side(camera.height) as u32)
}
