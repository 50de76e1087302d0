//! Notices that files of the scene were edited.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use super::Live;

/// How often the files are looked at.
const INTERVAL: Duration = Duration::from_millis(300);

/// Starts the thread that looks at files.
///
/// # Errors
/// If there is no thread to be had.
pub(crate) fn start(live: &Arc<Live>, files: Vec<PathBuf>) -> std::io::Result<()> {
    let live = Arc::clone(live);
    std::thread::Builder::new().name("view-files".to_owned()).spawn(move || {
        let mut known = state(&files);
        loop {
            std::thread::sleep(INTERVAL);
            let now = state(&files);
            if now != known {
                // Editors may write in several steps: the file is read once it rests.
                std::thread::sleep(INTERVAL / 3);
                known = state(&files);
                live.change(|wish| wish.reload = true);
            }
        }
    })?;
    Ok(())
}

/// When each file was changed last, and its length; `None` where there is none, for instance while an editor replaces it.
fn state(files: &[PathBuf]) -> Vec<Option<(SystemTime, u64)>> {
    let of = |file: &PathBuf| {
        let data = std::fs::metadata(file).ok()?;
        Some((data.modified().ok()?, data.len()))
    };
    files.iter().map(of).collect()
}
