//! `bench quality`: methods on a scene, from one or more cameras, become rows.

use std::hint::black_box;

use super::compare::{add_beaten_by, add_rivals};
use super::judge::Judge;
use super::method::{Examined, Method, Refused, drawn};
use super::motion::Motion;
use super::reference::{Reference, TRIANGLE_SAMPLES, cast, of_triangles};
use crate::bench::{BenchError, Clock, Schedule, interleave, pool};
use crate::measure::{CoverageError, Light, count_elsewhere, flicker, light_of};
use crate::model::frame::{exact_setup, reference};
use crate::report::plot::{Chart, RowPlot};
use crate::report::{Cell, Row, Table};
use shiftvox::graph::{Graph, Progress, Silent};
use shiftvox::picture::{Background, Rows, Shading};
use shiftvox::project::{Camera, SetupError};
use shiftvox_mesh::Surface;

#[derive(Debug, Clone)]
pub struct QualityPlan {
    pub schedule: Schedule,
    /// Camera motions to film. Without any there is no flicker.
    pub motions: Vec<Motion>,
    /// Frames of a film, 2 or more.
    pub frames: u32,
    /// Strata of a reference's pixel along each axis, as a power of two.
    pub strata_log2: u32,
}

#[derive(Clone, Copy)]
pub struct Scene<'s> {
    pub name: &'s str,
    /// Its voxels, of which exact rays are the truth.
    pub graph: Option<&'s Graph>,
    /// Its triangles, which are the truth if there are any.
    pub mesh: Option<&'s dyn Surface>,
}

/// The method of rows that compare a second reference with the first.
const NOISE_FLOOR: &str = "noise floor";
const SEEDS: [u64; 2] = [1, 2];
/// Most methods that draw in turn, and so have their buffers in memory at one time.
const MOST_IN_TURN: usize = 64;

fn failed(reason: impl std::fmt::Display) -> BenchError {
    BenchError::Picture(reason.to_string())
}

impl Scene<'_> {
    fn reference(
        &self,
        camera: &Camera,
        seed: u64,
        plan: &QualityPlan,
        progress: &dyn Progress,
    ) -> Result<Reference, BenchError> {
        if let Some(mesh) = self.mesh {
            return of_triangles(mesh, camera, seed, progress);
        }
        let graph = self
            .graph
            .ok_or_else(|| failed("a scene without voxels and triangles"))?;
        let (shading, background) = (Shading::default(), Background::default());
        let setup = exact_setup(graph, camera, 0)?;
        let sampling = (plan.strata_log2, seed);
        Ok(cast(graph, &setup, shading, background, sampling, progress))
    }

    fn film(
        &self,
        cameras: &[Camera],
        seed: u64,
        plan: &QualityPlan,
    ) -> Result<Vec<Light>, BenchError> {
        let light = |camera| Ok(light_of(&self.reference(camera, seed, plan, &Silent)?.rgba));
        cameras.iter().map(light).collect()
    }
}

struct Exact<'m> {
    graph: &'m Graph,
    aa_log2: u32,
    voxel: Vec<[i32; 4]>,
}

impl<'m> Exact<'m> {
    fn new(graph: &'m Graph, camera: &Camera, aa_log2: u32) -> Result<Self, BenchError> {
        let setup = exact_setup(graph, camera, aa_log2)?;
        let frame = reference(&graph.view(), &setup).map_err(BenchError::of_exact_rays)?;
        Ok(Self {
            graph,
            aa_log2,
            voxel: frame.voxel,
        })
    }

    fn put(&self, row: &mut Row, samples: &[[i32; 4]]) {
        let error = CoverageError::between(samples, &self.voxel);
        let elsewhere = count_elsewhere(samples, &self.voxel, self.graph.depth);
        let share = (error.extra + error.missing) as f64 / error.covered.max(1) as f64;
        row.put("extra", error.extra);
        row.put("missing", error.missing);
        row.put("elsewhere", elsewhere);
        row.put("coarser", error.wrong_voxel - elsewhere);
        row.put("wrong_share", Cell::Number(share, 6));
    }
}

