"""Three kinds of libraries: a folder with a manifest, 3D-FUTURE's layout, Sweet Home 3D's .sh3f."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.archives import Archive
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.library.database import TAGS
from chord_usd.library.design_tables import SizeM
from chord_usd.library.libraries.models import AXES, UNITS_M, Library, Model

MANIFESTS = ("manifest.json", "manifest.csv")
FUTURE_INFO = "model_info.json"
SWEET_HOME_CATALOGUE = "PluginFurnitureCatalog.properties"
MOST_CATALOGUE_BYTES = 64 * 2**20
"""A list of 10,000 models has 5 MB."""

MOST_LETTERS = 2_000
"""Of a name or a licence: all of it stands in every house with the model."""
MESH_SUFFIXES = (".glb", ".gltf", ".obj", ".usd", ".usda", ".usdc", ".usdz")

_EXAMPLE = '[{"file": "chair.glb", "category": "chair", "licence": "CC-BY-4.0", "author": "…"}]'


def open_library(path: Path) -> Library:
    """The library at path. Raises AssetError for what is none of the three kinds."""
    if path.is_file() and path.suffix.lower() in (".sh3f", ".zip"):
        return SweetHomeLibrary(path)
    if path.is_dir():
        for name in MANIFESTS:
            if (path / name).is_file():
                return ManifestLibrary(path, path / name)
        files = [path / FUTURE_INFO, path.parent / FUTURE_INFO]
        for info in files:
            if info.is_file():
                return FutureLibrary(path, info)
    raise AssetError(
        "is no library of models" if path.exists() else "there is no such library",
        where=str(path),
        expected=f"a folder with {MANIFESTS[0]} or {MANIFESTS[1]}, 3D-FUTURE's folder with "
        f"{FUTURE_INFO}, or a Sweet Home 3D library (.sh3f)",
        try_=f"write {MANIFESTS[0]}: {_EXAMPLE}",
    )


class ManifestLibrary:
    """A folder of meshes and a list of them, as JSON or CSV.

    Of each: file and category; perhaps id, label, size_m or size_cm (length, width, height), unit
    (m, cm, mm, in, ft), up and front (axes such as +y), licence, author, tags (a list, or words
    with spaces between; library.database.TAGS).
    """

    def __init__(self, folder: Path, manifest: Path) -> None:
        self._folder, self._manifest = folder, manifest

    def models(self) -> list[Model]:
        """The entries of the manifest. Raises AssetError that names the one at fault."""
        try:
            text = _text_of(self._manifest)
            where = str(self._manifest)
            rows = _json_rows(text, where) if where.endswith(".json") else _csv_rows(text)
        except (OSError, ValueError, RecursionError, csv.Error) as error:
            raise AssetError(
                f"the manifest cannot be read ({error})",
                where=str(self._manifest),
                expected=_EXAMPLE,
            ) from None
        return [self._model(row, number) for number, row in enumerate(rows, start=1)]

    def _model(self, row: Mapping[str, Any], number: int) -> Model:
        try:
            file = str(row["file"])
            return Model(
                id=str(row.get("id") or PurePosixPath(file).stem),
                category=str(row["category"]),
                file=_inside(file),
                size_m=_size_m(row),
                unit_m=UNITS_M[str(row["unit"])] if row.get("unit") else None,
                up=_axis(row.get("up")),
                front=_axis(row.get("front")),
                label=_text_at(row, "label"),
                licence=_text_at(row, "licence", "license"),
                author=_text_at(row, "author", "creator"),
                tags=_tags(row.get("tags")),
            )
        except (KeyError, ValueError, TypeError, OverflowError) as error:
            raise AssetError(
                f"entry {number} of the manifest is wrong ({error})",
                where=str(self._manifest),
                expected=_EXAMPLE,
            ) from None

    @contextmanager
    def opened(self, model: Model) -> Iterator[Path]:
        """The mesh where it lies."""
        yield _existing(self._folder / model.file)


class FutureLibrary:
    """3D-FUTURE: a folder per model with raw_model.obj and texture.png; model_info.json beside."""

    def __init__(self, folder: Path, info: Path) -> None:
        self._folder, self._info = folder, info

    def models(self) -> list[Model]:
        """The models that are there; the data set comes in parts."""
        try:
            rows = parse_json(_text_of(self._info), str(self._info), AssetError)
            listed = [(str(row["model_id"]), row) for row in rows]
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
            raise AssetError(
                f"cannot be read ({error})",
                where=str(self._info),
                expected='3D-FUTURE\'s list of {"model_id", "super-category", "category", …}',
            ) from None
        return [
            Model(
                id=f"future_{model_id}",
                category=str(row.get("category") or row.get("super-category") or ""),
                file=f"{_inside(model_id)}/raw_model.obj",
                unit_m=1.0,
                up="+y",
                front="+z",
                label=_text_at(row, "category"),
                licence="3D-FUTURE terms of use",
                author="Alibaba 3D-FUTURE",
            )
            for model_id, row in listed
            if (self._folder / model_id).is_dir()
        ]

    @contextmanager
    def opened(self, model: Model) -> Iterator[Path]:
        """The mesh where it lies."""
        yield _existing(self._folder / model.file)


class SweetHomeLibrary:
    """A Sweet Home 3D furniture library: a zip of OBJ meshes, textures and a catalogue."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def models(self) -> list[Model]:
        """The catalogue's furniture, without doors and windows. Raises AssetError."""
        data = self._archive.read(SWEET_HOME_CATALOGUE, MOST_CATALOGUE_BYTES)
        library = read_properties(data.decode("latin-1"))
        return [
            self._model(entry, library, number)
            for number, entry in _by_number(library).items()
            if "model" in entry and entry.get("doorOrWindow", "false") != "true"
        ]

    def _model(
        self, entry: Mapping[str, str], library: Mapping[str, str], number: int
    ) -> Model:  # fmt: skip
        try:
            size = tuple(float(entry[side]) / 100.0 for side in ("width", "depth", "height"))
            name, licence = _text_at(entry, "name"), _text_at({**library, **entry}, "license")
            author = _text_at(entry, "creator") or _text_at(library, "provider")
            rotation = _rotation(entry.get("modelRotation", ""))
        except (KeyError, ValueError) as error:
            raise AssetError(
                f"furniture {number} of the catalogue is wrong ({error})", where=str(self._path)
            ) from None
        return Model(
            id=entry.get("id", f"{self._path.stem}_{number}").split("#")[-1],
            category=f"{name} {entry.get('tags', '')}".strip() or entry.get("category", ""),
            file=_inside(entry["model"].lstrip("/")),
            size_m=(size[0], size[1], size[2]),
            up="+y",
            front="+z",
            rotation=rotation,
            label=name,
            licence=licence,
            author=author,
        )

    @contextmanager
    def opened(self, model: Model) -> Iterator[Path]:
        """The mesh and what lies beside it in the archive, unpacked for a while."""
        inside = PurePosixPath(model.file)
        with scratch_folder() as folder:
            self._archive.unpack(folder, self._folders.get(inside.parent, ()))
            yield _existing(folder / inside)

    @cached_property
    def _archive(self) -> Archive:
        """Looked through once: it has thousands of files, and is asked for each of its models."""
        expected = f"a zip archive with {SWEET_HOME_CATALOGUE}"
        return Archive(self._path, AssetError, expected=expected)

    @cached_property
    def _folders(self) -> dict[PurePosixPath, list[str]]:
        """Names of the files by the folder that they lie in."""
        folders: dict[PurePosixPath, list[str]] = {}
        for name in self._archive.names:
            folders.setdefault(PurePosixPath(name).parent, []).append(name)
        return folders


