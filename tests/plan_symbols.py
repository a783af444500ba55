"""Plans drawn the way architects draw them, to be read back."""

from __future__ import annotations

import cv2
import numpy as np

from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.scene.types import Opening, PixelFrame, Plan
from chord_usd.base.scene.units import px_from_m

SYMBOLS_M_PER_PX = 0.016


def frame_of_symbols(plan: Plan) -> PixelFrame:
    points = np.concatenate([room.polygon_m for room in plan.rooms])
    low, high = points.min(axis=0) - 1.5, points.max(axis=0) + 1.5
    size = int(np.ceil((high - low).max() / SYMBOLS_M_PER_PX))
    return PixelFrame(SYMBOLS_M_PER_PX, (float(low[0]), float(low[1])), size)


def draw_symbols(plan: Plan) -> np.ndarray:
    """A plan the way architects draw it: black walls, door leaves with arcs, window panes."""
    frame = frame_of_symbols(plan)
    rgb = draw_plan(Plan(plan.rooms, ()), frame, shade=False).rgb.copy()
    for opening in plan.openings:
        draw_symbol(rgb, opening, frame)
    return rgb


def draw_symbol(rgb: np.ndarray, opening: Opening, frame: PixelFrame) -> None:
    yaw = np.radians(opening.box.yaw_deg)
    along = np.array([np.cos(yaw), np.sin(yaw)])
    across = np.array([-along[1], along[0]])
    center, length = np.array(opening.box.center_m[:2]), opening.box.size_m[0]
    half, deep = along * length / 2, across * 0.13
    box = np.array([-half - deep, half - deep, half + deep, deep - half])

    def pixels(points: np.ndarray) -> np.ndarray:
        return np.rint(px_from_m(points, frame)).astype(np.int32)

    def line(points: np.ndarray) -> None:
        cv2.polylines(rgb, [pixels(points)], False, (0, 0, 0), 1)

    cv2.fillConvexPoly(rgb, pixels(center + box), (255, 255, 255))
    if opening.kind == "window":
        line(center + 0.9 * box[[0, 1, 2, 3, 0]])
        line(center + np.array([-half, half]))
    elif opening.kind == "door":
        hinge = center - half + 0.12 * across
        angles = np.radians(np.arange(0, 91, 5))[:, None]
        line(hinge + length * (np.cos(angles) * along + np.sin(angles) * across))
        line(hinge + np.array([[0.0, 0.0], length * across]))


def draw_storeys() -> np.ndarray:
    """A sheet with three rooms; to the right, two; and a bar below, which is no plan."""
    page = np.full((700, 1500, 3), 255, np.uint8)
    for left, top, right, bottom, walls in (
        (60, 80, 860, 600, (330, 600)),
        (1020, 120, 1440, 520, (1230,)),
    ):
        cv2.rectangle(page, (left, top), (right, bottom), (0, 0, 0), 14)
        for column in walls:
            cv2.line(page, (column, top), (column, bottom), (0, 0, 0), 14)
            page[top + 60 : top + 130, column - 9 : column + 10] = 255
        page[bottom - 9 : bottom + 10, left + 80 : left + 150] = 255
    cv2.line(page, (200, 670), (400, 670), (0, 0, 0), 2)
    return page
