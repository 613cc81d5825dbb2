//! Scene and camera to picture: what `render`, `turntable` and the demo share.

use std::time::Instant;

use super::args::{Aov, EngineArgs, PictureArgs};
use super::engines;
use super::error::{CliError, Kind};
use super::scenes::Scene;
use crate::frame::{Colors, Frame};
use crate::graph::GraphView;
use crate::picture::{Picture, Shading, lights, resolve};
use crate::project::{Camera, Contents, Engine, FrameSetup, Stats, Viewer};

/// A drawn picture and what it took.
pub(super) struct Drawn {
    pub(super) picture: Picture,
    pub(super) setup: FrameSetup,
    /// What the engine counted of one frame.
    pub(super) stats: Stats,
    /// Time of the engine for each repetition, milliseconds.
    pub(super) times_ms: Vec<f64>,
    /// Time to make the picture from the last frame, milliseconds.
    pub(super) resolve_ms: f64,
}

/// Most samples of a picture: about nine gigabytes with all that is made of them.
const MAX_SAMPLES: u64 = 1 << 27;

/// Refuses a picture that would take too much memory.
pub(super) fn check_samples((width, height): (u32, u32), aa_log2: u32) -> Result<(), CliError> {
    let samples = (u64::from(width) * u64::from(height)) << (2 * aa_log2);
    if samples <= MAX_SAMPLES {
        return Ok(());
    }
    Err(CliError::new(
        Kind::Limit,
        format!("a picture of {samples} samples is too large: the most is {MAX_SAMPLES}"),
    )
    .advise("ask for a smaller --size, or fewer samples with --aa"))
}

/// A scene that is drawn, once or from many cameras: what is made for a frame
/// and can stay (engine, frame, and a picture that does not change) does.
pub(super) struct Drawing<'s> {
    scene: &'s Scene,
    engine_args: &'s EngineArgs,
    picture_args: &'s PictureArgs,
    viewer: Viewer<'s, Box<dyn Engine>>,
    /// What the viewer shows.
    last: Option<Drawn>,
}

impl<'s> Drawing<'s> {
    /// Nothing is drawn yet.
    pub(super) fn new(
        scene: &'s Scene,
        engine_args: &'s EngineArgs,
        picture_args: &'s PictureArgs,
    ) -> Result<Self, CliError> {
        let engine = engines::engine(engine_args)?;
        let contents = match picture_args.aov.contains(&Aov::Records) {
            true => Contents::Records,
            false => Contents::Voxels,
        };
        Ok(Self {
            scene,
            engine_args,
            picture_args,
            viewer: Viewer::new(scene.graph.view(), engine, contents),
            last: None,
        })
    }

    /// Draws the scene, unless it was drawn like this the last time, and makes the picture.
    pub(super) fn draw(&mut self, camera: &Camera) -> Result<&Drawn, CliError> {
        let setup = self.setup(camera)?;
        let started = Instant::now();
        let is_shown = self.viewer.shows(&setup);
        let graph = &self.scene.graph;
        let light = lights(graph, &setup, self.picture_args.shading());
        let stats = self.viewer.render_lit(&setup, &light)?;
        let times_ms = vec![milliseconds_since(started)];
        let started = Instant::now();
        let picture = match self.last.take().filter(|_| is_shown) {
            Some(last) => last.picture,
            None => self.resolve(&setup)?,
        };
        Ok(self.last.insert(Drawn {
            picture,
            setup,
            stats,
            times_ms,
            resolve_ms: milliseconds_since(started),
        }))
    }

    /// Times of drawing the same frame so many times, each time all of it, as
    /// experiments time a frame: clear, traverse, colours written. Milliseconds.
    fn measure(&self, camera: &Camera, repeat: u32) -> Result<Vec<f64>, CliError> {
        let setup = self.setup(camera)?;
        let graph = &self.scene.graph;
        let mut engine = engines::engine(self.engine_args)?;
        let mut colors = Colors::new(setup.width, setup.height);
        let light = lights(graph, &setup, Shading::Flat);
        let view = GraphView {
            light: &light,
            ..graph.view()
        };
        let mut times_ms = Vec::new();
        for _ in 0..repeat {
            let started = Instant::now();
            engine.draw_colors(&view, &graph.color, &setup, &mut colors)?;
            std::hint::black_box(&colors);
            times_ms.push(milliseconds_since(started));
        }
        Ok(times_ms)
    }

    fn setup(&self, camera: &Camera) -> Result<FrameSetup, CliError> {
        let aa_log2 = self.picture_args.aa_log2();
        check_samples((camera.width, camera.height), aa_log2)?;
        let graph = &self.scene.graph;
        let options = self.engine_args.rules.options(aa_log2);
        let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options)?;
        Ok(setup)
    }

    /// The picture of what the viewer shows.
    fn resolve(&self, setup: &FrameSetup) -> Result<Picture, CliError> {
        let nothing = Frame::nodes_only(0, 0);
        let frame = self.viewer.frame().unwrap_or(&nothing);
        let shading = self.picture_args.shading();
        let background = self.picture_args.background.unwrap_or_default();
        let picture = resolve(frame, &self.scene.graph, setup, shading, background)?;
        Ok(picture)
    }
}

/// Draws a scene and makes the picture. With `repeat` above 1 the times are
/// those of so many frames drawn for that alone.
pub(super) fn draw(
    scene: &Scene,
    camera: &Camera,
    engine_args: &EngineArgs,
    picture_args: &PictureArgs,
    repeat: u32,
) -> Result<Drawn, CliError> {
    let mut drawing = Drawing::new(scene, engine_args, picture_args)?;
    let times_ms = if repeat > 1 {
        Some(drawing.measure(camera, repeat)?)
    } else {
        None
    };
    drawing.draw(camera)?;
    let drawn = drawing.last.map(|drawn| Drawn {
        times_ms: times_ms.unwrap_or(drawn.times_ms),
        ..drawn
    });
    drawn.ok_or_else(|| CliError::new(Kind::Run, "nothing was drawn"))
}

pub(super) fn milliseconds_since(started: Instant) -> f64 {
    started.elapsed().as_secs_f64() * 1e3
}

/// Least, middle and greatest of some times; zeros for none. The middle of an
/// even number of times is the mean of two.
pub(super) fn min_median_max(times: &[f64]) -> (f64, f64, f64) {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (Some(&min), Some(&max)) = (sorted.first(), sorted.last()) else {
        return (0.0, 0.0, 0.0);
    };
    let half = sorted.len() / 2;
    let median = if sorted.len() % 2 == 1 {
        sorted[half]
    } else {
        (sorted[half - 1] + sorted[half]) / 2.0
    };
    (min, median, max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_statistics() {
        assert_eq!(min_median_max(&[3.0, 1.0, 2.0]), (1.0, 2.0, 3.0));
        assert_eq!(min_median_max(&[4.0, 1.0, 2.0, 3.0]), (1.0, 2.5, 4.0));
        assert_eq!(min_median_max(&[]), (0.0, 0.0, 0.0));
    }
}
