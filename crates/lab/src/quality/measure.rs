//! `bench quality`: methods on a scene, from one or more cameras, become rows.

use std::hint::black_box;
use std::sync::Arc;

use super::compare::{add_beaten_by, add_rivals};
use super::film::{film, flicker};
use super::judge::{Judge, PictureError};
use super::method::{Method, Refused, Samples};
use super::motion::Motion;
use super::reference::{Reference, Sampling, TRIANGLE_SAMPLES, cast, of_triangles};
use super::voxels::PixelStyle;
use crate::bench::{BenchError, Clock, Schedule, interleave, pool};
use crate::measure::{CoverageError, LinearPicture, SizeError, Spread, count_elsewhere};
use crate::report::plot::{Panel, RowPlot};
use crate::report::{Cell, Row, Table};
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Progress, Silent};
use shiftvox::picture::{Background, Picture, resolve};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;
use shiftvox_mesh::Surface;

/// How methods are measured.
#[derive(Debug, Clone)]
pub struct QualityPlan {
    /// How often each method draws.
    pub schedule: Schedule,
    /// Camera motions to film. Without any there is no flicker.
    pub motions: Vec<Motion>,
    /// Frames of a film, 2 or more.
    pub frames: u32,
    /// Strata of a reference's pixel along each axis, as a power of two.
    pub strata_log2: u32,
    /// Shading and background.
    pub style: PixelStyle,
}

/// A scene and the truth about it.
#[derive(Clone, Copy)]
pub struct Scene<'s> {
    /// Its name in tables.
    pub name: &'s str,
    /// Its voxels, of which exact rays are the truth.
    pub graph: Option<&'s Graph>,
    /// Its triangles, which are the truth if there are any.
    pub mesh: Option<&'s dyn Surface>,
}

/// The method of rows that compare a second reference with the first.
pub const NOISE_FLOOR: &str = "noise floor";
/// Seeds of the reference and of the second one.
const SEEDS: [u64; 2] = [1, 2];
/// Most methods that draw in turn, and so have their buffers in memory at one time.
const MOST_IN_TURN: usize = 64;

fn failed(reason: impl std::fmt::Display) -> BenchError {
    BenchError::Picture(reason.to_string())
}

/// References that were made already.
struct References<'s> {
    scene: Scene<'s>,
    sampling: [Sampling; 2],
    style: PixelStyle,
    made: Vec<(Camera, usize, Arc<Reference>)>,
}

impl References<'_> {
    /// The first or second reference of a camera.
    fn of(
        &mut self,
        camera: &Camera,
        which: usize,
        progress: &dyn Progress,
    ) -> Result<Arc<Reference>, BenchError> {
        let mut made = self.made.iter();
        if let Some((.., known)) = made.find(|(from, of, _)| (from, *of) == (camera, which)) {
            return Ok(Arc::clone(known));
        }
        let sampling = self.sampling[which];
        let reference = match (self.scene.mesh, self.scene.graph) {
            (Some(mesh), _) => of_triangles(mesh, camera, self.style, sampling.seed, progress)?,
            (None, Some(graph)) => {
                let background = Background::Color(self.style.background);
                let setup = truth(graph, camera, 0)?;
                cast(
                    graph,
                    &setup,
                    self.style.shading,
                    background,
                    sampling,
                    progress,
                )
            }
            (None, None) => return Err(failed("a scene without voxels and triangles")),
        };
        let reference = Arc::new(reference);
        self.made.push((*camera, which, Arc::clone(&reference)));
        Ok(reference)
    }

    /// The references of a film, in linear light.
    fn film(&mut self, cameras: &[Camera], which: usize) -> Result<Vec<LinearPicture>, BenchError> {
        let light = |camera: &Camera| {
            let reference = self.of(camera, which, &Silent)?;
            let (width, height) = (reference.width, reference.height);
            Ok(LinearPicture::of((width, height, &reference.rgba)))
        };
        cameras.iter().map(light).collect()
    }
}

/// The integers that exact rays start from: those of the default format whatever a method has, so
/// that the view of a narrow format counts as an error.
fn truth(graph: &Graph, camera: &Camera, aa_log2: u32) -> Result<FrameSetup, BenchError> {
    let options = SetupOptions {
        aa_log2,
        lod_px: 0.0,
        ..SetupOptions::default()
    };
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options)?;
    Ok(setup)
}

