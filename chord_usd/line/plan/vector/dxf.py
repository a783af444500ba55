"""DXF: layers say what is what; units come from the header.

Walls are closed outlines, hatches, pairs of lines or single lines on a wall layer; a door is an arc
of a quarter circle, wherever it is drawn, or a block or line on a door layer; rooms are closed
outlines on a room layer, else what the walls enclose.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from shapely import STRtree
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import polygonize, unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.fonts import fonts_kept
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import FloatArray, OpeningKind
from chord_usd.line.plan.vector.dxf_storeys import by_storey, stairs_of
from chord_usd.line.plan.vector.shapes import (
    FARTHEST,
    Label,
    OpeningShape,
    RoomShape,
    VectorDrawing,
)

_EXPECTED = "a DXF drawing with layers for walls or rooms"
_LARGEST_BYTES = 256 * 2**20
_MOST_ENTITIES = 300_000
_DEEPEST_BLOCK = 6

_WALL = re.compile(r"wall|mauer|w[aä]nd|mur|pared|v[aä]gg|sein[aä]|墙|壁", re.I)
_DOOR = re.compile(r"door|t[uü]r|porte|puerta|porta|d[oö]rr|ovi|门|ドア", re.I)
_WINDOW = re.compile(r"window|glaz|fenster|fen[eê]tre|ventana|janela|f[oö]nster|ikkuna|窗|窓", re.I)
_PASSAGE = re.compile(r"passage|durchgang|durchbruch|v[aã]o livre|门洞", re.I)
_ROOM = re.compile(r"room|space|area|raum|pi[eè]ce|local|rum\b|tila|房间|部屋", re.I)
_NOT = re.compile(r"text|dim|hatch.?pattern|tag|annot|furn", re.I)

_M_PER_UNIT = {1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1.0, 10: 0.9144, 14: 0.1}
"""$INSUNITS."""

_HOUSE_M = (3.0, 120.0)
_SWING_DEG = (50.0, 130.0)
_SWING_M = (0.5, 1.5)
_LEAF_M = (0.3, 2.5)
"""Radii of arcs that are doors anywhere, and on a layer of doors."""

_HEIGHT_M = (0.2, 6.0)
"""Of an opening that is drawn extruded."""

_BEHIND_M = 0.05
_WIDEST_GAP_M = 0.3
"""How far behind the end of a leaf its wall goes on, and the widest gap that can be bridged."""

_JAMB_M = 0.01
_SHALLOWEST_HOLE_M = 0.1

_OPPOSITE = 0.98
"""Cosine, beyond which two leaves open away from each other."""

_THICKEST_WALL_M = 0.6
_TOUCH_M = 0.02
_SINGLE_WALL_M = 0.1
_SHORTEST_SINGLE_M = 0.3
_SINGLE = f"walls are drawn as single lines, and taken to be {_SINGLE_WALL_M * 100:.0f} cm thick"


def read_dxf(path: Path) -> list[VectorDrawing]:
    """The drawing in model space. Raises PlanError, MissingExtraError."""
    document = _open(path)
    if _count(document, document.modelspace(), 0, {}) > _MOST_ENTITIES:
        raise PlanError(
            f"has more than {_MOST_ENTITIES:,} entities once its blocks are taken apart",
            where=str(path), expected=_EXPECTED, try_="purge it, or leave out furniture",
        )  # fmt: skip
    flat = list(_flattened(document.modelspace(), 0))
    try:
        m_per_unit = _units(document, flat)
        drawings = [_drawing_of(name, entities, m_per_unit) for name, entities in by_storey(flat)]
    except ValueError as error:
        raise PlanError(f"is damaged ({error})", where=str(path), expected=_EXPECTED) from error
    drawings = [drawing for drawing in drawings if drawing.rooms or drawing.walls]
    if not drawings:
        layers = sorted({e.dxf.layer for e in flat if e.dxf.hasattr("layer")})[:8]
        speaking = [e for e in flat if _means(e) in ("wall", "room")]
        if speaking:
            named = sorted({e.dxf.layer for e in speaking})[:4]
            kinds = sorted({e.dxftype() for e in speaking})[:4]
            raise PlanError(
                f"has nothing on {', '.join(named)} that can be read as walls or rooms, only "
                f"{', '.join(kinds)}",
                where=str(path), expected="lines, polylines or hatches",
            )  # fmt: skip
        raise PlanError(
            f"has no layer that speaks of walls or rooms (it has {', '.join(layers) or 'none'})",
            where=str(path), expected=_EXPECTED, try_="rename the walls' layer to WALLS",
        )  # fmt: skip
    return drawings


def _drawing_of(name: str, entities: Sequence[Any], m_per_unit: float) -> VectorDrawing:
    floor = 0.0
    if name:
        outlines = [entity for entity in entities if entity.dxftype() == "LWPOLYLINE"]
        heights = [
            outline.dxf.elevation for outline in outlines if _means(outline) in ("wall", "room")
        ]
        floor = float(min(heights, default=0.0))
        _refuse_odd(entities[0], [floor])
        for outline in outlines:
            outline.dxf.elevation -= floor
    sorter = _Sorter(m_per_unit)
    for entity in entities:
        sorter.add(entity)
    drawing = sorter.drawing()
    if not name:
        return drawing
    return replace(drawing, name=name, elevation=floor, stairs=stairs_of(entities, _points))


def _open(path: Path) -> Any:
    with needed_for("reading this format"), fonts_kept():
        import ezdxf
        from ezdxf import recover
    if path.stat().st_size > _LARGEST_BYTES:
        raise PlanError(
            f"is larger than {_LARGEST_BYTES // 2**20} MiB", where=str(path), expected=_EXPECTED
        )
    try:
        document, _ = recover.readfile(path)
    except (ezdxf.DXFError, UnicodeError, ValueError, IndexError) as error:
        raise PlanError(f"is not a DXF drawing ({error})", where=str(path)) from error
    return document


def _count(
    document: Any, entities: Iterable[Any], depth: int, known: dict[tuple[str, int], int]
) -> int:
    """How many entities _flattened would yield, without taking anything apart.

    known: entities in each block at each depth, counted once however often it is inserted.
    """
    total = 0
    for entity in entities:
        if entity.dxftype() != "INSERT" or depth > _DEEPEST_BLOCK:
            total += 1
            continue
        key = str(entity.dxf.name), depth
        if key not in known:
            block = document.blocks.get(key[0])
            known[key] = 0 if block is None else _count(document, block, depth + 1, known)
        total += known[key]
    return total


def _flattened(entities: Iterable[Any], depth: int) -> Iterator[Any]:
    """All entities with blocks taken apart; a block's parts on layer 0 are on the block's own."""
    for entity in entities:
        if entity.dxftype() != "INSERT" or depth > _DEEPEST_BLOCK:
            yield entity
            continue
        block = f"{entity.dxf.layer} {entity.dxf.name}"
        parts = list(_flattened(entity.virtual_entities(), depth + 1))
        for part in parts:
            if part.dxf.layer == "0":
                part.dxf.layer = re.sub(r"[<>/\\\":;?*|=`]", "_", block)
        yield from parts


def _units(document: Any, entities: list[Any]) -> float:
    """Metres per unit: of the header if a house comes out, else those with which one does."""
    points = [p for e in entities if _means(e) for p in _points(e)]
    if not points:
        return _M_PER_UNIT.get(int(document.header.get("$INSUNITS", 0)), 0.001)
    side = float(np.ptp(np.array(points), axis=0).max())
    stated = _M_PER_UNIT.get(int(document.header.get("$INSUNITS", 0)))
    choices = [stated] if stated else []
    for m_per_unit in (*choices, 0.001, 0.01, 1.0, 0.0254, 0.3048):
        if m_per_unit and _HOUSE_M[0] <= side * m_per_unit <= _HOUSE_M[1]:
            return m_per_unit
    return stated or 0.001


def _means(entity: Any) -> str:
    """Wall, door, window, passage or room, by the layer."""
    layer = entity.dxf.layer if entity.dxf.hasattr("layer") else ""
    if _NOT.search(layer):
        return ""
    patterns = (
        ("window", _WINDOW), ("passage", _PASSAGE), ("door", _DOOR), ("wall", _WALL),
        ("room", _ROOM),
    )  # fmt: skip
    return next((name for name, pattern in patterns if pattern.search(layer)), "")


def _points(entity: Any) -> list[tuple[float, float]]:
    """The entity's points, arcs as they bend.

    Raises ValueError where they are no numbers, or lie beyond FARTHEST.
    """
    # Before it is drawn: ezdxf never ends on an arc round a centre that is no number.
    _refuse_odd(entity, list(_numbers(entity)))
    points = _drawn(entity)
    _refuse_odd(entity, points)
    return points


def _numbers(entity: Any) -> Iterator[float]:
    """All numbers that define the entity's shape."""
    for value in entity.dxf.all_existing_dxf_attribs().values():
        yield from (value.xyz if hasattr(value, "xyz") else [value] * isinstance(value, float))
    if entity.dxftype() == "LWPOLYLINE":
        yield from np.ravel(entity.get_points()).tolist()
    elif entity.dxftype() == "SPLINE":
        for rows in (entity.control_points, entity.fit_points, entity.knots, entity.weights):
            yield from np.ravel([tuple(row) for row in rows] if np.ndim(rows) > 1 else rows)


