//! Notices that files of the scene were edited.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, SystemTime};

use super::Live;
use crate::source::{LoadScene, LoadedScene};

/// How often the files are looked at.
const INTERVAL: Duration = Duration::from_millis(300);

/// When a file was changed last, and its length; `None` where there is none, for instance while an editor replaces it.
type FileState = Option<(SystemTime, u64)>;

/// The files of a scene, each in the state in which it was read. `None` stands for a state that is not known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct WatchedFiles(BTreeMap<PathBuf, FileState>);

impl WatchedFiles {
    /// The files of a scene that is read for the first time.
    pub(crate) fn of(scene: &LoadedScene) -> Self {
        Self::default().after(scene)
    }

    /// The same files as they are now.
    fn now(&self) -> Self {
        Self(self.0.keys().map(|file| (file.clone(), state(file))).collect())
    }

    /// The files of a scene that was read after these were looked at. Of files that are new, the state of now counts, unless they were
    /// changed since reading began: then it is not known what was read.
    fn after(&self, scene: &LoadedScene) -> Self {
        let new = |file: &Path| state(file).filter(|(changed, _)| *changed < scene.began);
        let of = |file: &PathBuf| (file.clone(), self.0.get(file).copied().unwrap_or_else(|| new(file)));
        Self(scene.files.iter().map(of).collect())
    }
}

fn state(file: &Path) -> FileState {
    let data = std::fs::metadata(file).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// Starts the thread that looks at the files of a scene, and reads it again after an edit.
///
/// # Errors
/// If there is no thread to be had.
pub(crate) fn start(live: &Arc<Live>, load: Box<LoadScene>, files: WatchedFiles) -> std::io::Result<()> {
    let live = Arc::clone(live);
    std::thread::Builder::new().name("view-files".to_owned()).spawn(move || {
        let mut files = files;
        loop {
            std::thread::sleep(INTERVAL);
            if files.now() == files {
                continue;
            }
            // Editors may write in several steps: the file is read once it rests.
            std::thread::sleep(INTERVAL / 3);
            // What is edited while the scene is read is noticed next time.
            files = files.now();
            match load() {
                Ok(scene) => {
                    files = files.after(&scene);
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

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 4], "direction": [0, 0, -1], "height_m": 1},
        "film": {"width": 1, "height": 1},
        "materials": {"grey": {"type": "lambert", "reflectance": 0.5}},
        "objects": [{"name": "ball", "shape": {"type": "sphere", "radius_m": 1}, "material": "grey"}],
        "lights": [{"type": "environment", "radiance": 1}]
    }"#;

    fn scene(files: &[&PathBuf], began: SystemTime) -> LoadedScene {
        let (scene, _) = etalon_scene::parse(TEXT, "ball.json").expect("a valid scene");
        let files = files.iter().map(|file| (*file).clone()).collect();
        LoadedScene { scene, sha256: String::new(), warnings: Vec::new(), files, began }
    }

    #[test]
    fn an_edit_during_a_load_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        let write = |file: &PathBuf, text: &str| std::fs::write(file, text).unwrap();
        write(&old, "1");
        write(&new, "1");
        let hour = Duration::from_secs(3600);
        let (past, future) = (SystemTime::now() - hour, SystemTime::now() + hour);
        let files = WatchedFiles::of(&scene(&[&old], future));
        assert_eq!(files, files.now());
        // A file that was looked at before the load counts as it was then, whatever the clock says.
        let before = files.now();
        write(&old, "12");
        let files = before.after(&scene(&[&old, &new], future));
        assert_ne!(files, files.now());
        let files = files.now().after(&scene(&[&old, &new], past));
        assert_eq!(files, files.now());
        // A file that was not looked at, and was changed since the load began, is read once more.
        let files = WatchedFiles::of(&scene(&[&new], past));
        assert_ne!(files, files.now());
        let files = files.now().after(&scene(&[&new], past));
        assert_eq!(files, files.now());
    }
}
