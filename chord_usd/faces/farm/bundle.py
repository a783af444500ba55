"""An Open Job Description bundle: a template, the stage with all its files, and Slurm scripts.

Every task is one `chord-usd render` of one camera, or of some with one import of the stage, one
tile and one block of samples, and leaves checked files; a last task merges parts. Specification:
jobtemplate-2023-09 (Open Job Description), which `openjd run`, AWS Deadline Cloud and others
understand.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, distribution
from itertools import product
from pathlib import Path
from typing import Any

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.files import Copies, output_folder
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_lines import read_lines
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.stages import StageFiles
from chord_usd.base.runtime.targets import FolderMode
from chord_usd.faces.farm.slurm import Host, slurm_scripts

TEMPLATE_FILE = "template.json"
TASKS_FILE = "tasks.jsonl"
ENVIRONMENT_FILE = "requirements.txt"
SCENE_FOLDER = "scene"
EXTRA_FOLDER = "extra"
"""In the scene's folder: files that options name."""

CAMERA, FRAME = "Camera", "Frame"
"""Parameters of tasks: names with commas between them, or numbers from and to."""

MOST_VALUES = 1024
"""Of one task parameter, by the specification."""

TIMEOUT_S = 24 * 3600
"""Of a task, where nothing else is asked for: longer than any picture takes, shorter than ever."""

HOST = Host(cores=2, memory_mib=4096)
"""What a worker should have; a task takes more cores where there are more."""


@dataclass(frozen=True)
class Work:
    """What a farm renders."""

    stage: Path
    files: StageFiles
    """All files the stage is made of, itself included."""
    cameras: tuple[str, ...]
    """All of them; of a walk or turntable, in the order of its frames."""
    words: tuple[str, ...]
    """Options of `chord-usd render` that hold for every task; files as place_of has them."""
    tiles: int = 1
    blocks: int = 1
    frames: bool = False
    """Whether the cameras are frames, which go by their numbers."""
    each: int = 1
    """Cameras or frames of a task: they share one import of the stage."""
    gpu: bool = False
    """Whether every worker must have a GPU."""
    lists_all: bool = False
    """Whether a last step lists all pictures in one data set."""
    timeout_s: int = TIMEOUT_S
    """Of a task."""
    extra: tuple[Path, ...] = field(default=())
    """Files that the words name."""

    @property
    def divided(self) -> bool:
        """Whether pictures come in parts."""
        return self.tiles * self.blocks > 1

    @property
    def has_last_step(self) -> bool:
        """Whether something is made of what all tasks leave."""
        return self.divided or self.lists_all

    def tasks(self) -> list[dict[str, str | int]]:
        """Parameters of every rendering task, in the order of the template."""
        everything = product(self.views, range(self.tiles), range(self.blocks))
        return [{self.view: v, "Tile": t, "Block": b} for v, t, b in everything]

    @property
    def view(self) -> str:
        """Name of the parameter that says what is looked at."""
        return FRAME if self.frames else CAMERA

    @property
    def views(self) -> list[str]:
        """Its values: "2-3" for frames, "A,B" for cameras."""
        starts = range(0, len(self.cameras), self.each)
        groups = [self.cameras[start : start + self.each] for start in starts]
        if not self.frames:
            return [",".join(group) for group in groups]
        return [f"{start}-{start + len(g) - 1}" for start, g in zip(starts, groups, strict=True)]


def place_of(file: Path) -> str:
    """Where a task has a file that an option names, as a word of the template."""
    return f"{{{{Param.Scene}}}}/{EXTRA_FOLDER}/{file.name}"


def write_bundle(work: Work, folder: Path, mode: FolderMode = "new") -> list[Path]:
    """Write the bundle, whole or not at all; returns its own files, without the stage's.

    Raises RenderError for more than a template can say and for a stage that points out of its
    folder, OutputError.
    """
    _check(work)
    written = {
        TEMPLATE_FILE: json.dumps(template(work), indent=2) + "\n",
        ENVIRONMENT_FILE: "\n".join(pinned()) + "\n",
        TASKS_FILE: "".join(json.dumps(task) + "\n" for task in work.tasks()),
        **slurm_scripts(HOST, TASKS_FILE, TEMPLATE_FILE, gpu=work.gpu, merge=work.has_last_step),
    }
    with output_folder(folder, mode) as bundle:
        _copy_stage(work, bundle / SCENE_FOLDER)
        for name, text in written.items():
            (bundle / name).write_text(text)
            if name.endswith(".sh"):
                (bundle / name).chmod(0o755)
    return [folder / name for name in written]


def tasks_of(folder: Path) -> tuple[list[str], list[dict[str, Any]]]:
    """Words of a bundle's task, `chord-usd` left out, and the parameters of every task.

    The words name tasks' parameters as the template does. Raises RenderError for no bundle.
    """
    files = folder / TEMPLATE_FILE, folder / TASKS_FILE
    try:
        refuse_odd_file(files[0], RenderError)
        template = parse_json(files[0].read_bytes(), str(files[0]), RenderError)
        words = [str(word) for word in template["steps"][0]["script"]["actions"]["onRun"]["args"]]
        tasks = [
            _task(parse_json(line, f"{files[1]}:{number}", RenderError))
            for number, line in read_lines(files[1], RenderError)
        ]
    except (OSError, LookupError, TypeError, ValueError) as error:
        raise RenderError("is no bundle", where=str(folder), try_="<farm bundle>") from error
    return words, tasks


