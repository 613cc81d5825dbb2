//! Methods on a mesh, distance by distance: time, error, flicker.

use serde::Serialize;

use super::distance::at_distance;
use crate::bench::{BenchError, Schedule, Summary};
use crate::error::{
    Examined, Judge, Method, PictureError, PixelStyle, Reference, Refused, as_map, of_triangles,
    outcome_or_reason, race,
};
use crate::flicker::{Motion, film_flicker};
use crate::measure::LinearPicture;
use shiftvox::graph::{Progress, Silent};
use shiftvox::project::{Camera, Stats};
use shiftvox_mesh::Surface;

/// What is measured, and how.
#[derive(Debug, Clone)]
pub struct MethodsPlan {
    /// Pixels down the picture at each distance.
    pub heights: Vec<u32>,
    /// How often each method draws.
    pub schedule: Schedule,
    /// Frames of the film in which flicker is searched for; below 2: none.
    pub frames: u32,
    /// How a film's camera moves.
    pub motion: Motion,
    /// How samples become colours.
    pub style: PixelStyle,
}

/// Facts about a method beside its pictures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// What tables call it.
    pub label: String,
    /// Bytes of what it draws.
    pub bytes: u64,
    /// Time to make that of the mesh, milliseconds.
    pub build_ms: f64,
}

/// A method at a distance.
#[derive(Debug, Clone, Serialize)]
pub struct MethodAtDistance {
    /// What it is called.
    pub method: String,
    /// Its family.
    pub family: &'static str,
    /// What came of it, or why nothing did.
    #[serde(serialize_with = "outcome_or_reason")]
    pub outcome: Result<Outcome, Refused>,
}

/// What came of a method at a distance.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Wall time of a frame, one thread.
    pub wall: Summary,
    /// Processor time of a frame.
    pub thread: Option<Summary>,
    /// Against the reference.
    pub picture: PictureError,
    /// Flicker of a film against the reference film; rms of linear light.
    pub flicker: Option<f64>,
    /// What changes where level of detail alone does, from frame to frame of the film.
    pub pop: Option<f64>,
    /// What it counted; the first is its work.
    #[serde(serialize_with = "as_map")]
    pub counters: Stats,
    /// Bytes that the frame is made of: those of the level of detail, where there are levels.
    pub read_bytes: u64,
    /// Anything else.
    pub remark: Option<String>,
}

/// All methods at a distance.
#[derive(Debug, Clone, Serialize)]
pub struct Distance {
    /// Pixels across and down, which the mesh about fills.
    pub size: (u32, u32),
    /// From eye to target, world units.
    pub distance_world: f64,
    /// What a second reference of another seed is from the first.
    pub noise_floor: PictureError,
    /// The methods.
    pub rows: Vec<MethodAtDistance>,
    /// The reference.
    #[serde(skip)]
    pub reference: Reference,
    /// The methods' pictures, in the order of rows; empty for those without.
    #[serde(skip)]
    pub pictures: Vec<Vec<[u8; 4]>>,
}

/// All methods on a mesh.
#[derive(Debug, Clone, Serialize)]
pub struct MeshMethods {
    /// The mesh.
    pub mesh: String,
    /// Its triangles.
    pub triangles: u64,
    /// The methods, in the order of the rows.
    pub facts: Vec<Facts>,
    /// From near to far.
    pub distances: Vec<Distance>,
}

