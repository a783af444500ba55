"""The shapes of a vector file as a picture, to draw over what was read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.confined import decode
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import ByteArray, PixelFrame, Plan
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.plan.placement import placement
from chord_usd.line.plan.scale_choice import SCALE
from chord_usd.line.plan.vector.formats import read_drawings
from chord_usd.line.plan.vector.shapes import VectorDrawing

_SIDE_PX = 1400
_MARGIN_M = 1.0
_WALL_GREY, _LINE_GREY = 60, 150


def backdrop(path: Path, plan: Plan) -> tuple[ByteArray, Mapping[str, Any]]:
    """(H, W, 3) the walls and room outlines of the file round a plan that was read from it.

    The second value is the entry for Plan.extra that says where this picture lies. The file is
    read in a process of its own. Raises PlanError.
    """
    shown: tuple[ByteArray, Mapping[str, Any]] = decode(
        "backdrop", path, plan, where=str(path), error=PlanError
    )
    return shown


def _backdrop(path: Path, plan: Plan) -> tuple[ByteArray, Mapping[str, Any]]:
    corners = np.concatenate([room.polygon_m for room in plan.rooms])
    low, high = corners.min(axis=0) - _MARGIN_M, corners.max(axis=0) + _MARGIN_M
    m_per_px = float((high - low).max()) / _SIDE_PX
    width, height = (int(np.ceil(side / m_per_px)) for side in high - low)
    frame = PixelFrame(m_per_px, (float(low[0]), float(low[1])), height)
    canvas = np.full((height, width, 3), 255, np.uint8)
    m_per_unit = float(plan.extra.get(SCALE, {}).get("mPerPx", 1.0))
    storey = _storey_of(path, plan, m_per_unit)
    for wall in storey.walls:
        for ring, grey in ((wall.exterior, _WALL_GREY), *((r, 255) for r in wall.interiors)):
            cv2.fillPoly(canvas, [_pixels(ring, m_per_unit, frame)], (grey,) * 3)
    for room in storey.rooms:
        outline = _pixels(room.polygon.exterior, m_per_unit, frame)
        cv2.polylines(canvas, [outline], True, (_LINE_GREY,) * 3, 2)
    return canvas, placement(frame)


def _pixels(ring: Any, m_per_unit: float, frame: PixelFrame) -> np.ndarray:  # type: ignore[type-arg]
    return np.rint(px_from_m(np.array(ring.coords) * m_per_unit, frame)).astype(np.int32)


def _storey_of(path: Path, plan: Plan, m_per_unit: float) -> VectorDrawing:
    """The storey of the file that the plan was read from: the one that covers its rooms best."""
    floors = [room_polygon(room) for room in plan.rooms]

    def covered(drawing: VectorDrawing) -> float:
        shapes = [room.polygon for room in drawing.rooms] or list(drawing.walls)
        scaled = [Polygon(np.array(s.exterior.coords) * m_per_unit).buffer(0) for s in shapes]
        return sum(floor.intersection(shape).area for floor in floors for shape in scaled)

    return max(read_drawings(path), key=covered)
