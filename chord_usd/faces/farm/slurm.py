"""The scripts by which Slurm runs the tasks of a bundle, through openjd.

What is submitted is what is not finished: `chord-usd farm due` lists it, so a second submission
after failures or `scancel` sends no more than what is missing.
"""

from __future__ import annotations

from dataclasses import dataclass

ARRAY_FILE = "slurm_array.sh"
MERGE_FILE = "slurm_merge.sh"
SUBMIT_FILE = "slurm_submit.sh"


@dataclass(frozen=True)
class Host:
    """What a worker must have."""

    cores: int
    memory_mib: int


def slurm_scripts(
    host: Host, tasks_file: str, template_file: str, *, gpu: bool, merge: bool
) -> dict[str, str]:
    """The scripts by their names. gpu: whether elements ask for one. merge: whether there is a step
    Merge after all tasks."""
    places = {"TASKS": tasks_file, "TEMPLATE": template_file}
    head = _HEAD.format(cores=host.cores, memory=host.memory_mib)
    needs_gpu = "#SBATCH --gres=gpu:1\n" if gpu else ""
    scripts = {
        ARRAY_FILE: head + needs_gpu + _WHERE + _ARRAY,
        SUBMIT_FILE: _SUBMIT + (_SUBMIT_MERGE if merge else ""),
    }
    if merge:
        scripts[MERGE_FILE] = head + _WHERE + _MERGE
    for name, text in scripts.items():
        for place, file in places.items():
            text = text.replace(f"@{place}@", file)
        scripts[name] = text
    return scripts


_HEAD = """#!/bin/bash
#SBATCH --job-name=chord-usd
#SBATCH --output=logs/%x-%j.log
#SBATCH --cpus-per-task={cores}
#SBATCH --mem={memory}M
"""

_WHERE = """set -euo pipefail
# Slurm runs a copy of this script; the bundle is where it was submitted.
cd "${SLURM_SUBMIT_DIR:-$(dirname "$0")}"
OUTPUT=${OUTPUT:-$PWD/pictures}
PROGRAM=${PROGRAM:-chord-usd}
"""

_ARRAY = """# Each element runs EACH tasks of the list DUE. Where a task fails, the others go on.
DUE=${DUE:-@TASKS@}
EACH=${EACH:-1}
first=$((SLURM_ARRAY_TASK_ID * EACH + 1))
failed=0
while read -r task; do
  openjd run @TEMPLATE@ --step Render --tasks "[$task]" \\
    -p OutputDir="$OUTPUT" -p Program="$PROGRAM" </dev/null || failed=1
done < <(sed -n "$first,$((first + EACH - 1))p" "$DUE")
exit $failed
"""

_MERGE = """openjd run @TEMPLATE@ --step Merge -p OutputDir="$OUTPUT" -p Program="$PROGRAM"
# The list of what was due.
rm -f "${DUE:-}"
"""

_SUBMIT = """#!/bin/bash
# Submits what is not finished as an array; run it again for what failed or was cancelled.
# OUTPUT: the folder for pictures. PROGRAM: chord-usd on the nodes. ELEMENTS: of the array, at most.
set -euo pipefail
cd "$(dirname "$0")"
export OUTPUT=${OUTPUT:-$PWD/pictures} PROGRAM=${PROGRAM:-chord-usd}
mkdir -p logs
DUE=$(mktemp "$PWD/logs/due-XXXXXX.jsonl")
"$PROGRAM" farm due . -o "$OUTPUT" > "$DUE"
count=$(wc -l < "$DUE")
wait=()
if [ "$count" -gt 0 ]; then
  # Slurm refuses arrays of more elements than MaxArraySize.
  most=${ELEMENTS:-$(scontrol show config | sed -n 's/^MaxArraySize *= *//p')}
  EACH=$(((count + most - 1) / most))
  export DUE EACH
  array=$(sbatch --parsable --output=logs/%x-%A_%a.log \\
    --array="0-$(((count + EACH - 1) / EACH - 1))" slurm_array.sh)
  echo "submitted $count tasks as job $array"
  wait=(--dependency="afterok:${array%%;*}" --kill-on-invalid-dep=yes)
else
  rm "$DUE"
  echo "all tasks are finished"
fi
"""

_SUBMIT_MERGE = """sbatch "${wait[@]}" slurm_merge.sh
"""