def _refuse_odd(entity: Any, values: Any) -> None:
    if not (np.abs(np.array(values, float)) <= FARTHEST).all():
        raise ValueError(f"{entity.dxftype()}: coordinates that are no numbers, or too large")


def _drawn(entity: Any) -> list[tuple[float, float]]:
    kind = entity.dxftype()
    if kind == "LINE":
        return [(entity.dxf.start.x, entity.dxf.start.y), (entity.dxf.end.x, entity.dxf.end.y)]
    if kind in ("LWPOLYLINE", "POLYLINE", "ARC", "SPLINE", "ELLIPSE", "CIRCLE"):
        from ezdxf import path as paths

        return [(p.x, p.y) for p in paths.make_path(entity).flattening(_sagitta(entity))]
    if kind in ("SOLID", "TRACE", "3DFACE"):
        corners = [entity.dxf.get(f"vtx{i}") for i in (0, 1, 3, 2)]
        return [(c.x, c.y) for c in corners if c is not None]
    return []


def _sagitta(entity: Any) -> float:
    """How far the polygon of a curve may lie inside it."""
    if entity.dxftype() == "ELLIPSE":
        # A curve from here to the moon has not more corners than a column's.
        return max(2.0, float(entity.dxf.major_axis.magnitude) / 1000.0)
    radius = entity.dxf.radius if entity.dxf.is_supported("radius") else 100.0
    return float(radius) / 50.0


