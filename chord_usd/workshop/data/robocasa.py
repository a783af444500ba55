"""RoboCasa's kitchen layouts (Nasiriany et al., RSS 2024; RoboCasa365) as scene graphs.

A layout is YAML: groups of fixtures, each a box with a size and a middle, or laid out beside a
fixture before it. Metres, z up, the back wall at y = 0; fixtures face -y, as ours do, and a
group is turned and moved as a whole. Sizes that are left to a model are those of the registry's
default (fixture_registry), or the usual ones. Layouts have walls and windows, and no doors.

A counter has its fronts below: it becomes base units between its sink, its
stovetop and its ends. Clutter, bar stools and what hangs on walls are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from shapely import Polygon, box, unary_union
from shapely.geometry.polygon import orient

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.design.unsaid import UNSAID
from chord_usd.base.scene.geometry import refuse_unreachable
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Item,
    Opening,
    Room,
    SceneGraph,
    frozen_array,
)

_FRIDGE = (0.85, 0.80, 1.78)
_SIZES: Mapping[str, tuple[float, float, float]] = {
    "stove": (0.76, 0.66, 0.915), "stove_wide": (0.91, 0.70, 0.915),
    "stovetop": (0.76, 0.55, 0.05), "sink": (0.75, 0.53, 0.25), "oven": (0.76, 0.60, 0.70),
    "dishwasher": (0.65, 0.60, 0.89), "microwave": (0.60, 0.45, 0.36), "hood": (0.76, 0.50, 0.60),
    "fridge_french_door": _FRIDGE, "fridge_side_by_side": (0.85, 0.80, 1.75),
    "fridge_bottom_freezer": (0.78, 0.80, 1.75), "window": (1.0, 0.10, 1.2),
}  # fmt: skip
"""Of fixtures that are models."""
_FRIDGES = tuple(name for name in _SIZES if name.startswith("fridge"))
_NO_FIXTURES = ("wall", "floor", "wall_accessory", "window", "stool")
_UNIT_M = 0.6
"""Base units that are wider have two doors."""
_LEAST_M = 0.14
"""Narrower rests of a counter are filled up by no unit."""
_TABLE_M = 0.8
"""Counters below it are tables."""
_TALL_M = 1.2
"""Stacks of cabinets that are higher carry no worktop."""
_FLOOR_M = 0.3
"""What begins above this hangs on a wall."""
_SLACK_M = 0.015 + 0.02
"""Of a counter's depth, doors below its edge; of its length, the rim about a sink."""
_SEAM_M = 0.1
"""Floors up to twice so far apart are one."""
_AXES = (("left", "right"), ("front", "back"), ("bottom", "top"))


@dataclass
class _Fixture:
    """A box in the frame of its group."""

    kind: str
    at: FloatArray
    """(3,) its middle."""
    size: FloatArray
    """(3,)"""
    turn: float = 0.0
    """Radians, beside its group's."""
    inner: str = ""
    """The fixture in it."""


def is_robocasa(record: Any) -> bool:
    """Whether parsed YAML looks like a layout: its room has walls and a floor."""
    room = record.get("room") if isinstance(record, Mapping) else None
    return isinstance(room, Mapping) and {"walls", "floor"} <= room.keys()


def kitchen_from_robocasa(record: Mapping[str, Any]) -> SceneGraph:
    """A kitchen. Raises SceneError where a fixture is laid out beside none that is known."""
    try:
        room = Room("kitchen", "kitchen", _floor(record["room"]), "kitchen")
        every = {name: dict(_fixtures(group)) for name, group in record.items()}
        items: list[Item] = []
        for name, fixtures in every.items():
            place = _Place.of(record[name])
            for fixture in fixtures.values():
                for category, at, size in _pieces(fixture, fixtures):
                    box_ = place.box(at, size, fixture.turn)
                    items.append(Item(f"kitchen/{category}_{len(items)}", category, box_, room.id))
        windows = [_window(entry, record["room"]) for entry in _windows(record)]
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise SceneError(f"no kitchen of RoboCasa: {error!r}") from None
    openings = tuple(
        Opening(f"window{number}", "window", hole, (room.id,))
        for number, hole in enumerate(windows, 1)
    )
    return SceneGraph((room,), openings, tuple(items), extra={UNSAID: ["doors", "home"]})


