//! Jobs for farms: what can be said of them without a farm. `tests/farm-slurm.sh` and `tests/farm-openjd.sh` run them for real.

use std::process::Command;

use crate::support::{etalon_line, scene};

#[test]
fn a_script_for_slurm_is_one_that_a_shell_understands_and_holds_the_options() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("job.sh");
    let picture = folder.path().join("it's here.exr");
    let cornell = scene("cornell.json");
    let mut arguments = vec!["farm".to_owned(), cornell.display().to_string()];
    arguments
        .extend("--shards 7 --slurm --spp 12 --seed 3 --bands 400:700:10 --error 1% -o".split(' ').map(str::to_owned));
    arguments.extend([script.display().to_string(), "--picture".to_owned(), picture.display().to_string()]);
    crate::support::etalon(&arguments).expect(0);
    assert!(Command::new("sh").arg("-n").arg(&script).status().unwrap().success());
    let text = std::fs::read_to_string(&script).unwrap();
    for part in ["shares=7", "--spp 12 --seed 3 --bands 400:700:10 --error 0.01", "it'\\''s here.exr", "--resume"] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
}

#[test]
fn a_template_of_open_job_description_renders_every_share_and_merges_after_them() {
    let ran = etalon_line("farm {} --shards 3 --openjd --threads 2", [&scene("cornell.json")]).expect(0);
    let template = ran.json();
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    let [render, merge] = [0, 1].map(|step| &template["steps"][step]);
    assert_eq!(render["parameterSpace"]["taskParameterDefinitions"][0]["range"], "1-3");
    assert_eq!(merge["dependencies"][0]["dependsOn"], render["name"]);
    let words = |step: &serde_json::Value| -> Vec<String> {
        let list = step["script"]["actions"]["onRun"]["args"].as_array().unwrap();
        list.iter().map(|word| word.as_str().unwrap().to_owned()).collect()
    };
    let render = words(render).join(" ");
    assert!(render.contains("--shard {{Task.Param.Share}}/3") && render.contains("--threads 2"), "{render}");
    let list = merge["script"]["embeddedFiles"][0]["data"].as_str().unwrap();
    assert_eq!(list.lines().filter(|line| line.ends_with(".part")).count(), 3);
    assert!(words(merge).contains(&"{{Task.File.Parts}}".to_owned()));
}

#[test]
fn a_scene_with_mistakes_is_found_before_it_is_sent_to_a_farm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.json");
    std::fs::write(&path, "{\"etalon\": 1}").unwrap();
    etalon_line("farm {} --shards 3 --slurm", [&path]).expect(2).says(["camera"]);
    etalon_line("farm {} --shards 3", [&scene("cornell.json")]).expect(2).says(["--slurm"]);
    etalon_line("farm {} --shards 0 --slurm", [&scene("cornell.json")]).expect(2).says(["--shards"]);
}

#[test]
fn every_option_of_a_render_is_in_the_job() {
    let options = "--spp 5 --replicates 2 --seed 3 --loop scalar --polarised --by-cosine --carry four-wavelengths";
    for kind in ["--slurm", "--openjd"] {
        let line = format!("farm {{}} --shards 2 {kind} {options}");
        let job = etalon_line(&line, [&scene("cornell.json")]).expect(0).stdout;
        let words: Vec<&str> = job.split(|c: char| c.is_whitespace() || c == ',' || c == '"').collect();
        for option in options.split(' ') {
            assert!(words.contains(&option), "{option} is not in {job}");
        }
    }
}

#[test]
fn what_would_fail_on_the_farm_is_refused_or_mended_when_the_job_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.json");
    let odd = folder.path().join(format!("{{{{x}}}} {}.json", "é".repeat(100)));
    std::fs::copy(&cornell, &odd).unwrap();
    let picture = folder.path().join("x.exr");
    let template = etalon_line("farm {} --shards 2 --openjd --picture {}", [&odd, &picture]).expect(0).json();
    let name = template["name"].as_str().unwrap();
    assert!(name.chars().count() <= 128 && !name.contains("{{"), "{name}");

    // 640 × 480 pixels are 1200 tiles.
    for kind in ["--slurm", "--openjd"] {
        etalon_line(&format!("farm {{}} --shards 1201 --size 640x480 {kind}"), [&cornell])
            .expect(2)
            .says(["1200 tiles"]);
        etalon_line(&format!("farm {{}} --shards 1200 --size 640x480 {kind}"), [&cornell]).expect(0);
        for (name, says) in [("x.jpg", "x.jpg"), ("a\u{7}b.exr", "control characters"), (&"y".repeat(240), "too long")]
        {
            let path = folder.path().join(name);
            let line = format!("farm {{}} --shards 2 {kind} --picture {{}}");
            etalon_line(&line, [&cornell, &path]).expect(2).says([says]);
        }
    }
    let far = folder.path().join("far/".repeat(260)).join("x.exr");
    etalon_line("farm {} --shards 2 --openjd --picture {}", [&cornell, &far]).expect(2).says(["1024 characters"]);
}

#[test]
#[cfg(unix)]
fn thousands_of_parts_are_merged_by_a_list() {
    let folder = tempfile::tempdir().unwrap();
    let deep = folder.path().join("some name/".repeat(20));
    let picture = deep.join("picture.exr");
    let cornell = scene("cornell.json");
    let line = "farm {} --shards 10000 --size 1600x1600";
    let template = etalon_line(&format!("{line} --openjd --picture {{}}"), [&cornell, &picture]).expect(0).json();
    let merge = &template["steps"][1]["script"];
    assert!(merge["actions"]["onRun"]["args"].as_array().unwrap().len() < 10);
    let list = merge["embeddedFiles"][0]["data"].as_str().unwrap();
    assert_eq!(list.lines().count(), 10_000);
    assert_eq!(list.lines().nth(41), Some("{{Param.Picture}}.42-of-10000.part"));

    // The script's own shell makes the list; a program that shows what it is given stands for ours.
    let (script, shows) = (folder.path().join("job.sh"), folder.path().join("shows"));
    std::fs::write(&shows, "#!/bin/sh\necho \"$@\"\ncat\n").unwrap();
    assert!(Command::new("chmod").arg("+x").arg(&shows).status().unwrap().success());
    etalon_line(&format!("{line} --slurm --picture {{}} -o {{}}"), [&cornell, &picture, &script]).expect(0);
    let said = Command::new("sh").arg(&script).arg("merge").env("ETALON", &shows).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let said = String::from_utf8(said.stdout).unwrap();
    assert_eq!(said.lines().next(), Some(format!("merge --list - -o {}", picture.display()).as_str()));
    assert_eq!(said.lines().nth(42), Some(format!("{}.42-of-10000.part", picture.display()).as_str()));
    assert_eq!(said.lines().count(), 10_001);
}
