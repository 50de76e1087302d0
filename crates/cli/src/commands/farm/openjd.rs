//! The template of Open Job Description, in its JSON form.

use std::path::Path;

use serde_json::{Value, json};

use super::{CHECKPOINT, Job};

/// The template.
pub(super) fn template(job: &Job) -> String {
    let shards = job.shards;
    let name = |path: &Path| path.display().to_string();
    let part = |share: &str| format!("{{{{Param.Picture}}}}.{share}{}", job.part_suffix());
    let mut render = ["render", "{{Param.Scene}}", "--shard"].map(str::to_owned).to_vec();
    render.extend([format!("{{{{Task.Param.Share}}}}/{shards}"), "-o".to_owned(), part("{{Task.Param.Share}}")]);
    render.extend(["--checkpoint", CHECKPOINT, "--resume", "--progress", "openjd"].map(str::to_owned));
    render.extend(job.threads.into_iter().flat_map(|threads| ["--threads".to_owned(), threads.to_string()]));
    render.extend(job.options.iter().cloned());
    // Thousands of parts are more than a command line holds.
    let merge = ["merge", "--list", "{{Task.File.Parts}}", "-o", "{{Param.Picture}}"].map(str::to_owned).to_vec();
    let list: String = (1..=shards).map(|share| part(&share.to_string()) + "\n").collect();
    let action = |arguments: Vec<String>| {
        json!({
            "actions": {
                "onRun": {
                    "command": "{{Param.Etalon}}",
                    "args": arguments,
                    // A task that is cancelled keeps what it has.
                    "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 60 }
                }
            }
        })
    };
    let mut merge = action(merge);
    merge["embeddedFiles"] = json!([{ "name": "Parts", "type": "TEXT", "data": list }]);
    // PATH parameters may not have absolute defaults; strings may, and all machines see the same paths.
    let template: Value = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name,
        "description": format!("Renders a scene in {shards} shares and merges them, byte for byte the picture of one machine."),
        "parameterDefinitions": [
            {
                "name": "Scene",
                "type": "STRING",
                "default": name(&job.scene),
                "description": "The scene."
            },
            {
                "name": "Picture",
                "type": "STRING",
                "default": name(&job.picture),
                "description": "The picture; the parts lie beside it."
            },
            {
                "name": "Etalon",
                "type": "STRING",
                "default": name(&job.program),
                "description": "The program."
            }
        ],
        "steps": [
            {
                "name": "Render",
                "parameterSpace": {
                    "taskParameterDefinitions": [{ "name": "Share", "type": "INT", "range": format!("1-{shards}") }]
                },
                "script": action(render)
            },
            {
                "name": "Merge",
                "dependencies": [{ "dependsOn": "Render" }],
                "script": merge
            }
        ]
    });
    let mut text = serde_json::to_string_pretty(&template).expect("plain data");
    text.push('\n');
    text
}