/// The voxels that exact rays hit at the sample points of a picture.
struct Exact<'m> {
    graph: &'m Graph,
    aa_log2: u32,
    voxel: Vec<[i32; 4]>,
    picture: Picture,
}

impl<'m> Exact<'m> {
    fn new(
        graph: &'m Graph,
        camera: &Camera,
        aa_log2: u32,
        style: PixelStyle,
    ) -> Result<Self, BenchError> {
        let setup = truth(graph, camera, aa_log2)?;
        let mut frame = Frame::new(setup.width, setup.height, false);
        let drawn = Rays.render(&graph.view(), &setup, &mut frame);
        drawn.map_err(failed)?;
        let background = Background::Color(style.background);
        let picture = resolve(&frame, graph, &setup, style.shading, background);
        Ok(Self {
            graph,
            aa_log2,
            voxel: frame.voxel,
            picture: picture.map_err(failed)?,
        })
    }

    /// The errors of samples: false positives and negatives, voxels elsewhere, coarser voxels.
    fn put(&self, row: &mut Row, samples: &Samples) {
        let error = CoverageError::between(&samples.voxel, &self.voxel);
        let elsewhere = count_elsewhere(&samples.voxel, &self.voxel, self.graph.depth);
        let wrong = error.extra + error.missing;
        let share = wrong as f64 / error.covered.max(1) as f64;
        row.put("extra", error.extra);
        row.put("missing", error.missing);
        row.put("elsewhere", elsewhere);
        row.put("coarser", error.wrong_voxel - elsewhere);
        row.put("wrong_share", Cell::Number(share, 6));
        row.put("samples_all", error.pixels);
        row.put("samples_covered", error.covered);
        let voxel = self.graph.placement.voxel_size;
        let depth = Spread::of_depths(&samples.depth, &self.picture.depth, voxel);
        let names = ["depth_mean", "depth_p999", "depth_worst"];
        put_spread(row, names, depth, 2);
    }
}

