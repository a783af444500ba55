"""Earlier states of a house, kept beside it: what a scene shows after undo is had again.

A house is one layer; the folders beside it only ever gain files. Putting the layer back is enough.
"""

from __future__ import annotations

import hashlib
import re
import shutil
from pathlib import Path

from .errors import InputError

FOLDER = ".revisions"

KEPT = 32
"""As many as Blender undoes by default."""


def revision(house: Path) -> str:
    """Hash that identifies this state of the house. Raises OSError."""
    return hashlib.sha256(house.read_bytes()).hexdigest()


def keep(house: Path) -> None:
    """Keep the house as it is now, before and after this panel changes it. Raises OSError."""
    folder = house.parent / FOLDER
    folder.mkdir(exist_ok=True)
    copy = _kept(house, revision(house))
    partial = copy.with_name(copy.name + ".part")
    shutil.copyfile(house, partial)
    partial.replace(copy)
    name = re.compile(rf"{re.escape(house.stem)}-[0-9a-f]{{16}}{re.escape(house.suffix)}")
    copies = [entry for entry in folder.iterdir() if name.fullmatch(entry.name)]
    for old in sorted(copies, key=lambda path: path.stat().st_mtime_ns)[:-KEPT]:
        old.unlink()


def put_back(house: Path, shown: str) -> None:
    """See to it that the house on disk is the one that the scene shows.

    shown: its revision. Raises InputError where that state was not kept, or the one on disk, which
    somebody else wrote then; OSError.
    """
    there = revision(house)
    if there == shown:
        return
    copy = _kept(house, shown)
    if not copy.is_file() or not _kept(house, there).is_file():
        raise InputError(
            f"{house.name} was changed outside of this scene, and saving would mix two houses. "
            'Bring it in again with the folder button beside "Generate"; changes that are not '
            "saved yet are then lost."
        )
    partial = house.with_name(f".{house.name}.part")
    shutil.copyfile(copy, partial)
    partial.replace(house)


def _kept(house: Path, state: str) -> Path:
    return house.parent / FOLDER / f"{house.stem}-{state[:16]}{house.suffix}"
