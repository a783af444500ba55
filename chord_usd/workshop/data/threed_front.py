"""3D-FRONT (Fu et al., ICCV 2021): whole houses, and single rooms as respace keeps them.

3D-FRONT is metres, y up, and the front of a model faces +z; ours is z up and faces -y. So
(x, y, z) becomes (x, -z, y), and a turn about its y axis is our yaw. Its terms forbid commercial
use: read it to measure and to train for oneself, ship nothing made from it.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from shapely import Polygon, unary_union
from shapely.geometry.polygon import orient

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.design.unsaid import UNSAID
from chord_usd.base.runtime.json_lines import read_lines
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.scene.geometry import refuse_unreachable
from chord_usd.base.scene.limits import MOST_FLOOR_TRIANGLES, MOST_ROOMS
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import (
    Box,
    FloatArray,
    Item,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)

_LABELS = Path(__file__).with_name("threed_front_labels.tsv")

_KINDS: tuple[tuple[str, RoomKind], ...] = (
    ("living", "living"), ("bed", "bedroom"), ("elderly", "bedroom"), ("nanny", "bedroom"),
    ("kids", "bedroom"), ("dining", "dining"), ("kitchen", "kitchen"), ("bathroom", "bathroom"),
    ("balcony", "balcony"), ("terrace", "balcony"), ("hallway", "corridor"), ("aisle", "corridor"),
    ("corridor", "corridor"), ("library", "study"), ("study", "study"), ("storage", "store"),
    ("cloak", "store"), ("laundry", "store"),
)  # fmt: skip
"""Parts of 3D-FRONT's room types as our kinds, the first that fits."""

_LEAST_FLOOR_M2 = 0.5


