//! The script for Slurm: it submits itself, once as an array of renders and once as the merge that waits for them.

use super::{CHECKPOINT, Job};
use crate::shell::{self, quoted};

/// The top of a script for Slurm: `comment`, what Slurm is to know, and the job's names.
pub(super) fn head(job: &Job, comment: &str) -> String {
    let Job { name, shards, .. } = job;
    let [program, scene, picture] =
        [&job.program, &job.scene, &job.picture].map(|path| quoted(&path.display().to_string()));
    let comment_name: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    let cpus = job.threads.map_or_else(String::new, |threads| format!("#SBATCH --cpus-per-task={threads}\n"));
    format!(
        r#"#!/bin/sh
{comment}
#SBATCH --job-name={comment_name}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@120
{cpus}set -eu

etalon=${{ETALON:-{program}}}
scene={scene}
picture={picture}
shares={shards}

"#
    )
}

/// The option for the number of threads: the job's, or what Slurm gives the task.
pub(super) fn threads(job: &Job) -> String {
    job.threads.map_or_else(
        || "${SLURM_CPUS_PER_TASK:+--threads \"$SLURM_CPUS_PER_TASK\"}".to_owned(),
        |threads| format!("--threads {threads}"),
    )
}

/// The script.
pub(super) fn script(job: &Job) -> String {
    let shards = job.shards;
    let options = shell::words(job.options.iter().cloned());
    let threads = threads(job);
    let head = head(
        job,
        &format!(
            "# Renders a scene in {shards} shares and merges them. Run it where jobs are submitted, with any options for sbatch:
#   sh THIS [--partition=...] [--time=...]
# A task that is stopped, or moved to another machine, goes on from its checkpoint. A share that failed is rendered again by
#   sbatch --array=K THIS
# and the picture merged by
#   sbatch THIS merge"
        ),
    );
    format!(
        r#"{head}part() {{ printf '%s.%s-of-%s.part' "$picture" "$1" "$shares"; }}

if [ -n "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
    # The render takes the shell's place, so that signals reach it.
    exec "$etalon" render "$scene" --shard "$SLURM_ARRAY_TASK_ID/$shares" -o "$(part "$SLURM_ARRAY_TASK_ID")" \
        --checkpoint {CHECKPOINT} --resume {threads} {options}
elif [ "${{1:-}}" = merge ]; then
    # Thousands of parts are more than a command line holds.
    share=1
    while [ "$share" -le "$shares" ]; do
        part "$share" && echo
        share=$((share + 1))
    done | "$etalon" merge --list - -o "$picture"
else
    array=$(sbatch --parsable --array=1-"$shares" --output="$picture.%a-of-$shares.log" "$@" "$0")
    merge=$(sbatch --parsable --dependency=afterok:"${{array%%;*}}" --kill-on-invalid-dep=yes --output="$picture.merge.log" \
        "$@" "$0" merge)
    echo "array ${{array%%;*}} renders, job ${{merge%%;*}} merges into $picture"
fi
"#
    )
}