#[derive(Debug, thiserror::Error)]
enum Unmeasured {
    #[error(transparent)]
    Refused(#[from] Refused),
    /// The experiment itself failed.
    #[error(transparent)]
    Failed(#[from] BenchError),
}

/// Measures methods on a scene from cameras: a row for each camera and method, and one of the noise
/// floor. A method without a picture has a row with the reason.
///
/// Every picture is judged. Then all methods draw in turn, on one thread, and are timed.
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

fn head(scene: Scene<'_>, camera: &Camera, plan: &QualityPlan, method: [&str; 3]) -> Row {
    let mut row = Row::default();
    let samples = match scene.mesh {
        Some(_) => TRIANGLE_SAMPLES,
        None => 1 << (2 * plan.strata_log2),
    };
    row.put("scene", scene.name);
    row.put("size", format!("{}x{}", camera.width, camera.height));
    row.put("height", u64::from(camera.height));
    row.put("method", method[0]);
    row.put("family", method[1]);
    row.put("kind", method[2]);
    row.put("reference_samples", u64::from(samples));
    row.put("scene_voxels", scene.graph.map(|graph| graph.voxels));
    row.put("scene_triangles", scene.mesh.map(|mesh| mesh.len() as u64));
    let distance = (camera.eye - camera.target).length();
    row.put("distance", Cell::Number(distance, 3));
    row
}

fn at(
    scene: Scene<'_>,
    camera: &Camera,
    methods: &[Method<'_>],
    plan: &QualityPlan,
    progress: &dyn Progress,
) -> Result<Vec<Row>, BenchError> {
    let reference = scene.reference(camera, SEEDS[0], plan, progress)?;
    let second = scene.reference(camera, SEEDS[1], plan, progress)?;
    let judge = Judge::new(&reference);
    let mut floor = head(scene, camera, plan, [NOISE_FLOOR, "reference", "reference"]);
    let picture = (second.width, second.height, &second.rgba[..]);
    let judged = judge.put(&mut floor, picture, &second.shares);
    judged.map_err(failed)?;

    let mut films: Vec<(&Motion, Vec<Camera>, Vec<Light>)> = Vec::new();
    for motion in &plan.motions {
        progress.begin("drawing references of a film", 2);
        let cameras: Vec<Camera> = (0..plan.frames)
            .map(|frame| motion.after(camera, frame))
            .collect::<Result<_, _>>()
            .map_err(SetupError::from)?;
        let truth = scene.film(&cameras, SEEDS[0], plan)?;
        progress.advance(1);
        let second = scene.film(&cameras, SEEDS[1], plan)?;
        floor.put(
            motion.columns()[0],
            thousandths(flickers(&second, &truth)?.0),
        );
        films.push((motion, cameras, truth));
        progress.end();
    }

    progress.begin("judging pictures", methods.len() as u64);
    let mut exact: Vec<Exact<'_>> = Vec::new();
    let mut rows = Vec::new();
    for method in methods {
        let names = [&method.name, method.family, &method.kind];
        let mut row = head(scene, camera, plan, names);
        for (name, value) in &method.settings {
            row.put(name, value.clone());
        }
        let judged = judged_row(&mut row, method, camera, &judge, &mut exact);
        let filmed = judged.and_then(|()| {
            films.iter().try_for_each(|(motion, cameras, truth)| {
                film(&mut row, method, motion, cameras, truth)
            })
        });
        match filmed {
            Ok(()) => {}
            Err(Unmeasured::Refused(Refused(reason))) => row.put("refused", reason),
            Err(Unmeasured::Failed(error)) => return Err(error),
        }
        rows.push(row);
        progress.advance(1);
    }
    progress.end();

    let in_turn = methods.chunks(MOST_IN_TURN);
    for (methods, rows) in in_turn.zip(rows.chunks_mut(MOST_IN_TURN)) {
        race(methods, rows, camera, plan.schedule, progress)?;
    }
    add_beaten_by(&mut rows);
    add_rivals(&mut rows);
    rows.push(floor);
    Ok(rows)
}

fn thousandths(light: f64) -> Cell {
    Cell::Number(1e3 * light, 2)
}

fn flickers(film: &[Light], truth: &[Light]) -> Result<(f64, f64), BenchError> {
    flicker(film, truth).ok_or_else(|| failed("the pictures of a film differ in size"))
}

fn film(
    row: &mut Row,
    method: &Method<'_>,
    motion: &Motion,
    cameras: &[Camera],
    truth: &[Light],
) -> Result<(), Unmeasured> {
    let mut drawing = (method.drawing)();
    let film: Vec<Light> = cameras
        .iter()
        .map(|camera| Ok(light_of(&drawn(drawing.as_mut(), camera)?.pixels.rgba())))
        .collect::<Result<_, Refused>>()?;
    let (whole, worst) = flickers(&film, truth)?;
    let columns = motion.columns();
    row.put(columns[0], thousandths(whole));
    row.put(columns[1], thousandths(worst));
    Ok(())
}

fn judged_row<'m>(
    row: &mut Row,
    method: &Method<'m>,
    camera: &Camera,
    judge: &Judge<'_>,
    exact: &mut Vec<Exact<'m>>,
) -> Result<(), Unmeasured> {
    let mut drawing = (method.drawing)();
    let shown = drawn(drawing.as_mut(), camera)?;
    let Examined {
        shares,
        samples,
        counters,
        remark,
    } = (method.examine)(&shown, camera)?;
    let (width, height) = shown.buffers.size();
    let judged = judge.put(row, (width, height, &shown.pixels.rgba()), &shares);
    judged.map_err(failed)?;
    if let (Some(graph), Some((aa_log2, voxels))) = (method.graph, samples) {
        let is_same =
            |exact: &Exact<'_>| std::ptr::eq(exact.graph, graph) && exact.aa_log2 == aa_log2;
        if !exact.iter().any(is_same) {
            exact.push(Exact::new(graph, camera, aa_log2)?);
        }
        if let Some(exact) = exact.iter().find(|exact| is_same(exact)) {
            exact.put(row, &voxels);
        }
    }
    if let Some((name, count)) = counters.first() {
        row.put("work", *count);
        row.put("work_unit", *name);
    }
    // Bytes that the frame reads: those of its level of detail, if there are levels.
    row.put("read_bytes", method.bytes);
    for (name, count) in &counters {
        let name = if *name == "bytes" { "read_bytes" } else { name };
        row.put(name, *count);
    }
    row.put("bytes", method.bytes);
    row.put("build_ms", method.build_ms.map(Cell::ms));
    row.put("remark", remark);
    Ok(())
}

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

pub fn table(title: &str, rows: &[Row]) -> Table {
    const COLUMNS: &str = "method ms work psnr flip bias_percent flicker_turntable flicker_dolly flicker_pan extra \
        missing elsewhere read_bytes build_ms ahead beaten_by remark refused";
    Table::select(title, rows, COLUMNS).condensed()
}

/// Plots of the rows of one scene and camera: time and machine-independent work against errors and
/// flicker.
pub fn charts(rows: &[Row]) -> Vec<Chart> {
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    let title = format!("{}, {}", first.text("scene"), first.text("size"));
    let floor = rows.iter().find(|row| row.text("method") == NOISE_FLOOR);
    let mut charts = Vec::new();
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
            charts.extend(plot.chart(rows));
        }
    }
    charts
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use shiftvox::machine::Machine;
    use shiftvox::project::SetupOptions;
    use shiftvox::scene::{NoMeshes, OpenOptions, Source, open_source};

