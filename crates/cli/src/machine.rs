//! The machine that a price is for, and its clocks.

use std::time::Instant;

use serde::Serialize;

/// What a time was measured with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Machine {
    /// The processor, by its own name where the system tells it.
    pub processor: String,
    /// Threads used.
    pub threads: usize,
    /// Program and version.
    pub software: &'static str,
}

impl Machine {
    /// This machine with this many threads.
    pub(crate) fn with_threads(threads: usize) -> Self {
        let known = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        });
        let processor = known.unwrap_or_else(|| format!("{} on {}", std::env::consts::ARCH, std::env::consts::OS));
        Self { processor, threads, software: concat!("etalon ", env!("CARGO_PKG_VERSION")) }
    }
}

/// Which clock counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ClockKind {
    /// Elapsed time.
    Wall,
    /// Processor time divided by the number of threads. Other programs do not change it.
    Cpu,
}

/// A clock that tells seconds since it was started.
pub(crate) struct Clock {
    start: Instant,
    /// Processor time at the start, and threads.
    processor: Option<(f64, f64)>,
}

impl Clock {
    /// Starts a clock. Where a system does not tell processor time, the wall's clock counts.
    pub(crate) fn start(kind: ClockKind, threads: usize) -> Self {
        let processor = match kind {
            ClockKind::Wall => None,
            ClockKind::Cpu => processor_seconds().map(|seconds| (seconds, threads as f64)),
        };
        Self { start: Instant::now(), processor }
    }

    /// Seconds since the start.
    pub(crate) fn seconds(&self) -> f64 {
        match self.processor {
            Some((start, threads)) => (processor_seconds().unwrap_or(start) - start) / threads,
            None => self.start.elapsed().as_secs_f64(),
        }
    }
}

/// Processor time of this process, all threads together, s.
#[cfg(unix)]
fn processor_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
fn processor_seconds() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sleeping_program_takes_no_processor_time() {
        let (wall, cpu) = (Clock::start(ClockKind::Wall, 1), Clock::start(ClockKind::Cpu, 1));
        std::thread::sleep(std::time::Duration::from_millis(60));
        assert!(wall.seconds() >= 0.06);
        // Other tests may run meanwhile; with their threads counted it would be more, and without unix it is the wall's.
        assert!(cpu.seconds() >= 0.0);
        assert!(!Machine::with_threads(2).processor.is_empty());
    }
}
