"""Where things lie: paths as users name them, and the files that ship with the package.

In a checkout (editable install) `materials/` and `checkpoints/` are the repository's own folders;
in an installed wheel they are inside the package.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

from chord_usd.base.errors import AssetError, CheckpointError, ChordError
from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.extras import REINSTALL

CACHE_VARIABLE = "CHORD_USD_CACHE"
"""Environment variable: folder for what is computed once and kept."""

CHECKPOINTS_VARIABLE = "CHORD_USD_CHECKPOINTS"
"""Environment variable: a folder of checkpoints, or a run of `chord-usd train`, that is looked into
before the shipped ones."""

RUN_CHECKPOINT = "checkpoint"
"""Folder of the checkpoint in a run of `chord-usd train`."""

_NAME_FILE = "NETWORK"
"""In the checkpoint of a run: which of the shipped checkpoints it stands for."""

_LEAST_STEPS = 100
"""A network that was trained for fewer steps is as good as untrained."""

_in_use: dict[str, Path] = {}

ROOT_VARIABLE = "CHORD_USD_ROOT"
"""Environment variable: files below this folder may be read, and none elsewhere."""

_PACKAGE = Path(__file__).parents[2]


def absolute(path: Path) -> Path:
    """The path from the root, without `..`; links stay, unless a `..` leads out of what they name.

    The only function that makes a path absolute, so that two paths of one file compare as equal.
    Raises ChordError where the working folder is gone.
    """
    whole = path if path.is_absolute() else working_folder() / path
    if whole.name == "..":
        return Path(os.path.realpath(whole))
    if ".." in whole.parts:
        return Path(os.path.realpath(whole.parent)) / whole.name
    return whole


def working_folder() -> Path:
    """The folder that relative paths start from. Raises ChordError where it is gone."""
    try:
        return Path.cwd()
    except FileNotFoundError as error:
        raise ChordError(
            "the working folder was deleted", expected="a folder that is there", try_="cd ~"
        ) from error


def checkpoint_folder(name: str) -> Path:
    """Folder of a checkpoint, such as "plan2layout" or "detector".

    One that the folder of CHORD_USD_CHECKPOINTS lacks is the shipped one. Raises CheckpointError
    when there is none of this name, or nothing in it, or where the variable names no folder with
    checkpoints.
    """
    named = _own_checkpoints()
    if name in named:
        _in_use[name] = named[name]
        return named[name]
    folder = _shipped("checkpoints") / name
    if folder.is_dir() and any(folder.iterdir()):
        return folder
    raise CheckpointError(
        f"there is no checkpoint {name!r}",
        where=str(folder.parent),
        expected=f"a folder {name} with safetensors weights and a config",
        try_=(f"<train={name}>", f"{CHECKPOINTS_VARIABLE}, set to a folder that holds it"),
    )


def name_checkpoint(run: Path, name: str) -> None:
    """Note in the folder of a training run which checkpoint it makes; before the first one is
    written, nothing."""
    if (run / RUN_CHECKPOINT).is_dir():
        (run / RUN_CHECKPOINT / _NAME_FILE).write_text(f"{name}\n", encoding="ascii")


def untrained_in_use() -> list[str]:
    """A line for each network of CHORD_USD_CHECKPOINTS that this process took though it is hardly
    trained."""
    lines = []
    for name, folder in sorted(_in_use.items()):
        steps = _steps_of(folder)
        if steps is not None and steps < _LEAST_STEPS:
            trained = f"{name} in {folder} was trained for {counted(steps, 'step')}"
            lines.append(f"{trained}: what it makes is noise")
    return lines


def _steps_of(folder: Path) -> int | None:
    """How many steps a checkpoint was trained for; None where it does not say."""
    try:
        config = json.loads((folder / "config.json").read_text(encoding="utf-8"))
        if "images" in config:
            return int(config["images"]) // max(int(config["batch"]), 1)
        return int(config["training"]["steps"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _own_checkpoints() -> dict[str, Path]:
    """Folders in CHORD_USD_CHECKPOINTS by the names of the shipped checkpoints."""
    value = os.environ.get(CHECKPOINTS_VARIABLE)
    if not value:
        return {}
    where = f"{CHECKPOINTS_VARIABLE}={value}"
    unset = f"unset {CHECKPOINTS_VARIABLE}, for the checkpoints that come with chord-usd"
    if not Path(value).is_dir():
        raise CheckpointError(
            "is no folder" if Path(value).exists() else "there is no such folder",
            where=where,
            expected="a folder of checkpoints, one folder each, such as plan2layout",
            try_=unset,
        )
    named = _named_in(Path(value))
    if not named:
        raise CheckpointError(
            "holds no networks",
            where=where,
            expected="a training run, or folders such as plan2layout",
            try_=unset,
        )
    return named


def _named_in(place: Path) -> dict[str, Path]:
    """Checkpoints in a folder of runs or checkpoints, in a run, or in a checkpoint of a run."""
    by_name = {}
    for folder in (place, place / RUN_CHECKPOINT):
        if (folder / _NAME_FILE).is_file():
            by_name[(folder / _NAME_FILE).read_text(encoding="ascii", errors="replace").strip()] = (
                folder
            )
    names = [shipped.name for shipped in _shipped("checkpoints").iterdir() if shipped.is_dir()]
    for name in names:
        run = place / name / RUN_CHECKPOINT
        folder = run if run.is_dir() else place / name
        if folder.is_dir() and any(folder.iterdir()):
            by_name[name] = folder
    return by_name


def shipped_checkpoints() -> Path:
    """The folder of the checkpoints that come with the program."""
    return _shipped("checkpoints")


def cache_folder() -> Path:
    """CHORD_USD_CACHE, else chord-usd in XDG_CACHE_HOME, else in ~/.cache."""
    value = os.environ.get(CACHE_VARIABLE)
    if value:
        return Path(value)
    shared = os.environ.get("XDG_CACHE_HOME")
    return (Path(shared) if shared else Path.home() / ".cache") / "chord-usd"


def is_cached(path: Path) -> bool:
    """Whether a file lies in the cache, which this program alone writes; links count as what they
    lead to."""
    return path.resolve().is_relative_to(cache_folder().resolve())


def portable(path: Path, home: Path) -> Path:
    """A path as a file in the folder home names it: relative to the cache, or else to home.

    An absolute path says who made the file, and leads nowhere on another machine.
    """
    if not path.is_absolute():
        return path
    cache = absolute(cache_folder())
    return (
        path.relative_to(cache) if path.is_relative_to(cache) else Path(os.path.relpath(path, home))
    )


def open_folders() -> list[Path]:
    """Folders that a run may read, with our own; empty where it may read all of the disk."""
    root = os.environ.get(ROOT_VARIABLE)
    return [Path(root), cache_folder(), _shipped("materials")] if root else []


def require_open(path: Path, error: type[ChordError] = ChordError) -> None:
    """Raises error for a path outside the folders that are open; links count as what they lead
    to."""
    folders = [Path(os.path.realpath(folder)) for folder in open_folders()]
    real = Path(os.path.realpath(path))
    if folders and not any(real.is_relative_to(folder) for folder in folders):
        raise error(
            "lies outside the folder that is open",
            where=str(path),
            expected=f"a path below {os.environ[ROOT_VARIABLE]}",
        )


def keep_caches() -> None:
    """Have libraries keep what they compute once beside our own, not all over the machine."""
    for name, folder in (("MPLCONFIGDIR", "matplotlib"), ("TORCHINDUCTOR_CACHE_DIR", "torch")):
        os.environ.setdefault(name, str(cache_folder() / folder))


def materials_folder() -> Path:
    """Folder of wall and floor looks, one folder each. Raises AssetError when it is missing."""
    folder = _shipped("materials")
    if not folder.is_dir():
        raise AssetError(
            "the looks of walls and floors are missing",
            where=str(folder),
            expected="one folder per look",
            try_=REINSTALL,
        )
    return folder


def _shipped(kind: str) -> Path:
    installed = _PACKAGE / "_data" / kind
    return installed if installed.is_dir() else _PACKAGE.parent / kind
