"""One copy of each asset and material for all houses of a batch.

Every house has its own assets/ and materials/ beside its stage, so its folder can be moved and
mailed; their files are hard links to those in the batch's assets/ and materials/. A house never
depends on them: where links cannot be made, or something of another kind has a name, it keeps its
copy.
"""

from __future__ import annotations

import contextlib
import errno
import filecmp
import os
from collections.abc import Iterator
from pathlib import Path

from chord_usd.faces.batch.records import files_in

SHARED_FOLDERS = ("assets", "materials")

_NO_LINKS = (
    errno.EMLINK, errno.EPERM, errno.ENOTSUP, errno.EXDEV, errno.ENOSYS,
    errno.ENOTDIR, errno.EEXIST,  # a file of somebody where a folder would be
)  # fmt: skip


def share_files(house: Path, library: Path) -> None:
    """Replace a house's copies by links into library, which takes in what is new.

    house: a folder that nobody else uses yet, on the library's file system.
    """
    library = library.resolve()
    for kind in SHARED_FOLDERS:
        for file in files_in(house / kind):
            kept = library / file.relative_to(house)
            if kept.parent.resolve() == kept.parent:  # no link leads out of the library
                _share(file, kept)


def keep_pictures(old: Path, new: Path, name: str) -> None:
    """Let the folder name of an old house live on in its new one, which is about to replace it."""
    for file in (path for path in (old / name).rglob("*") if path.is_file()):
        target = new / file.relative_to(old)
        target.parent.mkdir(parents=True, exist_ok=True)
        with _where_links_are():
            os.link(file, target)


def _share(file: Path, kept: Path) -> None:
    with _where_links_are():
        kept.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(file, kept)
        except FileExistsError:
            # Of another version, damaged or somebody's own: it stays, and the house keeps its copy.
            if filecmp.cmp(file, kept, shallow=False):
                link = file.with_name(f".{file.name}.link")
                os.link(kept, link)
                link.replace(file)


@contextlib.contextmanager
def _where_links_are() -> Iterator[None]:
    """Pass over what a file system cannot do, or not any more, and names that are taken."""
    try:
        yield
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