def _task(parsed: Any) -> dict[str, Any]:
    """Raises LookupError, TypeError, ValueError for what is none."""
    view = CAMERA if CAMERA in parsed else FRAME
    return {view: str(parsed[view]), "Tile": int(parsed["Tile"]), "Block": int(parsed["Block"])}


def template(work: Work) -> dict[str, Any]:
    """The job template, as plain values."""
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "name": f"Render {work.stage.stem}"[:128],
        "description": "Pictures of an OpenUSD house, by chord-usd and Blender Cycles.",
        "parameterDefinitions": [
            # A folder, since farms copy what a parameter names, and not what a stage points to.
            _path("Scene", "DIRECTORY", "IN", SCENE_FOLDER, "the house with all its files"),
            _path("OutputDir", "DIRECTORY", "OUT", "pictures", "where pictures go"),
            {
                "name": "Program",
                "type": "STRING",
                "default": "chord-usd",
                "description": "chord-usd on the workers",
            },
        ],
        "steps": [_render_step(work), *([_merge_step(work)] if work.has_last_step else [])],
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
    view = [f"--{work.view.lower()}", f"{{{{Task.Param.{work.view}}}}}"]
    words = [*work.words, *view, *(parts if work.divided else [])]
    # A task that is given out again, after its worker died, finds what is whole.
    return {
        "name": "Render",
        "parameterSpace": {
            "taskParameterDefinitions": [
                {"name": work.view, "type": "STRING", "range": work.views},
                {"name": "Tile", "type": "INT", "range": f"0-{work.tiles - 1}"},
                {"name": "Block", "type": "INT", "range": f"0-{work.blocks - 1}"},
            ],
            "combination": f"{work.view} * Tile * Block",
        },
        "hostRequirements": _requirements(work.gpu),
        "script": _script(work, [*words, "--skip-existing"]),
    }


def _merge_step(work: Work) -> dict[str, Any]:
    """Puts parts together; where pictures came whole, it lists them in one data set."""
    all_ = f"0-{len(work.cameras) - 1}" if work.frames else ",".join(work.cameras)
    view = [f"--{work.view.lower()}", all_]
    last = ["--merge"] if work.divided else ["--skip-existing"]
    return {
        "name": "Merge",
        "dependencies": [{"dependsOn": "Render"}],
        "hostRequirements": _requirements(gpu=False),
        "script": _script(work, [*work.words, *view, *last]),
    }


def _requirements(gpu: bool) -> dict[str, Any]:
    amounts = [
        {"name": "amount.worker.vcpu", "min": HOST.cores},
        {"name": "amount.worker.memory", "min": HOST.memory_mib},
    ]
    return {"amounts": [*amounts, *([{"name": "amount.worker.gpu", "min": 1}] if gpu else [])]}


def _script(work: Work, words: Sequence[str]) -> dict[str, Any]:
    stage = f"{{{{Param.Scene}}}}/{work.stage.name}"
    whole = ["render", stage, "-o", "{{Param.OutputDir}}", *words, "--progress", "openjd"]
    run = {"command": "{{Param.Program}}", "args": whole, "timeout": work.timeout_s}
    return {"actions": {"onRun": run}}


# --- files --------------------------------------------------------------------------------------


def _check(work: Work) -> None:
    for what, count in (
        ("groups of cameras", len(work.views)),
        ("tiles", work.tiles),
        ("sample blocks", work.blocks),
    ):
        if not 1 <= count <= MOST_VALUES:
            raise RenderError(
                f"{count} {what}", where=work.stage.name, expected=f"1 to {MOST_VALUES} in one job"
            )
    root = _root(work)
    outside = [file for file in _files(work) if not file.is_relative_to(root)]
    # A link in the folder may lead to anything; the stage itself is what the user named.
    linked = work.files.outside([root])
    if outside or linked:
        raise RenderError(
            f"points to {outside[0] if outside else linked}",
            where=str(work.stage),
            expected="a stage whose files lie in its own folder, so that it can travel",
            try_="<export>",
        )
    taken = {root / EXTRA_FOLDER / file.name for file in work.extra}.intersection(_files(work))
    if taken:
        raise RenderError(
            "has the name of a file of the stage", where=str(min(taken)), try_="another name"
        )


def _copy_stage(work: Work, folder: Path) -> None:
    copies = {folder / file.relative_to(_root(work)): file for file in _files(work)}
    copies |= {folder / EXTRA_FOLDER / file.name: file for file in work.extra}
    made = Copies()
    for target, file in copies.items():
        made.add(file, target)


def _files(work: Work) -> tuple[Path, ...]:
    return (*work.files.layers, *work.files.others)


def _root(work: Work) -> Path:
    return absolute(work.stage).parent


# The packages that this program runs with, by their exact versions -------------------------------

_NAME = re.compile(r"[A-Za-z0-9][\w.-]*")


def pinned(package: str = "chord-usd") -> list[str]:
    """Lines for `pip install -r`: the package and all that it needs, extras left out."""
    versions: dict[str, str] = {}
    due = [package]
    while due:
        name = due.pop()
        key = re.sub(r"[-_.]+", "-", name).lower()
        if key in versions:
            continue
        try:
            installed = distribution(name)
        except PackageNotFoundError:  # of another system
            continue
        versions[key] = f"{key}=={installed.version}"
        due += [
            match[0]
            for line in installed.requires or ()
            if "extra ==" not in line and (match := _NAME.match(line))
        ]
    return sorted(versions.values())
