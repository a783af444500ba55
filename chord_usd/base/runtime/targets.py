"""What may be written where, and what is told of targets that may not."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import stat
from pathlib import Path
from typing import Literal

from chord_usd.base.errors import DiskFullError, OutputError, reason_of
from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.manifest import MANIFEST_FILE, Manifest
from chord_usd.base.runtime.scratch import PREFIX as SCRATCH_PREFIX

FolderMode = Literal["new", "replace", "renew", "add"]
"""What becomes of a folder that holds something already. new: it is refused. replace: what this
program wrote there as one output is replaced. renew: as replace, and files of ours that were
damaged or changed are set aside, which replace refuses. add: new files join those of ours."""

_FULL_DISK = (errno.ENOSPC, errno.EDQUOT)
FREE_SPACE = "free some space, or write to another disk"

NEARLY_FULL_BYTES = 16 * 2**20
"""Less than this free: no house fits, and a writer that failed without words failed for it."""


def check_run_folder(folder: Path) -> None:
    """Raise OutputError for a folder that a training run may not write its files into."""
    if os.path.lexists(folder) and not folder.is_dir():
        raise OutputError("is no folder", where=str(folder), expected="a folder, or nothing")
    if folder.is_dir() and not Manifest(folder).is_of_a_run:
        refuse_folder(folder, "new")


def begin_run(folder: Path) -> None:
    """Take a folder for a training run, which rewrites its files again and again.

    Raises OutputError for a folder that holds anything but such a run, or cannot be written.
    """
    check_run_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        Manifest(folder).note_run()
        interrupts.delivered.append(folder)
    except OSError as error:
        raise output_error(error, folder) from error


def refuse_full_disk(folder: Path, target: Path) -> None:
    """Raise DiskFullError where a folder that is there has no space for a house."""
    with contextlib.suppress(OSError):
        if shutil.disk_usage(folder).free < NEARLY_FULL_BYTES:
            raise DiskFullError("the disk is full", where=str(target), try_=FREE_SPACE)


def check_file_target(target: Path) -> None:
    """Raise OutputError for a target that is there and no plain file."""
    try:
        mode = target.lstat().st_mode
    except OSError:
        return  # not there, or not to be seen: writing will tell
    if stat.S_ISREG(mode):
        return
    if stat.S_ISLNK(mode):
        raise OutputError(
            "is a symbolic link", where=str(target), expected="a file", try_="the path it leads to"
        )
    what = "is a folder" if stat.S_ISDIR(mode) else "is no regular file"
    raise OutputError(what, where=str(target), expected="a file name to write")


def refuse_folder(folder: Path, mode: FolderMode) -> None:
    """Raise OutputError for a folder whose content may not be replaced or added to."""
    there = sorted(one.name for one in folder.iterdir() if one.name != MANIFEST_FILE)
    there = [name for name in there if not name.startswith(SCRATCH_PREFIX)]
    manifest = Manifest(folder)
    if not there or (mode in ("replace", "renew") and manifest.is_of_a_whole_folder):
        return
    if mode == "add" and manifest.hashes:
        return
    ours = mode == "new" and manifest.is_of_a_whole_folder
    raise OutputError(
        f"holds {_listed(there)}"
        + ("" if ours else ", which chord-usd did not write as one output"),
        where=str(folder),
        expected="an empty folder, or none yet",
        try_="--overwrite, which replaces what chord-usd wrote there, or another -o"
        if ours
        else "another -o",
    )


def _listed(names: list[str]) -> str:
    first = ", ".join(names[:3])
    return first if len(names) <= 3 else f"{first} and {len(names) - 3} more"


def not_ours(target: Path) -> OutputError:
    """What the user is told of a file that is not replaced."""
    return OutputError(
        "was not written by chord-usd, or was changed since",
        where=str(target),
        expected="a name that is free",
        try_="move it away, or another -o",
    )


def output_error(error: OSError, target: Path) -> OutputError:
    """What the user is told where a target cannot be written."""
    if is_full(error):
        return DiskFullError("the disk is full", where=str(target), try_=FREE_SPACE)
    return OutputError(
        f"cannot be written ({reason_of(error)})",
        where=str(target),
        expected="a path in a writable folder",
        try_="another -o path",
    )


def is_full(error: OSError) -> bool:
    """Whether the disk is."""
    # Copies of whole folders gather what failed, as words.
    gathered = isinstance(error, shutil.Error) and os.strerror(errno.ENOSPC) in str(error)
    return gathered or error.errno in _FULL_DISK
