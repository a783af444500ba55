"""Geometry of SVG elements: transforms, paths, basic shapes and filled areas, y down."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element

import numpy as np
from shapely.geometry import LineString, Polygon
from shapely.ops import polygonize, unary_union

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.plan.vector.safe_xml import local_name

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_COMMAND = re.compile(r"([MmLlHhVvCcSsQqTtAaZz])([^MmLlHhVvCcSsQqTtAaZz]*)")
_ARC = re.compile(rf"({_NUMBER.pattern})[\s,]*" * 3 + r"([01])[\s,]*" * 2
                  + rf"({_NUMBER.pattern})[\s,]*" * 2)  # fmt: skip
"""Flags of arcs may stand together with what follows: "a5 5 0 01.5-3"."""
_TRANSFORM = re.compile(r"(matrix|translate|scale|rotate|skewX|skewY)\s*\(([^)]*)\)")
_ARGUMENTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_CURVE_POINTS = 8
IDENTITY = np.eye(3)


def numbers(text: str) -> list[float]:
    """All numbers in a list of them."""
    return [float(match) for match in _NUMBER.findall(text)]


def transform(element: Element) -> FloatArray:
    """(3, 3) the element's own transform."""
    matrix = IDENTITY
    for name, arguments in _TRANSFORM.findall(element.get("transform", "")):
        matrix = matrix @ _matrix(name, numbers(arguments))
    return matrix


def _matrix(name: str, v: list[float]) -> FloatArray:
    if name == "matrix" and len(v) == 6:
        return np.array([[v[0], v[2], v[4]], [v[1], v[3], v[5]], [0, 0, 1]])
    if name == "translate" and v:
        return np.array([[1, 0, v[0]], [0, 1, v[1] if len(v) > 1 else 0], [0, 0, 1]])
    if name == "scale" and v:
        return np.diag([v[0], v[1] if len(v) > 1 else v[0], 1.0])
    if name == "rotate" and v:
        cos, sin = math.cos(math.radians(v[0])), math.sin(math.radians(v[0]))
        turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
        if len(v) == 3:
            there, back = _matrix("translate", v[1:]), _matrix("translate", [-v[1], -v[2]])
            return there @ turn @ back
        return turn
    if name.startswith("skew") and v:
        tangent, is_x = math.tan(math.radians(v[0])), name == "skewX"
        return np.array([[1, tangent * is_x, 0], [tangent * (not is_x), 1, 0], [0, 0, 1]])
    return IDENTITY


def viewport(element: Element, shown: Element | None = None) -> FloatArray:
    """(3, 3) from the units inside a nested svg, symbol or use to those around it.

    element: says where it lies and how large it is; shown: whose view box that is, if another's.
    """
    x, y = (_length(element, key) for key in ("x", "y"))
    matrix = np.array([[1.0, 0, x], [0, 1, y], [0, 0, 1]])
    box = numbers((element if shown is None else shown).get("viewBox", ""))
    if len(box) != 4 or min(box[2:]) <= 0.0:
        return matrix
    sizes = [_length(element, key) for key in ("width", "height")]
    shares = [size / side for size, side in zip(sizes, box[2:], strict=True) if size > 0.0]
    share = min(shares, default=1.0)
    return matrix @ np.diag([share, share, 1.0]) @ _matrix("translate", [-box[0], -box[1]])


def _length(element: Element, key: str) -> float:
    """A length in the units around; 0 without one and for a share of what is around."""
    text = element.get(key, "")
    return (numbers(text) or [0.0])[0] if "%" not in text else 0.0


def filled(outlines: Sequence[FloatArray], *, is_even_odd: bool) -> list[Polygon]:
    """What the outlines of one path fill together, each (N, 2), closed or not.

    Outlines within one another are holes by the even-odd rule, or by their directions.
    """
    rings = [np.vstack([ring, ring[:1]]) for ring in outlines if len(ring) >= 3]
    if len(rings) == 1:
        return polygons_of(Polygon(rings[0]).buffer(0))
    cells = polygonize(unary_union([LineString(ring) for ring in rings]))
    kept = [cell for cell in cells if _is_inside(cell, rings, is_even_odd=is_even_odd)]
    return polygons_of(unary_union(kept))


