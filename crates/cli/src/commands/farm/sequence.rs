//! Jobs that render a sequence: each task renders every N-th frame, whole, and nothing is merged.

use serde_json::json;

use super::{CHECKPOINT, Job, check_length, slurm};
use crate::failure::Failure;
use crate::frames::{FrameList, patterns};
use crate::output::Format;
use crate::shell;
use crate::state;
use miette::miette;

/// All that would make the job fail when it runs.
pub(super) fn check(job: &Job, list: &FrameList) -> Failure {
    let mut failure = Failure::default();
    let frames = list.numbers().len();
    match Format::of(&job.picture) {
        Ok(Format::Part) => failure.add(Failure::input(miette!(
            code = "frame-part",
            help = "name it .exr or .png",
            "frames of a sequence are not rendered in parts"
        ))),
        Ok(_) => {}
        Err(unknown) => failure.add(unknown),
    }
    match patterns(std::slice::from_ref(&job.picture), frames) {
        Ok(patterns) => {
            let longest = list.numbers().iter().max().zip(patterns.first());
            if let Some((number, pattern)) = longest {
                let name = state::checkpoint_path(&pattern.of(*number));
                failure.add(check_length(&name, "checkpoints of its frames"));
            }
        }
        Err(bad) => failure.add(bad),
    }
    if job.shards as usize > frames {
        failure.add(Failure::input(miette!(
            code = "shard-empty",
            "{frames} frames cannot be divided into {} shares",
            job.shards
        )));
    }
    failure
}

/// The script for Slurm: it submits itself as an array of renders.
pub(super) fn script(job: &Job, frames: &[String]) -> String {
    let shards = job.shards;
    let frames = shell::words(frames.to_vec());
    let options = shell::words(job.options.iter().cloned());
    let threads = slurm::threads(job);
    let head = slurm::head(
        job,
        &format!(
            "# Renders the frames of a sequence in {shards} tasks. Run it where jobs are submitted, with any options for sbatch:
#   sh THIS [--partition=...] [--time=...]
# A task that is stopped, or moved to another machine, keeps its finished frames and goes on from its checkpoint. A task that failed is run
# again by
#   sbatch --array=K THIS"
        ),
    );
    format!(
        r#"{head}if [ -n "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
    # The render takes the shell's place, so that signals reach it.
    exec "$etalon" render "$scene" {frames} --shard "$SLURM_ARRAY_TASK_ID/$shares" -o "$picture" \
        --checkpoint {CHECKPOINT} --resume {threads} {options}
else
    array=$(sbatch --parsable --array=1-"$shares" --output="$picture.%a-of-$shares.log" "$@" "$0")
    echo "array ${{array%%;*}} renders $picture"
fi
"#
    )
}

/// The template of Open Job Description.
pub(super) fn openjd(job: &Job, frames: &[String]) -> String {
    let shards = job.shards;
    let name = |path: &std::path::Path| path.display().to_string();
    let mut render = vec!["render".to_owned(), "{{Param.Scene}}".to_owned()];
    render.extend(frames.iter().cloned());
    render.extend(["--shard".to_owned(), format!("{{{{Task.Param.Share}}}}/{shards}")]);
    render.extend(["-o", "{{Param.Picture}}", "--checkpoint", CHECKPOINT, "--resume"].map(str::to_owned));
    render.extend(["--progress", "openjd"].map(str::to_owned));
    render.extend(job.threads.into_iter().flat_map(|threads| ["--threads".to_owned(), threads.to_string()]));
    render.extend(job.options.iter().cloned());
    let parameter = |name: &str, default: String, description: &str| json!({ "name": name, "type": "STRING", "default": default, "description": description });
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name,
        "description": format!("Renders the frames of a sequence in {shards} tasks."),
        "parameterDefinitions": [
            parameter("Scene", name(&job.scene), "The scene."),
            parameter("Picture", name(&job.picture), "The pictures: {frame} stands for the number of each."),
            parameter("Etalon", name(&job.program), "The program.")
        ],
        "steps": [
            {
                "name": "Render",
                "parameterSpace": {
                    "taskParameterDefinitions": [{ "name": "Share", "type": "INT", "range": format!("1-{shards}") }]
                },
                "script": {
                    "actions": {
                        "onRun": {
                            "command": "{{Param.Etalon}}",
                            "args": render,
                            // A task that is cancelled keeps what it has.
                            "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 60 }
                        }
                    }
                }
            }
        ]
    });
    serde_json::to_string_pretty(&template).expect("plain data") + "\n"
}
