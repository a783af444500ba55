"""CHOrD JSON: the paper's listing, read and written, for plans and for scene graphs.

The file holds `rooms`, `windowsDoors` and `furniture`, in centimetres and degrees. Conventions:

- Coordinates are (x, y) with y up. `pos` is the centre of the box in x and y and its underside in
  z; `length` runs along the box's own x, `width` along its own y, `height` along z.
- `rotate` is our yaw as it stands: counter-clockwise, the front towards -y at 0.
- `wallPoints` may run either way round, and may repeat the first point at the end.
- `roomType` 0 is the outline of the house. It is no room: it travels in `extra["outRooms"]`.
- Keys not known here travel in `extra` of their element and are written again.

A scene graph adds `style`, `dressing` (elements as in `furniture`, of categories of the
dressing level), `provenance`, and to elements `id`, `roomId` (`roomIds` for openings), `asset`,
`score`, `rests_on` and `children` (posed in their parent's frame). Where ids or rooms are missing
they are filled in: ids by count, rooms by where things stand. Numbers are written to 1e-6 cm, so
that writing what was read gives the same text again.

read_plan and plan_from_json raise PlanError, read_scene and scene_from_json SceneError; both name
the file, the element and the key.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, get_args

import numpy as np
import shapely
from shapely import LinearRing, Point, Polygon

from chord_usd.base.errors import ChordError, PlanError, SceneError, reason_of
from chord_usd.base.runtime.files import destination, write_atomic
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_text import json_text, parse_json
from chord_usd.base.runtime.locations import portable
from chord_usd.base.scene.geometry import Floors, extent_m, footprint_polygon, rooms_beside
from chord_usd.base.scene.json_categories import (
    read_category,
    read_style,
    refuse_loose_ends,
    spelling,
)
from chord_usd.base.scene.json_elements import Element, Names, shown
from chord_usd.base.scene.json_facts import FACT_KEYS, facts_to_json, read_facts
from chord_usd.base.scene.json_provenance import provenance_to_json, read_provenance
from chord_usd.base.scene.limits import (
    LARGEST_HOUSE_M,
    MOST_CORNERS,
    MOST_CORNERS_IN_ALL,
    MOST_ITEMS,
    MOST_JSON_BYTES,
    MOST_OPENINGS,
    MOST_ROOMS,
)
from chord_usd.base.scene.palette import Level
from chord_usd.base.scene.piles import is_piled
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import (
    ROOM_KINDS,
    WALL_THICKNESS_M,
    WET_KINDS,
    Asset,
    Box,
    FloatArray,
    Item,
    Opening,
    OpeningKind,
    Plan,
    Provenance,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.base.scene.units import cm_from_m, m_from_cm
from chord_usd.base.scene.wet_rooms import with_wet_kinds

OUT_ROOMS = "outRooms"
"""Key of Plan.extra and SceneGraph.extra: the elements of roomType 0, as they stood in the file."""

SMALLEST_ROOM_M2 = 0.01
"""A file with smaller ones is not in centimetres, or broken."""

_DEEPEST_OVERLAP_M = WALL_THICKNESS_M
"""Rooms that lie in each other no deeper than this are sloppy drawing, not an error."""

_CM_DECIMALS = 6

_HOUSE_KEYS = ("rooms", "windowsDoors", "furniture", "dressing", "style", "provenance")
_BOX_KEYS = ("pos", "length", "width", "height", "rotate")
_ROOM_KEYS = ("roomId", "roomName", "roomType", "roomKind", "wallPoints")
_OPENING_KEYS = ("type", *_BOX_KEYS, "id", "roomIds")
_ITEM_KEYS = ("type", *_BOX_KEYS, "id", "roomId", "asset", "score", "children",
              *FACT_KEYS)  # fmt: skip

_OPENING_SYNONYMS: dict[str, OpeningKind] = {
    "opening": "passage", "doorway": "passage", "archway": "passage", "hole": "passage",
    "single_door": "door", "double_door": "door", "sliding_door": "door", "swing_door": "door",
    "entrance_door": "door", "front_door": "door",
    "bay_window": "window", "floor_window": "window", "french_window": "window",
    "floor_to_ceiling_window": "window",
}  # fmt: skip


# Reading -----------------------------------------------------------------------------------------


def read_plan(path: Path) -> Plan:
    """The plan in a CHOrD JSON file; furniture in it is passed over. Raises PlanError."""
    return plan_from_json(_load(path, PlanError), str(path))


def read_scene(path: Path) -> SceneGraph:
    """The scene graph in a CHOrD JSON file. Raises SceneError."""
    return scene_from_json(_load(path, SceneError), str(path))


def plan_from_json(data: object, where: str = "plan") -> Plan:
    """A plan from parsed JSON. where: what error messages call it. Raises PlanError."""
    house = Element(data, where, PlanError)
    floors, openings, extra = _read_shell(house)
    said = [room.text("roomId") for room in house.elements("rooms", "room", MOST_ROOMS)
            if room.has("roomKind")]  # fmt: skip
    return with_wet_kinds(Plan(floors.rooms, openings, extra), said)


def scene_from_json(data: object, where: str = "scene") -> SceneGraph:
    """A scene graph from parsed JSON. where: what error messages call it. Raises SceneError."""
    house = Element(data, where, SceneError)
    floors, openings, extra = _read_shell(house)
    names = Names("furniture", MOST_ITEMS)
    elements = house.elements("furniture", "furniture", MOST_ITEMS)
    items = tuple(_read_item(element, names, floors) for element in elements)
    dressing = _read_dressing(house, names, floors, items)
    if is_piled(items) or is_piled(dressing):
        raise house.error("thousands of pieces stand in one another", "pieces side by side")
    return SceneGraph(
        floors.rooms, openings, items, read_provenance(house), extra, dressing, read_style(house)
    )


def _read_dressing(
    house: Element, names: Names, floors: Floors, items: Sequence[Item]
) -> tuple[Item, ...]:
    if not house.has("dressing"):
        return ()
    elements = house.elements("dressing", "dressing", MOST_ITEMS)
    dressing = tuple(
        _read_item(element, names, floors, level=Level.DRESSING) for element in elements
    )
    refuse_loose_ends(elements, dressing, items)
    return dressing


def _load(path: Path, error: type[ChordError]) -> object:
    refuse_odd_file(path, error, MOST_JSON_BYTES)
    try:
        data = path.read_bytes()
    except OSError as problem:
        raise error(f"cannot be read ({reason_of(problem)})", where=str(path)) from problem
    return parse_json(data, str(path), error)


def _refuse_scan(house: Element) -> None:
    """Raises the error of the file where a phone's scan is taken for a plan."""
    keys = house.keys()
    if "rooms" not in keys and {"walls", "doors", "windows", "objects"} <= keys:
        raise house.error(
            "is a RoomPlan scan of a phone, which is not read", expected="CHOrD JSON",
            try_="export its floor plan as PDF, PNG or DXF",
        )  # fmt: skip


