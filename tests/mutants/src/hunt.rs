//! Which mutants the tests notice.

use crate::build::{Program, prepare, programs};
use crate::rewrite::{Mutant, What};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A test, alone in its process, because a program of many tests goes on after one has failed.
struct Test<'a> {
    program: &'a Program,
    name: String,
    /// The mutants at places that it passes.
    reached: BTreeSet<u32>,
    seconds: f64,
}

/// What became of a mutant.
enum Fate {
    Noticed,
    Survives,
    Unreached,
}

/// How many of the tests that noticed something last are asked first.
const LAST: usize = 6;

/// Hunts; returns the number of mutants that are reached and that nothing notices.
///
/// Of many mutants only `limit` are tried, evenly; tests that take more than `quick_s` seconds are not asked.
pub fn hunt(
    tree: &Path,
    (files, what): (&[String], What),
    tests: &[String],
    limit: usize,
    quick_s: f64,
) -> Result<usize, String> {
    let work = fs::canonicalize(tree).map_err(|e| e.to_string())?.join("target/mutants");
    let copy = work.join("tree");
    fs::create_dir_all(&copy).map_err(|e| e.to_string())?;
    let mutated = prepare(tree, &copy, files, what)?;
    let count: usize = mutated.iter().map(|m| m.mutants.len()).sum();
    println!("{count} mutants; building the tests");
    let programs = programs(&copy, tests)?;
    let tests = known(&programs, &work, quick_s)?;
    let stride = count.div_ceil(limit.min(count).max(1));
    let chosen: Vec<(&str, u32, &Mutant)> = mutated
        .iter()
        .flat_map(|m| m.mutants.iter().map(|(number, mutant)| (m.file.as_str(), *number, mutant)))
        .filter(|(_, number, _)| (*number as usize).is_multiple_of(stride))
        .collect();
    // The tests that noticed something, the last one last.
    let last: Mutex<Vec<usize>> = Mutex::new(Vec::new());
    let fates = side_by_side(&chosen, |(file, number, mutant)| {
        let fate = fate(*number, &tests, &last);
        let what = match fate {
            Fate::Noticed => return fate,
            Fate::Survives => "SURVIVES",
            Fate::Unreached => "is not reached",
        };
        let to = if mutant.to.is_empty() { "nothing" } else { mutant.to };
        println!("{file}:{}:{}: mutant {number}, {} for {to}, {what}", mutant.line, mutant.column, mutant.from);
        let _ = std::io::stdout().flush();
        fate
    });
    let of = |which: fn(&Fate) -> bool| fates.iter().filter(|fate| which(fate)).count();
    let survived = of(|fate| matches!(fate, Fate::Survives));
    let (noticed, unreached) = (of(|fate| matches!(fate, Fate::Noticed)), of(|fate| matches!(fate, Fate::Unreached)));
    println!("{noticed} noticed, {survived} survive, {unreached} not reached by these tests");
    Ok(survived)
}

/// Every test that reaches a mutant, the quick ones first.
fn known<'a>(programs: &'a [Program], work: &Path, quick_s: f64) -> Result<Vec<Test<'a>>, String> {
    let mut names = Vec::new();
    for program in programs {
        let list =
            Command::new(&program.path).args(["--list", "--format", "terse"]).current_dir(&program.folder).output();
        let list = list.map_err(|e| e.to_string())?;
        let text = String::from_utf8_lossy(&list.stdout).into_owned();
        names
            .extend(text.lines().filter_map(|line| line.strip_suffix(": test")).map(|name| (program, name.to_owned())));
    }
    let asked = names.len();
    let tests = side_by_side(&names, |(program, name)| {
        let list = work.join(format!("reached-{:?}", std::thread::current().id()));
        let _ = fs::remove_file(&list);
        let start = Instant::now();
        let passes = run(program, name, ("MUTANTS_REACHED", &list.to_string_lossy()), Duration::from_secs_f64(quick_s));
        let seconds = start.elapsed().as_secs_f64();
        if seconds >= quick_s {
            return Ok(None);
        }
        if !passes {
            return Err(format!("{name} of {} fails without a mutant", program.path.display()));
        }
        let text = fs::read_to_string(&list).unwrap_or_default();
        let reached = text.lines().filter_map(|line| line.parse().ok()).collect();
        Ok(Some(Test { program, name: name.clone(), reached, seconds }))
    });
    let mut tests: Vec<Test> = tests.into_iter().filter_map(Result::transpose).collect::<Result<_, _>>()?;
    println!("{} of {asked} tests take less than {quick_s} s", tests.len());
    tests.retain(|test| !test.reached.is_empty());
    tests.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let seconds: f64 = tests.iter().map(|test| test.seconds).sum();
    println!("{} of them reach a mutant; together they take {seconds:.0} s", tests.len());
    Ok(tests)
}

/// Asks the tests that reach a mutant, one after another.
fn fate(number: u32, tests: &[Test], last: &Mutex<Vec<usize>>) -> Fate {
    let reaching = |&index: &usize| tests[index].reached.contains(&number);
    let mut order: Vec<usize> =
        last.lock().expect("no panic").iter().rev().take(LAST).copied().filter(reaching).collect();
    order.sort_unstable();
    let rest: Vec<usize> = (0..tests.len()).filter(reaching).filter(|index| !order.contains(index)).collect();
    order.extend(rest);
    if order.is_empty() {
        return Fate::Unreached;
    }
    for index in order {
        let test = &tests[index];
        let patience = Duration::from_secs_f64(20.0 + 10.0 * test.seconds);
        if !run(test.program, &test.name, ("MUTANT", &number.to_string()), patience) {
            let mut last = last.lock().expect("no panic");
            last.retain(|other| *other != index);
            last.push(index);
            return Fate::Noticed;
        }
    }
    Fate::Survives
}

/// Something of each, by as many threads as there are processors, in their order.
fn side_by_side<T: Sync, R: Send>(all: &[T], each: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(one) = all.get(index) else { return done };
            done.push((index, each(one)));
        }
    };
    let mut done: Vec<(usize, R)> = std::thread::scope(|scope| {
        let count = std::thread::available_parallelism().map_or(1, usize::from);
        let threads: Vec<_> = (0..count).map(|_| scope.spawn(worker)).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("no panic")).collect()
    });
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Whether a test passes within some time and 16 GiB of addresses: a mutant may never end, and ask for ever more.
fn run(program: &Program, name: &str, variable: (&str, &str), patience: Duration) -> bool {
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v 16777216; exec \"$0\" --exact \"$1\""]).arg(&program.path).arg(name);
    command.current_dir(&program.folder).stdout(Stdio::null()).stderr(Stdio::null()).stdin(Stdio::null());
    // As `.cargo/config.toml` has it.
    command.env("PROPTEST_RNG_SEED", "1").env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
    let Ok(mut child) = command.env(variable.0, variable.1).spawn() else { return false };
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) if start.elapsed() < patience => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                return false;
            }
        }
    }
}
