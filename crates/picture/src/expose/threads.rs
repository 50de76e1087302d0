//! Work on the pixels of a picture by several threads.

use std::ops::Range;
use std::thread::{Builder, ScopedJoinHandle, available_parallelism, scope};

/// A part of the work: on its way, or done.
enum Part<'scope, T> {
    Running(ScopedJoinHandle<'scope, Vec<T>>),
    Done(Vec<T>),
}

/// What `of` makes of each pixel from 0 to `count`, in this order, by so many threads (all cores if not given). The result is the same for
/// any number of them.
pub(super) fn of_pixels<T: Send>(count: usize, threads: Option<usize>, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let cores = || available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or_else(cores).clamp(1, count.max(1));
    let work = |range: Range<usize>| range.map(&of).collect::<Vec<T>>();
    let work = &work;
    scope(|scope| {
        let ranges = (0..threads).map(|i| i * count / threads..(i + 1) * count / threads);
        let parts: Vec<Part<'_, T>> = ranges
            .map(|range| {
                let own = range.clone();
                match Builder::new().spawn_scoped(scope, move || work(own)) {
                    Ok(running) => Part::Running(running),
                    // A thread that the system does not give: this one does its work.
                    Err(_) => Part::Done(work(range)),
                }
            })
            .collect();
        let mut all = Vec::with_capacity(count);
        for part in parts {
            match part {
                Part::Running(running) => match running.join() {
                    Ok(part) => all.extend(part),
                    Err(panic) => std::panic::resume_unwind(panic),
                },
                Part::Done(part) => all.extend(part),
            }
        }
        all
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_is_worked_on_once_and_in_order() {
        for count in [0, 1, 7, 1000] {
            for threads in [None, Some(0), Some(1), Some(3), Some(64)] {
                assert_eq!(of_pixels(count, threads, |i| 2 * i), (0..count).map(|i| 2 * i).collect::<Vec<_>>());
            }
        }
    }
}
