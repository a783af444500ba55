"""Files that a browser sends: how large, of what kind, and under which name they are kept."""

from __future__ import annotations

import errno
import shutil
import unicodedata
from collections.abc import AsyncIterator
from pathlib import Path, PurePosixPath

from chord_usd.base.errors import ChordError, DiskFullError, Steps

MOST_BYTES = 64 * 2**20
"""Of a plan. Whatever says that it is larger is refused unread."""

LEAST_FREE_BYTES = 256 * 2**20
"""What must be free before anything is begun: a house takes some ten megabytes."""

LONGEST_NAME = 80

_PICTURES = (
    b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"II*\0", b"MM\0*", b"BM", b"RIFF", b"GIF8",
)  # fmt: skip
"""Any of them under any of their suffixes: many a JPEG is called .png."""

_PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".gif")

_STARTS: dict[str, tuple[bytes, ...]] = {
    **dict.fromkeys(_PICTURE_SUFFIXES, _PICTURES),
    ".pdf": (b"%PDF",),
    ".sh3d": (b"PK\x03\x04",),
    ".ifc": (b"ISO-10303-21",),
    ".json": (b"{",),
    ".svg": (b"<",),
    ".dxf": (),
}
"""How files of a kind begin. The verb that reads one looks closer, in a process with limits."""

PLAN_SUFFIXES = tuple(_STARTS)


class UploadError(ChordError):
    """A file that is not taken; status is HTTP's."""

    def __init__(self, what: str, status: int, *, expected: str = "", try_: Steps = "") -> None:
        super().__init__(what, expected=expected, try_=try_)
        self.status = status


def plan_suffix(name: str) -> str:
    """The suffix that an upload is kept under. Raises UploadError."""
    suffix = PurePosixPath(name.replace("\\", "/")).suffix.lower()
    if suffix not in _STARTS:
        raise UploadError(
            f"{suffix or 'a file without a suffix'} is no plan",
            415,
            expected=f"one of {', '.join(PLAN_SUFFIXES)}",
        )
    return suffix


def shown_name(name: str) -> str:
    """What a house is called, after a file or as a user says it: one line, never a path."""
    last = PurePosixPath(name.replace("\\", "/")).name
    line = "".join(c if unicodedata.category(c)[0] != "C" else " " for c in last)
    return " ".join(line.split())[:LONGEST_NAME] or "house"


def refuse_size(said: str | None) -> None:
    """Raises UploadError for a length, as a header says it, that is too large or none."""
    if said is not None and (not said.isdecimal() or int(said[:18]) > MOST_BYTES):
        raise _too_large()


def refuse_full_disk(folder: Path) -> None:
    """Raises DiskFullError where nothing more should be begun."""
    free = shutil.disk_usage(folder).free
    if free < LEAST_FREE_BYTES:
        raise DiskFullError(
            f"the disk has {free / 1e6:.0f} MB left",
            expected=f"at least {LEAST_FREE_BYTES / 1e6:.0f} MB",
            try_=("deleting houses", "<root> on another disk"),
        )


async def receive(chunks: AsyncIterator[bytes], target: Path) -> None:
    """Write an upload to target, whole or not at all; its suffix says what it must be.

    Raises UploadError, DiskFullError.
    """
    partial = target.with_name(f"{target.name}.part")
    size, start = 0, b""
    try:
        with partial.open("wb") as file:
            async for chunk in chunks:
                size += len(chunk)
                if size > MOST_BYTES:
                    raise _too_large()
                start = start if len(start) >= 512 else (start + chunk)[:512]
                file.write(chunk)
        _refuse_kind(start, target.suffix)
        partial.replace(target)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise DiskFullError("the disk is full", try_="delete houses") from error
        raise
    finally:
        partial.unlink(missing_ok=True)


def _refuse_kind(start: bytes, suffix: str) -> None:
    if not start:
        raise UploadError("the file is empty", 415)
    starts = _STARTS[suffix]
    if starts and not start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(starts):
        raise UploadError(
            f"the file is called {suffix}, and is something else",
            415,
            try_="save it under its own suffix",
        )


def _too_large() -> UploadError:
    return UploadError(f"is larger than {MOST_BYTES // 2**20} MB", 413, try_="a smaller picture")
