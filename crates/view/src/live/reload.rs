//! Notices that files of the scene were edited.

use std::path::PathBuf;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, SystemTime};

use super::Live;
use crate::source::{LoadScene, LoadedScene};

/// How often the files are looked at.
const INTERVAL: Duration = Duration::from_millis(300);

/// Starts the thread that looks at the files of a scene, and reads it again after an edit.
///
/// # Errors
/// If there is no thread to be had.
pub(crate) fn start(live: &Arc<Live>, load: Box<LoadScene>, files: Vec<PathBuf>) -> std::io::Result<()> {
    let live = Arc::clone(live);
    std::thread::Builder::new().name("view-files".to_owned()).spawn(move || {
        let mut files = files;
        let mut known = state(&files);
        loop {
            std::thread::sleep(INTERVAL);
            if state(&files) == known {
                continue;
            }
            // Editors may write in several steps: the file is read once it rests.
            std::thread::sleep(INTERVAL / 3);
            known = state(&files);
            match load() {
                Ok(scene) => {
                    files.clone_from(&scene.files);
                    known = state(&files);
                    take(&live, scene);
                }
                // The scene before stays.
                Err(problems) => live.show(|seen| seen.status.problems = problems),
            }
        }
    })?;
    Ok(())
}

/// Takes over an edited scene. One that says the same as before begins nothing anew.
fn take(live: &Live, scene: LoadedScene) {
    let mut place = live.scene.lock().unwrap_or_else(PoisonError::into_inner);
    let is_same = place.as_ref().is_some_and(|before| before.sha256 == scene.sha256);
    *place = Some(scene);
    drop(place);
    live.show(|seen| seen.status.problems.clear());
    if !is_same {
        live.change(|wish| wish.stage += 1);
    }
}

/// When each file was changed last, and its length; `None` where there is none, for instance while an editor replaces it.
fn state(files: &[PathBuf]) -> Vec<Option<(SystemTime, u64)>> {
    let of = |file: &PathBuf| {
        let data = std::fs::metadata(file).ok()?;
        Some((data.modified().ok()?, data.len()))
    };
    files.iter().map(of).collect()
}
