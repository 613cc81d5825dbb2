//! A voxel graph as a [`Drawable`], with any engine of voxels.

use std::borrow::Cow;

use serde_json::json;

use super::{
    Buffers, COLOR_BYTES, DrawError, Drawable, Figures, Frames, Shown, check_samples,
    milliseconds_since, now, timed,
};
use crate::frame::Colors;
use crate::graph::Graph;
use crate::picture::{Background, Buffer, Pixels, ResolveError, Resolver, Rows, Shading, lights};
use crate::project::{
    Bounds, Camera, Canvas, Contents, Engine, FrameSetup, SetupOptions, Stats, Up, Viewer,
};

#[derive(Debug, Clone, PartialEq)]
pub struct GraphStyle {
    pub options: SetupOptions,
    pub shading: Shading,
    pub background: Background,
    pub buffers: Vec<Buffer>,
    /// Whether the picture's hash is needed, which is over all buffers.
    pub is_hashed: bool,
}

/// A graph drawn from one or many cameras. Engine, frame and an unchanged picture are kept.
pub struct GraphDrawing<'g> {
    graph: &'g Graph,
    up: Up,
    style: GraphStyle,
    engine: Box<dyn Fn() -> Box<dyn Engine + Send> + 'g>,
    viewer: Viewer<'g>,
    pixel_bytes: u64,
    last: Option<Drawn>,
}

pub struct DrawnFrame {
    pub setup: FrameSetup,
    pub stats: Stats,
    pub draw_ms: f64,
    was_shown: bool,
}

struct Drawn {
    pixels: Pixels,
    pixels_drawn: usize,
    setup: FrameSetup,
    stats: Stats,
    times_ms: Vec<f64>,
    resolve_ms: f64,
}

impl<'g> GraphDrawing<'g> {
    /// Draws nothing. `engine` makes equal new engines.
    pub fn new(
        graph: &'g Graph,
        up: Up,
        style: GraphStyle,
        engine: impl Fn() -> Box<dyn Engine + Send> + 'g,
    ) -> Self {
        Self::on(Canvas::new(engine()), graph, up, style, engine)
    }

    /// [`GraphDrawing::new`] on another drawing's canvas, whose engine must be of the kind that `engine` makes.
    pub fn on(
        canvas: Canvas,
        graph: &'g Graph,
        up: Up,
        style: GraphStyle,
        engine: impl Fn() -> Box<dyn Engine + Send> + 'g,
    ) -> Self {
        let of_voxels = [Buffer::Depth, Buffer::Normal, Buffer::Voxel];
        let wants = |buffer: &Buffer| style.buffers.contains(buffer);
        let contents = if wants(&Buffer::Records) {
            Contents::Records
        } else if style.is_hashed || of_voxels.iter().any(wants) || !graph.links.is_empty() {
            Contents::Voxels
        } else {
            // Colours depend on voxels only where a node has no normal. A fifth of the memory.
            Contents::Nodes
        };
        Self {
            graph,
            up,
            style,
            viewer: Viewer::new(graph.view(), canvas, contents),
            engine: Box::new(engine),
            pixel_bytes: COLOR_BYTES,
            last: None,
        }
    }

    pub fn into_canvas(self) -> Canvas {
        self.viewer.into_canvas()
    }

    /// Sets the memory that the caller needs per finished pixel, bytes, for the check of memory; by default 3, for colours.
    pub fn expect_pixel_bytes(&mut self, bytes: u64) {
        self.pixel_bytes = bytes;
    }

    /// The integers of a frame. Fails when the picture is too large, or the frame cannot be set up.
    pub fn setup(&self, camera: &Camera) -> Result<FrameSetup, DrawError> {
        check_samples(
            camera,
            self.style.options.aa_log2,
            self.sample_bytes(),
            self.pixel_bytes,
            self.viewer.frame_bytes(),
        )?;
        let Graph {
            placement, depth, ..
        } = self.graph;
        Ok(FrameSetup::new(
            camera,
            placement,
            *depth,
            &self.style.options,
        )?)
    }

    fn sample_bytes(&self) -> u64 {
        let (node, voxel, records, blend) = (4, 16, 4, 16);
        let voxels = match self.viewer.contents() {
            Contents::Nodes => 0,
            Contents::Voxels => voxel,
            Contents::Records => voxel + records,
        };
        let blends = self.style.options.coverage.blends();
        node + voxels + if blends { blend } else { 0 }
    }

