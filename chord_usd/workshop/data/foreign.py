"""Houses from elsewhere, whatever they are written in; what cannot be read is passed over, with
its reason.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from shapely.errors import ShapelyError

from chord_usd.base.errors import ChordError, SceneError
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_lines import MOST_LINE_BYTES, read_lines
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.yaml_text import parse_yaml
from chord_usd.base.scene.chord_json import scene_from_json, scene_to_json
from chord_usd.base.scene.types import SceneGraph
from chord_usd.workshop.data.box_scenes import (
    BOX_KEYS,
    OBJECT_TYPES_FILE,
    read_boxes,
    read_object_types,
    room_from_boxes,
)
from chord_usd.workshop.data.flats import flat_from_lines
from chord_usd.workshop.data.procthor import Sizes, house_from_procthor, read_asset_sizes
from chord_usd.workshop.data.robocasa import is_robocasa, kitchen_from_robocasa
from chord_usd.workshop.data.tdw import Size, furnishings, is_tdw, read_model_sizes
from chord_usd.workshop.data.threed_front import house_from_front, read_models, room_from_record

FORMATS = "CHOrD JSON, 3D-FRONT, ATISS, ProcTHOR, RoboCasa, ThreeDWorld or FloorplanTransformation"

_MALFORMED = (
    ArithmeticError, AttributeError, LookupError, TypeError, ValueError, ShapelyError,
)  # fmt: skip
"""What other people's records make of readers that take their form for granted."""

_BOXES = "boxes.npz"
_SCENE = "scene.json"
"""Of each house of a batch, in its own folder (batch.make.SCENE_FILE)."""
_STAGES = (".usda", ".usdc", ".usd", ".usdz")
_YAML = (".yaml", ".yml")
_PATTERNS = ("*.json", "*.npz", "*.yaml", "*.yml", f"*/{_BOXES}")
_LONGEST_NAME = 100
_NOT_IN_NAMES = re.compile(r"[^\w-]+")


@dataclass(frozen=True)
class Models:
    """What 3D-FRONT, ProcTHOR, ATISS and ThreeDWorld keep beside the houses."""

    categories: Mapping[str, str] = field(default_factory=dict)
    """3D-FRONT: category by model id."""
    sizes: Sizes = field(default_factory=dict)
    """ProcTHOR: size by asset id."""
    object_types: tuple[str, ...] = ()
    """ATISS: names of classes in their order."""
    librarian: Mapping[str, tuple[str, Size]] = field(default_factory=dict)
    """ThreeDWorld: category and size by name."""


class Found(NamedTuple):
    """A house, or in words why there is none."""

    name: str
    house: SceneGraph | None
    why: str = ""


def read_models_file(path: Path) -> Models:
    """3D-FUTURE's model_info.json, ProcTHOR's asset-database.json, ATISS's dataset_stats.txt or
    ThreeDWorld's models_core.json.

    Raises SceneError.
    """
    if path.name == OBJECT_TYPES_FILE:
        return Models(object_types=read_object_types(path))
    try:
        refuse_odd_file(path, SceneError)
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise SceneError(f"cannot be read: {error}", where=str(path)) from None
    if '"wcategory"' in text:
        return Models(librarian=_librarian(path, text))
    if text.lstrip().startswith("["):
        return Models(categories=read_models(path))
    return Models(sizes=read_asset_sizes(path))


def _librarian(path: Path, text: str) -> dict[str, tuple[str, Size]]:
    try:
        return read_model_sizes(parse_json(text, str(path), SceneError))
    except _MALFORMED as error:
        raise SceneError(
            f"cannot be read: {error!r:.200}", where=str(path), expected="models_core.json"
        ) from None


def stages_in(source: Path) -> list[tuple[str, Path]]:
    """The stages of a source with their names: itself, a folder's, or those of houses one folder
    below, as batches write them."""
    if source.suffix.lower() in _STAGES:
        stages = [source]
    else:
        here = [path for path in sorted(source.glob("*")) if path.suffix in (".usda", ".usdz")]
        stages = here or sorted(source.glob("*/house.usda")) or sorted(source.glob("*/house.usdz"))
    return [(path.parent.name if path.stem == "house" else path.stem, path) for path in stages]


