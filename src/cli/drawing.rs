//! Scene and camera to picture: what `render`, `turntable` and the demo share.

use std::time::Instant;

use super::args::{Aov, EngineArgs, PictureArgs};
use super::engines;
use super::error::{CliError, Kind};
use super::scenes::Scene;
use crate::frame::{Colors, Frame};
use crate::picture::{Picture, resolve};
use crate::project::{Camera, FrameSetup, Stats};

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

/// Draws a scene `repeat` times (at least once) and makes the picture.
pub(super) fn draw(
    scene: &Scene,
    camera: &Camera,
    engine_args: &EngineArgs,
    picture_args: &PictureArgs,
    repeat: u32,
) -> Result<Drawn, CliError> {
    let graph = &scene.graph;
    let samples =
        (u64::from(camera.width) * u64::from(camera.height)) << (2 * picture_args.aa_log2());
    if samples > MAX_SAMPLES {
        return Err(CliError::new(
            Kind::Limit,
            format!("a picture of {samples} samples is too large: the most is {MAX_SAMPLES}"),
        )
        .advise("ask for a smaller --size, or fewer samples with --aa"));
    }
    let options = engine_args.options(picture_args.aa_log2());
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options)?;
    let mut engine = engines::engine(engine_args)?;
    let with_records = picture_args.aov.contains(&Aov::Records);
    let mut frame = Frame::new(setup.width, setup.height, with_records);
    let mut times_ms = Vec::new();
    if repeat > 1 {
        // A frame as experiments time it: clear, traverse, colours written.
        let mut colors = Colors::new(setup.width, setup.height);
        for _ in 0..repeat {
            let started = Instant::now();
            engine.draw_colors(&graph.view(), &graph.color, &setup, &mut colors)?;
            std::hint::black_box(&colors);
            times_ms.push(milliseconds_since(started));
        }
    }
    let started = Instant::now();
    let stats = engine.render(&graph.view(), &setup, &mut frame)?;
    if repeat <= 1 {
        times_ms.push(milliseconds_since(started));
    }
    let started = Instant::now();
    let shading = picture_args.shading();
    let background = picture_args.background.unwrap_or_default();
    let picture = resolve(&frame, graph, &setup, shading, background)?;
    Ok(Drawn {
        picture,
        setup,
        stats,
        times_ms,
        resolve_ms: milliseconds_since(started),
    })
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