    use crate::bench::MakeEngine;
    use crate::quality::voxel_method;

    #[test]
    fn methods_are_refused_and_experiments_fail() {
        let source = Source::Generated("gen:sphere,depth=3".to_owned());
        let opened = open_source(source, &OpenOptions::default(), &NoMeshes, &Silent);
        let graph = opened.unwrap().graph;
        let too_deep = Graph {
            depth: 99,
            ..graph.clone()
        };
        let (eye, target) = (DVec3::new(20.0, -9.0, 12.0), DVec3::splat(4.0));
        let camera = Camera::looking(eye, target, 60.0, (8, 8));
        let plan = QualityPlan {
            schedule: Schedule { warmup: 0, runs: 1 },
            motions: Vec::new(),
            frames: 2,
            strata_log2: 1,
        };
        let run = |method: Method<'_>| {
            let scene = Scene {
                name: "sphere",
                graph: Some(&graph),
                mesh: None,
            };
            let rows = measure(scene, &[camera], &[method], &plan, &Silent);
            rows.map(|rows| !rows[0].text("refused").is_empty()).ok()
        };
        let make: MakeEngine = |_| Box::new(Machine::default());
        let method = |options| voxel_method(&graph, ("machine", make), options);
        let wide = SetupOptions::default();
        assert_eq!(run(method(wide)), Some(false));
        // The words do not hold the picture.
        let narrow = SetupOptions {
            bits: 16,
            frac: Some(15),
            ..wide
        };
        assert_eq!(run(method(narrow)), Some(true));
        let unseen = Method {
            graph: Some(&too_deep),
            ..method(wide)
        };
        assert_eq!(run(unseen), None);
    }
}
