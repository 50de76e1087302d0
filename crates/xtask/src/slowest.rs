//! The slowest tests of a run, by the moments at which the test runner says that they ended.
//!
//! The stable test runner prints no times. But it starts the tests of a binary in the order of their names, as many at once as it has
//! threads, and the next one when one ends. So the lines `test … ok` and the moments at which they come tell when each began.
//! The command runs as it would alone: its output is passed on line by line, and its exit status is handed on.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

/// How many tests are printed.
const COUNT: usize = 20;

/// `cargo xtask slowest -- COMMAND …`: runs a command that tests, and prints the slowest tests behind what it prints.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let arguments = arguments.strip_prefix(&["--".to_owned()]).unwrap_or(arguments);
    let [program, rest @ ..] = arguments else {
        return Err("a command is missing: cargo xtask slowest -- cargo test --release --workspace".into());
    };
    let fail = |error: std::io::Error| format!("{program}: {error}");
    // One pipe for both, so that their lines keep their order.
    let (output, input) = std::io::pipe().map_err(fail)?;
    let mut command = Command::new(program);
    command.args(rest).current_dir(root).stdout(input.try_clone().map_err(fail)?).stderr(input);
    let mut child = command.spawn().map_err(fail)?;
    // The command holds the pipe's other end open.
    drop(command);
    let threads = threads(rest, std::env::var("RUST_TEST_THREADS").ok());
    let mut times = Times::new(threads);
    let start = Instant::now();
    let passed_on =
        pass_on(output, &mut std::io::stdout().lock(), |line| times.line(line, start.elapsed().as_secs_f64()));
    let status = child.wait().map_err(fail)?;
    passed_on.map_err(|error| format!("what {program} printed could not be passed on: {error}"))?;
    print!("{}", times.table(COUNT));
    Ok(if status.success() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(status.code().map_or(1, |code| code.clamp(1, 255) as u8))
    })
}

/// Copies each line as it comes.
fn pass_on(from: impl std::io::Read, to: &mut impl Write, mut see: impl FnMut(&str)) -> std::io::Result<()> {
    let mut from = BufReader::new(from);
    let mut line = Vec::new();
    while from.read_until(b'\n', &mut line)? > 0 {
        to.write_all(&line)?;
        to.flush()?;
        see(String::from_utf8_lossy(&line).trim_end());
        line.clear();
    }
    Ok(())
}

