"""Rooms as lists of labelled boxes, as graph pipelines train on and draw them.

ATISS (Paschalidou et al., NeurIPS 2021) keeps a room of 3D-FRONT as a `boxes.npz`
(scripts/preprocess_data.py), and DiffuScene, InstructScene and PhyScene read and draw the same
fields. Metres and radians, y up, of n boxes:

- `class_labels` (n, classes): one of the object types, which `dataset_stats.txt` beside the rooms
  lists, or what comes after them: start, end or empty, which is no box.
- `translations` (n, 3): the middle of a box, from the middle of the floor.
- `sizes` (n, 3): half of its length, height and depth, along its own axes.
- `angles` (n, 1): its turn about y.
- `floor_plan_vertices` (v, 3), `floor_plan_faces` (f, 3): the floor, where 3D-FRONT has it;
  `floor_plan_centroid` (3,) is its middle.
- `scene_type`: "bedroom", "MasterBedroom", "bed".

What a sampler draws has the first four alone, often in a batch of one. In JSON, class_labels may be
words.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from shapely.geometry import MultiPoint

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.design.unsaid import UNSAID
from chord_usd.base.runtime.archives import Archive
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.sent_values import array_in
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import FloatArray, Item, Room, SceneGraph, frozen_array
from chord_usd.workshop.data.threed_front import category_of, item_at, kind_of, outline_of

BOX_KEYS = frozenset(("class_labels", "translations", "sizes", "angles"))
"""By these a record is known as a list of boxes."""

OBJECT_TYPES_FILE = "dataset_stats.txt"
"""JSON; lies beside the folders of the rooms."""

LEFT_OUT = "leftOut"
"""Key of SceneGraph.extra: how many boxes of each label have no category here."""

_ROOM_KEYS = ("floor_plan_vertices", "floor_plan_faces", "floor_plan_centroid", "scene_type")
_NO_BOX = frozenset(("start", "end", "empty"))
_MOST_FILE_BYTES = 64 * 2**20
_MOST_ARRAY_BYTES = 16 * 2**20


def read_object_types(path: Path) -> tuple[str, ...]:
    """Names of the classes in a dataset_stats.txt, in their order. Raises SceneError."""
    refuse_odd_file(path, SceneError)
    try:
        names = parse_json(path.read_bytes(), str(path), SceneError)["object_types"]
        return tuple(str(name) for name in names)
    except (OSError, KeyError, TypeError) as problem:
        raise SceneError(
            f"cannot be read: {problem!r}", where=str(path), expected="ATISS's dataset_stats.txt"
        ) from None


def read_boxes(path: Path) -> dict[str, Any]:
    """The fields of a boxes.npz that say what stands where; nothing in it is unpickled.

    Raises SceneError.
    """
    refuse_odd_file(path, SceneError, _MOST_FILE_BYTES)
    with Archive(path, SceneError) as archive:
        files = {f"{key}.npy": key for key in (*BOX_KEYS, *_ROOM_KEYS)}
        return {
            files[name]: _array(archive.read(name, _MOST_ARRAY_BYTES), f"{path}: {name}")
            for name in archive.names
            if name in files
        }


def _array(data: bytes, where: str) -> npt.NDArray[Any]:
    """An array of numbers or words; its header is believed only as far as there are bytes."""
    try:
        return array_in(data)[0]
    except ValueError as problem:
        raise SceneError(
            f"is no array ({problem})",
            where=where,
            expected="numbers or words, as NumPy saves them",
        ) from None


def room_from_boxes(record: Mapping[str, Any], object_types: Sequence[str] = ()) -> SceneGraph:
    """One room as a scene of its own, around the middle of its floor.

    object_types: names of the first columns of class_labels, where the record has none itself.
    Without a floor, that is the rectangle around the boxes. Raises SceneError where fields do not
    fit each other.
    """
    labels = _labels(record["class_labels"], record.get("object_types", object_types))
    middles, halves = (_rows(record[key], len(labels), 3, key) for key in ("translations", "sizes"))
    angles = _rows(record["angles"], len(labels), 1, "angles")
    kind = str(np.asarray(record.get("scene_type", "")))
    items: list[Item] = []
    left_out = Counter[str]()
    for label, middle, half, angle in zip(labels, middles, halves, angles, strict=True):
        category = category_of(label) if label else None
        if category:
            turn_deg = math.degrees(float(angle[0]))
            items.append(item_at(category, middle, turn_deg, 2.0 * half, "room", len(items)))
        elif label:
            left_out[label] += 1
    outline = _outline(record)
    has_floor = outline is not None
    if outline is None:
        if not items:
            raise SceneError("holds neither a floor nor a piece", expected="boxes in a room")
        corners = np.concatenate([footprint(item.box) for item in items])
        outline = frozen_array(MultiPoint(corners).envelope.exterior.coords[:-1])
    room = Room("room", kind_of(kind), outline, kind)
    unsaid = ["doors", "windows", "home", *([] if has_floor else ["walls"])]
    extra: dict[str, Any] = {UNSAID: unsaid}
    if left_out:
        extra[LEFT_OUT] = dict(sorted(left_out.items()))
    return SceneGraph((room,), (), tuple(items), extra=extra)


def _labels(rows: Any, object_types: Sequence[str]) -> list[str]:
    """The label of each row; "" for what is no box."""
    if isinstance(rows, list) and all(isinstance(row, str) for row in rows):
        return ["" if row.casefold() in _NO_BOX else row for row in rows]
    scores = np.asarray(rows, dtype=np.float64)
    scores = scores.reshape(scores.shape[-2:])
    if not len(object_types) <= scores.shape[1] <= len(object_types) + len(_NO_BOX):
        raise SceneError(
            f"has {scores.shape[1]} classes, and {len(object_types)} names for them",
            where="class_labels", expected="the object_types of the data set",
            try_=f"--models {OBJECT_TYPES_FILE}",
        )  # fmt: skip
    names = [*object_types, *("" for _ in _NO_BOX)]
    return [names[int(row.argmax())] if row.max() > 0.0 else "" for row in scores]


def _rows(values: Any, count: int, width: int, key: str) -> FloatArray:
    """(count, width)"""
    rows: FloatArray = np.asarray(values, dtype=np.float64)
    if rows.size != count * width or not np.isfinite(rows).all():
        raise SceneError(
            f"has the shape {rows.shape}, or holds what is no number",
            where=key,
            expected=f"{count} times {width} numbers",
        )
    return rows.reshape(count, width)


def _outline(record: Mapping[str, Any]) -> FloatArray | None:
    if "floor_plan_vertices" not in record or "floor_plan_faces" not in record:
        return None
    middle = np.asarray(record.get("floor_plan_centroid", (0.0, 0.0, 0.0)), dtype=np.float64)
    corners = np.reshape(np.asarray(record["floor_plan_vertices"], np.float64), (-1, 3)) - middle
    faces = np.reshape(np.asarray(record["floor_plan_faces"], np.int64), (-1, 3))
    return outline_of(corners[faces])
