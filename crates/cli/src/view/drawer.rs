//! The thread of a socket: it draws what is asked for, one question after the other.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use serde_json::{Value, json};
use tokio::sync::mpsc::Sender;

use super::request::{self, Ask, Flags, MODEL_SIDE, MOST_PIXELS, MOST_SAMPLES, Request, Show};
use super::{Shared, overlay};
use crate::args::Setting;
use crate::error::{CliError, Kind};
use crate::methods::DrawArgs;
use crate::{model, report};
use shiftvox::drawing::{Drawable, milliseconds_since};
use shiftvox::picture::{self, Pixels};
use shiftvox::project::Camera;

/// Drawings that are kept: of a picture that moves, and of the same when it stands still.
const KEPT: usize = 2;
/// After so long without a question nothing is kept: buffers of large pictures take hundreds of megabytes.
const IDLE: Duration = Duration::from_secs(10);

/// What a drawing depends on, but for camera and size.
#[derive(Debug, Clone, PartialEq)]
struct Key {
    scene: usize,
    flags: Flags,
    aa_log2: u32,
    show: Show,
    hash: bool,
}

/// What is drawn for a socket.
struct Drawer<'s> {
    shared: &'s Shared,
    kept: Vec<(Key, Box<dyn Drawable + 's>)>,
}

/// Answers questions until nobody asks any more. Of those that wait it answers the newest.
pub(super) fn run(shared: &Shared, questions: &Receiver<String>, answers: &Sender<Bytes>) {
    let mut drawer = Drawer {
        shared,
        kept: Vec::new(),
    };
    if answers.blocking_send(message(&hello(shared), &[])).is_err() {
        return;
    }
    loop {
        let question = match questions.recv_timeout(IDLE) {
            Ok(question) => question,
            Err(RecvTimeoutError::Timeout) => {
                drawer.kept.clear();
                continue;
            }
            Err(RecvTimeoutError::Disconnected) => return,
        };
        let newest = questions.try_iter().last().unwrap_or(question);
        if answers.blocking_send(drawer.answer(&newest)).is_err() {
            return;
        }
    }
}

/// What a page begins with.
fn hello(shared: &Shared) -> Value {
    let names: Vec<&str> = shared.scenes.iter().map(|s| s.name.as_str()).collect();
    let picture = &shared.args.picture;
    let size = picture.size.map(|size| [size.width, size.height]);
    json!({
        "ask": "hello",
        "version": env!("CARGO_PKG_VERSION"),
        "scenes": names,
        "flags": request::first_flags(&shared.args),
        "size": size,
        "aa": 1 << picture.aa_log2(),
        "most_pixels": MOST_PIXELS,
        "most_samples": MOST_SAMPLES,
    })
}

/// A message to a page: the length of its head in four bytes (least significant first), the head as
/// JSON, and the picture.
fn message(head: &Value, body: &[u8]) -> Bytes {
    let head = head.to_string();
    let mut bytes = Vec::with_capacity(4 + head.len() + body.len());
    begin(&mut bytes, &head);
    bytes.extend_from_slice(body);
    bytes.into()
}

fn begin(bytes: &mut Vec<u8>, head: &str) {
    // A head is a few thousand bytes.
    bytes.extend_from_slice(&(head.len() as u32).to_le_bytes());
    bytes.extend_from_slice(head.as_bytes());
}

impl<'s> Drawer<'s> {
    fn answer(&mut self, question: &str) -> Bytes {
        let request = Request::read(question);
        let seq = request.as_ref().ok().map(|request| request.seq);
        let answer = request.and_then(|request| match request.ask {
            Ask::Picture => self.picture(&request),
            Ask::Figures => Ok(message(&self.figures(&request)?, &[])),
        });
        answer.unwrap_or_else(|error| {
            let CliError {
                message: said,
                advice,
                ..
            } = error;
            message(
                &json!({ "ask": "error", "seq": seq, "error": said, "advice": advice }),
                &[],
            )
        })
    }