def _floor(room: Mapping[str, Any]) -> FloatArray:
    """Its floors together; sizes are half extents."""
    parts = []
    for entry in room["floor"]:
        if entry.get("backing") or entry["type"] != "floor":
            continue
        (x, y), (wide, deep) = entry["pos"][:2], entry["size"][:2]
        refuse_unreachable((x, y, wide, deep))
        parts.append(box(x - wide, y - deep, x + wide, y + deep))
    area = unary_union([part.buffer(_SEAM_M, join_style="mitre") for part in parts])
    whole = max(getattr(area, "geoms", [area]), key=lambda part: part.area)
    face = Polygon(whole.buffer(-_SEAM_M, join_style="mitre").exterior)
    return frozen_array(orient(face).simplify(1e-3).exterior.coords[:-1])


@dataclass(frozen=True)
class _Place:
    """How a group is turned about its origin, then moved."""

    origin: tuple[float, float]
    to: tuple[float, float]
    turn: float

    @classmethod
    def of(cls, group: Mapping[str, Any]) -> _Place:
        """Of a group; one that says nothing stays."""
        origin, to = group.get("group_origin", (0, 0)), group.get("group_pos", (0, 0))
        return cls(tuple(origin), tuple(to), float(group.get("group_z_rot", 0.0)))

    def box(self, at: FloatArray, size: FloatArray, turn: float) -> Box:
        """The box in the room."""
        refuse_unreachable((*at, *size))
        x, y = at[0] - self.origin[0], at[1] - self.origin[1]
        cos, sin = math.cos(self.turn), math.sin(self.turn)
        middle = (cos * x - sin * y + self.to[0], sin * x + cos * y + self.to[1])
        yaw_deg = round(math.degrees(self.turn + turn), 1)
        return Box(
            (*middle, float(at[2] - size[2] / 2)),
            (float(size[0]), float(size[1]), float(size[2])),
            (yaw_deg + 180.0) % 360.0 - 180.0,
        )


def _fixtures(group: Mapping[str, Any]) -> Iterator[tuple[str, _Fixture]]:
    """The boxes of a group by name, in its order."""
    known: dict[str, _Fixture] = {}
    for entries in group.values():
        if not isinstance(entries, list) or not all(
            isinstance(entry, Mapping) for entry in entries
        ):
            continue
        for entry in entries:
            if entry["type"] in _NO_FIXTURES:
                continue
            if entry.get("enable", True) and "placement" not in entry:
                known[entry["name"]] = _fixture(entry, known)
    yield from known.items()


def _fixture(entry: Mapping[str, Any], known: Mapping[str, _Fixture]) -> _Fixture:
    kind = entry["type"]
    size = _size(entry, known)
    turn = float(entry.get("z_rot", 0.0) or 0.0)
    fixture = _Fixture(kind, np.zeros(3), size, turn, entry.get("interior_obj", ""))
    if "align_to" in entry:
        fixture.at = _beside(entry, size, known[entry["align_to"]])
    elif entry.get("pos") is not None:
        middle = [np.nan if value is None else value for value in entry["pos"]]
        fixture.at = np.array([*middle, np.nan][:3], dtype=np.float64)
        if np.isnan(fixture.at[2]):  # on the floor
            fixture.at[2] = size[2] / 2
        fixture.at = np.nan_to_num(fixture.at)
    if fixture.inner and kind == "counter":
        _lay_in(known[fixture.inner], fixture, entry)
    elif fixture.inner:
        _house(known[fixture.inner], fixture, entry)
    return fixture


