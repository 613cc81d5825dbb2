//! Interleaved runs: each round draws one frame per contender.
//!
//! Drift then affects all contenders, and none finds the caches as its own last frame left them. One
//! more frame gives the counters and the picture. `spec/lab.md` defines a frame.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::hint::black_box;

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::clock::{Clock, Elapsed};
use super::statistics::Summary;
use crate::report::{Cell, Row};
use shiftvox::frame::{Colors, Frame};
use shiftvox::graph::{Graph, Progress};
use shiftvox::picture::ResolveError;
use shiftvox::project::{Engine, EngineError, FrameSetup, SetupError, Stats};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "clap",
    derive(clap::Args),
    command(next_help_heading = "Measurement")
)]
pub struct Schedule {
    /// Frames per contender before those that count
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", default_value_t = 1,
               value_parser = clap::value_parser!(u32).range(0..=1000)))]
    pub warmup: u32,
    /// Frames per contender that count, 1 or more; runs are interleaved
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", default_value_t = 5,
               value_parser = clap::value_parser!(u32).range(1..=10_000)))]
    pub runs: u32,
}

pub(super) struct Contender<'c> {
    pub(super) name: String,
    pub(super) graph: &'c Graph,
    pub(super) setup: FrameSetup,
    pub(super) threads: usize,
    pub(super) engine: Box<dyn Engine + Send>,
}

impl Contender<'_> {
    fn failed(&self, source: EngineError) -> BenchError {
        BenchError::Engine {
            who: self.name.clone(),
            source,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Times {
    wall: Summary,
    /// Processor time of the drawing thread: of contenders on one thread, where the system measures
    /// it.
    thread: Option<Summary>,
}

impl Times {
    fn of(elapsed: &[Elapsed]) -> Self {
        let wall: Vec<f64> = elapsed.iter().map(|t| t.wall_ms).collect();
        let thread: Option<Vec<f64>> = elapsed.iter().map(|t| t.thread_ms).collect();
        Self {
            wall: Summary::of(&wall),
            thread: thread.map(|thread| Summary::of(&thread)),
        }
    }

    /// The times that other work disturbs least: processor time, or else wall time.
    pub(super) fn best(&self) -> Summary {
        self.thread.unwrap_or(self.wall)
    }

    pub(crate) fn put(&self, row: &mut Row) {
        let best = self.best();
        row.put("cpu_ms", self.thread.map(|cpu| Cell::ms(cpu.median_ms)));
        row.put("wall_ms", Cell::ms(self.wall.median_ms));
        row.put("wall_min_ms", Cell::ms(self.wall.min_ms));
        row.put("wall_max_ms", Cell::ms(self.wall.max_ms));
        row.put("wall_deviation_ms", Cell::ms(self.wall.deviation_ms));
        row.put("runs", self.wall.runs as u64);
        row.put("ms", Cell::ms(best.median_ms));
        row.put("deviation_ms", Cell::ms(best.deviation_ms));
        row.put("min_ms", Cell::ms(best.min_ms));
    }
}

pub(crate) fn interleave<E>(
    contenders: usize,
    schedule: Schedule,
    progress: &dyn Progress,
    draw: &mut dyn FnMut(usize) -> Result<Elapsed, E>,
) -> Result<Vec<Times>, E> {
    let rounds = schedule.warmup + schedule.runs.max(1);
    let mut elapsed = vec![Vec::with_capacity(rounds as usize); contenders];
    progress.begin("measuring", u64::from(rounds));
    for round in 0..rounds {
        for (place, elapsed) in elapsed.iter_mut().enumerate() {
            let frame = draw(place)?;
            if round >= schedule.warmup {
                elapsed.push(frame);
            }
        }
        progress.advance(1);
    }
    progress.end();
    Ok(elapsed.iter().map(|elapsed| Times::of(elapsed)).collect())
}

pub(crate) fn pool(threads: usize) -> Result<ThreadPool, BenchError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| BenchError::Picture(format!("cannot start {threads} threads: {e}")))
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BenchError {
    #[error("{who}: {source}")]
    Engine { who: String, source: EngineError },
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    #[error("{0}")]
    Picture(String),
}

impl BenchError {
    pub(crate) fn of_exact_rays(source: EngineError) -> Self {
        let who = "exact rays".to_owned();
        Self::Engine { who, source }
    }
}

/// A picture whose memory is touched before its first frame is timed.
fn colors(width: u32, height: u32) -> Colors {
    let mut colors = Colors::new(width, height);
    colors.words.fill(1);
    colors
}

/// Runs contenders. Keeps thread pools and buffers between races.
pub struct Harness<'p> {
    schedule: Schedule,
    progress: &'p dyn Progress,
    pools: BTreeMap<usize, ThreadPool>,
    buffers: BTreeMap<(u32, u32), Colors>,
}