def read_properties(text: str) -> dict[str, str]:
    """A Java properties file: key = value, # comments, \\uXXXX, lines continued by a backslash."""
    properties: dict[str, str] = {}
    lines = iter(text.splitlines())
    for line in lines:
        line = line.strip()
        while line.endswith("\\"):
            line = line[:-1] + next(lines, "").strip()
        if not line or line[0] in "#!":
            continue
        key, _, value = line.partition("=")
        properties[key.strip()] = _unescaped(value.strip())
    return properties


def _unescaped(value: str) -> str:
    """The escapes of Java in a value of Latin-1 letters."""
    try:
        return value.encode("latin-1", "backslashreplace").decode("unicode_escape")
    except UnicodeDecodeError:
        return value


def _by_number(properties: Mapping[str, str]) -> dict[int, dict[str, str]]:
    """Entries `name#7 = value` under their number."""
    entries: dict[int, dict[str, str]] = {}
    for key, value in properties.items():
        name, hash_mark, number = key.partition("#")
        if hash_mark and re.fullmatch("[0-9]{1,9}", number):
            entries.setdefault(int(number), {})[name] = value
    return dict(sorted(entries.items()))


def _text_of(file: Path) -> str:
    """The text of a list. Raises ValueError for one that is far too long."""
    if file.stat().st_size > MOST_CATALOGUE_BYTES:
        raise ValueError(f"it has more than {MOST_CATALOGUE_BYTES // 2**20} MB")
    return file.read_text(encoding="utf-8-sig")