fn put_spread(row: &mut Row, names: [&'static str; 3], spread: Spread, digits: usize) {
    row.put(names[2], Cell::Number(spread.worst, digits));
    row.put(names[0], Cell::Number(spread.mean, digits + 1));
    row.put(names[1], Cell::Number(spread.percentile_99_9, digits));
}

fn put_picture(row: &mut Row, error: &PictureError) {
    row.put("psnr", Cell::Number(error.psnr_linear, 2));
    row.put("flip", Cell::Number(error.flip, 4));
    row.put("ssim", Cell::Number(error.ssim, 4));
    row.put("rms_linear", Cell::Number(error.rms_linear, 5));
    let (all, thin) = (&error.coverage.all, &error.coverage.thin);
    let percent = |share: f64| Cell::Number(100.0 * share, 2);
    row.put("bias_percent", percent(all.bias()));
    row.put("coverage_percent", percent(all.relative()));
    if thin.area > 0.0 {
        row.put("thin_bias_percent", percent(thin.bias()));
        row.put("thin_coverage_percent", percent(thin.relative()));
    }
}

/// Linear light in thousandths of white.
fn thousandths(light: f64) -> Cell {
    Cell::Number(1e3 * light, 2)
}

/// Measures methods on a scene from cameras: a row for each camera and method, and one of the noise
/// floor. A method without a picture has a row with the reason.
///
/// Every picture is judged. Then all methods draw in turn, on one thread, and are timed.
///
/// # Errors
/// When a camera cannot see, or there is no thread.
pub fn measure(
    scene: Scene<'_>,
    cameras: &[Camera],
    methods: &[Method<'_>],
    plan: &QualityPlan,
    progress: &dyn Progress,
) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    for camera in cameras {
        rows.extend(at(scene, camera, methods, plan, progress)?);
    }
    Ok(rows)
}

fn at(
    scene: Scene<'_>,
    camera: &Camera,
    methods: &[Method<'_>],
    plan: &QualityPlan,
    progress: &dyn Progress,
) -> Result<Vec<Row>, BenchError> {
    let mut references = References {
        scene,
        sampling: SEEDS.map(|seed| Sampling {
            strata_log2: plan.strata_log2,
            seed,
        }),
        style: plan.style,
        made: Vec::new(),
    };
    let reference = references.of(camera, 0, progress)?;
    let second = references.of(camera, 1, progress)?;
    let judge = Judge::new(&reference);
    let samples = match scene.mesh {
        Some(_) => TRIANGLE_SAMPLES,
        None => 1 << (2 * plan.strata_log2),
    };
    let blank = |method: &str, family: &str, kind: &str| {
        let mut row = Row::default();
        row.put("scene", scene.name);
        let stem = std::path::Path::new(scene.name).file_stem();
        row.put("stem", stem.map(|stem| stem.to_string_lossy().into_owned()));
        row.put("size", format!("{}x{}", camera.width, camera.height));
        row.put("height", u64::from(camera.height));
        row.put("method", method);
        row.put("family", family);
        row.put("kind", kind);
        row.put("reference_samples", u64::from(samples));
        row.put("scene_voxels", scene.graph.map(|graph| graph.voxels));
        row.put("scene_triangles", scene.mesh.map(|mesh| mesh.len() as u64));
        row.put(
            "distance",
            Cell::Number((camera.eye - camera.target).length(), 3),
        );
        row
    };
    let mut floor = blank(NOISE_FLOOR, "reference", "reference");
    let mismatch = |e: SizeError| failed(e);
    let error = judge.judge(&second.rgba, &second.shares);
    put_picture(&mut floor, &error.map_err(mismatch)?);

    let mut films = Vec::new();
    for motion in &plan.motions {
        progress.begin("drawing references of a film", 2);
        let cameras: Vec<Camera> = (0..plan.frames)
            .map(|frame| motion.after(camera, frame))
            .collect::<Result<_, _>>()
            .map_err(shiftvox::project::SetupError::from)?;
        let truth = references.film(&cameras, 0)?;
        progress.advance(1);
        let second = references.film(&cameras, 1)?;
        let (of_film, _) = flicker(&second, &truth).map_err(mismatch)?;
        floor.put(motion.columns()[0], thousandths(of_film));
        films.push((motion, cameras, truth));
        progress.end();
    }

    progress.begin("judging pictures", methods.len() as u64);
    let mut exact: Vec<Exact<'_>> = Vec::new();
    let mut rows = Vec::new();
    for method in methods {
        let mut row = blank(&method.name, method.family, &method.kind);
        for (name, value) in &method.settings {
            row.put(name, value.clone());
        }
        let judged = judged(&mut row, method, camera, plan.style, &judge, &mut exact)?;
        let filmed = judged.and_then(|()| {
            let mut films = films.iter();
            films.try_for_each(|(motion, cameras, truth)| {
                let film = film(method, cameras, truth)?;
                let [flicker, flicker_worst, pop, pop_worst, popped] = motion.columns();
                let most = |steps: &[f64]| steps.iter().copied().fold(0.0, f64::max);
                row.put(flicker, thousandths(film.flicker.0));
                row.put(flicker_worst, thousandths(most(&film.flicker.1)));
                if let Some((of_film, steps)) = &film.pop {
                    row.put(pop, thousandths(*of_film));
                    row.put(pop_worst, thousandths(most(steps)));
                    row.put(
                        popped,
                        steps.iter().filter(|&&pop| pop > 0.0).count() as u64,
                    );
                }
                row.put("film_error", thousandths(film.error));
                Ok(())
            })
        });
        if let Err(Refused(reason)) = filmed {
            row.put("refused", reason);
        }
        rows.push(row);
        progress.advance(1);
    }
    progress.end();

    for (methods, rows) in methods
        .chunks(MOST_IN_TURN)
        .zip(rows.chunks_mut(MOST_IN_TURN))
    {
        race(methods, rows, camera, plan.schedule, progress)?;
    }
    add_beaten_by(&mut rows);
    add_rivals(&mut rows);
    rows.push(floor);
    Ok(rows)
}

/// Draws and judges a picture.
fn judged<'m>(
    row: &mut Row,
    method: &Method<'m>,
    camera: &Camera,
    style: PixelStyle,
    judge: &Judge<'_>,
    exact: &mut Vec<Exact<'m>>,
) -> Result<Result<(), Refused>, BenchError> {
    let (rgba, examined) = match method.show(camera) {
        Ok(shown) => shown,
        Err(refused) => return Ok(Err(refused)),
    };
    put_picture(row, &judge.judge(&rgba, &examined.shares).map_err(failed)?);
    if let (Some(graph), Some(samples)) = (method.graph, &examined.samples) {
        let is_same = |exact: &Exact<'_>| {
            std::ptr::eq(exact.graph, graph) && exact.aa_log2 == samples.aa_log2
        };
        let place = match exact.iter().position(is_same) {
            Some(place) => place,
            None => {
                exact.push(Exact::new(graph, camera, samples.aa_log2, style)?);
                exact.len() - 1
            }
        };
        exact[place].put(row, samples);
    }
    if let Some(spread) = examined.vertices {
        put_spread(
            row,
            ["vertex_mean", "vertex_p999", "vertex_worst"],
            spread,
            4,
        );
    }
    if let Some((name, count)) = examined.counters.first() {
        row.put("work", *count);
        row.put("work_unit", *name);
    }
    // Bytes that the frame reads: those of its level of detail, if there are levels.
    row.put("read_bytes", method.bytes);
    for (name, count) in &examined.counters {
        let name = if *name == "bytes" { "read_bytes" } else { name };
        row.put(name, *count);
    }
    row.put("bytes", method.bytes);
    row.put("build_ms", method.build_ms.map(Cell::ms));
    row.put("remark", examined.remark);
    Ok(Ok(()))
}