    /// Draws a frame, unless the viewer shows it already. Errors: see [`DrawError`].
    pub fn draw_frame(&mut self, camera: &Camera) -> Result<DrawnFrame, DrawError> {
        let setup = self.setup(camera)?;
        let was_shown = self.viewer.shows(&setup);
        let (stats, draw_ms) = self.draw_set_up(&setup)?;
        Ok(DrawnFrame {
            setup,
            stats,
            draw_ms,
            was_shown,
        })
    }

    fn draw_set_up(&mut self, setup: &FrameSetup) -> Result<(Stats, f64), DrawError> {
        let started = now();
        let light = lights(self.graph, setup, self.style.shading)?;
        let stats = self.viewer.render(setup, &light)?;
        Ok((stats, started.map_or(0.0, milliseconds_since)))
    }

    /// Makes something from a drawn frame. Draws the frame again with voxels if colours depend on them.
    pub fn resolve<T>(
        &mut self,
        drawn: &mut DrawnFrame,
        mut make: impl FnMut(&Resolver<'_>) -> Result<T, ResolveError>,
    ) -> Result<T, DrawError> {
        match make(&self.resolver(&drawn.setup)?) {
            Err(ResolveError::Voxel) if self.viewer.contents() == Contents::Nodes => {
                self.viewer.store(Contents::Voxels);
                let (stats, draw_ms) = self.draw_set_up(&drawn.setup)?;
                drawn.stats = stats;
                drawn.draw_ms += draw_ms;
                drawn.was_shown = false;
                Ok(make(&self.resolver(&drawn.setup)?)?)
            }
            made => Ok(made?),
        }
    }

    fn resolver(&self, setup: &FrameSetup) -> Result<Resolver<'_>, ResolveError> {
        let frame = self.viewer.frame();
        let frame = frame.ok_or(ResolveError::Size(0, 0, setup.width, setup.height))?;
        let GraphStyle {
            shading,
            background,
            ..
        } = self.style;
        Resolver::new(frame, self.graph, setup, shading, background)
    }
}

fn pixels(resolver: &Resolver<'_>) -> Result<Pixels, ResolveError> {
    let (width, height) = resolver.size();
    let rows = 0..height;
    Ok(match resolver.is_opaque() {
        true => Pixels::opaque(width, height, resolver.colors(rows)?),
        false => Pixels::new(width, height, resolver.colors(rows)?),
    })
}

impl Drawable for GraphDrawing<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of(self.graph)
    }

    fn up(&self) -> Up {
        self.up
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        let measured = match runs {
            0 | 1 => None,
            runs => Some(timed(runs, self.frames(camera)?)?.1),
        };
        let mut drawn = self.draw_frame(camera)?;
        let started = now();
        let last = self
            .last
            .take()
            .filter(|last| drawn.was_shown && last.setup == drawn.setup);
        let draw_ms = drawn.draw_ms;
        let pixels = match last {
            Some(last) => last.pixels,
            None => self.resolve(&mut drawn, pixels)?,
        };
        let resolve_ms = started.map_or(0.0, milliseconds_since) - (drawn.draw_ms - draw_ms);
        self.last = Some(Drawn {
            pixels,
            pixels_drawn: self.resolver(&drawn.setup)?.drawn(),
            times_ms: measured.unwrap_or_else(|| vec![drawn.draw_ms]),
            setup: drawn.setup,
            stats: drawn.stats,
            resolve_ms,
        });
        Ok(())
    }

    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError> {
        let Some(last) = &self.last else {
            return Ok(None);
        };
        let counters: Figures = last
            .stats
            .iter()
            .map(|&(name, count)| (name, count.into()))
            .collect();
        let word = json!({
            "bits": last.setup.format.bits(),
            "screen_fraction_bits": last.setup.format.frac(),
            "clip_fraction_bits": last.setup.clip_frac,
        });
        Ok(Some(Shown {
            pixels: Cow::Borrowed(&last.pixels),
            buffers: Buffers::Resolved(Box::new(self.resolver(&last.setup)?)),
            pixels_drawn: last.pixels_drawn,
            coverage: &[],
            times_ms: &last.times_ms,
            counters,
            details: vec![("word", word), ("resolve_ms", json!(last.resolve_ms))],
        }))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let (graph, setup) = (self.graph, self.setup(camera)?);
        let mut engine = (self.engine)();
        let mut colors = Colors::new(0, 0);
        colors.fit(setup.width, setup.height)?;
        let light = lights(graph, &setup, Shading::Flat)?;
        Ok(Box::new(move || {
            let view = graph.lit(&light);
            engine.draw_colors(&view, &graph.color, &setup, &mut colors)?;
            std::hint::black_box(&colors);
            Ok(())
        }))
    }
}
