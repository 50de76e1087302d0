//! Exit statuses and messages of bad and good usage.

use crate::support::{etalon, etalon_line, scene};

#[test]
fn without_a_command_the_program_explains_itself_and_exits_2() {
    let ran = etalon::<&str>([]).expect(2);
    assert!(ran.stderr.contains("render") && ran.stderr.contains("schema"), "{}", ran.stderr);
}

#[test]
fn help_and_version_are_no_failures() {
    assert!(etalon(["--help"]).expect(0).stdout.contains("render"));
    assert_eq!(etalon(["--version"]).expect(0).stdout, format!("etalon {}\n", env!("CARGO_PKG_VERSION")));
    for command in ["render", "schema"] {
        etalon([command, "--help"]).expect(0);
    }
}

#[test]
fn what_is_no_command_or_option_exits_2_and_is_named() {
    etalon(["rendre"]).expect(2).says(["rendre", "render"]);
    etalon_line("render {} -o x.exr --ssp 4", [&scene("cornell.json")]).expect(2).says(["--ssp", "--spp"]);
    etalon(["render"]).expect(2).says(["SCENE"]);
}

#[test]
fn values_out_of_range_exit_2_and_name_their_option() {
    for (option, value) in [
        ("--spp", "0"),
        ("--spp", "-1"),
        ("--spp", "2147483648"),
        ("--seed", "-1"),
        ("--seed", "18446744073709551616"),
        ("--threads", "0"),
        ("--threads", "two"),
        ("--size", "0x10"),
        ("--size", "640"),
        ("--exposure", "nan"),
        ("--exposure", "inf"),
        ("--crop", "5,5,1,0"),
        ("--crop", "1,2,3"),
        ("--sampler", "halton"),
        ("--max-depth", "0"),
        ("--checkpoint", "20000000000000000000s"),
        ("--time", "99999999999h"),
    ] {
        let ran =
            etalon_line(&format!("render {{}} -o x.exr --quiet {option}={value}"), [&scene("cornell.json")]).expect(2);
        assert!(ran.stderr.contains(option), "{option} {value}: {}", ran.stderr);
    }
}

#[test]
fn a_path_is_replayed_by_its_pixel() {
    let scene = scene("cornell.json");
    etalon_line("render {} --sample 1 -o x.exr --spp 1 --size 4x4", [&scene]).expect(2).says(["--pixel"]);
    etalon_line("render {} --pixel 1,1 --sample 0 -o x.exr", [&scene]).expect(2).says(["--pixel", "--output"]);
}

/// What bash offers for the last of these words.
#[cfg(unix)]
fn completed(script: &std::path::Path, words: &[&str]) -> Vec<String> {
    let line = format!(
        "source '{}'; COMP_WORDS=({}); COMP_CWORD={}; _etalon etalon '{}' '{}'; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        script.display(),
        words.join(" "),
        words.len() - 1,
        words[words.len() - 1],
        words[words.len() - 2],
    );
    let ran = std::process::Command::new("bash").args(["--norc", "-c", &line]).output().expect("bash");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    String::from_utf8_lossy(&ran.stdout).lines().map(str::to_owned).collect()
}

#[cfg(unix)]
#[test]
fn bash_completes_commands_options_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("etalon.bash");
    std::fs::write(&script, etalon(["completions", "bash"]).expect(0).stdout).unwrap();
    assert_eq!(completed(&script, &["etalon", "ren"]), ["render"]);
    assert_eq!(completed(&script, &["etalon", "render", "--white"]), ["--white-balance"]);
    assert_eq!(completed(&script, &["etalon", "develop", "--curve", "a"]), ["agx"]);
}

#[test]
fn scripts_for_other_shells_name_every_command() {
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let script = etalon(["completions", shell]).expect(0).stdout;
        for word in ["render", "develop", "completions", "white-balance"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    etalon(["completions", "tcsh"]).expect(2).says(["bash"]);
}

#[test]
fn there_is_a_manual_page_for_each_command() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("new/man1");
    let said = etalon_line("man -o {}", [&pages]).expect(0).stdout;
    let page = |name: &str| std::fs::read_to_string(pages.join(name)).unwrap();
    assert!(page("etalon.1").contains(".TH etalon 1"), "{said}");
    let render = page("etalon-render.1");
    assert!(render.contains(".TH etalon-render 1") && render.contains("etalon render scenes/cornell.json"), "{render}");
    assert!(said.starts_with(&format!("{} pages", std::fs::read_dir(&pages).unwrap().count())), "{said}");
}