def _read_shell(house: Element) -> tuple[Floors, tuple[Opening, ...], dict[str, Any]]:
    """Rooms, openings and everything else of the file's top level."""
    _refuse_scan(house)
    inner: list[Element] = []
    out_rooms: list[Any] = []
    for element in house.elements("rooms", "room", MOST_ROOMS, name_key="roomId"):
        if element.whole("roomType") == 0:
            out_rooms.append(element.raw())
        else:
            inner.append(element)
    if not inner:
        raise house.error("rooms holds no room", expected="at least one of roomType 1")
    names = Names("room", MOST_ROOMS)
    floors = Floors(_read_room(element, names) for element in inner)
    _refuse_sprawl(floors, house)
    _refuse_overlaps(floors, house)
    names = Names("opening", MOST_OPENINGS)
    elements = house.elements("windowsDoors", "opening", MOST_OPENINGS)
    openings = tuple(_read_opening(element, names, floors) for element in elements)
    extra = house.rest(_HOUSE_KEYS)
    if out_rooms:
        extra[OUT_ROOMS] = out_rooms
    return floors, openings, extra


def _read_room(element: Element, names: Names) -> Room:
    name = element.text("roomName")
    kind = room_kind(name)
    if element.has("roomKind"):
        kind = element.choice("roomKind", ROOM_KINDS)
    extra = element.rest(_ROOM_KEYS)
    if element.whole("roomType") != 1:
        extra["roomType"] = element.whole("roomType")
    room_id = names.take(element, element.text("roomId"))
    polygon = frozen_array(_read_polygon(element))
    return Room(room_id, kind, polygon, "" if name == kind else name, extra)


