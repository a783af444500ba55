"""The stages of assets: those that this program did not draw are tried before they are opened."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import AssetError, StageError
from chord_usd.base.runtime.locations import is_cached
from chord_usd.base.runtime.stages import StageFiles, files_of, look_through, open_known, walk

if TYPE_CHECKING:
    from pxr import Usd

EXPECTED = "a USD layer with a default prim"


def try_assets(paths: Iterable[Path]) -> None:
    """Try assets outside the cache, all in one process, since a process for each is slow.

    Raises AssetError.
    """
    with _usable():
        look_through([path for path in dict.fromkeys(paths) if not is_cached(path)])


def asset_files(path: Path) -> StageFiles:
    """The files of an asset. Raises AssetError."""
    with _usable():
        return walk(path) if is_cached(path) else files_of(path)


def open_asset(path: Path) -> Usd.Stage:
    """The stage of an asset. Raises AssetError."""
    asset_files(path)
    with _usable():
        return open_known(path)


@contextmanager
def _usable() -> Iterator[None]:
    try:
        yield
    except StageError as error:
        raise AssetError(
            f"the asset cannot be used: {error.what}", where=error.where, expected=EXPECTED
        ) from error