def _size(entry: Mapping[str, Any], known: Mapping[str, _Fixture]) -> FloatArray:
    """(3,) Where a size is named after another fixture, that one's along the axis."""
    usual = np.array(_SIZES.get(entry["type"], (0.6, 0.6, 0.9)))
    given = entry.get("size") or [None] * 3
    inner = known.get(entry.get("interior_obj", ""))
    if entry["type"] == "housing_cabinet" and inner is not None:
        usual = inner.size + np.array([(low or 0) + (high or 0) for low, high in _pads(entry)])
    scales = [value / usual[axis] for axis, value in enumerate(given) if _is_number(value)]
    if entry["type"] in _SIZES and scales:  # a model keeps its shape
        usual = usual * (sum(scales) / len(scales))
    size = [
        float(usual[axis]) if value is None
        else float(known[value].size[axis]) if isinstance(value, str) else float(value)
        for axis, value in enumerate(given)
    ]  # fmt: skip
    if entry.get("stack_height") is not None:
        size[2] = entry["stack_height"] - sum(known[n].size[2] for n in entry["stack_fixtures"])
    return np.array(size)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and value > 0


def _pads(entry: Mapping[str, Any]) -> list[tuple[float | None, float | None]]:
    """Along each axis, before and behind what a cabinet houses; None where nothing is said."""
    return [tuple(pad) if pad else (None, None) for pad in entry.get("padding") or [None] * 3]


def _beside(entry: Mapping[str, Any], size: FloatArray, other: _Fixture) -> FloatArray:
    """The middle of a box flush with a side of another (scene_utils.get_relative_position)."""
    side, alignment = entry["side"].lower(), entry.get("alignment", "center").lower()
    at = other.at.copy()
    for axis, (low, high) in enumerate(_AXES):
        if side in (low, high):
            at[axis] += (1 if side == high else -1) * (other.size[axis] + size[axis]) / 2
        elif low in alignment:
            at[axis] += (size[axis] - other.size[axis]) / 2
        elif high in alignment:
            at[axis] -= (size[axis] - other.size[axis]) / 2
    return at + np.array(entry.get("offset", (0.0, 0.0, 0.0)), dtype=np.float64)


def _lay_in(inner: _Fixture, counter: _Fixture, entry: Mapping[str, Any]) -> None:
    """A sink or stovetop in the worktop, so far along it (counter._place_interior_obj)."""
    room = counter.size[0] - inner.size[0] - _SLACK_M
    along = (float(entry.get("obj_x_percent", 0.5)) - 0.5) * counter.size[0]
    inner.at = counter.at.copy()
    inner.at[0] += float(np.clip(along, -max(room, 0.0) / 2, max(room, 0.0) / 2))


def _house(inner: _Fixture, cabinet: _Fixture, entry: Mapping[str, Any]) -> None:
    """A refrigerator or oven in the cabinet around it (cabinets.HousingCabinet)."""
    rest = cabinet.size - inner.size
    for axis, (low, high) in enumerate(_pads(entry)):
        before = rest[axis] / 2 if low is None and high is None else low
        before = rest[axis] - (high or 0.0) if before is None else before
        inner.at[axis] = cabinet.at[axis] + before - rest[axis] / 2


def _pieces(
    fixture: _Fixture, fixtures: Mapping[str, _Fixture]
) -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """What a fixture is in our categories: (category, middle, size) each."""
    kind, base = fixture.kind, fixture.at[2] - fixture.size[2] / 2
    if kind in _FRIDGES:
        yield "refrigerator", fixture.at, fixture.size
    elif kind in ("stove", "stove_wide"):
        yield "cooker_cabinet", fixture.at, fixture.size
    elif kind == "counter" and fixture.size[2] + base < _TABLE_M:
        yield "dining_table", fixture.at, fixture.size
    elif kind == "counter":
        yield from _units(fixture, fixtures)
    elif base < _FLOOR_M and _is_tall_unit(fixture, fixtures):
        yield "electrical_floor_cabinet", fixture.at, fixture.size


