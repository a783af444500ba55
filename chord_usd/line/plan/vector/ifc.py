"""IFC: IfcSpace, IfcWall, IfcDoor, IfcWindow of each storey; geometry comes in metres."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.stair_places import StairShape
from chord_usd.base.scene.storeys import IFC_FORMS
from chord_usd.base.scene.types import FloatArray, OpeningKind
from chord_usd.line.plan.vector.shapes import OpeningShape, RoomShape, VectorDrawing

_LARGEST_BYTES = 512 * 2**20
_DEEPEST_AGGREGATE = 50
"""Nothing stops a file from saying that a storey is part of a wall in it."""
_LEAST_RUN_M = 0.5
"""Between the middles of the lowest and the highest steps, which shows the direction up."""

_LEAST_DOORWAY_M = (0.5, 1.85)
"""Width and height from which a hole without a leaf is a passage."""


def read_ifc(path: Path) -> list[VectorDrawing]:
    """One drawing per storey that has spaces or walls. Raises PlanError, MissingExtraError."""
    model = _open(path)
    by_storey: dict[str, list[Any]] = defaultdict(list)
    for kind in ("IfcSpace", "IfcWall", "IfcDoor", "IfcWindow", "IfcOpeningElement", "IfcStair"):
        for element in model.by_type(kind):
            by_storey[_storey(element)].append(element)
    heights = {
        storey.Name or storey.GlobalId: float(storey.Elevation or 0.0)
        for storey in model.by_type("IfcBuildingStorey")
    }
    drawings = [
        replace(drawing, elevation=heights.get(name, 0.0))
        for name, elements in by_storey.items()
        if (drawing := _drawing(name, elements)).rooms or drawing.walls
    ]
    if not drawings:
        raise PlanError(
            "holds neither spaces nor walls", where=str(path),
            expected="an IFC model with IfcSpace, or with IfcWall round its rooms",
        )  # fmt: skip
    return drawings


def _open(path: Path) -> Any:
    with needed_for("reading this format"):
        import ifcopenshell
    with path.open("rb") as file:
        head = file.read(512)
    if b"ISO-10303-21" not in head or path.stat().st_size > _LARGEST_BYTES:
        raise PlanError(
            "is not an IFC file", where=str(path),
            expected=f"IFC-SPF text of at most {_LARGEST_BYTES // 2**20} MiB",
        )  # fmt: skip
    try:
        return ifcopenshell.open(str(path))
    except Exception as error:
        # The library raises what its parser in C++ does: there is no common class.
        raise PlanError(f"is a damaged IFC file ({error})", where=str(path)) from error


def _storey(element: Any) -> str:
    import ifcopenshell.util.element as relations

    holder = element
    if element.is_a("IfcOpeningElement") and element.VoidsElements:
        holder = element.VoidsElements[0].RelatingBuildingElement
    container = relations.get_container(holder) or relations.get_aggregate(holder)
    for _ in range(_DEEPEST_AGGREGATE):
        if container is None or container.is_a("IfcBuildingStorey"):
            break
        container = relations.get_aggregate(container)
    return (container.Name or container.GlobalId) if container is not None else ""


def _drawing(name: str, elements: list[Any]) -> VectorDrawing:
    rooms: list[RoomShape] = []
    walls: list[Polygon] = []
    floor_m = 0.0
    # What fills a hole is as large as the hole, and often drawn to the last screw.
    drawn = (element for element in elements if not getattr(element, "FillsVoids", ()))
    meshes = {element.id(): _triangles(element) for element in drawn}
    for element in elements:
        triangles = meshes.get(element.id())
        if triangles is None or not (element.is_a("IfcSpace") or element.is_a("IfcWall")):
            continue
        floor_m = float(triangles[..., 2].min()) if not (rooms or walls) else floor_m
        parts = polygons_of(_shadow(triangles))
        if element.is_a("IfcSpace") and parts:
            largest = max(parts, key=lambda part: part.area)
            rooms.append(RoomShape(largest, element.LongName or element.Name or ""))
        else:
            walls += parts
    openings = list(_openings(elements, meshes, floor_m))
    stairs = [
        stair
        for element in elements
        if element.is_a("IfcStair") and (stair := _stair(element, meshes))
    ]
    return VectorDrawing(rooms, walls, openings, stairs=stairs, m_per_unit=1.0, name=name)


def _stair(element: Any, meshes: dict[int, FloatArray | None]) -> StairShape | None:
    """A stair by its own body, or by the bodies of its flights and landings."""
    import ifcopenshell.util.element as relations

    parts = [meshes.get(element.id())]
    parts += [
        _triangles(part)
        for part in relations.get_parts(element)
        if part.is_a("IfcStairFlight") or part.is_a("IfcSlab")
    ]
    bodies = [part for part in parts if part is not None and len(part)]
    shadow = polygons_of(_shadow(np.concatenate(bodies))) if bodies else []
    if not shadow:
        return None
    points = np.concatenate(bodies).reshape(-1, 3)
    low, high = points[:, 2].min(), points[:, 2].max()
    foot, top = (points[np.abs(points[:, 2] - z) < 0.2 * (high - low), :2].mean(axis=0)
                 for z in (low, high))  # fmt: skip
    rise = float(np.hypot(*(top - foot)))
    area = max(shadow, key=lambda part: part.area)
    up = (top - foot) / rise if rise > _LEAST_RUN_M else None
    said = getattr(element, "PredefinedType", None) or getattr(element, "ShapeType", None)
    forms = tuple(form for form, word in IFC_FORMS.items() if word == said)
    return StairShape(area, up, (foot, top), forms)


def _triangles(element: Any) -> FloatArray | None:
    """(N, 3, 3) the element's triangles in the world, metres; None if it has no body."""
    import ifcopenshell.geom

    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    try:
        shape: Any = ifcopenshell.geom.create_shape(settings, element)
    except RuntimeError:
        return None
    vertices = np.array(shape.geometry.verts).reshape(-1, 3)
    return vertices[np.array(shape.geometry.faces).reshape(-1, 3)]


