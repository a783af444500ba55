"""An Open Job Description bundle: a template, the stage with all its files, and Slurm scripts.

Every task is one `chord-usd render` of one camera, one tile and one block of samples, and leaves
one checked file; a last task merges them. Specification: jobtemplate-2023-09 (Open Job
Description), which `openjd run`, AWS Deadline Cloud and others understand.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from chord_usd.errors import RenderError
from chord_usd.runtime.files import output_folder
from chord_usd.runtime.targets import FolderMode

TEMPLATE_FILE = "template.json"
TASKS_FILE = "tasks.jsonl"
ARRAY_FILE = "slurm_array.sh"
MERGE_FILE = "slurm_merge.sh"
SUBMIT_FILE = "slurm_submit.sh"
SCENE_FOLDER = "scene"

MOST_VALUES = 1024
"""Of one task parameter, by the specification."""

_CORES = 2
_MEMORY_MIB = 4096
"""What a worker should have; a task takes more cores where there are more."""


@dataclass(frozen=True)
class Work:
    """What a farm shall render."""

    stage: Path
    files: tuple[Path, ...]
    """All files the stage is made of, itself included."""
    cameras: tuple[str, ...]
    words: tuple[str, ...]
    """Options of `chord-usd render` that hold for every task."""
    tiles: int = 1
    blocks: int = 1
    gpu: bool = False
    """Whether every worker must have a GPU."""

    @property
    def divided(self) -> bool:
        """Whether pictures come in parts."""
        return self.tiles * self.blocks > 1

    def tasks(self) -> list[dict[str, str | int]]:
        """Parameters of every rendering task, in the order of the template."""
        everything = product(self.cameras, range(self.tiles), range(self.blocks))
        return [{"Camera": c, "Tile": t, "Block": b} for c, t, b in everything]


def write_bundle(work: Work, folder: Path, mode: FolderMode = "new") -> list[Path]:
    """Write the bundle, whole or not at all; returns its own files, without the stage's.

    Raises RenderError for more than a template can say or a stage that points out of its folder,
    OutputError.
    """
    _check(work)
    written = {
        TEMPLATE_FILE: json.dumps(template(work), indent=2) + "\n",
        TASKS_FILE: "".join(json.dumps(task) + "\n" for task in work.tasks()),
        ARRAY_FILE: _array_script(work),
        MERGE_FILE: _merge_script(),
        SUBMIT_FILE: _submit_script(),
    }
    with output_folder(folder, mode) as bundle:
        _copy_stage(work, bundle / SCENE_FOLDER)
        for name, text in written.items():
            (bundle / name).write_text(text)
            if name.endswith(".sh"):
                (bundle / name).chmod(0o755)
    return [folder / name for name in written]


def template(work: Work) -> dict[str, Any]:
    """The job template, as plain values."""
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "name": f"Render {work.stage.stem}"[:128],
        "description": "Pictures of an OpenUSD house, by chord-usd and Blender Cycles.",
        "parameterDefinitions": [
            _path("Stage", "FILE", "IN", f"{SCENE_FOLDER}/{work.stage.name}", "the house"),
            _path("OutputDir", "DIRECTORY", "OUT", "pictures", "where pictures go"),
            {
                "name": "Program",
                "type": "STRING",
                "default": "chord-usd",
                "description": "chord-usd on the workers",
            },
        ],
        "steps": [_render_step(work), _merge_step(work)],
    }


def _path(name: str, kind: str, flow: str, default: str, description: str) -> dict[str, str]:
    return {
        "name": name,
        "type": "PATH",
        "objectType": kind,
        "dataFlow": flow,
        "default": default,
        "description": description,
    }


def _render_step(work: Work) -> dict[str, Any]:
    parts = ["--tile", f"{{{{Task.Param.Tile}}}}/{work.tiles}"]
    parts += ["--sample-block", f"{{{{Task.Param.Block}}}}/{work.blocks}"]
    words = [*work.words, "--camera", "{{Task.Param.Camera}}", *(parts if work.divided else [])]
    # A task that is given out again, after its worker died, finds what is whole.
    return {
        "name": "Render",
        "parameterSpace": {
            "taskParameterDefinitions": [
                {"name": "Camera", "type": "STRING", "range": list(work.cameras)},
                {"name": "Tile", "type": "INT", "range": f"0-{work.tiles - 1}"},
                {"name": "Block", "type": "INT", "range": f"0-{work.blocks - 1}"},
            ],
            "combination": "Camera * Tile * Block",
        },
        "hostRequirements": _requirements(work.gpu),
        "script": _script([*words, "--skip-existing"]),
    }


def _merge_step(work: Work) -> dict[str, Any]:
    """Puts parts together; where pictures came whole, it lists them in one data set."""
    cameras = [word for camera in work.cameras for word in ("--camera", camera)]
    last = ["--merge"] if work.divided else ["--skip-existing"]
    return {
        "name": "Merge",
        "dependencies": [{"dependsOn": "Render"}],
        "hostRequirements": _requirements(gpu=False),
        "script": _script([*work.words, *cameras, *last]),
    }


def _requirements(gpu: bool) -> dict[str, Any]:
    amounts = [
        {"name": "amount.worker.vcpu", "min": _CORES},
        {"name": "amount.worker.memory", "min": _MEMORY_MIB},
    ]
    return {"amounts": [*amounts, *([{"name": "amount.worker.gpu", "min": 1}] if gpu else [])]}


def _script(words: Sequence[str]) -> dict[str, Any]:
    whole = ["render", "{{Param.Stage}}", "-o", "{{Param.OutputDir}}", *words]
    run = {"command": "{{Param.Program}}", "args": [*whole, "--progress", "openjd"]}
    return {"actions": {"onRun": run}}


# --- Slurm --------------------------------------------------------------------------------------

_HEAD = """#!/bin/bash
#SBATCH --job-name=chord-usd
#SBATCH --cpus-per-task={cores}
#SBATCH --mem={memory}M
"""

_RUN = """set -euo pipefail
# Slurm runs a copy of this script; the bundle is where it was submitted.
cd "${SLURM_SUBMIT_DIR:-$(dirname "$0")}"
OUTPUT=${OUTPUT:-$PWD/pictures}
"""


def _array_script(work: Work) -> str:
    head = _HEAD.format(cores=_CORES, memory=_MEMORY_MIB)
    gpu = "#SBATCH --gres=gpu:1\n" if work.gpu else ""
    return (
        f"{head}{gpu}#SBATCH --array=0-{len(work.tasks()) - 1}\n"
        "# One task of the bundle for each element of the array.\n"
        f"{_RUN}"
        f'task=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" {TASKS_FILE})\n'
        f'openjd run {TEMPLATE_FILE} --step Render --tasks "[$task]" -p OutputDir="$OUTPUT"\n'
    )


def _merge_script() -> str:
    head = _HEAD.format(cores=_CORES, memory=_MEMORY_MIB)
    return f'{head}{_RUN}openjd run {TEMPLATE_FILE} --step Merge -p OutputDir="$OUTPUT"\n'


def _submit_script() -> str:
    return (
        "#!/bin/bash\n"
        "# Submits the array, and the merge for when all of it is done.\n"
        "set -euo pipefail\n"
        'cd "$(dirname "$0")"\n'
        f"array=$(sbatch --parsable {ARRAY_FILE})\n"
        f'sbatch --dependency="afterok:$array" {MERGE_FILE}\n'
    )


# --- files --------------------------------------------------------------------------------------


def _check(work: Work) -> None:
    for what, count in (
        ("cameras", len(work.cameras)),
        ("tiles", work.tiles),
        ("sample blocks", work.blocks),
    ):
        if not 1 <= count <= MOST_VALUES:
            raise RenderError(
                f"{count} {what}", where=work.stage.name, expected=f"1 to {MOST_VALUES} in one job"
            )
    root = _root(work)
    root = _root(work)
    outside = [file for file in work.files if not file.is_relative_to(root)]
    # A link in the folder may lead to anything; the stage itself is what the user named.
    real = {file: file.resolve() for file in work.files[1:]}
    outside += [file for file in real if not real[file].is_relative_to(root.resolve())]
    if outside:
        raise RenderError(
            f"points to {outside[0]}",
            where=str(work.stage),
            expected="a stage whose files lie in its own folder, so that it can travel",
            try_="chord-usd export, which packs a stage into one file",
        )


def _copy_stage(work: Work, folder: Path) -> None:
    for file in work.files:
        target = folder / file.relative_to(_root(work))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)


def _root(work: Work) -> Path:
    return Path(os.path.abspath(work.stage)).parent  # noqa: PTH100 (resolve would follow links)
