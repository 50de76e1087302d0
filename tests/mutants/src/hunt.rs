//! Which mutants the tests notice.

use crate::build::{Program, prepare, programs};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What a test program reaches, and for how long it runs.
struct Known {
    program: Program,
    reached: BTreeSet<u32>,
    seconds: f64,
}

/// Hunts; returns the number of mutants that are reached and that nothing notices.
pub fn hunt(tree: &Path, files: &[String], tests: &[String], limit: usize) -> Result<usize, String> {
    let work = fs::canonicalize(tree).map_err(|e| e.to_string())?.join("target/mutants");
    let copy = work.join("tree");
    fs::create_dir_all(&copy).map_err(|e| e.to_string())?;
    let mutated = prepare(tree, &copy, files)?;
    let count: usize = mutated.iter().map(|m| m.mutants.len()).sum();
    println!("{count} mutants; building the tests");
    let mut known = Vec::new();
    for program in programs(&copy, tests)? {
        let list = work.join("reached");
        let _ = fs::remove_file(&list);
        let start = Instant::now();
        let passes = run(&program, |command| command.env("MUTANTS_REACHED", &list), Duration::from_secs(3600));
        if !passes {
            return Err(format!("{} fails without a mutant", program.path.display()));
        }
        let seconds = start.elapsed().as_secs_f64();
        let text = fs::read_to_string(&list).unwrap_or_default();
        let reached: BTreeSet<u32> = text.lines().filter_map(|line| line.parse().ok()).collect();
        let name = program.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        println!("{name}: reaches {} in {seconds:.1} s", reached.len());
        known.push(Known { program, reached, seconds });
    }
    // The quick ones first.
    known.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let (mut noticed, mut survived, mut unreached) = (0, 0, 0);
    let stride = count.div_ceil(limit.min(count).max(1));
    for (file, number, mutant) in mutated.iter().flat_map(|m| m.mutants.iter().map(move |(n, one)| (&m.file, n, one))) {
        if *number as usize % stride != 0 {
            continue;
        }
        let reaching: Vec<&Known> = known.iter().filter(|k| k.reached.contains(number)).collect();
        let what = match reaching.is_empty() {
            true => {
                unreached += 1;
                "is not reached"
            }
            false
                if reaching.iter().all(|k| {
                    let patience = Duration::from_secs_f64(20.0 + 5.0 * k.seconds);
                    run(&k.program, |command| command.env("MUTANT", number.to_string()), patience)
                }) =>
            {
                survived += 1;
                "SURVIVES"
            }
            false => {
                noticed += 1;
                continue;
            }
        };
        let to = if mutant.to.is_empty() { "nothing" } else { mutant.to };
        println!("{file}:{}:{}: {} for {to} {what}", mutant.line, mutant.column, mutant.from);
        let _ = std::io::stdout().flush();
    }
    println!("{noticed} noticed, {survived} survive, {unreached} not reached by these tests");
    Ok(survived)
}

/// Whether a program passes within some time.
fn run(program: &Program, with: impl Fn(&mut Command) -> &mut Command, patience: Duration) -> bool {
    let mut command = Command::new(&program.path);
    command.current_dir(&program.folder).stdout(Stdio::null()).stderr(Stdio::null()).stdin(Stdio::null());
    with(&mut command);
    let Ok(mut child) = command.spawn() else { return false };
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