def foreign_houses(source: Path, models: Models) -> Iterator[Found]:
    """Every house of a folder, a JSON, YAML or .npz file, or a JSON lines file, gzipped or not.

    A folder holds JSON, YAML, .npz, a folder with a boxes.npz for each room, or the houses of a
    batch or release, whose other files are passed over. Each house says by its keys what it is:
    CHOrD JSON, a house or a room of 3D-FRONT, boxes as ATISS keeps them, a house of ProcTHOR, a
    kitchen of RoboCasa, a flat of FloorplanTransformation; a file of ThreeDWorld holds several.
    Raises SceneError where source cannot be opened.
    """
    if source.is_dir():
        is_batch = next(source.glob(f"*/{_SCENE}"), None) is not None
        for pattern in (f"*/{_SCENE}",) if is_batch else _PATTERNS:
            for path in sorted(source.glob(pattern)):
                yield from _read(path, models)
    elif source.suffix in (".json", ".npz", *_YAML):
        yield from _read(source, models)
    else:
        yield from _lines(source, models)


def _read(path: Path, models: Models) -> Iterator[Found]:
    name = path.parent.name if path.name in (_BOXES, _SCENE) else path.stem
    try:
        if path.suffix == ".npz":
            record: Any = read_boxes(path)
        else:
            refuse_odd_file(path, SceneError, MOST_LINE_BYTES)
            read = parse_yaml if path.suffix in _YAML else parse_json
            record = read(path.read_bytes(), "", SceneError)
        if is_tdw(record):
            for inner, house in furnishings(record, models.librarian):
                yield Found(inner, scene_from_json(scene_to_json(house)))
        else:
            yield Found(name, house_from_record(record, models))
    except ChordError as error:
        yield Found(name, None, str(error))
    except _MALFORMED as error:
        yield Found(name, None, f"cannot be understood ({error!r:.200})")


def _lines(path: Path, models: Models) -> Iterator[Found]:
    taken: set[str] = set()
    for number, line in read_lines(path, SceneError):
        record = _converted(f"{path.name.split('.')[0]}_{number:06d}", line, models)
        source = _as_name(str(record.house.extra.get("source", ""))) if record.house else ""
        # Houses that call themselves the same are still two, also where case does not count.
        name = source if source and source.casefold() not in taken else record.name
        taken.add(name.casefold())
        yield record._replace(name=name)


def _as_name(source: str) -> str:
    """What a house calls itself, as the name of a file on any system."""
    return _NOT_IN_NAMES.sub("_", source)[:_LONGEST_NAME]


def _converted(name: str, data: bytes, models: Models) -> Found:
    try:
        return Found(name, house_from_record(parse_json(data, "", SceneError), models))
    except ChordError as error:
        return Found(name, None, str(error))


def house_from_record(record: Any, models: Models) -> SceneGraph:
    """One house by its keys. Raises ChordError where it is none of FORMATS, is broken, or is
    larger than any house (limits.py)."""
    if not isinstance(record, Mapping):
        raise SceneError("no house", expected=FORMATS)
    try:
        foreign = _foreign(record, models)
        # Every verb refuses what the reader of CHOrD JSON does, and with it the whole folder.
        return scene_from_json(record if foreign is None else scene_to_json(foreign))
    except _MALFORMED as error:
        raise SceneError(f"cannot be understood ({error!r:.200})", expected=FORMATS) from error


def _foreign(record: Mapping[str, Any], models: Models) -> SceneGraph | None:
    """A house in another form than CHOrD JSON, None for what may be that."""
    keys = record.keys()
    if is_robocasa(record):
        return kitchen_from_robocasa(record)
    if keys >= {"scene", "furniture", "mesh"}:
        return house_from_front(record, models.categories)
    if keys >= {"room_type", "floor", "objects"}:
        return room_from_record(record)
    if keys >= BOX_KEYS:
        return room_from_boxes(record, models.object_types)
    if keys >= {"rooms", "walls", "objects"}:
        return house_from_procthor(record, models.sizes)
    if keys >= {"id", "lines"}:
        plan = flat_from_lines(record["id"], record["lines"])
        return SceneGraph(plan.rooms, plan.openings, (), extra=plan.extra)
    return None