def _is_tall_unit(fixture: _Fixture, fixtures: Mapping[str, _Fixture]) -> bool:
    """Whether a fixture on the floor is a separate unit, which no worktop covers."""
    if fixture.kind == "housing_cabinet":
        return not _holds_fridge(fixture, fixtures)
    if fixture.kind == "oven":
        return not _is_built_in(fixture, fixtures)
    return fixture.kind == "stack" and fixture.size[2] > _TALL_M


def _holds_fridge(fixture: _Fixture, fixtures: Mapping[str, _Fixture]) -> bool:
    return fixtures[fixture.inner].kind in _FRIDGES if fixture.inner in fixtures else False


def _is_built_in(fixture: _Fixture, fixtures: Mapping[str, _Fixture]) -> bool:
    """Whether a cabinet houses it, or a worktop passes over it."""
    return any(
        fixtures.get(other.inner) is fixture
        or (other.kind == "counter"
            and (np.abs(other.at - fixture.at)[:2] < other.size[:2] / 2).all())
        for other in fixtures.values()
    )  # fmt: skip


def _units(
    counter: _Fixture, fixtures: Mapping[str, _Fixture]
) -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """The base units of a counter, from left to right."""
    half = counter.size[0] / 2
    left, right = counter.at[0] - half, counter.at[0] + half
    inner = fixtures.get(counter.inner)
    if inner is None:
        spans = [("", left, right)]
    else:
        low = max(left, inner.at[0] - inner.size[0] / 2 - _SLACK_M / 2)
        high = min(right, inner.at[0] + inner.size[0] / 2 + _SLACK_M / 2)
        name = "sink_cabinet" if inner.kind == "sink" else "cooker_cabinet"
        spans = [("", left, low), (name, low, high), ("", high, right)]
    tall = counter.at[2] + counter.size[2] / 2
    for name, low, high in spans:
        count = 1 if name else max(1, round((high - low) / _UNIT_M))
        wide = (high - low) / count
        if wide < _LEAST_M:
            continue
        side = "double" if wide > _UNIT_M else "single"
        for number in range(count):
            at = np.array([low + (number + 0.5) * wide, counter.at[1], tall / 2])
            size = np.array([wide, counter.size[1], tall])
            yield name or f"{side}_door_floor_cabinet", at, size


def _windows(record: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    for group in record.values():
        for entries in group.values():
            if isinstance(entries, list):
                yield from (e for e in entries if isinstance(e, Mapping) and e["type"] == "window")


def _window(entry: Mapping[str, Any], room: Mapping[str, Any]) -> Box:
    """In the wall that it hangs on; its place along that wall is in the room's axes."""
    wall = next(wall for wall in room["walls"] if wall["name"] == entry["attach_to"])
    side = wall.get("wall_side", "back")
    half = WALL_THICKNESS_M / 2
    out = {"back": (0, half), "front": (0, -half), "left": (-half, 0), "right": (half, 0)}[side]
    x, y = (
        float(given if given is not None else of) + shift
        for given, of, shift in zip(entry["pos"][:2], wall["pos"][:2], out, strict=True)
    )
    if side in ("back", "front"):
        y = float(wall["pos"][1]) + out[1]
    else:
        x = float(wall["pos"][0]) + out[0]
    usual = _SIZES["window"]
    wide, tall = (
        float(given) if given is not None else fallback
        for given, fallback in zip((entry["size"][0], entry["size"][2]), usual[::2], strict=True)
    )
    z = float(entry["pos"][2] if entry["pos"][2] is not None else 1.5)
    refuse_unreachable((x, y, z, wide, tall))
    yaw_deg = 0.0 if side in ("back", "front") else 90.0
    return Box((x, y, max(0.0, z - tall / 2)), (wide, WALL_THICKNESS_M, tall), yaw_deg)