@cache
def labels_by_name() -> dict[str, str]:
    """Our categories by 3D-FRONT's labels, folded; "" for what has no place in ours."""
    with _LABELS.open(encoding="utf-8", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    rows = csv.reader(lines, delimiter="\t", quoting=csv.QUOTE_NONE)
    return {_folded(label): category.strip("-") for label, category, _ in rows}


def _folded(label: str) -> str:
    return re.sub(r"[\s_]*(/)[\s_]*|[\s_]+", r"\1 ", label.strip().casefold())


def category_of(label: str) -> str | None:
    """Our category of one of 3D-FRONT's labels, or of ATISS's short names for them; None for what
    has no place in ours."""
    return labels_by_name().get(_folded(label)) or None


def kind_of(room_type: str) -> RoomKind:
    """Our kind of one of 3D-FRONT's room types."""
    lowered = room_type.casefold()
    return next((kind for part, kind in _KINDS if part in lowered), "unknown")


# --- houses ----------------------------------------------------------------------------------


def read_models(path: Path) -> dict[str, str]:
    """3D-FUTURE's model_info.json: the category of every model. Raises SceneError."""
    try:
        records = parse_json(path.read_bytes(), str(path), SceneError)
        return {record["model_id"]: record["category"] or "" for record in records}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SceneError(
            f"cannot be read: {error!r}", where=str(path), expected="3D-FUTURE's model_info.json"
        ) from None


def house_from_front(record: Mapping[str, Any], models: Mapping[str, str]) -> SceneGraph:
    """A house of 3D-FRONT: rooms from their floor meshes, furniture by the remap table.

    models: category by model id, where the house does not say it itself. Sizes are the
    models' sizes times the scale they stand in. Doors and windows are not read: 3D-FRONT keeps
    them as loose meshes. Raises SceneError where a key is missing or no room has a floor.
    """
    try:
        furniture = {f["uid"]: f for f in record["furniture"] if f.get("valid", True)}
        floors = {m["uid"]: m for m in record["mesh"] if "floor" in m["type"].casefold()}
        _refuse_crowded(record["scene"]["room"], floors)
        rooms: list[Room] = []
        items: list[Item] = []
        for entry in record["scene"]["room"]:
            polygon = _floor([floors[c["ref"]] for c in entry["children"] if c["ref"] in floors])
            if polygon is None:
                continue
            room = Room(str(entry["instanceid"]), kind_of(entry["type"]), polygon, entry["type"])
            rooms.append(room)
            for child in entry["children"]:
                item = _placed(child, furniture.get(child["ref"]), models, room.id, len(items))
                if item:
                    items.append(item)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise SceneError(f"no house of 3D-FRONT: {error!r}") from None
    if not rooms:
        raise SceneError("no room has a floor", expected="a house of 3D-FRONT")
    extra = {"source": str(record.get("uid", "")), UNSAID: ["doors", "windows"]}
    return SceneGraph(tuple(rooms), (), tuple(items), extra=extra)


def _refuse_crowded(rooms: Sequence[Mapping[str, Any]], floors: Mapping[str, Any]) -> None:
    """Refuse what would take minutes, before any floor is joined: a mesh can be named often."""
    if len(rooms) > MOST_ROOMS:
        raise SceneError(f"has {len(rooms):,} rooms", expected=f"at most {MOST_ROOMS:,}")
    sizes = {uid: len(mesh["faces"]) // 3 for uid, mesh in floors.items()}
    triangles = sum(sizes.get(child["ref"], 0) for room in rooms for child in room["children"])
    if triangles > MOST_FLOOR_TRIANGLES:
        raise SceneError(
            f"its floors have {triangles:,} triangles", expected=f"at most {MOST_FLOOR_TRIANGLES:,}"
        )


def _floor(meshes: Sequence[Mapping[str, Any]]) -> FloatArray | None:
    """The outline of a room's floor meshes, metres; None where there is none worth the name."""
    triangles = []
    for mesh in meshes:
        corners = np.reshape(np.array(mesh["xyz"], dtype=np.float64), (-1, 3))
        triangles += list(corners[np.reshape(np.array(mesh["faces"], dtype=np.int64), (-1, 3))])
    return outline_of(triangles)


def outline_of(triangles: Iterable[FloatArray]) -> FloatArray | None:
    """(N, 2) the outline of a floor, metres, our axes; None where there is none worth the name.

    triangles: (3, 3) corners each, in 3D-FRONT's axes; at most MOST_FLOOR_TRIANGLES. Raises
    SceneError.
    """
    triangles = list(islice(triangles, MOST_FLOOR_TRIANGLES + 1))
    if len(triangles) > MOST_FLOOR_TRIANGLES:
        raise SceneError(
            "a floor has too many triangles", expected=f"at most {MOST_FLOOR_TRIANGLES:,}"
        )
    refuse_unreachable(triangles)
    shapes = [Polygon(corners[:, [0, 2]] * (1.0, -1.0)) for corners in triangles]
    # Meshes of one floor meet in tiny slits.
    area = unary_union([t.buffer(1e-4, join_style="mitre") for t in shapes if t.area > 1e-6])
    parts = sorted(getattr(area, "geoms", [area]), key=lambda part: -part.area)
    if not parts or parts[0].area < _LEAST_FLOOR_M2:
        return None
    outline = orient(Polygon(parts[0].exterior)).simplify(0.01)
    return frozen_array(outline.exterior.coords[:-1])


def _placed(
    child: Mapping[str, Any],
    model: Mapping[str, Any] | None,
    models: Mapping[str, str],
    room_id: str,
    number: int,
) -> Item | None:
    if model is None:
        return None
    category = category_of(models.get(model["jid"]) or model.get("category") or "")
    size = model.get("size") or model.get("bbox")
    if category is None or not size:
        return None
    scaled = [float(s) * float(k) for s, k in zip(size, child["scale"], strict=True)]
    return _item(category, child["pos"], child["rot"], scaled, room_id, number)


# --- rooms -----------------------------------------------------------------------------------


def read_rooms(path: Path) -> Iterator[SceneGraph]:
    """Rooms of a JSON lines file, gzipped: {room_type, id, floor, objects} each.

    floor lists (x, z), objects {pos, rot, size, category}. Each room is a scene of its own.
    Raises SceneError naming the line that is none.
    """
    for number, line in read_lines(path, SceneError):
        where = f"{path} line {number}"
        yield room_from_record(parse_json(line, where, SceneError), where)


def room_from_record(record: Mapping[str, Any], where: str = "") -> SceneGraph:
    """One room as a scene of its own; see read_rooms. Raises SceneError naming where."""
    try:
        corners = [(x, -z) for x, z in record["floor"]]
        refuse_unreachable(corners)
        outline = orient(Polygon(corners))
        kind = kind_of(record["room_type"])
        room = Room("room", kind, frozen_array(outline.exterior.coords[:-1]), record["room_type"])
        items = [
            _item(category, entry["pos"], entry["rot"], entry["size"], room.id, number)
            for number, entry in enumerate(record["objects"])
            if (category := category_of(entry["category"])) is not None
        ]
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise SceneError(f"no room of 3D-FRONT: {error!r}", where=where) from None
    extra = {"source": record.get("id", ""), UNSAID: ["doors", "windows", "home"]}
    return SceneGraph((room,), (), tuple(items), extra=extra)


def _item(
    category: str,
    pos: Sequence[float],
    rot: Sequence[float],
    size: Sequence[float],
    room_id: str,
    number: int,
) -> Item:
    """pos: middle of the underside; rot: quaternion, real part last; size: along x, y and z."""
    turn_deg = math.degrees(2.0 * math.atan2(float(rot[1]), float(rot[3])))
    return item_at(category, pos, turn_deg, size, room_id, number)


def item_at(
    category: str,
    pos: Sequence[float],
    turn_deg: float,
    size: Sequence[float],
    room_id: str,
    number: int,
) -> Item:
    """A piece of this package where 3D-FRONT has one.

    pos: x, y, z of its middle, of which y does not matter: ours stand where their category does.
    turn_deg: about y; size: along its own x, y and z.
    """
    x, _, z = (float(value) for value in pos)
    length, height, depth = (float(value) for value in size)
    refuse_unreachable((x, z, length, height, depth))
    base = CATEGORIES[category].mount_height_m
    box = Box((x, -z, base), (length, depth, height), (turn_deg + 180.0) % 360.0 - 180.0)
    return Item(f"{room_id}/{category}_{number}", category, box, room_id)