def _shadow(triangles: FloatArray) -> BaseGeometry:
    """What the element covers seen from above. Lintels close the holes in walls."""
    flat = [Polygon(triangle[:, :2]) for triangle in triangles]
    area = unary_union([part.buffer(1e-5, join_style="mitre") for part in flat if part.area > 1e-6])
    return area.buffer(-1e-5, join_style="mitre").simplify(1e-4)


def _openings(
    elements: list[Any], meshes: dict[int, FloatArray | None], floor_m: float
) -> Iterator[OpeningShape]:
    """Doors and windows as large as the holes they fill, and holes that nothing fills."""
    for element in elements:
        kind: OpeningKind
        if element.is_a("IfcDoor") or element.is_a("IfcWindow"):
            kind = "door" if element.is_a("IfcDoor") else "window"
            hole = element.FillsVoids[0].RelatingOpeningElement if element.FillsVoids else element
            triangles = meshes.get(hole.id())
            triangles = _triangles(hole) if triangles is None else triangles
            # The body of an open door is as deep as its leaf is wide: only its hole is straight.
            if triangles is not None:
                yield _opening(kind, triangles, floor_m, element.OverallWidth is not None)
        elif element.is_a("IfcOpeningElement") and not element.HasFillings:
            triangles = meshes.get(element.id())
            if triangles is None:
                continue
            passage = _opening("passage", triangles, floor_m, True)
            width = float(np.hypot(*(passage.stop - passage.start)))
            if width > _LEAST_DOORWAY_M[0] and (passage.height or 0.0) > _LEAST_DOORWAY_M[1]:
                yield passage


def _opening(
    kind: OpeningKind, triangles: FloatArray, floor_m: float, is_sized: bool
) -> OpeningShape:
    box = _shadow(triangles).minimum_rotated_rectangle
    corners = np.array(box.exterior.coords[:4])
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    first = int(np.argmax(lengths[:2]))
    middle, half = corners.mean(axis=0), edges[first] / 2
    low, high = float(triangles[..., 2].min()), float(triangles[..., 2].max())
    base = max(0.0, low - floor_m)
    return OpeningShape(
        kind, middle - half, middle + half,
        depth=float(lengths[1 - first]) if is_sized else None,
        base=0.0 if kind != "window" and base < 0.3 else base, height=high - low,
    )  # fmt: skip
