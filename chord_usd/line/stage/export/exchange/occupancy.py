"""Which part of a house a robot can be in, in cells of 5 cm.

Doors count as open, and their leaves as out of the way, unless somebody gave them a state: then
their leaves are occupied where they stand. What is lower than THRESHOLD_M (rugs, sills) is driven
over, what begins above ROBOT_M is driven under.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from pxr import Usd
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray
from chord_usd.line.stage.export.exchange.built_house import House
from chord_usd.line.stage.export.exchange.placed_pieces import pieces_of
from chord_usd.line.stage.export.exchange.wall_pieces import wall_pieces

RESOLUTION_M = 0.05
ROBOT_M = 1.5
"""Height of the tallest robot."""

THRESHOLD_M = 0.03

OCCUPIED, FREE, UNKNOWN = 0, 254, 205
"""Grey values, as map_server writes and reads them."""

Window = tuple[slice, slice]
"""Rows and columns of a part of the grid."""

_REACH_M = 0.005
"""What reaches less far into a cell does not occupy it."""

_MARGIN_M = 0.25
"""Of what is unknown, round the house."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of RESOLUTION_M; the first row of the image is the northernmost."""

    origin_m: tuple[float, float]
    """South-west corner of the south-western cell."""
    image: ByteArray
    """(H, W) OCCUPIED, FREE or UNKNOWN."""

    @classmethod
    def around(cls, house: House) -> Grid:
        """An unknown world with room for a house."""
        west, south, east, north = unary_union(
            [house.walls.solid_m, *house.walls.floors_m]
        ).bounds  # fmt: skip
        low = np.floor((np.array([west, south]) - _MARGIN_M) / RESOLUTION_M)
        high = np.ceil((np.array([east, north]) + _MARGIN_M) / RESOLUTION_M)
        columns, rows = (high - low).astype(int)
        origin = tuple(float(round(at * RESOLUTION_M, 6)) for at in low)
        return cls((origin[0], origin[1]), np.full((rows, columns), UNKNOWN, dtype=np.uint8))

    def fill(self, house: House, stage: Usd.Stage) -> None:
        """Floors and doorways are free, walls and obstacles are occupied."""
        ways = [
            tunnel.area_m
            for tunnel in house.walls.tunnels.values()
            if tunnel.opening.kind != "window" and tunnel.low_m <= THRESHOLD_M
        ]
        for area in (*house.walls.floors_m, *ways):
            self._free(area)
        doorways = unary_union(ways)
        for piece in wall_pieces(house.walls):
            wall = shapely.difference(piece.area_m, doorways, grid_size=1e-4)
            self._occupy(wall)
        for well in house.wells:  # steps below, a hole above
            self._occupy(well)
        for shadow in obstacles(house, stage):
            self._occupy(shadow)
        for door in house.stated.values():
            for shadow in door.shadows_m:
                self._occupy(shadow)

    def _free(self, floor: BaseGeometry) -> None:
        for part in polygons_of(floor):
            window, within = self.cells_in(part)
            self.image[window][within] = FREE

    def _occupy(self, area: BaseGeometry) -> None:
        """Take the cells that an area reaches into; what lies beyond the grid is left out."""
        reach = RESOLUTION_M / 2 - _REACH_M
        for part in polygons_of(area):
            window, x, y = self._window_of(part)
            cells = shapely.box(x - reach, y - reach, x + reach, y + reach)
            self.image[window][shapely.intersects(part, cells)] = OCCUPIED

    def at_m(self, rows: Any, columns: Any) -> tuple[FloatArray, FloatArray]:
        """x of the middles of columns, y of the middles of rows."""
        x = self.origin_m[0] + (np.asarray(columns) + 0.5) * RESOLUTION_M
        y = self.origin_m[1] + (self.image.shape[0] - np.asarray(rows) - 0.5) * RESOLUTION_M
        return x, y

    def _cell(self, at_m: tuple[float, float]) -> tuple[int, int]:
        """Row and column of a point."""
        column = math.floor((at_m[0] - self.origin_m[0]) / RESOLUTION_M)
        row = self.image.shape[0] - 1 - math.floor((at_m[1] - self.origin_m[1]) / RESOLUTION_M)
        return row, column

    def cells_in(self, floor: Polygon) -> tuple[Window, BoolArray]:
        """The window of the image round a floor, and which of its cells lie in it."""
        window, x, y = self._window_of(floor)
        return window, shapely.contains_xy(floor, x, y)

    def _window_of(self, area: Polygon) -> tuple[Window, FloatArray, FloatArray]:
        """The window of the image round an area, which is prepared, and the middles of its cells:
        (H, W) x and y."""
        low, high = self._cell(area.bounds[:2]), self._cell(area.bounds[2:])
        rows = slice(max(high[0], 0), max(low[0] + 1, 0))
        columns = slice(max(low[1], 0), max(high[1] + 1, 0))
        height, width = self.image.shape
        x, y = np.meshgrid(*self.at_m(np.arange(height)[rows], np.arange(width)[columns]))
        shapely.prepare(area)
        return (rows, columns), x, y


def obstacles(house: House, stage: Usd.Stage) -> Iterator[BaseGeometry]:
    """What stands in a robot's way, seen from above."""
    shadows: dict[tuple[str, int], BaseGeometry] = {}
    for piece in pieces_of(stage, house):
        if is_underfoot(piece.item):
            continue
        for number, solid in enumerate(piece.solids):
            low, high = solid.bounds_m[:, 2]
            if low >= ROBOT_M or high <= THRESHOLD_M:
                continue
            key = piece.model, number
            if key not in shadows:
                shadows[key] = piece.shadow(solid)
            yield piece.shadow_in_world(shadows[key])