/// As the test runner decides how many tests it runs at once.
fn threads(arguments: &[String], variable: Option<String>) -> usize {
    let mut option = None;
    for (n, argument) in arguments.iter().enumerate() {
        if argument == "--test-threads" {
            option = arguments.get(n + 1).cloned();
        } else if let Some(value) = argument.strip_prefix("--test-threads=") {
            option = Some(value.to_owned());
        }
    }
    let given = option.or(variable).and_then(|value| value.parse().ok());
    given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// A test that ended and the seconds that it took.
#[derive(Clone, Debug, PartialEq)]
struct Timed {
    name: String,
    seconds: f64,
}

struct Times {
    threads: usize,
    binary: String,
    /// When the tests of the present binary began.
    begin: Option<f64>,
    /// Those that ended, in that order, with the moment.
    ended: Vec<(String, f64)>,
    timed: Vec<Timed>,
    /// Tests that ended before they can have begun, if the runner does as is said above.
    unknown: usize,
}

impl Times {
    fn new(threads: usize) -> Self {
        Self {
            threads: threads.max(1),
            binary: String::new(),
            begin: None,
            ended: Vec::new(),
            timed: Vec::new(),
            unknown: 0,
        }
    }

    /// Takes in a line of output that came at a moment.
    fn line(&mut self, line: &str, now: f64) {
        let trimmed = line.trim_start();
        if let Some(rest) = trimmed.strip_prefix("Running ").filter(|rest| rest.ends_with(')')) {
            // `Running unittests src/lib.rs (target/release/deps/etalon_optics-0123)`
            let file = rest.rsplit(['(', '/', '\\']).next().unwrap_or_default().trim_end_matches(')');
            self.binary = file.rsplit_once('-').map_or(file, |(name, _)| name).to_owned();
        } else if let Some(name) = trimmed.strip_prefix("Doc-tests ") {
            self.binary = format!("{name} (documentation)");
        } else if line.starts_with("running ") && (line.ends_with(" tests") || line.ends_with(" test")) {
            self.begin = Some(now);
            self.ended.clear();
        } else if line.starts_with("test result: ") {
            self.end_of_binary();
        } else if let Some((name, outcome)) = line.strip_prefix("test ").and_then(|rest| rest.rsplit_once(" ... "))
            && ["ok", "FAILED", "ignored"].iter().any(|word| outcome.starts_with(word))
        {
            let name = [" - should panic", " - compile fail", " - compile"]
                .iter()
                .find_map(|end| name.strip_suffix(end))
                .unwrap_or(name);
            self.ended.push((name.to_owned(), now));
        }
    }

    /// Tells when each test began: the first ones with the binary, each further one when another ended.
    fn end_of_binary(&mut self) {
        let Some(begin) = self.begin.take() else { return };
        let mut names: Vec<&String> = self.ended.iter().map(|(name, _)| name).collect();
        names.sort();
        let mut waiting = names.into_iter();
        let mut running: Vec<(&String, f64)> = waiting.by_ref().take(self.threads).map(|name| (name, begin)).collect();
        for (name, end) in &self.ended {
            if let Some(at) = running.iter().position(|(other, _)| *other == name) {
                let (_, start) = running.swap_remove(at);
                self.timed.push(Timed { name: format!("{} {name}", self.binary), seconds: end - start });
                running.extend(waiting.next().map(|name| (name, *end)));
            } else {
                self.unknown += 1;
            }
        }
    }

    fn table(&self, count: usize) -> String {
        let mut timed = self.timed.clone();
        timed.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        if timed.is_empty() && self.unknown == 0 {
            return String::new();
        }
        let all = timed.len() + self.unknown;
        let mut text =
            format!("\n== the slowest {} of {all} tests, {} at once\n", count.min(timed.len()), self.threads);
        for test in timed.iter().take(count) {
            text += &format!("{:>8.1} s  {}\n", test.seconds, test.name);
        }
        if self.unknown > 0 {
            text += &format!(
                "{} tests ended in another order than they are taken to begin; their times are not known\n",
                self.unknown
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(threads: usize, lines: &[(f64, &str)]) -> Times {
        let mut times = Times::new(threads);
        for (now, line) in lines {
            times.line(line, *now);
        }
        times
    }

    fn seconds(times: &Times) -> Vec<(&str, f64)> {
        times.timed.iter().map(|test| (test.name.as_str(), test.seconds)).collect()
    }

    #[test]
    fn times_are_told_from_the_moments_at_which_tests_end() {
        // Two at once: a from 1 to 6, b from 1 to 2, c from 2 to 3, d from 3 to 7.
        let times = times(
            2,
            &[
                (0.5, "     Running unittests src/lib.rs (target/release/deps/some_crate-0123abcd)"),
                (1.0, "running 5 tests"),
                (2.0, "test b ... ok"),
                (2.0, "test ba ... ignored, takes an hour"),
                (3.0, "test c - should panic ... FAILED"),
                (6.0, "test a ... ok"),
                (7.0, "test d ... ok"),
                (7.0, "test result: FAILED. 3 passed; 1 failed; 1 ignored; 0 measured"),
            ],
        );
        let expected = [("b", 1.0), ("ba", 0.0), ("c", 1.0), ("a", 5.0), ("d", 4.0)];
        let names: Vec<_> = expected.iter().map(|(name, s)| (format!("some_crate {name}"), *s)).collect();
        assert_eq!(seconds(&times), names.iter().map(|(name, s)| (name.as_str(), *s)).collect::<Vec<_>>());
        assert!(times.table(2).starts_with(
            "\n== the slowest 2 of 5 tests, 2 at once\n     5.0 s  some_crate a\n     4.0 s  some_crate d\n"
        ));
    }

    #[test]
    fn each_binary_begins_anew_and_documentation_is_one() {
        let times = times(
            8,
            &[
                (1.0, "running 1 test"),
                (3.0, "test a ... ok"),
                (3.0, "test result: ok. 1 passed"),
                (4.0, "   Doc-tests some_crate"),
                (5.0, "running 1 test"),
                (9.0, "test crates/a/src/lib.rs - b (line 3) - compile ... ok"),
                (9.0, "test result: ok. 1 passed"),
            ],
        );
        let doc = "some_crate (documentation) crates/a/src/lib.rs - b (line 3)";
        assert_eq!(seconds(&times), [(" a", 2.0), (doc, 4.0)]);
    }

    #[test]
    fn an_order_that_cannot_be_is_counted() {
        let lines = [
            (0.0, "running 3 tests"),
            (1.0, "test c ... ok"),
            (2.0, "test a ... ok"),
            (3.0, "test b ... ok"),
            (3.0, "test result: ok."),
        ];
        let times = times(1, &lines);
        assert_eq!((times.unknown, times.timed.len()), (1, 2));
        assert!(times.table(20).contains("1 tests ended in another order"));
        assert_eq!(Times::new(2).table(20), "");
    }

    #[test]
    fn output_is_passed_on_unchanged() {
        let text = b"a\n\xff\xfe\n\nlast line without an end";
        let (mut out, mut seen) = (Vec::new(), 0);
        pass_on(&text[..], &mut out, |_| seen += 1).unwrap();
        assert_eq!((out.as_slice(), seen), (&text[..], 4));
    }

    #[test]
    fn threads_are_those_of_the_test_runner() {
        let arguments = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(threads(&arguments("test -- --test-threads 3"), Some("5".into())), 3);
        assert_eq!(threads(&arguments("test -- --test-threads=4"), None), 4);
        assert_eq!(threads(&arguments("test"), Some("5".into())), 5);
        assert!(threads(&[], None) >= 1);
    }

    #[test]
    #[cfg(unix)]
    fn the_exit_status_is_handed_on() {
        let run = |script: &str| run(&crate::root(), &["sh", "-c", script].map(str::to_owned)).unwrap();
        assert_eq!(run("true"), ExitCode::SUCCESS);
        assert_eq!(run("exit 7"), ExitCode::from(7));
        assert_eq!(run("kill -9 $$"), ExitCode::from(1));
    }
}
