//! Two clocks: the wall's, and the calling thread's time on a processor.

use std::time::{Duration, Instant};

pub(crate) struct Clock {
    wall: Instant,
    thread: Option<Duration>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Elapsed {
    pub(super) wall_ms: f64,
    /// By the calling thread alone; `None` where the system does not report it.
    pub(super) thread_ms: Option<f64>,
}

impl Clock {
    /// Now. To be read again on the same thread.
    pub(crate) fn start() -> Self {
        Self {
            thread: thread_time(),
            wall: Instant::now(),
        }
    }

    pub(crate) fn elapsed(&self) -> Elapsed {
        let wall = self.wall.elapsed();
        let thread = self.thread.zip(thread_time());
        Elapsed {
            wall_ms: wall.as_secs_f64() * 1e3,
            thread_ms: thread.map(|(from, to)| to.saturating_sub(from).as_secs_f64() * 1e3),
        }
    }
}

#[cfg(unix)]
fn thread_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    let seconds = u64::try_from(time.tv_sec).ok()?;
    let nanoseconds = u32::try_from(time.tv_nsec).ok()?;
    Some(Duration::new(seconds, nanoseconds))
}

#[cfg(not(unix))]
fn thread_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleeping_is_wall_time_alone() {
        let clock = Clock::start();
        std::thread::sleep(Duration::from_millis(30));
        let elapsed = clock.elapsed();
        let thread_ms = elapsed.thread_ms.unwrap_or(0.0);
        assert!(elapsed.wall_ms >= 30.0 && thread_ms < 15.0, "{elapsed:?}");
    }
}