def _text_at(row: Mapping[str, Any], *keys: str) -> str:
    """What an entry says under the first of keys that it has. Raises ValueError."""
    text = next((str(row[key]) for key in keys if row.get(key)), "")
    if len(text) > MOST_LETTERS:
        raise ValueError(f"{keys[0]} has {len(text):,} letters, more than {MOST_LETTERS:,}")
    # A half of a pair of surrogates cannot be written.
    return text.encode("utf-8", "replace").decode("utf-8")


def _json_rows(text: str, where: str) -> list[Mapping[str, Any]]:
    data = parse_json(text, where, AssetError)
    rows = data.get("models") if isinstance(data, dict) else data
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise ValueError("it is no list of objects")
    return rows


def _csv_rows(text: str) -> list[Mapping[str, Any]]:
    rows: list[Mapping[str, Any]] = []
    for row in csv.DictReader(text.splitlines()):
        sides = [row.get(f"{side}_m") or "" for side in ("length", "width", "height")]
        rows.append({**row, **({"size_m": sides} if all(sides) else {})})
    return rows


def _tags(value: object) -> tuple[str, ...]:
    """Tags of a list or of words; raises ValueError for an unknown tag."""
    tags = tuple(map(str, value)) if isinstance(value, list) else tuple(str(value or "").split())
    unknown = sorted(set(tags) - set(TAGS))
    if unknown:
        raise ValueError(f"the tag {unknown[0]!r} is unknown, use {', '.join(TAGS)}")
    return tags


def _size_m(row: Mapping[str, Any]) -> SizeM | None:
    for key, unit_m in (("size_m", 1.0), ("size_cm", 0.01)):
        if row.get(key):
            length, width, height = (float(side) * unit_m for side in row[key])
            if not all(0.0 < side < 100.0 for side in (length, width, height)):
                raise ValueError(f"{key} is {row[key]}, not three positive lengths")
            return length, width, height
    return None


def _rotation(text: str) -> tuple[float, ...]:
    """The nine numbers of a catalogue's modelRotation; none where it has none.

    Raises ValueError for numbers that turn nothing.
    """
    try:
        numbers = tuple(float(number) for number in text.split())
    except ValueError:
        return ()
    if len(numbers) != 9:
        return ()
    matrix = np.array(numbers).reshape(3, 3)
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=0.01):
        raise ValueError(f"modelRotation is {text}, no rotation")
    return numbers


def _axis(value: object) -> str | None:
    if not value:
        return None
    text = str(value).lower()
    text = text if text[0] in "+-" else f"+{text}"
    if text not in AXES:
        raise ValueError(f"{value!r} is no axis; one of {', '.join(AXES)}")
    return text


def _inside(name: str) -> str:
    """The name, if it stays inside the library. Raises ValueError or AssetError."""
    path = PurePosixPath(name.replace("\\", "/"))
    if path.is_absolute() or ".." in path.parts:
        raise AssetError(f"the library names a file outside itself: {name!r}")
    return str(path)


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise AssetError("the mesh is missing", where=path.name)
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise AssetError(
            f"{path.suffix or 'no suffix'} is no mesh format that can be read",
            where=path.name,
            expected=", ".join(MESH_SUFFIXES),
        )
    return path
