"""Copies of what a house points to, beside it, so that its folder can be moved and mailed.

A package is a folder: an asset's or a look's interface layer and the files that this refers to.
Houses in one folder share the packages that are the same; one that lies there already is never
changed. Packages of one database share a folder of pictures beside them; those that point into
it keep it, and those that stand alone have hard links to it, here as there.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path

from chord_usd.base.errors import AssetError, ChordError
from chord_usd.base.runtime.asset_stages import EXPECTED, asset_files
from chord_usd.base.runtime.files import hash_file, link_or_copy, write_atomic
from chord_usd.base.runtime.locations import cache_folder
from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.articulation import JOINTED_LAYER, PAYLOAD_LAYER, PAYLOADS
from chord_usd.library.prop import prop_files

SHARED = "Finishes"
"""Folder beside packages whose pictures all of them may use."""

_PICTURES = (".jpg", ".jpeg", ".png")


class Packages:
    """The packages of one kind that a house uses, such as its assets."""

    def __init__(self, staged: Path, finals: Sequence[Path], kind: str) -> None:
        """staged: folder being written; finals: the folders that hold what the house will find
        beside it; kind: name of the folder."""
        self._staged, self._kind = staged / kind, kind
        self._finals = [final / kind for final in finals]
        self._names: dict[Path, str] = {}
        self._shared: set[Path] = set()

    def add(self, interface: Path, also: Collection[str] = ()) -> str:
        """Take in the package of this interface layer; returns the path for a reference.

        also: names of files beside it that go with it where they are there; a package without them
        is the same. Raises AssetError when the layer is not there, is none, or refers to files
        outside its folder.
        """
        interface = Path(os.path.abspath(interface))  # noqa: PTH100 (not through links)
        if interface not in self._names:
            package = package_files(interface, also)
            files = package.files
            taken = set(self._names.values())
            needed = {name: file for name, file in files.items() if name.name not in also}
            name = free_package(interface.parent.name, needed, self._finals, taken)
            self._names[interface] = name
            # Also what lies there already: the house is checked before it is delivered.
            _copy(files, self._staged / name)
            self._share((*package.shared, *package.linked.values()), interface)
            for inner, picture in package.linked.items():
                place = self._staged / name / inner
                place.parent.mkdir(parents=True, exist_ok=True)
                link_or_copy(self._staged / SHARED / picture.name, place)
        return f"./{self._kind}/{self._names[interface]}/{interface.name}"

    def _share(self, pictures: Iterable[Path], interface: Path) -> None:
        """Copy pictures that packages share; pictures of one name are one picture, and one file."""
        for picture in pictures:
            if picture in self._shared:
                continue
            self._shared.add(picture)
            place = self._staged / SHARED / picture.name
            finals = [final / SHARED / picture.name for final in self._finals]
            present = [there for there in (*finals, place) if os.path.lexists(there)]
            for there in present:
                if not is_copy(picture, there):
                    raise AssetError(
                        f"needs {SHARED}/{picture.name}, and another file is there already",
                        where=str(interface),
                        expected="one picture of that name in all databases of a house",
                        try_="-o in an empty folder, or give that picture another name",
                    )
            if not place.exists():
                place.parent.mkdir(parents=True, exist_ok=True)
                if present:
                    link_or_copy(present[0], place)
                else:
                    shutil.copyfile(picture, place)


@dataclass(frozen=True)
class Package:
    """What belongs to an asset or a look."""

    files: Mapping[Path, Path]
    """By their path within the package."""
    shared: tuple[Path, ...]
    """Pictures in the folder that it shares with others, which it points to."""
    linked: Mapping[Path, Path] = field(default_factory=dict)
    """Pictures of its own, by their path within it, to those in that folder which they are."""


def package_files(interface: Path, also: Iterable[str] = ()) -> Package:
    """The files of a package. Raises AssetError."""
    if not interface.is_file():
        raise AssetError(
            "the asset's layer is missing",
            where=str(interface),
            expected=EXPECTED,
            try_="<assets build>",
        )
    source = Path(os.path.abspath(interface.parent))  # noqa: PTH100 (not through links)
    package = _kept(interface, source) or _walked(interface, source)
    beside = {Path(name): source / name for name in also if (source / name).is_file()}
    return replace(package, files=dict(sorted({**package.files, **beside}.items())))


def _walked(interface: Path, source: Path) -> Package:
    """What the layers themselves name; noted where the package lies in the cache."""
    asset = asset_files(interface)
    shared = _shared_pictures(asset.others, source.parent / SHARED)
    files = [file for file in (*asset.layers, *asset.others) if file not in shared]
    outside = replace(asset, others=tuple(files[len(asset.layers) :])).outside([source]) or next(
        (file for file in files if not file.is_relative_to(source)), None
    )
    if outside is not None:
        raise AssetError(
            f"the asset points to {outside}",
            where=str(interface),
            expected=f"an asset whose files lie in its folder, its pictures there or in {SHARED}/",
            try_="copy that file beside the asset, and refer to it there",
        )
    inner = {file.relative_to(source): file for file in files}
    inner |= {file.relative_to(source): file for file in prop_beside(interface)}
    linked = {name: source.parent / SHARED / name.name for name in inner}
    linked = {name: picture for name, picture in linked.items() if _is_one(inner[name], picture)}
    inner = {name: file for name, file in inner.items() if name not in linked}
    package = Package(inner, tuple(sorted(shared)), linked)
    _keep(package, source)
    return package


def prop_beside(interface: Path) -> list[Path]:
    """The files of a package that its interface does not point to, and that are no links."""
    folder = interface.parent
    files = (folder / name for name in prop_files(interface.stem))
    home = folder.resolve()
    return [
        file
        for file in files
        if file.is_file() and file.resolve() == home / file.relative_to(folder)
    ]


def _note(source: Path) -> Path | None:
    """Where the files of a package are noted: of those in the cache only, which never change."""
    database = source.parent
    if database.parent != cache_folder():
        return None
    return database.with_name(f"{database.name}-files") / f"{source.name}.json"


def _kept(interface: Path, source: Path) -> Package | None:
    """What was noted of a package; None where nothing was, or where it holds no longer."""
    note = _note(source)
    try:
        content = json.loads(note.read_bytes()) if note and interface.stem == source.name else None
        if content is None:
            return None
        files = {Path(name): source / name for name in content["files"]}
        shared = tuple(source.parent / SHARED / name for name in content["shared"])
        linked = {
            Path(name): source.parent / SHARED / Path(name).name for name in content["linked"]
        }
    except (OSError, ValueError, KeyError, TypeError):
        return None
    needed = (*files.values(), *shared, *linked.values())
    return Package(files, shared, linked) if all(map(Path.is_file, needed)) else None


def _keep(package: Package, source: Path) -> None:
    note = _note(source)
    if note is None:
        return
    content = {
        "files": [name.as_posix() for name in package.files],
        "shared": [picture.name for picture in package.shared],
        "linked": [name.as_posix() for name in package.linked],
    }
    with suppress(OSError, ChordError):  # the cache is a convenience
        note.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(note, json.dumps(content).encode())


def _shared_pictures(files: Iterable[Path], folder: Path) -> set[Path]:
    """The pictures that lie, and not only seem to, in the folder beside a package."""
    if folder.is_symlink():
        return set()
    return {
        file
        for file in files
        if file.parent == folder and file.suffix.lower() in _PICTURES and not file.is_symlink()
    }


def share_pictures(assets: Path) -> None:
    """Let packages point to the pictures that they share, before they go into an archive, which
    knows no links and would hold each of them many times."""
    from pxr import UsdUtils

    there = {file.name for file in (assets / SHARED).glob("*")}
    for name in (PAYLOAD_LAYER, JOINTED_LAYER):
        for file in assets.glob(f"*/{PAYLOADS}/{name}"):
            up = os.path.relpath(assets / SHARED, file.parent)
            layer = open_layer(file)
            UsdUtils.ModifyAssetPaths(
                layer,
                lambda path, up=up: f"{up}/{Path(path).name}" if Path(path).name in there else path,
            )
            layer.Save()


def _is_one(file: Path, picture: Path) -> bool:
    """Whether a picture of a package is one of those that packages share."""
    if file.suffix.lower() not in _PICTURES or picture.is_symlink() or not picture.is_file():
        return False
    return file.samefile(picture) or is_copy(file, picture)


def free_package(
    name: str, files: Mapping[Path, Path], finals: Sequence[Path], taken: Iterable[str] = ()
) -> str:
    """The package's own name, numbered where that is taken by other bytes, or by one of taken."""
    candidates = (name if number == 1 else f"{name}_{number}" for number in count(1))
    return next(
        candidate
        for candidate in candidates
        if candidate not in taken
        and candidate.lower() != SHARED.lower()
        and all(_is_free_or_same(final / candidate, files) for final in finals)
    )


def _is_free_or_same(folder: Path, files: Mapping[Path, Path]) -> bool:
    """Whether nothing is there, or all of these files with these bytes."""
    if not os.path.lexists(folder):
        return True
    return all(is_copy(file, folder / name) for name, file in files.items())


def _copy(files: Mapping[Path, Path], folder: Path) -> None:
    for inner in {name.parent for name in files}:
        (folder / inner).mkdir(parents=True, exist_ok=True)
    for name, file in files.items():
        shutil.copyfile(file, folder / name)


def is_copy(file: Path, other: Path) -> bool:
    """Whether other is there and holds the same bytes."""
    if not other.is_file() or other.stat().st_size != file.stat().st_size:
        return False
    return hash_file(other) == hash_file(file)
