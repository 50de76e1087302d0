//! SIGINT and SIGTERM: the first asks a render to end well, the same again ends it at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Whether the program was asked to end.
#[derive(Default)]
pub(crate) struct Interrupt {
    signal: Arc<AtomicUsize>,
}

/// Time between two of the same signal for the second to count. `timeout` sends one to the program and one to its group: these are one request.
#[cfg(unix)]
const APART: std::time::Duration = std::time::Duration::from_millis(500);

impl Interrupt {
    /// Listens to both signals from now on. Where a system has none, nothing ever comes.
    #[cfg(unix)]
    pub(crate) fn listen() -> std::io::Result<Self> {
        use signal_hook::consts::{SIGINT, SIGTERM};
        use std::time::Instant;
        let interrupt = Self::default();
        let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
        let first_of_all = Arc::clone(&interrupt.signal);
        let listen = move || {
            let mut first: [Option<Instant>; 2] = [None; 2];
            for signal in signals.forever() {
                match &mut first[usize::from(signal == SIGTERM)] {
                    Some(at) if at.elapsed() >= APART => signal_hook::low_level::exit(128 + signal),
                    Some(_) => {}
                    first => {
                        *first = Some(Instant::now());
                        // That of another kind changes nothing, so the exit status is that of the first.
                        let _ = first_of_all.compare_exchange(0, signal as usize, Ordering::Relaxed, Ordering::Relaxed);
                    }
                }
            }
        };
        std::thread::Builder::new().name("signals".to_owned()).spawn(listen)?;
        Ok(interrupt)
    }

    /// Listens to nothing.
    #[cfg(not(unix))]
    pub(crate) fn listen() -> std::io::Result<Self> {
        Ok(Self::default())
    }

    /// The number of the signal that came, if one did.
    pub(crate) fn signal(&self) -> Option<u8> {
        u8::try_from(self.signal.load(Ordering::Relaxed)).ok().filter(|&signal| signal > 0)
    }
}
