//! Scene and camera to picture: what `render`, `turntable` and the demo share.

use std::time::Instant;

use super::args::{Aov, EngineArgs, PictureArgs};
use super::engines;
use super::error::{CliError, Kind};
use super::scenes::Scene;
use crate::frame::Colors;
use crate::graph::GraphView;
use crate::picture::png::Pixels;
use crate::picture::{ResolveError, Resolver, Rows, Shading, lights};
use crate::project::{Camera, Contents, Engine, FrameSetup, Stats, Viewer};

/// A drawn picture and what it took.
pub(super) struct Drawn {
    /// Its colours. The other buffers are made when they are written.
    pub(super) pixels: Pixels,
    /// Pixels that show a voxel at their middle sample.
    pub(super) pixels_drawn: usize,
    pub(super) setup: FrameSetup,
    /// What the engine counted of one frame.
    pub(super) stats: Stats,
    /// Time of the engine for each repetition, milliseconds.
    pub(super) times_ms: Vec<f64>,
    /// Time to make the colours from the last frame, milliseconds.
    pub(super) resolve_ms: f64,
}

/// Most samples of a picture: about three gigabytes with all that is made of them.
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
    /// What the viewer's frames hold.
    contents: Contents,
    /// What the viewer shows.
    last: Option<Drawn>,
}

impl<'s> Drawing<'s> {
    /// Nothing is drawn yet. `is_hashed`: whether pictures' hashes are wanted,
    /// which are over all buffers.
    pub(super) fn new(
        scene: &'s Scene,
        engine_args: &'s EngineArgs,
        picture_args: &'s PictureArgs,
        is_hashed: bool,
    ) -> Result<Self, CliError> {
        let engine = engines::engine(engine_args)?;
        let wants = |aov: Aov| picture_args.aov.contains(&aov);
        let of_voxels = [Aov::Depth, Aov::Normal, Aov::Voxel];
        let contents = if wants(Aov::Records) {
            Contents::Records
        } else if is_hashed || of_voxels.into_iter().any(wants) || !scene.graph.links.is_empty() {
            Contents::Voxels
        } else {
            // A fifth of the memory. Colours depend on voxels where a node has
            // no normal, and the graph then says where the node is.
            Contents::Nodes
        };
        Ok(Self {
            scene,
            engine_args,
            picture_args,
            viewer: Viewer::new(scene.graph.view(), engine, contents),
            contents,
            last: None,
        })
    }

    /// Draws the scene, unless it was drawn like this the last time, and makes the colours.
    pub(super) fn draw(&mut self, camera: &Camera) -> Result<(), CliError> {
        let setup = self.setup(camera)?;
        let mut started = Instant::now();
        let is_shown = self.viewer.shows(&setup);
        let graph = &self.scene.graph;
        let light = lights(graph, &setup, self.picture_args.shading());
        let mut stats = self.viewer.render_lit(&setup, &light)?;
        let mut draw_ms = milliseconds_since(started);
        started = Instant::now();
        let pixels = match self.last.take().filter(|_| is_shown) {
            Some(last) => last.pixels,
            None => match self.pixels(&setup) {
                Err(ResolveError::Voxel) if self.contents == Contents::Nodes => {
                    // The graph does not say it: once more, with voxels.
                    let engine = engines::engine(self.engine_args)?;
                    self.contents = Contents::Voxels;
                    self.viewer = Viewer::new(graph.view(), engine, self.contents);
                    started = Instant::now();
                    stats = self.viewer.render_lit(&setup, &light)?;
                    draw_ms += milliseconds_since(started);
                    started = Instant::now();
                    self.pixels(&setup)?
                }
                made => made?,
            },
        };
        let pixels_drawn = self.resolver(&setup)?.drawn();
        self.last = Some(Drawn {
            pixels,
            pixels_drawn,
            setup,
            stats,
            times_ms: vec![draw_ms],
            resolve_ms: milliseconds_since(started),
        });
        Ok(())
    }

    /// What was drawn, and its buffers.
    pub(super) fn shown(&self) -> Result<(&Drawn, Resolver<'_>), CliError> {
        let nothing = || CliError::new(Kind::Run, "nothing was drawn");
        let drawn = self.last.as_ref().ok_or_else(nothing)?;
        Ok((drawn, self.resolver(&drawn.setup)?))
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

    /// The buffers of what the viewer shows.
    fn resolver(&self, setup: &FrameSetup) -> Result<Resolver<'_>, ResolveError> {
        // A frame that is not there has no samples.
        let frame = self.viewer.frame();
        let frame = frame.ok_or(ResolveError::Size(0, 0, setup.width, setup.height))?;
        let shading = self.picture_args.shading();
        let background = self.picture_args.background.unwrap_or_default();
        Resolver::new(frame, &self.scene.graph, setup, shading, background)
    }

    /// The colours of what the viewer shows.
    fn pixels(&self, setup: &FrameSetup) -> Result<Pixels, ResolveError> {
        let resolver = self.resolver(setup)?;
        let (width, height) = resolver.size();
        let rows = 0..height;
        Ok(match resolver.is_opaque() {
            true => Pixels::opaque(width, height, resolver.colors(rows)?),
            false => Pixels::new(width, height, resolver.colors(rows)?),
        })
    }
}

/// Draws a scene and makes the colours. With `repeat` above 1 the times are
/// those of so many frames drawn for that alone.
pub(super) fn draw<'s>(
    scene: &'s Scene,
    camera: &Camera,
    engine_args: &'s EngineArgs,
    picture_args: &'s PictureArgs,
    repeat: u32,
    is_hashed: bool,
) -> Result<Drawing<'s>, CliError> {
    let mut drawing = Drawing::new(scene, engine_args, picture_args, is_hashed)?;
    let times_ms = if repeat > 1 {
        Some(drawing.measure(camera, repeat)?)
    } else {
        None
    };
    drawing.draw(camera)?;
    if let (Some(drawn), Some(times_ms)) = (&mut drawing.last, times_ms) {
        drawn.times_ms = times_ms;
    }
    Ok(drawing)
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
