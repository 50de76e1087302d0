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
    assert_eq!(words(merge).iter().filter(|word| word.ends_with(".part")).count(), 3);
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
