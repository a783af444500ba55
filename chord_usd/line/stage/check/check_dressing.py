"""How full rooms are, and how they are dressed: figures of the report that are no faults."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

import shapely
from pxr import Sdf, Usd, UsdShade

from chord_usd.base.metrics.clear_floor import rooms_beside
from chord_usd.base.metrics.rooms import rooms_to_furnish
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.base.scene.types import WET_KINDS, Item, Opening, Room, RoomKind, SceneGraph
from chord_usd.line.stage.author.surfaces import bound_material, coordinates_read
from chord_usd.line.stage.check.check_held import WINDOW_GAP_M
from chord_usd.line.stage.check.check_scene import StageScene


@dataclass(frozen=True)
class Objects:
    """Furniture, tabletop items and dressing; median, least and by_kind are a room, of the rooms
    that nobody leaves empty."""

    total: int
    """Of the whole house."""
    median: float
    least: int
    by_kind: dict[RoomKind, float]
    """Medians."""


@dataclass(frozen=True)
class Dressing:
    """How a house is dressed. Shares of nothing are 0."""

    items: int
    windows_dressed: float
    """Share of the windows of rooms that nobody leaves empty that have a curtain or blind."""
    wet_rooms_with_mirror: float
    """Share of bathrooms, and of other wet rooms with a washbasin."""
    textured_area: float
    """Share of the surface of furniture and dressing whose material has a texture."""


def count_objects(graph: SceneGraph) -> Objects:
    """How many objects the rooms of a house hold."""
    rooms = rooms_to_furnish(graph.rooms)
    counts = [(room.kind, _count(_things(graph, room))) for room in rooms]
    kinds = dict.fromkeys(kind for kind, _ in counts)
    return Objects(
        total=_count((*graph.items, *graph.dressing)),
        median=median([count for _, count in counts] or [0]),
        least=min((count for _, count in counts), default=0),
        by_kind={kind: median([n for of, n in counts if of == kind]) for kind in kinds},
    )


def measure_dressing(stage: Usd.Stage, storeys: Sequence[StageScene]) -> Dressing:
    """Figures of the dressing of a house. Payloads must be loaded."""
    graphs = [scene.graph for scene in storeys]
    dressed = windows = 0
    for graph in graphs:
        hung = [footprint_polygon(item.box) for item in graph.dressing if _is_at_window(item)]
        panes = [footprint_polygon(window.box) for window in _windows(graph)]
        dressed += sum(bool((shapely.distance(hung, pane) <= WINDOW_GAP_M).any()) for pane in panes)
        windows += len(panes)
    mirrored = {item.room_id for graph in graphs for item in graph.dressing
                if item.category == "mirror"}  # fmt: skip
    basins = {item.room_id for graph in graphs for item in graph.items
              if item.category == "washbasin"}  # fmt: skip
    rooms = [room for graph in graphs for room in graph.rooms if room.kind in WET_KINDS]
    wet = [room.id for room in rooms if room.kind == "bathroom" or room.id in basins]
    return Dressing(
        items=sum(len(graph.dressing) for graph in graphs),
        windows_dressed=_share(dressed, windows),
        wet_rooms_with_mirror=_share(sum(room in mirrored for room in wet), len(wet)),
        textured_area=_textured_area(stage, storeys),
    )


def _things(graph: SceneGraph, room: Room) -> list[Item]:
    return [*graph.items_of(room.id), *graph.dressing_of(room.id)]


def _count(items: Iterable[Item]) -> int:
    return sum(1 + _count(item.children) for item in items)


def _windows(graph: SceneGraph) -> list[Opening]:
    lived_in = {room.id for room in rooms_to_furnish(graph.rooms)}
    windows = [opening for opening in graph.openings if opening.kind == "window"]
    beside = zip(windows, rooms_beside(windows, graph.rooms), strict=True)
    return [
        window for window, sides in beside if any(side and side.id in lived_in for side in sides)
    ]


def _is_at_window(item: Item) -> bool:
    row = CATEGORIES.get(item.category)
    return row is not None and row.mount is Mount.WINDOW


def _textured_area(stage: Usd.Stage, storeys: Sequence[StageScene]) -> float:
    """Instances of one mesh are looked at once, and so is a material of many meshes."""
    meshes: dict[Sdf.Path, bool] = {}
    materials: dict[Sdf.Path, bool] = {}
    textured_m2 = all_m2 = 0.0
    bodies = (body for scene in storeys for body in scene.items)
    for solid in (solid for body in bodies for solid in body.solids):
        mesh = stage.GetPrimAtPath(solid.path)
        source = mesh.GetPrimInPrototype() if mesh.IsInstanceProxy() else mesh
        path = source.GetPath()
        if path not in meshes:
            meshes[path] = _is_textured(bound_material(source), materials)
        all_m2 += solid.area_m2
        textured_m2 += solid.area_m2 * meshes[path]
    return _share(textured_m2, all_m2)


def _is_textured(material: UsdShade.Material | None, known: dict[Sdf.Path, bool]) -> bool:
    if material is None:
        return False
    path = material.GetPath()
    if path not in known:
        surface = material.ComputeSurfaceSource()[0]
        known[path] = bool(surface and coordinates_read(surface))
    return known[path]


def _share(part: float, whole: float) -> float:
    return part / whole if whole else 0.0