@dataclass(frozen=True, eq=False)
class _Bar:
    """A line of an opening, and the heights of an extruded line."""

    line: LineString
    low: float | None = None
    height: float | None = None


class _Sorter:
    """Sorts entities into walls, openings, rooms and labels. Lengths in drawing units."""

    def __init__(self, m_per_unit: float) -> None:
        self.m_per_unit = m_per_unit
        self.areas: list[Polygon] = []
        self.lines: list[LineString] = []
        self.rooms: list[RoomShape] = []
        self.arcs: list[Any] = []
        self.leaves: list[FloatArray] = []
        self.bars: dict[OpeningKind, list[_Bar]] = {"door": [], "window": [], "passage": []}
        self.labels: list[Label] = []

    def add(self, entity: Any) -> None:
        kind, means = entity.dxftype(), _means(entity)
        if kind in ("TEXT", "MTEXT"):
            said = entity.plain_text() if kind == "MTEXT" else entity.dxf.text
            place = entity.dxf.insert
            self.labels.append(Label(" ".join(said.split()), np.array([place.x, place.y])))
        elif kind == "ARC" and _points(entity) and self._is_swing(entity, means == "door"):
            self.arcs.append(entity)
        elif kind == "HATCH" and means == "wall":
            self.areas += _hatch(entity)
        elif means and (points := _points(entity)) and len(points) >= 2:
            self._add_line(means, points, *self._heights(entity))

    def _is_swing(self, arc: Any, is_door: bool) -> bool:
        """is_door: whether its layer says so; elsewhere only a usual leaf is taken for one."""
        sweep = (arc.dxf.end_angle - arc.dxf.start_angle) % 360.0
        radius_m = arc.dxf.radius * self.m_per_unit
        least, most = _LEAF_M if is_door else _SWING_M
        return _SWING_DEG[0] <= sweep <= _SWING_DEG[1] and least <= radius_m <= most

    def _heights(self, entity: Any) -> tuple[float | None, float | None]:
        """Where an extruded entity begins and how high it is; None for one that is flat."""
        attributes = entity.dxf
        height = float(attributes.thickness) if attributes.is_supported("thickness") else 0.0
        if not _HEIGHT_M[0] <= height * self.m_per_unit <= _HEIGHT_M[1]:
            return None, None
        return float(attributes.elevation) if entity.dxftype() == "LWPOLYLINE" else 0.0, height

    def _add_line(
        self, means: str, points: list[tuple[float, float]], low: float | None,
        height: float | None,
    ) -> None:  # fmt: skip
        line = LineString(points)
        closed = len(points) > 3 and line.is_ring
        if means == "room" and closed:
            self.rooms.append(RoomShape(Polygon(points)))
        elif means == "wall" and closed and self._is_thin(Polygon(points)):
            self.areas.append(Polygon(points).buffer(0))
        elif means == "wall":
            self.lines.append(line)
        elif means in ("window", "passage", "door"):
            self.bars[cast(OpeningKind, means)].append(_Bar(line, low, height))

    def _is_thin(self, area: Polygon) -> bool:
        return area.buffer(-_THICKEST_WALL_M / self.m_per_unit / 2).is_empty

    def drawing(self) -> VectorDrawing:
        openings = [*self._doors(), *self._bars("window"), *self._bars("passage")]
        pairs = self._between_lines()
        singles = self._single_lines([*self.areas, *pairs])
        notes = [_SINGLE] if singles and not pairs and not self.areas else []
        return VectorDrawing(
            self.rooms, [*self.areas, *pairs, *singles], openings, self.labels,
            m_per_unit=self.m_per_unit, notes=notes,
        )  # fmt: skip

    def _between_lines(self) -> list[Polygon]:
        """Walls drawn as pairs of lines: the thin faces between them."""
        if not self.lines:
            return []
        reach = _TOUCH_M / self.m_per_unit
        stretched = [_stretched(line, reach) for line in self.lines]
        faces = polygonize(unary_union(stretched))
        return [face for face in faces if self._is_thin(face)]

    def _single_lines(self, walls: list[Polygon]) -> list[Polygon]:
        """Walls drawn as one line each: the lines that bound no other wall."""
        known = unary_union(walls).buffer(2 * _TOUCH_M / self.m_per_unit)
        half = _SINGLE_WALL_M / 2 / self.m_per_unit
        left = [line.difference(known) for line in self.lines]
        shortest = _SHORTEST_SINGLE_M / self.m_per_unit
        alone = unary_union([line for line in left if line.length > shortest])
        thick = alone.buffer(half, cap_style="square", join_style="mitre")
        return polygons_of(thick.difference(unary_union(walls)))

    def _doors(self) -> Iterator[OpeningShape]:
        """By their arcs; what else lies on a door layer counts where no arc is."""
        swings = list(self._swings())
        reach = 0.2 / self.m_per_unit
        taken = [LineString([shape.start, shape.stop]).buffer(reach) for shape in swings]
        swept = unary_union([*taken, *(_disc(arc) for arc in self.arcs)])
        yield from swings
        for opening in self._bars("door"):
            if not LineString([opening.start, opening.stop]).intersects(swept):
                yield opening

    def _swings(self) -> Iterator[OpeningShape]:
        """From hinge to jamb, or to the other hinge where two leaves meet."""
        # Eroded, since the jamb beside an open leaf's hinge is no wall behind it.
        walls = [area.buffer(-_JAMB_M / self.m_per_unit) for area in self.areas]
        solid = unary_union([*walls, *self.lines])
        left = [(_center(arc), arc) for arc in self.arcs]
        while left:
            hinge, arc = left.pop(0)
            low, height = self._heights(arc)
            ends = _ends(arc)
            index = next((n for n, row in enumerate(left) if self._meet(hinge, ends, *row)), None)
            if index is not None:
                stop = left.pop(index)[0]
            elif solid.is_empty:
                stop = ends[0]
            else:
                stop = min(ends, key=lambda end: self._off_walls(hinge, end, solid))
            yield OpeningShape("door", hinge, stop, base=low, height=height)

    def _meet(self, hinge: FloatArray, ends: list[FloatArray], other: FloatArray, arc: Any) -> bool:
        """Whether two leaves, closed, are one door: tips together, hinges on either side."""
        for jamb in ends:
            for end in _ends(arc):
                ways = jamb - hinge, end - other
                lengths = [float(np.hypot(*way)) for way in ways]
                apart = ways[0] @ ways[1] < -_OPPOSITE * lengths[0] * lengths[1]
                if apart and float(np.hypot(*(jamb - end))) < _TOUCH_M / self.m_per_unit:
                    return True
        return False

    def _off_walls(
        self, hinge: FloatArray, end: FloatArray, solid: BaseGeometry
    ) -> tuple[float, float]:
        """How far the walls are from where they go on behind a closed leaf, and from its tip.

        An open leaf may end at a wall, too, but has none behind its hinge.
        """
        along = (end - hinge) / max(float(np.hypot(*(end - hinge))), 1e-9)
        beyond = along * _BEHIND_M / self.m_per_unit
        probes = [Point(*at).distance(solid) for at in (hinge - beyond, end + beyond)]
        near = [min(probe * self.m_per_unit, _WIDEST_GAP_M) for probe in probes]
        return round(sum(near), 3), Point(*end).distance(solid)

    def _bars(self, kind: OpeningKind) -> Iterator[OpeningShape]:
        """Openings drawn as rectangles or bundles of lines: one for each that hang together."""
        bars = self.bars[kind]
        if not bars:
            return
        # Within a hand's breadth lines are parts of one opening; the outline of a hole is one.
        holes = unary_union([hole for bar in bars if (hole := self._hole(bar.line)) is not None])
        near, far = _JAMB_M / self.m_per_unit, 0.06 / self.m_per_unit
        holes = holes.buffer(near)
        blob = unary_union(
            [bar.line.buffer(near if holes.covers(bar.line) else far) for bar in bars]
        )
        tree = STRtree([bar.line for bar in bars])
        for part in polygons_of(blob):
            within = [bars[index] for index in sorted(tree.query(part, predicate="intersects"))]
            lines = unary_union([bar.line for bar in within])
            shrunk = lines.buffer(far).minimum_rotated_rectangle
            corners = np.array(shrunk.exterior.coords[:4])
            edges = np.roll(corners, -1, axis=0) - corners
            lengths = np.hypot(edges[:, 0], edges[:, 1]) - 2 * far
            first = int(np.argmax(lengths[:2]))
            if lengths[first] <= 0.3 / self.m_per_unit:
                continue
            middle = corners.mean(axis=0)
            half = edges[first] / np.hypot(*edges[first]) * lengths[first] / 2
            extruded = next((bar for bar in within if bar.height), within[0])
            is_hole = not holes.is_empty and holes.intersects(lines)
            yield OpeningShape(
                kind, middle - half, middle + half,
                depth=float(lengths[1 - first]) if is_hole else None,
                base=extruded.low, height=extruded.height,
            )  # fmt: skip

    def _hole(self, line: LineString) -> Polygon | None:
        """What an outline encloses that is as deep as a wall."""
        area = Polygon(line.coords) if len(line.coords) > 3 and line.is_ring else Polygon()
        is_deep = not area.buffer(-_SHALLOWEST_HOLE_M / self.m_per_unit / 2).is_empty
        return area if is_deep else None