    fn picture(&mut self, request: &Request) -> Result<Bytes, CliError> {
        let started = Instant::now();
        let shared = self.shared;
        let settings = request.settings()?;
        let listed = shared.scenes.get(request.scene).ok_or_else(no_scene)?;
        let args = DrawArgs {
            is_hashed: request.hash,
            ..shared.args.draw_args(&settings.engine, &settings.picture)
        };
        let key = Key {
            scene: request.scene,
            flags: request.flags.clone(),
            aa_log2: settings.picture.aa_log2(),
            show: request.show,
            hash: request.hash,
        };
        let opened = listed.for_flags(&args)?;
        let drawable = match self.kept.iter().position(|(of, _)| *of == key) {
            Some(at) => self.kept.remove(at).1,
            None => {
                opened.check(&listed.name, &args)?;
                self.kept.truncate(KEPT - 1);
                opened.drawable(&args)?
            }
        };
        // Those used last are first.
        self.kept.insert(0, (key, drawable));
        let drawable = &mut self.kept[0].1;
        let up = shared.args.scene.up_or(drawable.up());
        let size = settings.picture.size();
        let fitted = || shared.args.camera.camera(&drawable.bounds(), up, size, 0.0);
        let camera = request.camera().unwrap_or_else(fitted);
        drawable.draw(&camera, 1)?;
        let shown = drawable.shown()?;
        let shown = shown.ok_or_else(|| CliError::new(Kind::Run, "nothing was drawn"))?;
        let hash = match request.hash {
            true => Some(picture::hash_rows(&shown.buffers)?),
            false => None,
        };
        let overlay = match request.show {
            Show::Color => None,
            show => Some(overlay::colors(&shown.buffers, show)?),
        };
        let ends = overlay.as_ref().and_then(|(_, ends)| ends.clone());
        let engine: Setting = ("engine", crate::args::word(&opened.engine));
        let head = json!({
            "ask": request.ask,
            "seq": request.seq,
            "width": size.0,
            "height": size.1,
            "png": request.png,
            "camera": report::camera(&camera),
            "axis": up.axis().to_array(),
            "engine": engine.1.as_str(),
            "command": request.render_command(&listed.name, &shared.args.scene, &camera),
            "hash": hash,
            "counters": shown.counters,
            "pixels_drawn": shown.pixels_drawn,
            "ends": ends.map(|ends| [ends.start, ends.end]),
            "draw_ms": shown.times_ms.last(),
            "all_ms": milliseconds_since(started),
        });
        let head = head.to_string();
        let pixels = u64::from(size.0) * u64::from(size.1);
        let mut bytes = Vec::with_capacity(4 + head.len() + 4 * pixels as usize);
        begin(&mut bytes, &head);
        let made = overlay.map(|(colors, _)| Pixels::new(size.0, size.1, colors));
        let shown = made.as_ref().unwrap_or(&*shown.pixels);
        if request.png {
            let failed = |error| CliError::new(Kind::Run, format!("no PNG: {error}"));
            shown.write(&mut bytes).map_err(failed)?;
        } else {
            shown.append_rgba(&mut bytes);
        }
        Ok(bytes.into())
    }

    /// Figures of the hardware model, of a picture of at most [`MODEL_SIDE`].
    fn figures(&self, request: &Request) -> Result<Value, CliError> {
        let shared = self.shared;
        let settings = request.settings()?;
        let listed = shared.scenes.get(request.scene).ok_or_else(no_scene)?;
        let args = shared.args.draw_args(&settings.engine, &settings.picture);
        let graph = listed.for_flags(&args)?.graph().ok_or_else(|| {
            CliError::usage("the hardware model is of voxels, and this scene has none")
        })?;
        let camera = request
            .camera()
            .ok_or_else(|| CliError::usage("figures are of a placed camera"))?;
        let camera = of_model_size(camera);
        let figures = model::brief(request.model_words(), graph, &camera)?;
        Ok(json!({
            "ask": request.ask,
            "seq": request.seq,
            "width": camera.width,
            "height": camera.height,
            "command": request.model_command(&listed.name, &shared.args.scene, &camera),
            "figures": figures,
        }))
    }
}

fn no_scene() -> CliError {
    CliError::usage("there is no scene of this number")
}

/// The camera with a smaller picture of the same shape.
fn of_model_size(camera: Camera) -> Camera {
    let longer = camera.width.max(camera.height).max(MODEL_SIDE);
    let side = |side: u32| (u64::from(side) * u64::from(MODEL_SIDE) / u64::from(longer)).max(1);
    Camera {
        // At most 256.
        width: side(camera.width) as u32,
        height: side(camera.height) as u32,
        ..camera
    }
}
