"""Files as users have them: only regular ones are opened, and none that is too large for its kind.

A pipe or a device never ends; so nothing is opened before it was looked at here.
"""

from __future__ import annotations

import stat
from pathlib import Path

from chord_usd.base.errors import ChordError, reason_of
from chord_usd.base.runtime.locations import require_open

_MIB = 2**20

STAGE_SUFFIXES = (".usda", ".usd", ".usdc", ".usdz")
"""Of stages, read and written."""

LARGEST_BYTES = {
    ".json": 512 * _MIB, ".jsonl": 4096 * _MIB, ".svg": 64 * _MIB,
    ".pdf": 512 * _MIB, ".dxf": 512 * _MIB, ".ifc": 1024 * _MIB, ".sh3d": 1024 * _MIB,
    ".usd": 4096 * _MIB, ".usda": 4096 * _MIB, ".usdc": 4096 * _MIB, ".usdz": 4096 * _MIB,
    ".zip": 16384 * _MIB, ".gz": 16384 * _MIB,
}  # fmt: skip
"""By suffix: several times what the largest real ones take."""

_LARGEST_OTHER_BYTES = 1024 * _MIB
"""Pictures, mostly: 12,000 pixels a side take 600 MB without compression."""


def refuse_odd_file(
    path: Path, error: type[ChordError] = ChordError, most_bytes: int | None = None
) -> None:
    """Look at a file without opening it.

    Raises error for a path outside the folders that are open (locations.open_folders), and for
    what is no regular file (a folder, a pipe, a device, a socket), cannot be reached, or is larger
    than most_bytes, by default LARGEST_BYTES of its suffix.
    """
    where = str(path)
    require_open(path, error)
    try:
        status = path.stat()
    except (FileNotFoundError, NotADirectoryError) as problem:
        raise error(
            "cannot be read (no such file)", where=where, try_="check the path"
        ) from problem
    except OSError as problem:
        raise error(f"cannot be read ({reason_of(problem)})", where=where) from problem
    if stat.S_ISDIR(status.st_mode):
        raise error("is a folder", where=where, expected="a file")
    if not stat.S_ISREG(status.st_mode):
        raise error(
            f"is {_kind(status.st_mode)}",
            where=where,
            expected="a regular file",
            try_="save it to a file first",
        )
    most = most_bytes or LARGEST_BYTES.get(path.suffix.lower(), _LARGEST_OTHER_BYTES)
    if status.st_size > most:
        raise error(
            f"is larger than {most // _MIB} MiB",
            where=where,
            expected="a file of this kind that can be read at once",
        )


def _kind(mode: int) -> str:
    if stat.S_ISFIFO(mode):
        return "a pipe"
    return "a socket" if stat.S_ISSOCK(mode) else "a device"
