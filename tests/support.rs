//! Running the program as a user does.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use etalon_picture::{ExrFile, read_exr};
use serde_json::Value;

/// How a run of the program ended.
pub(crate) struct Ran {
    /// Exit status.
    pub(crate) status: i32,
    /// Standard output.
    pub(crate) stdout: String,
    /// Standard error.
    pub(crate) stderr: String,
}

impl Ran {
    /// The one JSON object on standard output.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("standard output is not one JSON value: {error}\n{}", self.stdout));
        assert!(value.is_object(), "not an object: {value}");
        value
    }

    /// Fails unless the exit status is this one.
    #[track_caller]
    pub(crate) fn expect(self, status: i32) -> Self {
        assert_eq!(self.status, status, "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        self
    }

    /// Fails unless standard error contains all of these.
    #[track_caller]
    pub(crate) fn says<const N: usize>(self, parts: [&str; N]) -> Self {
        for part in parts {
            assert!(self.stderr.contains(part), "`{part}` is not in:\n{}", self.stderr);
        }
        self
    }
}

/// The program, not yet started, with its output to be caught and a surrounding that does not depend on the machine.
pub(crate) fn command<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).env("NO_COLOR", "1");
    // Each test makes its own tables, and leaves none.
    command.env("ETALON_TABLES", "");
    // What a test wrongly lets be written lands among the build's files.
    command.current_dir(env!("CARGO_TARGET_TMPDIR"));
    command
}

/// Runs the program to its end.
#[track_caller]
pub(crate) fn etalon<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Ran {
    let output = command(arguments).output().expect("the program starts");
    Ran {
        status: output.status.code().expect("the program ends by itself"),
        stdout: String::from_utf8(output.stdout).expect("standard output is UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("standard error is UTF-8"),
    }
}

/// Runs the program with arguments written as one line of words, `{}` standing for each of `paths` in turn.
#[track_caller]
pub(crate) fn etalon_line<const N: usize>(line: &str, paths: [&Path; N]) -> Ran {
    etalon(words(line, paths))
}

/// Runs the program to its end, which it must reach within half a minute whatever the machine.
#[track_caller]
pub(crate) fn etalon_that_ends<const N: usize>(line: &str, paths: [&Path; N]) -> Ran {
    ends(command(words(line, paths)))
}

/// Runs a command to its end, which it must reach within half a minute whatever the machine.
#[track_caller]
pub(crate) fn ends(mut command: Command) -> Ran {
    let mut child = command.spawn().expect("the program starts");
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(30) {
            child.kill().unwrap();
            panic!("it does not end: {command:?}");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let output = child.wait_with_output().unwrap();
    Ran {
        status: output.status.code().expect("the program ends by itself"),
        stdout: String::from_utf8(output.stdout).expect("standard output is UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("standard error is UTF-8"),
    }
}

/// Sends a signal, `INT` or `TERM`.
pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// The words of a line, `{}` standing for each of `paths` in turn (it may end a word: `--output={}`).
#[track_caller]
pub(crate) fn words<const N: usize>(line: &str, paths: [&Path; N]) -> Vec<String> {
    let mut paths = paths.into_iter().map(|path| path.to_str().expect("paths in tests are UTF-8"));
    let words = line
        .split_whitespace()
        .map(|word| match word.contains("{}") {
            true => word.replace("{}", paths.next().expect("a path for each {}")),
            false => word.to_owned(),
        })
        .collect();
    assert_eq!(paths.next(), None, "a {{}} for each path");
    words
}

/// The folder of the ready-made scenes.
pub(crate) fn scenes_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").canonicalize().expect("the repository has scenes")
}

/// A ready-made scene.
pub(crate) fn scene(name: &str) -> PathBuf {
    scenes_folder().join(name)
}

/// A ready-made scene's JSON, changed and written to `path`.
pub(crate) fn changed_scene(name: &str, path: &Path, change: impl FnOnce(&mut Value)) {
    let text = std::fs::read_to_string(scene(name)).expect("the scene is there");
    let mut value = serde_json::from_str(&text).expect("a ready-made scene is plain JSON");
    change(&mut value);
    std::fs::write(path, serde_json::to_string_pretty(&value).expect("it was JSON")).expect("a temporary file");
}

/// Names of all files in a folder, hidden ones too, sorted.
pub(crate) fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| entry.expect("it can be listed").file_name().into_string().expect("names in tests are UTF-8"))
        .collect();
    names.sort();
    names
}

/// The bits of the pixels of an EXR file, channel by channel, and the file.
#[track_caller]
pub(crate) fn pixel_bits(path: &Path) -> (Vec<(String, Vec<u32>)>, ExrFile) {
    let file = read_exr(path).unwrap_or_else(|error| panic!("{}", error.with_causes()));
    let bits = file
        .picture
        .channels()
        .iter()
        .map(|channel| (channel.name.clone(), channel.samples.iter().map(|sample| sample.to_bits()).collect()))
        .collect();
    (bits, file)
}