def _center(arc: Any) -> FloatArray:
    return np.array([arc.dxf.center.x, arc.dxf.center.y])


def _ends(arc: Any) -> list[FloatArray]:
    return [np.array([point.x, point.y]) for point in (arc.start_point, arc.end_point)]


def _disc(arc: Any) -> Polygon:
    center = arc.dxf.center
    return LineString([(center.x, center.y), (center.x + 1e-9, center.y)]).buffer(arc.dxf.radius)


def _hatch(entity: Any) -> list[Polygon]:
    """What it fills: a boundary within another is a hole."""
    filled: BaseGeometry = Polygon()
    for boundary in entity.paths:
        vertices = getattr(boundary, "vertices", None)
        if vertices and len(vertices) >= 3:
            filled = filled.symmetric_difference(
                Polygon([(v[0], v[1]) for v in vertices]).buffer(0)
            )
    return polygons_of(filled)


def _stretched(line: LineString, reach: float) -> LineString:
    """The line, a little longer at both ends, so that lines that should touch do."""
    points = np.array(line.coords)
    if line.is_ring:
        return line
    for end, inner in ((0, 1), (-1, -2)):
        way = points[end] - points[inner]
        length = math.hypot(*way)
        if length > 0.0:
            points[end] = points[end] + way / length * reach
    return LineString(points)
