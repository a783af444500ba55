"""The solid of the walls, cut into straight walls as builders count them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import WALL_THICKNESS_M
from chord_usd.line.stage.shell.walls import Tunnel, WallLine, Walls

_GRID_M = 1e-4
_LEAST_M2 = 1e-3
"""Smaller pieces are no walls: they go to a wall beside them."""


@dataclass(frozen=True, eq=False)
class WallPiece:
    """One wall, seen from above."""

    area_m: Polygon
    tunnels: tuple[Tunnel, ...]
    """What is cut through it, and through no other."""
    gaps: tuple[Tunnel, ...]
    """Where a railing stands in its place."""


def wall_pieces(walls: Walls) -> tuple[WallPiece, ...]:
    """The walls of a house. Together they cover the solid exactly once; the longest run through
    at corners, and the rest ends at their faces."""
    areas = _joined(_along_lines(walls), walls.cuts())
    holes = list(walls.tunnels.values())
    gaps = [tunnel for _, tunnel in walls.railings]
    owned: list[tuple[list[Tunnel], list[Tunnel]]] = [([], []) for _ in areas]
    for kind, cuts in enumerate((holes, gaps)):
        for cut in cuts:
            shared = shapely.area(shapely.intersection(areas, cut.area_m))
            owned[int(np.argmax(shared))][kind].append(cut)
    return tuple(
        WallPiece(area, tuple(closed), tuple(open_))
        for area, (closed, open_) in zip(areas, owned, strict=True)
    )


def _along_lines(walls: Walls) -> list[Polygon]:
    """What lies behind each line of the walls, the longest first."""
    left = walls.solid_m
    strips: list[Polygon] = []
    for line in sorted(walls.lines, key=lambda line: -round(line.length_m, 3)):
        strip = _behind(line)
        if not left.intersects(strip):
            continue
        taken = shapely.intersection(left, strip, grid_size=_GRID_M)
        pieces = [piece for piece in polygons_of(taken) if piece.area >= _LEAST_M2]
        if pieces:
            strips += pieces
            rest = shapely.difference(left, unary_union(pieces), grid_size=_GRID_M)
            left = MultiPolygon(polygons_of(rest))  # where pieces touch, lines and points remain
    for piece in polygons_of(left):
        beside = [shapely.intersection(other, piece).length for other in strips]
        if piece.area >= _LEAST_M2 or not any(beside):
            strips.append(piece)
        else:
            nearest = int(np.argmax(beside))
            strips[nearest] = _polygon_or(strips[nearest].union(piece), strips[nearest])
    return strips


def _behind(line: WallLine) -> Polygon:
    """The strip one wall deep behind a line, as much longer at both ends."""
    along = (line.end_m - line.start_m) / max(line.length_m, _GRID_M)
    inwards = np.array([-along[1], along[0]]) * WALL_THICKNESS_M
    start = line.start_m - along * WALL_THICKNESS_M
    end = line.end_m + along * WALL_THICKNESS_M
    return Polygon([start, end, end + inwards, start + inwards])


def _joined(areas: Sequence[Polygon], cuts: Sequence[Tunnel]) -> list[Polygon]:
    """The walls, those as one that one hole goes through: thick ones, or two in a row."""
    groups = [{index} for index in range(len(areas))]
    tree = shapely.STRtree(areas)
    for cut in cuts:
        met = [n for n in tree.query(cut.area_m) if _is_cut(areas[n], cut)]
        whole = set().union(*(groups[n] for n in met)) if met else set()
        for index in whole:
            groups[index] = whole
    merged = []
    for index, group in enumerate(groups):
        if index == min(group):
            area = unary_union([areas[n] for n in sorted(group)])
            merged += [orient(part) for part in polygons_of(area)]
    return merged


def _is_cut(area: Polygon, cut: Tunnel) -> bool:
    return bool(area.intersection(cut.area_m).area > _GRID_M)


def _polygon_or(area: BaseGeometry, otherwise: Polygon) -> Polygon:
    return area if isinstance(area, Polygon) else otherwise