def _read_polygon(element: Element) -> FloatArray:
    """(N, 2) corners in metres, counter-clockwise, simple and of some area."""
    points = np.array(
        [[m_from_cm(value) for value in point] for point in element.points(MOST_CORNERS)]
    ).reshape(-1, 2)
    keep = np.any(points != np.roll(points, -1, axis=0), axis=1)
    points = points[keep]
    if len(points) < 3:
        raise element.error("wallPoints has fewer than three corners", expected="a polygon")
    polygon = Polygon(points)
    if not polygon.is_valid and LinearRing(points).length > 0:
        corner = _crossing_corner(points)
        if corner is not None:
            raise element.error(
                f"wallPoints cross at corner {corner + 1}",
                expected="a simple polygon",
                try_="put the corners in order round the room",
            )
    if polygon.area < SMALLEST_ROOM_M2 or not polygon.is_valid:
        raise element.error(
            f"the room has an area of {polygon.area:.3g} m2",
            expected=f"wallPoints in centimetres, round at least {SMALLEST_ROOM_M2} m2",
        )
    if not LinearRing(points).is_ccw:
        points = np.roll(points[::-1], 1, axis=0)
    return points


def _crossing_corner(points: FloatArray) -> int | None:
    """The first corner whose wall crosses or touches a wall that is not its neighbour."""
    count = len(points)
    walls = shapely.linestrings(np.stack([points, np.roll(points, -1, axis=0)], axis=1))
    first, second = shapely.STRtree(walls).query(walls, predicate="intersects")
    apart = (second - first) % count
    crossing = first[(apart > 1) & (apart < count - 1)]
    return int(crossing.min()) if len(crossing) else None


def _refuse_sprawl(floors: Floors, house: Element) -> None:
    """Refuse a house that is larger than any, or too finely cut to be one."""
    corners = sum(len(room.polygon_m) for room in floors.rooms)
    if corners > MOST_CORNERS_IN_ALL:
        raise house.error(
            f"the rooms have {corners} corners", expected=f"at most {MOST_CORNERS_IN_ALL} in all"
        )
    across_m = extent_m(floors.rooms)
    if across_m > LARGEST_HOUSE_M:
        raise house.error(
            f"the house is {across_m:.0f} m across",
            expected=f"at most {LARGEST_HOUSE_M:.0f} m, and lengths in centimetres",
        )


def _refuse_overlaps(floors: Floors, house: Element) -> None:
    """Refuse rooms that lie in each other by more than rounding and sloppy drawing explain."""
    for index, polygon in enumerate(floors.polygons):
        for other in floors.near(polygon):
            if other >= index or not polygon.intersects(floors.polygons[other]):
                continue
            shared = polygon.intersection(floors.polygons[other])
            if not shared.buffer(-_DEEPEST_OVERLAP_M / 2).is_empty:
                first, second = floors.rooms[index].id, floors.rooms[other].id
                raise house.error(
                    f"room '{shown(first)}' crosses room '{shown(second)}'",
                    expected="rooms side by side",
                    try_="correct the wallPoints of one of them",
                )