def _is_inside(cell: Polygon, rings: Sequence[FloatArray], *, is_even_odd: bool) -> bool:
    point = np.array(cell.representative_point().coords[0])
    turns = sum(_turns_round(point, ring) for ring in rings)
    return turns % 2 == 1 if is_even_odd else turns != 0


def _turns_round(point: FloatArray, ring: FloatArray) -> int:
    """How often a closed ring, its first corner repeated, goes round a point."""
    (x0, y0), (x1, y1) = (ring[:-1] - point).T, (ring[1:] - point).T
    side = x0 * y1 - x1 * y0
    up = (y0 <= 0.0) & (y1 > 0.0) & (side > 0.0)
    down = (y0 > 0.0) & (y1 <= 0.0) & (side < 0.0)
    return int(up.sum()) - int(down.sum())


def outlines(element: Element) -> Iterator[FloatArray]:
    """(N, 2) the points of each of the element's own outlines, before its transform."""
    name = local_name(element)
    if name in ("polygon", "polyline"):
        values = numbers(element.get("points", ""))
        points = np.array(values[: len(values) // 2 * 2]).reshape(-1, 2)
        yield np.vstack([points, points[:1]]) if name == "polygon" else points
    elif name == "rect":
        x, y, w, h = (float((numbers(element.get(k, "0")) or [0.0])[0])
                      for k in ("x", "y", "width", "height"))  # fmt: skip
        yield np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]])
    elif name == "line":
        ends = [(numbers(element.get(k, "0")) or [0.0])[0] for k in ("x1", "y1", "x2", "y2")]
        yield np.array(ends).reshape(2, 2)
    elif name == "path":
        yield from (np.array(points) for points in _path(element.get("d", "")) if len(points) > 1)


def _path(data: str) -> Iterator[list[tuple[float, float]]]:
    points: list[tuple[float, float]] = []
    place = (0.0, 0.0)
    for letter, arguments in _COMMAND.findall(data):
        values, size = _values(letter, arguments), _ARGUMENTS[letter.upper()]
        if letter in "Zz":
            if points:
                place = points[0]
                yield [*points, place]
                points = []
            continue
        for index in range(0, len(values) - size + 1, size):
            step = values[index : index + size]
            base = place if letter.islower() else (0.0, 0.0)
            first_of_move = letter in "Mm" and index == 0
            if first_of_move and points:
                yield points
            if first_of_move:
                points = []
            elif not points:
                points = [place]
            reached = _stretch(letter.upper(), step, base, place)
            points += reached
            place = reached[-1]
    if points:
        yield points


def _values(letter: str, arguments: str) -> list[float]:
    if letter in "Aa":
        return [float(value) for arc in _ARC.findall(arguments) for value in arc]
    return numbers(arguments)


def _stretch(
    command: str, v: list[float], base: tuple[float, float], place: tuple[float, float]
) -> list[tuple[float, float]]:
    """The points of one command after the present place."""
    if command == "H":
        return [(base[0] + v[0], place[1])]
    if command == "V":
        return [(place[0], base[1] + v[0])]
    ends = [
        (base[0] + x, base[1] + y) for x, y in zip(v[-2::-2][::-1], v[::-2][::-1], strict=False)
    ]
    if command in ("C", "S", "Q"):
        controls = [place, *((base[0] + v[i], base[1] + v[i + 1]) for i in range(0, len(v), 2))]
        return _bezier(np.array(controls))
    # An arc's end is what counts for walls; its bulge is a door's swing.
    return ends[-1:]


def _bezier(controls: FloatArray) -> list[tuple[float, float]]:
    """De Casteljau, at even steps."""
    points = []
    for t in np.linspace(0.0, 1.0, _CURVE_POINTS + 1)[1:]:
        row = controls
        while len(row) > 1:
            row = row[:-1] * (1 - t) + row[1:] * t
        points.append((float(row[0][0]), float(row[0][1])))
    return points