/// Times methods, interleaved, on one thread.
fn race(
    methods: &[Method<'_>],
    rows: &mut [Row],
    camera: &Camera,
    schedule: Schedule,
    progress: &dyn Progress,
) -> Result<(), BenchError> {
    let pool = pool(1)?;
    let takes_part = methods.iter().zip(rows);
    let (drawings, rows): (Vec<_>, Vec<_>) = takes_part
        .filter(|(_, row)| *row.get("refused") == Cell::None)
        .map(|(method, row)| ((method.drawing)(), row))
        .unzip();
    let frames = drawings.iter().map(|drawing| drawing.frames(camera));
    let mut frames: Vec<_> = frames.collect::<Result<_, _>>().map_err(failed)?;
    let times = interleave(frames.len(), schedule, progress, &mut |place| {
        pool.install(|| {
            let clock = Clock::start();
            let drawn = black_box(frames[place]());
            let elapsed = clock.elapsed();
            drawn.map(|()| elapsed).map_err(failed)
        })
    })?;
    rows.into_iter()
        .zip(times)
        .for_each(|(row, times)| times.put(row));
    Ok(())
}

/// The most important columns of the rows of one scene and camera, for people.
#[must_use]
pub fn table(title: &str, rows: &[Row]) -> Table {
    const COLUMNS: [&str; 24] = [
        "method",
        "ms",
        "work",
        "psnr",
        "flip",
        "bias_percent",
        "flicker_turntable",
        "flicker_dolly",
        "flicker_pan",
        "pop_turntable",
        "pop_dolly",
        "pop_pan",
        "popped_dolly",
        "extra",
        "missing",
        "elsewhere",
        "vertex_worst",
        "read_bytes",
        "build_ms",
        "ahead",
        "beaten_by",
        "ssim",
        "remark",
        "refused",
    ];
    Table::select(title, rows, &COLUMNS).condensed()
}

/// Plots of the rows of one scene and camera: time and machine-independent work against errors and
/// flicker.
#[must_use]
pub fn panels(rows: &[Row]) -> Vec<Panel> {
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    let title = format!("{}, {}", first.text("scene"), first.text("size"));
    let floor = rows.iter().find(|row| row.text("method") == NOISE_FLOOR);
    let mut panels = Vec::new();
    for y in [
        (
            "rms_linear",
            "error against the reference: rms, linear light",
        ),
        ("flip", "error against the reference: mean FLIP"),
        ("wrong_share", "share of wrong samples"),
        (
            "flicker_turntable",
            "flicker of a turntable, thousandths of white",
        ),
        ("flicker_dolly", "flicker of a dolly, thousandths of white"),
        ("flicker_pan", "flicker of a pan, thousandths of white"),
    ] {
        let level = floor.and_then(|row| row.get(y.0).number());
        for x in [
            ("operations", "operations of the machine per frame"),
            ("ms", "ms per frame, one thread (median)"),
        ] {
            let plot = RowPlot {
                title: &title,
                x,
                y,
                series: "kind",
                front: Some("method"),
                level: level.map(|at| (at, NOISE_FLOOR)),
                deviation: None,
            };
            panels.extend(plot.chart(rows));
        }
    }
    panels
}
