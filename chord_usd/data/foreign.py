"""Houses from elsewhere, whatever they are written in; what cannot be read is passed over, with
its reason.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from chord_usd.chord_json import scene_from_json
from chord_usd.data.flats import flat_from_lines
from chord_usd.data.procthor import Sizes, house_from_procthor, read_asset_sizes
from chord_usd.data.threed_front import house_from_front, read_models, room_from_record
from chord_usd.errors import ChordError, SceneError
from chord_usd.runtime.inputs import refuse_odd_file
from chord_usd.types import SceneGraph

FORMATS = "CHOrD JSON, 3D-FRONT, ProcTHOR or FloorplanTransformation"


@dataclass(frozen=True)
class Models:
    """What 3D-FRONT and ProcTHOR keep about their models beside the houses."""

    categories: Mapping[str, str] = field(default_factory=dict)
    """3D-FRONT: category by model id."""
    sizes: Sizes = field(default_factory=dict)
    """ProcTHOR: size by asset id."""


class Found(NamedTuple):
    """A house, or in words why there is none."""

    name: str
    house: SceneGraph | None
    why: str = ""


def read_models_file(path: Path) -> Models:
    """3D-FUTURE's model_info.json or ProcTHOR's asset-database.json. Raises SceneError."""
    try:
        refuse_odd_file(path, SceneError)
        is_list = path.read_text(encoding="utf-8").lstrip().startswith("[")
    except (OSError, ValueError) as error:
        raise SceneError(f"cannot be read: {error}", where=str(path)) from None
    if is_list:
        return Models(categories=read_models(path))
    return Models(sizes=read_asset_sizes(path))


def foreign_houses(source: Path, models: Models) -> Iterator[Found]:
    """Every house of a folder of JSON, a JSON file, or a JSON lines file, gzipped or not.

    Each house says by its keys what it is: CHOrD JSON, a house or a room of 3D-FRONT, a house of
    ProcTHOR, a flat of FloorplanTransformation. Raises SceneError where source cannot be opened.
    """
    if source.is_dir():
        for path in sorted(source.glob("*.json")):
            yield _read(path, models)
    elif source.suffix == ".json":
        yield _read(source, models)
    else:
        yield from _lines(source, models)


def _bytes(path: Path) -> bytes:
    refuse_odd_file(path, SceneError)
    try:
        return path.read_bytes()
    except OSError as error:
        raise SceneError(f"cannot be read: {error.strerror}", where=str(path)) from None


def _read(path: Path, models: Models) -> Found:
    return _found(path.stem, _bytes(path), models)


def _lines(path: Path, models: Models) -> Iterator[Found]:
    data = _bytes(path)
    try:
        data = gzip.decompress(data) if path.suffix == ".gz" else data
    except (OSError, EOFError, zlib.error) as error:
        raise SceneError(f"cannot be unpacked: {error}", where=str(path)) from None
    taken: set[str] = set()
    for number, line in enumerate(data.splitlines(), start=1):
        found = _found(f"{path.name.split('.')[0]}_{number:06d}", line, models)
        own = str(found.house.extra.get("source", "")).replace("/", "_") if found.house else ""
        # Houses that call themselves the same are still two.
        name = own if own and own not in taken else found.name
        taken.add(name)
        yield found._replace(name=name)


def _found(name: str, data: bytes, models: Models) -> Found:
    try:
        return Found(name, house_from_record(json.loads(data.decode("utf-8-sig")), models))
    except ChordError as error:
        return Found(name, None, str(error))
    except (ValueError, RecursionError) as error:
        return Found(name, None, f"no JSON: {error}")


def house_from_record(record: Any, models: Models) -> SceneGraph:
    """One house by its keys. Raises ChordError where it is none of FORMATS or is broken."""
    if not isinstance(record, Mapping):
        raise SceneError("no house", expected=FORMATS)
    keys = record.keys()
    if keys >= {"scene", "furniture", "mesh"}:
        return house_from_front(record, models.categories)
    if keys >= {"room_type", "floor", "objects"}:
        return room_from_record(record)
    if keys >= {"rooms", "walls", "objects"}:
        return house_from_procthor(record, models.sizes)
    if keys >= {"id", "lines"}:
        plan = flat_from_lines(record["id"], record["lines"])
        return SceneGraph(plan.rooms, plan.openings, (), extra=plan.extra)
    return scene_from_json(record)
