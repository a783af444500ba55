"""Archives from strangers: what is in them is looked at before anything is written."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from chord_usd.errors import AssetError

MOST_BYTES = 4 * 2**30
"""Unpacked; the largest Sweet Home 3D library has less than a tenth of this."""

MOST_RATIO = 300
"""Unpacked against packed. Text of meshes shrinks to a tenth, zeros to a thousandth."""

MOST_ENTRIES = 60_000
_RATIO_FROM_BYTES = 10 * 2**20


def checked_archive(path: Path) -> zipfile.ZipFile:
    """The archive, opened. Raises AssetError for one that is damaged, far too large when unpacked,
    or that names files outside itself."""
    try:
        archive = zipfile.ZipFile(path)
    except (OSError, zipfile.BadZipFile) as error:
        raise AssetError(
            f"the library cannot be opened ({error})", where=str(path), expected="a zip archive"
        ) from None
    entries = archive.infolist()
    size = sum(entry.file_size for entry in entries)
    packed = max(sum(entry.compress_size for entry in entries), 1)
    if size > MOST_BYTES or len(entries) > MOST_ENTRIES:
        raise AssetError(
            f"the library unpacks to {size / 2**30:.1f} GB in {len(entries)} files",
            where=str(path),
            expected=f"at most {MOST_BYTES / 2**30:.0f} GB and {MOST_ENTRIES} files",
        )
    if size > _RATIO_FROM_BYTES and size / packed > MOST_RATIO:
        raise AssetError(
            f"the library unpacks to {size / packed:.0f} times its size",
            where=str(path),
            expected=f"at most {MOST_RATIO} times; this looks like a zip bomb",
        )
    for entry in entries:
        _refuse_escape(entry.filename, path)
    return archive


def files_by_folder(archive: zipfile.ZipFile) -> dict[str, list[zipfile.ZipInfo]]:
    """The files of an archive by the folder that they lie in; "." is its root."""
    folders: dict[str, list[zipfile.ZipInfo]] = {}
    for entry in archive.infolist():
        if not entry.is_dir():
            folders.setdefault(str(PurePosixPath(entry.filename).parent), []).append(entry)
    return folders


def unpack(archive: zipfile.ZipFile, entries: Iterable[zipfile.ZipInfo], target: Path) -> None:
    """Write entries of an archive, side by side."""
    for entry in entries:
        (target / PurePosixPath(entry.filename).name).write_bytes(archive.read(entry))


def _refuse_escape(name: str, path: Path) -> None:
    parts = PurePosixPath(name.replace("\\", "/"))
    if parts.is_absolute() or ".." in parts.parts or ":" in name:
        raise AssetError(
            f"the library names a file outside itself: {name!r}",
            where=str(path),
            expected="names relative to the archive",
        )