/// Measures methods on a mesh, from a camera and from farther and farther off.
///
/// # Errors
/// When the camera cannot see, or there is no thread. A method without a
/// picture is no error but a row with the reason.
pub fn measure(
    (name, mesh): (&str, &dyn Surface),
    camera: &Camera,
    methods: &[Method<'_>],
    facts: Vec<Facts>,
    plan: &MethodsPlan,
    progress: &dyn Progress,
) -> Result<MeshMethods, BenchError> {
    let mut distances = Vec::new();
    for &height in &plan.heights {
        let camera = at_distance(camera, height);
        distances.push(at(mesh, &camera, (methods, &facts), plan, progress)?);
    }
    Ok(MeshMethods {
        mesh: name.to_owned(),
        triangles: mesh.len() as u64,
        facts,
        distances,
    })
}

fn at(
    mesh: &dyn Surface,
    camera: &Camera,
    (methods, facts): (&[Method<'_>], &[Facts]),
    plan: &MethodsPlan,
    progress: &dyn Progress,
) -> Result<Distance, BenchError> {
    let failed = |e: &dyn std::fmt::Display| BenchError::Picture(e.to_string());
    let cameras: Vec<Camera> = (0..plan.frames.max(1))
        .map(|frame| plan.motion.after(camera, frame))
        .collect::<Result<_, _>>()
        .map_err(|e| failed(&e))?;
    progress.begin("drawing references", cameras.len() as u64);
    let mut films = Vec::new();
    for camera in &cameras {
        films.push(of_triangles(mesh, camera, plan.style, 1, &Silent)?);
        progress.advance(1);
    }
    progress.end();
    let second = of_triangles(mesh, camera, plan.style, 2, &Silent)?;
    let judge = Judge::new(&films[0]);
    let noise_floor = judge.judge(&second.rgba, &second.shares);
    let noise_floor = noise_floor.map_err(|e| failed(&e))?;
    let light = |r: &Reference| LinearPicture::of((r.width, r.height, &r.rgba));
    let truth: Vec<LinearPicture> = films.iter().map(light).collect();

    progress.begin("judging pictures", methods.len() as u64);
    let mut shown: Vec<Result<Seen, Refused>> = Vec::new();
    for method in methods {
        shown.push(seen(method, &cameras, &judge, &truth));
        progress.advance(1);
    }
    progress.end();
    let taking_part: Vec<bool> = shown.iter().map(Result::is_ok).collect();
    let times = race(methods, &taking_part, camera, plan.schedule, progress)?;
    let mut pictures = Vec::new();
    let mut rows = Vec::new();
    let made = methods.iter().zip(facts);
    for (((method, facts), seen), (wall, thread)) in made.zip(shown).zip(times) {
        let outcome = seen.map(|seen| {
            pictures.push(seen.rgba);
            Outcome {
                wall,
                thread,
                picture: seen.picture,
                flicker: seen.flicker,
                pop: seen.pop,
                read_bytes: read_bytes(&seen.examined.counters).unwrap_or(facts.bytes),
                counters: seen.examined.counters,
                remark: seen.examined.remark,
            }
        });
        if outcome.is_err() {
            pictures.push(Vec::new());
        }
        rows.push(MethodAtDistance {
            method: method.name.clone(),
            family: method.family,
            outcome,
        });
    }
    Ok(Distance {
        size: (camera.width, camera.height),
        distance_world: (camera.eye - camera.target).length(),
        noise_floor,
        rows,
        reference: films.swap_remove(0),
        pictures,
    })
}

/// Bytes of what a level of detail is drawn from.
fn read_bytes(counters: &Stats) -> Option<u64> {
    let found = counters.iter().find(|(name, _)| *name == "bytes");
    found.map(|(_, bytes)| *bytes)
}

/// What was seen of a method, nothing of it timed.
struct Seen {
    rgba: Vec<[u8; 4]>,
    examined: Examined,
    picture: PictureError,
    flicker: Option<f64>,
    pop: Option<f64>,
}

fn seen(
    method: &Method<'_>,
    cameras: &[Camera],
    judge: &Judge<'_>,
    truth: &[LinearPicture],
) -> Result<Seen, Refused> {
    let (rgba, examined) = method.show(&cameras[0])?;
    let picture = judge.judge(&rgba, &examined.shares);
    let picture = picture.map_err(Refused::because)?;
    let film = match cameras.len() {
        0 | 1 => None,
        _ => Some(film_flicker(method, cameras, truth)?),
    };
    Ok(Seen {
        rgba,
        examined,
        picture,
        flicker: film.as_ref().map(|film| film.flicker),
        pop: film.and_then(|film| film.pop),
    })
}