impl<'p> Harness<'p> {
    /// A harness; `progress` advances with every frame, between frames.
    pub fn new(schedule: Schedule, progress: &'p dyn Progress) -> Self {
        Self {
            schedule,
            progress,
            pools: BTreeMap::new(),
            buffers: BTreeMap::new(),
        }
    }

    /// Measures all contenders. `look` gets each contender's place in the list and its first frame,
    /// with voxels, outside of the times.
    pub(super) fn race(
        &mut self,
        contenders: &mut [Contender<'_>],
        look: &mut dyn FnMut(usize, &Frame),
    ) -> Result<Vec<(Times, Stats)>, BenchError> {
        let mut counters = Vec::new();
        self.progress.begin("drawing", contenders.len() as u64);
        for (place, contender) in contenders.iter_mut().enumerate() {
            if let Entry::Vacant(place) = self.pools.entry(contender.threads) {
                place.insert(pool(contender.threads)?);
            }
            let (frame, stats) = self.whole_frame(contender)?;
            look(place, &frame);
            counters.push(stats);
            self.progress.advance(1);
        }
        self.progress.end();
        let (schedule, progress) = (self.schedule, self.progress);
        let mut times = interleave(contenders.len(), schedule, progress, &mut |place| {
            self.frame(&mut contenders[place])
        })?;
        for (times, contender) in times.iter_mut().zip(contenders) {
            times.thread = times.thread.filter(|_| contender.threads == 1);
        }
        Ok(times.into_iter().zip(counters).collect())
    }

    fn whole_frame(&self, contender: &mut Contender<'_>) -> Result<(Frame, Stats), BenchError> {
        let (setup, graph) = (&contender.setup, contender.graph.view());
        let mut frame = Frame::new(setup.width, setup.height, false);
        let engine = &mut contender.engine;
        let pool = &self.pools[&contender.threads];
        let stats = pool.install(|| engine.render(&graph, setup, &mut frame));
        let stats = stats.map_err(|source| contender.failed(source))?;
        Ok((frame, stats))
    }

    /// One frame; the clocks run inside the pool, around the work alone.
    fn frame(&mut self, contender: &mut Contender<'_>) -> Result<Elapsed, BenchError> {
        let (setup, graph) = (&contender.setup, contender.graph);
        let size = (setup.width, setup.height);
        let buffer = self.buffers.entry(size);
        let colors = buffer.or_insert_with(|| colors(size.0, size.1));
        let engine = &mut contender.engine;
        let pool = &self.pools[&contender.threads];
        let (elapsed, drawn) = pool.install(|| {
            let clock = Clock::start();
            let drawn = engine.draw_colors(&graph.view(), &graph.color, setup, colors);
            black_box(colors.words.as_slice());
            (clock.elapsed(), drawn)
        });
        drawn.map_err(|source| contender.failed(source))?;
        Ok(elapsed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shiftvox::graph::Silent;

    #[test]
    fn contenders_take_turns() {
        let mut order = Vec::new();
        let schedule = Schedule { warmup: 1, runs: 2 };
        let times = interleave(2, schedule, &Silent, &mut |place| {
            order.push(place);
            Ok::<_, ()>(Elapsed {
                wall_ms: order.len() as f64,
                thread_ms: None,
            })
        });
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        let medians = times.unwrap().into_iter().map(|of| of.wall.median_ms);
        assert_eq!(medians.collect::<Vec<_>>(), [4.0, 5.0]);
    }
}