def _read_opening(element: Element, names: Names, floors: Floors) -> Opening:
    kinds = get_args(OpeningKind)
    spelled = spelling(element.text("type"))
    kind = _OPENING_SYNONYMS.get(spelled, spelled)
    if kind not in kinds:
        raise element.error(
            f"unknown type '{shown(element.text('type'))}'", expected=f"one of {', '.join(kinds)}"
        )
    box = read_box(element)
    if element.has("roomIds"):
        room_ids = element.texts("roomIds")
        for room_id in room_ids:
            _known_room(element, room_id, floors)
    else:
        room_ids = rooms_beside(box, floors)
    opening_id = names.take(element, _optional_id(element), default=str(kind))
    return Opening(opening_id, kind, box, room_ids, element.rest(_OPENING_KEYS))  # type: ignore[arg-type]


def _read_item(
    element: Element,
    names: Names,
    floors: Floors,
    parent: Item | None = None,
    level: Level = Level.HOUSE,
) -> Item:
    category = read_category(element, level, is_child=parent is not None)
    box = read_box(element)
    if element.has("roomId"):
        room_id = element.text("roomId")
        if room_id:
            _known_room(element, room_id, floors)
    else:
        room_id = _room_under(box, floors) if parent is None else ""
    item_id = names.take(element, _optional_id(element), default=category)
    score = element.number("score") if element.has("score") else 1.0
    item = Item(item_id, category, box, room_id)
    children: tuple[Item, ...] = ()
    if element.has("children"):
        parts = element.elements("children", "child", MOST_ITEMS)
        children = tuple(_read_item(part, names, floors, item) for part in parts)
    asset = _read_asset(element.element("asset")) if element.has("asset") else None
    facts, extra = read_facts(element, read_box), element.rest(_ITEM_KEYS)
    return Item(item_id, category, box, room_id, asset, children, score, facts, extra)


def read_box(element: Element) -> Box:
    """The box that an element is, in metres."""
    x, y, z = (m_from_cm(value) for value in element.numbers("pos", 3))
    length, width, height = (m_from_cm(element.size(key)) for key in ("length", "width", "height"))
    return Box((x, y, z), (length, width, height), element.angle("rotate"))


def _read_asset(element: Element) -> Asset:
    length, width, height = (m_from_cm(value) for value in element.numbers("size", 3))
    return Asset(
        id=element.text("id"),
        category=element.text("category"),
        size_m=(length, width, height),
        usd_path=element.path("usdPath"),
        licence=element.text("licence") if element.has("licence") else "",
        author=element.text("author") if element.has("author") else "",
        styles=element.texts("styles") if element.has("styles") else (),
    )


def _optional_id(element: Element) -> str | None:
    return element.text("id") if element.has("id") else None


def _known_room(element: Element, room_id: str, floors: Floors) -> None:
    if room_id not in floors.index_of:
        near = get_close_matches(room_id[:100], list(floors.index_of)[:MOST_ROOMS], n=1)
        raise element.error(
            f"room '{shown(room_id)}' does not exist",
            expected="the roomId of a room",
            try_=f"'{shown(near[0])}'" if near else "",
        )


def _room_under(box: Box, floors: Floors) -> str:
    """The room that holds the box's centre, else most of its footprint, else "" for none."""
    center, shape = Point(box.center_m[:2]), footprint_polygon(box)
    for index in floors.near(center):
        if floors.polygons[index].covers(center):
            return floors.rooms[index].id
    shared = {
        floors.rooms[index].id: floors.polygons[index].intersection(shape).area
        for index in floors.near(shape)
    }
    best = max(shared, key=lambda room_id: shared[room_id], default="")
    return best if best and shared[best] > 0 else ""


# Writing -----------------------------------------------------------------------------------------


def write_plan(plan: Plan, path: Path) -> None:
    """Write a plan as CHOrD JSON, whole or not at all. Raises OutputError."""
    write_atomic(path, json_text(plan_to_json(plan)))


def write_scene(graph: SceneGraph, path: Path) -> None:
    """Write a scene graph as CHOrD JSON, whole or not at all. Raises OutputError."""
    write_atomic(path, json_text(portable_scene(graph, path)))


