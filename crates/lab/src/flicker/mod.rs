//! Films: how much pictures flicker when the camera moves a little.
//!
//! *Flicker* is what changes from frame to frame other than in the
//! reference. *Pop* is what changes in one picture when level of detail decides
//! as it did a frame before: the same camera, the other cut (see
//! [`cut_at`](crate::error::cut_at)).

mod motion;

use rayon::prelude::*;
use serde::Serialize;

pub use motion::Motion;

use crate::bench::{BenchError, Subject};
use crate::error::{Method, PixelStyle, References, Refused, Sampling, drawn};
use crate::measure::{Flicker, LinearPicture, SizeError};
use crate::report::plot::{Axis, Chart, Panel, Scale, Series};
use crate::report::{Cell, Table};
use shiftvox::graph::{Progress, Silent};
use shiftvox::project::Camera;

/// What is filmed, and how.
#[derive(Debug, Clone, Copy)]
pub struct FilmPlan {
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Frames of a film, 2 or more.
    pub frames: u32,
    /// Strata of a reference's pixel along each axis, as a power of two.
    pub strata_log2: u32,
    /// How samples become colours.
    pub style: PixelStyle,
}

/// A film of one method.
#[derive(Debug, Clone, Serialize)]
pub struct Film {
    /// What the method is called.
    pub method: String,
    /// What was seen, or why there is no film.
    pub seen: Result<FilmFlicker, String>,
}

/// How much a film flickers. Linear light from 0 to 1, root of the mean square
/// over pixels and channels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilmFlicker {
    /// Of the whole film.
    pub flicker: f64,
    /// By step, from the second frame on.
    pub flicker_by_step: Vec<f64>,
    /// Of the whole film; `None` where there is no level of detail.
    pub pop: Option<f64>,
    /// By step, from the second frame on.
    pub pop_by_step: Vec<f64>,
    /// Mean distance of a frame from its reference.
    pub error: f64,
}

impl FilmFlicker {
    /// Steps in which another cut makes another picture. A film without any does not show
    /// how much a change of level shows.
    #[must_use]
    pub fn popped(&self) -> u64 {
        self.pop_by_step.iter().filter(|&&pop| pop > 0.0).count() as u64
    }
}

/// The films of a scene, by one motion.
#[derive(Debug, Clone, Serialize)]
pub struct Films {
    /// The scene.
    pub scene: String,
    /// The motion.
    #[serde(flatten)]
    pub motion: Motion,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Frames.
    pub frames: u32,
    /// Samples of a pixel of the reference.
    pub reference_samples: u32,
    /// Flicker of a second reference film, of another seed, against the first.
    pub noise_floor: f64,
    /// The methods.
    pub films: Vec<Film>,
}

