//! Work in a thread of its own, while the thread that asked for it answers to signals and shows progress.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use etalon::{Control, Counters, Prediction, Watch};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::internal;

/// How often signals are looked for.
const POLL: Duration = Duration::from_millis(50);

/// What both threads know of the work.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    stop: AtomicBool,
    paths: AtomicU64,
    planned: AtomicU64,
}

impl Progress {
    /// Asks the work to end.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(crate) fn control(&self) -> Control {
        if self.stop.load(Ordering::Relaxed) { Control::Stop } else { Control::Continue }
    }

    /// Camera paths so far and planned; 0 planned as long as a pilot runs.
    fn paths(&self) -> (u64, u64) {
        (self.paths.load(Ordering::Relaxed), self.planned.load(Ordering::Relaxed))
    }
}

impl Watch for Progress {
    fn work(&self, counters: &Counters) {
        self.paths.fetch_add(counters.paths, Ordering::Relaxed);
    }

    fn planned(&self, paths: u64, _predicted: Option<&Prediction>) {
        // The paths of the pilot are not the picture's.
        self.paths.store(0, Ordering::Relaxed);
        self.planned.store(paths, Ordering::Relaxed);
    }

    fn control(&self) -> Control {
        self.control()
    }
}

/// Where messages of a thread arrive, as long as somebody wants them.
pub(crate) type Inbox<T> = Mutex<Option<Receiver<T>>>;

/// Starts work in a thread. What it gives comes into the inbox; a panic comes as an exception.
pub(crate) fn start<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> PyResult<Inbox<PyResult<T>>> {
    let (sender, receiver) = sync_channel(1);
    let run = move || {
        let result = catch_unwind(AssertUnwindSafe(work));
        // Where nobody waits any more, nobody misses it.
        let _ = sender.send(result.map_err(|panic| internal(&*panic)));
    };
    thread::Builder::new().name("etalon".to_owned()).spawn(run)?;
    Ok(Mutex::new(Some(receiver)))
}

/// Wants no more messages.
pub(crate) fn close<T>(inbox: &Inbox<T>) {
    *inbox.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

/// Waits for the next message, without the interpreter's lock; `None` if no more will come. `Err` if a signal handler or `each` raises;
/// the work still goes on then.
pub(crate) fn wait<T: Send>(
    py: Python<'_>,
    inbox: &Inbox<T>,
    mut each: impl FnMut() -> PyResult<()>,
) -> PyResult<Option<T>> {
    loop {
        let received = py.detach(|| {
            let receiver = inbox.lock().unwrap_or_else(PoisonError::into_inner);
            receiver.as_ref().map_or(Err(RecvTimeoutError::Disconnected), |receiver| receiver.recv_timeout(POLL))
        });
        match received {
            Ok(message) => return Ok(Some(message)),
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
        }
        py.check_signals()?;
        each()?;
    }
}

/// The outcome of [`run`].
pub(crate) struct Outcome<T> {
    /// What the work gave, perhaps before it was done.
    pub(crate) value: T,
    /// What interrupted it.
    pub(crate) interrupted: Option<PyErr>,
}

/// Runs work in a thread. An exception, of a signal or of `tick`, asks the work to end, and waits until it has ended. `tick` is called
/// with the paths that are done and planned.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: &Arc<Progress>,
    tick: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<Outcome<T>> {
    let inbox = start(work)?;
    let waited = wait(py, &inbox, || tick.map_or(Ok(()), |tick| tick.call1(progress.paths()).map(|_| ())));
    let (result, interrupted) = match waited {
        Ok(result) => (result, None),
        Err(error) => {
            progress.stop();
            // A second signal does not wait for the work to end.
            (wait(py, &inbox, || Ok(()))?, Some(error))
        }
    };
    let result = result.ok_or_else(|| PyRuntimeError::new_err("the work ended without an answer"))?;
    Ok(Outcome { value: result?, interrupted })
}
