//! Platforms that the program is built for but that are not at hand: everything is compiled for them up to linking.

use std::path::Path;
use std::process::{Command, ExitCode};

use crate::manifest;

/// What `cargo xtask check-targets` checks; docs/platforms.md has a row for each.
const TARGETS: &[&str] = &[
    "aarch64-unknown-linux-gnu",
    "aarch64-apple-darwin",
    "x86_64-pc-windows-msvc",
    // Neither SSE2 nor NEON: the scalar code of `simd` and `geometry`.
    "riscv64gc-unknown-linux-gnu",
];

/// `cargo xtask check-targets [TARGET …]`: `cargo check` of all crates, tests and benches for each target.
pub(crate) fn check(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let all: Vec<String> = TARGETS.iter().map(|&target| target.to_owned()).collect();
    let targets = if arguments.is_empty() { &all } else { arguments };
    let installed = installed()?;
    let mut failed = Vec::new();
    for target in targets {
        println!("== {target}");
        if !installed.contains(target) {
            eprintln!("its standard library is missing: rustup target add {target}");
            failed.push(target.as_str());
            continue;
        }
        // A folder of its own: what is built for this machine stays as it is.
        let arguments =
            ["check", "--locked", "--workspace", "--all-targets", "--target-dir", "target/check", "--target", target];
        if !run(Command::new("cargo").args(arguments).current_dir(root))? {
            failed.push(target);
        }
    }
    println!("== {} of {} targets checked", targets.len() - failed.len(), targets.len());
    if failed.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!("not checked, or with errors: {}", failed.join(", "));
    Ok(ExitCode::FAILURE)
}

/// The targets whose standard library the toolchain has.
fn installed() -> Result<Vec<String>, String> {
    let output =
        Command::new("rustc").args(["--print", "sysroot"]).output().map_err(|error| format!("rustc: {error}"))?;
    let sysroot = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let folder = Path::new(&sysroot).join("lib/rustlib");
    let entries = std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let entries = entries.flatten().filter(|entry| entry.path().join("lib").is_dir());
    Ok(entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
}

/// `cargo xtask msrv`: the oldest Rust that `Cargo.toml` promises compiles all crates and tests.
pub(crate) fn msrv(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    if !arguments.is_empty() {
        return Err("it takes no options".into());
    }
    let version = manifest::rust_version(root)?;
    let version = if version.matches('.').count() == 1 { format!("{version}.0") } else { version };
    println!("== Rust {version}");
    let there = Command::new("rustup").args(["run", &version, "rustc", "--version"]).output();
    if !there.map_err(|error| format!("rustup: {error}"))?.status.success() {
        return Err(format!("the toolchain is missing: rustup toolchain install {version} --profile minimal"));
    }
    let mut command = Command::new("rustup");
    command.args(["run", &version, "cargo", "check", "--locked", "--workspace", "--all-targets"]);
    // A folder of its own, and not the `cargo` of the toolchain that runs this.
    command.args(["--target-dir", "target/msrv"]).env_remove("CARGO").env_remove("RUSTUP_TOOLCHAIN").current_dir(root);
    Ok(if run(&mut command)? { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn run(command: &mut Command) -> Result<bool, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    command.status().map(|status| status.success()).map_err(|error| format!("{name}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_platforms_has_a_row_for_each_target() {
        let page = std::fs::read_to_string(crate::root().join("docs/platforms.md")).unwrap();
        for target in TARGETS {
            assert!(
                page.lines().any(|line| line.starts_with('|') && line.contains(&format!("`{target}`"))),
                "{target}"
            );
        }
    }
}