def portable_scene(graph: SceneGraph, path: Path) -> dict[str, Any]:
    """As scene_to_json, for a file at path, without absolute paths."""
    data, home = scene_to_json(graph), destination(path.parent)
    due = [*data["furniture"], *data.get("dressing", ())]
    while due:
        element = due.pop()
        due += element.get("children", ())
        if "asset" in element:
            named = Path(element["asset"]["usdPath"])
            element["asset"]["usdPath"] = portable(named, home).as_posix()
    return data


def plan_to_json(plan: Plan) -> dict[str, Any]:
    """The JSON object of a plan; plan_from_json gives it back."""
    return {**_shell_to_json(plan.rooms, plan.openings, plan.extra), "furniture": []}


def scene_to_json(graph: SceneGraph) -> dict[str, Any]:
    """The JSON object of a scene graph; scene_from_json gives it back."""
    data = _shell_to_json(graph.rooms, graph.openings, graph.extra)
    data["furniture"] = [_item_to_json(item) for item in graph.items]
    if graph.dressing:
        data["dressing"] = [_item_to_json(item) for item in graph.dressing]
    if graph.style:
        data["style"] = graph.style
    if graph.provenance != Provenance():
        data["provenance"] = provenance_to_json(graph.provenance)
    return data


def _shell_to_json(
    rooms: Sequence[Room], openings: Sequence[Opening], extra: Mapping[str, Any]
) -> dict[str, Any]:
    elements = [_room_to_json(room) for room in rooms] + list(extra.get(OUT_ROOMS, ()))
    return {
        "rooms": elements,
        "windowsDoors": [_opening_to_json(opening) for opening in openings],
        **{key: value for key, value in extra.items() if key != OUT_ROOMS},
    }


def _room_to_json(room: Room) -> dict[str, Any]:
    name = room.name or room.kind
    data: dict[str, Any] = {"roomId": room.id, "roomName": name, "roomType": 1}
    # A name that says no more than the class leaves the kind of a wet room open.
    if room.kind in WET_KINDS or room_kind(name) != room.kind:
        data["roomKind"] = room.kind
    data["wallPoints"] = [[_cm(x), _cm(y)] for x, y in room.polygon_m]
    return {**data, **room.extra}


def _opening_to_json(opening: Opening) -> dict[str, Any]:
    return {
        "type": opening.kind,
        **box_to_json(opening.box),
        "id": opening.id,
        "roomIds": list(opening.room_ids),
        **opening.extra,
    }


def _item_to_json(item: Item, *, is_child: bool = False) -> dict[str, Any]:
    data: dict[str, Any] = {"type": item.category, **box_to_json(item.box), "id": item.id}
    if item.room_id or not is_child:
        data["roomId"] = item.room_id
    if item.score != 1.0:
        data["score"] = item.score
    if item.asset is not None:
        data["asset"] = _asset_to_json(item.asset)
    if item.children:
        data["children"] = [_item_to_json(child, is_child=True) for child in item.children]
    return {**data, **facts_to_json(item.facts, box_to_json), **item.extra}


def _asset_to_json(asset: Asset) -> dict[str, Any]:
    return {
        "id": asset.id,
        "category": asset.category,
        "size": [_cm(value) for value in asset.size_m],
        "usdPath": asset.usd_path.as_posix(),
        "licence": asset.licence,
        "author": asset.author,
        **({"styles": list(asset.styles)} if asset.styles else {}),
    }


def box_to_json(box: Box) -> dict[str, Any]:
    """The keys of an element that say its box, in centimetres."""
    length, width, height = (_cm(value) for value in box.size_m)
    return {
        "pos": [_cm(value) for value in box.center_m],
        "length": length,
        "width": width,
        "height": height,
        "rotate": _plain(box.yaw_deg),
    }


def _cm(length_m: float) -> float | int:
    return _plain(cm_from_m(float(length_m)))


def _plain(value: float) -> float | int:
    """The value as it is written: 95, not 95.0 or 95.00000000000001."""
    rounded = round(float(value), _CM_DECIMALS)
    return int(rounded) if rounded.is_integer() else rounded