/// Films a scene from its camera on, moving.
///
/// # Errors
/// When a camera cannot see. A method without a picture is no error but a film with the reason.
pub fn film(
    subject: &Subject,
    motion: Motion,
    methods: &[Method<'_>],
    plan: &FilmPlan,
    references: &mut References<'_>,
    progress: &dyn Progress,
) -> Result<Films, BenchError> {
    let start = Camera {
        width: plan.size.0,
        height: plan.size.1,
        ..subject.camera
    };
    let cameras: Vec<Camera> = (0..plan.frames)
        .map(|frame| motion.after(&start, frame))
        .collect::<Result<_, _>>()
        .map_err(shiftvox::project::SetupError::from)?;
    progress.begin(
        &format!("{}, {}", subject.name, motion.name()),
        u64::from(plan.frames) * 2 + methods.len() as u64,
    );
    let mut reference = |seed: u64| -> Result<Vec<LinearPicture>, BenchError> {
        let sampling = Sampling {
            strata_log2: plan.strata_log2,
            seed,
        };
        let light = |camera: &Camera| {
            let reference = references.of(subject, camera, sampling, plan.style, &Silent)?;
            progress.advance(1);
            Ok(LinearPicture::of((
                reference.width,
                reference.height,
                &reference.rgba,
            )))
        };
        cameras.iter().map(light).collect()
    };
    let (truth, second) = (reference(1)?, reference(2)?);
    let mismatch = |e: SizeError| BenchError::Picture(e.to_string());
    let noise_floor = flicker(&second, &truth).map_err(mismatch)?.rms();
    let films = methods
        .iter()
        .map(|method| {
            let seen = film_flicker(method, &cameras, &truth);
            progress.advance(1);
            Film {
                method: method.name.clone(),
                seen: seen.map_err(|refused| refused.to_string()),
            }
        })
        .collect();
    progress.end();
    let samples = references.samples(Sampling {
        strata_log2: plan.strata_log2,
        seed: 1,
    });
    Ok(Films {
        scene: subject.name.clone(),
        motion,
        width: plan.size.0,
        height: plan.size.1,
        frames: plan.frames,
        reference_samples: samples,
        noise_floor,
        films,
    })
}

fn flicker(film: &[LinearPicture], truth: &[LinearPicture]) -> Result<Flicker, SizeError> {
    let mut flicker = Flicker::default();
    for (frame, right) in film.iter().zip(truth) {
        flicker.push(frame.clone(), right.clone())?;
    }
    Ok(flicker)
}

/// Films one method.
pub(crate) fn film_flicker(
    method: &Method<'_>,
    cameras: &[Camera],
    truth: &[LinearPicture],
) -> Result<FilmFlicker, Refused> {
    let mut film = Vec::new();
    let mut pops = Vec::new();
    let light =
        |camera: &Camera, rgba: &[[u8; 4]]| LinearPicture::of((camera.width, camera.height, rgba));
    let mut drawing = (method.drawing)();
    for (at, camera) in cameras.iter().enumerate() {
        let shown = drawn(drawing.as_mut(), camera)?;
        film.push(light(camera, &shown.pixels.rgba()));
        let before = at.checked_sub(1).map(|before| &cameras[before]);
        if let (Some(before), Some(with_cut_of)) = (before, &method.with_cut_of) {
            let [own, other] = [camera, before].map(|chooser| with_cut_of(camera, chooser));
            let (own, other) = (light(camera, &own?), light(camera, &other?));
            pops.push(own.rms(&other).map_err(Refused::because)?);
        }
    }
    let flicker = flicker(&film, truth).map_err(Refused::because)?;
    let errors: Vec<f64> = film
        .par_iter()
        .zip(truth)
        .map(|(frame, right)| frame.rms(right))
        .collect::<Result<_, _>>()
        .map_err(Refused::because)?;
    let squares: f64 = pops.iter().map(|pop| pop * pop).sum();
    Ok(FilmFlicker {
        flicker: flicker.rms(),
        flicker_by_step: flicker.by_step(),
        pop: (!pops.is_empty()).then(|| libm::sqrt(squares / pops.len() as f64)),
        pop_by_step: pops,
        error: errors.iter().sum::<f64>() / errors.len().max(1) as f64,
    })
}

/// The greatest of some numbers, none of them below 0.
fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// All films as a table, a row for each scene, motion and method; the noise
/// floor as a method of its own.
#[must_use]
pub fn table(films: &[Films]) -> Table {
    let columns = "scene motion method flicker flicker_worst pop pop_worst popped error remark";
    let mut table = Table::of(
        "Flicker and pop: rms of linear light, in thousandths of white",
        columns,
    );
    let thousandths = |value: f64| Cell::Number(1e3 * value, 2);
    for films in films {
        let place = [Cell::Text(films.scene.clone()), films.motion.name().into()];
        for film in &films.films {
            let mut cells = place.to_vec();
            cells.push(Cell::Text(film.method.clone()));
            match &film.seen {
                Ok(seen) => cells.extend([
                    thousandths(seen.flicker),
                    thousandths(most(&seen.flicker_by_step)),
                    seen.pop.map_or(Cell::None, thousandths),
                    seen.pop
                        .map_or(Cell::None, |_| thousandths(most(&seen.pop_by_step))),
                    seen.pop.map_or(Cell::None, |_| Cell::Count(seen.popped())),
                    thousandths(seen.error),
                    Cell::None,
                ]),
                Err(reason) => {
                    cells.resize(columns.len() - 1, Cell::None);
                    cells.push(Cell::Text(reason.clone()));
                }
            }
            table.rows.push(cells);
        }
        let mut floor = place.to_vec();
        floor.push("noise floor".into());
        floor.push(thousandths(films.noise_floor));
        floor.resize(columns.len(), Cell::None);
        table.rows.push(floor);
    }
    table
}

/// Flicker over time; and pop, if there is any.
#[must_use]
pub fn panels(films: &Films) -> Vec<Panel> {
    type Steps = fn(&FilmFlicker) -> &[f64];
    let of = |what: &str, steps: Steps, level: Option<(f64, String)>| {
        let series: Vec<Series> = films
            .films
            .iter()
            .filter_map(|film| Some((&film.method, steps(film.seen.as_ref().ok()?))))
            .filter(|(_, steps)| !steps.is_empty())
            .map(|(name, steps)| {
                let points = steps.iter().enumerate();
                let points = points.map(|(at, value)| ((at + 1) as f64, 1e3 * value));
                Series::curve(name.clone(), points)
            })
            .collect();
        let title = format!("{}, {}: {what}", films.scene, films.motion.name());
        let axis = |label: &str| Axis {
            label: label.to_owned(),
            scale: Scale::Linear,
        };
        let chart = Chart {
            title,
            x: axis("frame"),
            y: axis("rms of linear light, thousandths"),
            series,
            level,
        };
        Panel::Chart(chart)
    };
    let floor = (1e3 * films.noise_floor, "noise floor".to_owned());
    let mut panels = vec![of("flicker", |seen| &seen.flicker_by_step, Some(floor))];
    let pops = |film: &Film| {
        film.seen
            .as_ref()
            .is_ok_and(|seen| most(&seen.pop_by_step) > 0.0)
    };
    if films.films.iter().any(pops) {
        panels.push(of("pop", |seen| &seen.pop_by_step, None));
    }
    panels
}
