//! The same film on every instruction set, and on every processor.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use etalon_simd::Level;
use sha2::{Digest, Sha256};

use crate::support::{command, pixel_bits, scene, words};

/// Scenes that take the ways that differ between instruction sets: few primitives, filtered at once; trees of triangles, of
/// spheres and of instances; paths side by side with one wavelength, several and bands, guided, shared between pixels; media that are even, of a density grid, and within glass.
const FILMS: [(&str, &str); 12] = [
    ("cornell.json", ""),
    ("cornell.json", "--path-reuse 4x2"),
    ("cornell.json", "--sampler independent"),
    ("cornell-glass.json", ""),
    ("prism.json", "--bands 420:680:20"),
    ("vase.json", ""),
    ("lanterns.json", ""),
    ("veach-mis.json", "--loop scalar"),
    ("polarisers.json", ""),
    ("fog.json", ""),
    ("cloud.json", "--bands 420:680:20"),
    ("milk.json", ""),
];

/// The variable that names another program than the one under test, with the words before it: one for another processor.
const OTHER: &str = "ETALON_OTHER";

/// The SHA-256 of the channels of a film, which a program renders with some more arguments and settings of the environment.
#[track_caller]
fn film(mut program: Command, (name, more): (&str, &str), output: &Path) -> String {
    let line = format!("render {{}} -o {{}} --spp 2 --size 40x30 --quiet {more}");
    program.args(words(&line, [&scene(name), output]));
    // A program that writes nothing must not be given the film before.
    std::fs::remove_file(output).ok();
    let ran = program.output().expect("the program starts");
    assert!(ran.status.success(), "{name} {more}: {}", String::from_utf8_lossy(&ran.stderr));
    let mut hash = Sha256::new();
    for (channel, bits) in pixel_bits(output).0 {
        hash.update(channel);
        bits.into_iter().for_each(|pixel| hash.update(pixel.to_le_bytes()));
    }
    hash.finalize().iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

/// The program under test on an instruction set.
fn on(level: &str) -> Command {
    let mut program = command::<&str>([]);
    program.env(etalon_simd::VARIABLE, level);
    program
}

#[test]
#[allow(clippy::print_stdout, reason = "says what was compared, and what this machine cannot run")]
fn films_have_the_same_bytes_on_every_instruction_set() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let available: Vec<&str> = Level::available().into_iter().map(Level::name).collect();
    for level in ["avx2", "avx512"].into_iter().filter(|level| !available.contains(level)) {
        println!("skipped: this processor has no {level}");
    }
    for what in FILMS {
        let baseline = film(on("baseline"), what, &output);
        println!("{baseline} {} {}: {}", what.0, what.1, available.join(", "));
        for level in &available[1..] {
            assert_eq!(film(on(level), what, &output), baseline, "{what:?} on {level}");
        }
    }
}

/// `tests/aarch64.sh` sets the variable.
#[test]
#[allow(clippy::print_stdout, reason = "says what was compared, and what this machine cannot run")]
fn another_program_renders_the_same_bytes() {
    let Ok(other) = std::env::var(OTHER) else {
        println!("skipped: {OTHER} names no program");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    for what in FILMS {
        let ours = film(on(""), what, &output);
        let mut words = other.split_whitespace();
        let mut program = Command::new(words.next().expect("a program"));
        program.args(words);
        assert_eq!(film(program, what, &output), ours, "{what:?}");
        println!("{ours} {} {}: the same from {other}", what.0, what.1);
    }
}

/// Whatever the command.
#[test]
fn an_unknown_instruction_set_is_bad_usage() {
    for level in ["avx", "AVX2", "neon"] {
        for line in [&["schema"][..], &["explain", "no-such-file.json"]] {
            let ran = on(level).args(line).output().unwrap();
            let stderr = String::from_utf8(ran.stderr).unwrap();
            assert_eq!(ran.status.code(), Some(2), "{stderr}");
            let message = format!("ETALON_SIMD={level}: unknown instruction set; use baseline, avx2 or avx512");
            assert!(stderr.contains(&message) && ran.stdout.is_empty(), "{stderr}");
        }
    }
    let available: Vec<&str> = Level::available().into_iter().map(Level::name).collect();
    for level in ["avx2", "avx512"].into_iter().filter(|level| !available.contains(level)) {
        let ran = on(level).arg("schema").output().unwrap();
        let stderr = String::from_utf8(ran.stderr).unwrap();
        assert!(ran.status.code() == Some(2) && stderr.contains("this processor has baseline"), "{stderr}");
    }
}
