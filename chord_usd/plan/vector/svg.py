"""SVG floor plans: CubiCasa's model.svg, and plain SVG whose ids or classes say what is what.

CubiCasa: groups with class "Wall External", "Door Swing Beside", "Window Regular" and "Space
Bedroom", each with a polygon. Plain: any shape that stands in a group, or has itself an id, class
or label, that speaks of walls, doors, windows or rooms.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from shapely.geometry import LineString, Polygon

from chord_usd.errors import PlanError
from chord_usd.plan.vector.safe_xml import LARGEST_BYTES, local_name, parse_xml
from chord_usd.plan.vector.shapes import Label, OpeningShape, RoomShape, VectorDrawing
from chord_usd.plan.vector.svg_shapes import IDENTITY, numbers, outlines, transform
from chord_usd.scene.geometry import polygons_of
from chord_usd.scene.room_names import room_kind
from chord_usd.scene.types import FloatArray, OpeningKind

_EXPECTED = "an SVG whose classes or ids name walls, rooms, doors and windows"

_MEANINGS = (
    (
        "skip",
        re.compile(r"fixedfurniture|furniture|panel|threshold|dimension|selection|icon", re.I),
    ),
    ("window", re.compile(r"\bwindows?\b|fenster|fen[eê]tre|ventana|janela|ikkuna", re.I)),
    ("door", re.compile(r"\bdoors?\b|entrance door|porte|puerta|\bt[uü]r\b|ovi", re.I)),
    ("passage", re.compile(r"\bopenings?\b|\bpassages?\b", re.I)),
    ("wall", re.compile(r"\bwalls?\b|\bw[aä]nde?\b|\bmurs?\b|\bmuros?\b|parede", re.I)),
    ("room", re.compile(r"\bspace\b|\brooms?\b|\bfloors?\b|\braum\b|\bpi[eè]ce\b", re.I)),
)
_M_PER_LENGTH = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "ft": 0.3048}
_MOST_NUMBERS = 200_000
"""In all outlines of walls, rooms and openings: a large house has some thousand."""
_PLAIN_ROOM = re.compile(r"(?i)space|rooms?|floor|\d*")
_LEAST_HOUSE_M = 3.0
"""An SVG whose page is smaller is not drawn at full size, whatever its units say."""


@dataclass
class _Found:
    where: str
    numbers: int = 0
    """In the outlines so far."""
    rooms: list[RoomShape] = field(default_factory=list)
    walls: list[Polygon] = field(default_factory=list)
    openings: list[OpeningShape] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)


def read_svg(path: Path) -> list[VectorDrawing]:
    """The drawing in an SVG; one per CubiCasa floor. Raises PlanError."""
    with path.open("rb") as file:
        root = parse_xml(file.read(LARGEST_BYTES + 1), str(path), _EXPECTED)
    if local_name(root) != "svg":
        raise PlanError("is not an SVG", where=str(path), expected=_EXPECTED)
    floors = [e for e in root.iter() if _said(e).split(" ")[0] in ("Floor", "Floorplan")]
    known = {id(floor) for floor in floors}
    inner = [e for e in floors if not any(id(child) in known for child in list(e.iter())[1:])]
    scale = _m_per_unit(root)
    drawings = []
    for top in inner or [root]:
        found = _Found(str(path))
        _visit(top, _matrix_above(root, top), "", found)
        if found.rooms or found.walls:
            drawings.append(
                VectorDrawing(
                    found.rooms, found.walls, found.openings, found.labels, scale, _said(top)
                )
            )
    if not drawings:
        raise PlanError(
            "names neither walls nor rooms", where=str(path), expected=_EXPECTED,
            try_="export it as PNG, which is read by its looks",
        )  # fmt: skip
    return drawings


def _matrix_above(root: Element, target: Element) -> FloatArray:
    """The transforms of all elements that hold this one."""

    def search(element: Element, matrix: FloatArray) -> FloatArray | None:
        if element is target:
            return matrix
        below = matrix @ transform(element)
        hits = (search(child, below) for child in element)
        return next((hit for hit in hits if hit is not None), None)

    found = search(root, IDENTITY)
    return IDENTITY if found is None else found


def _said(element: Element) -> str:
    keys = ("class", "id", "{http://www.inkscape.org/namespaces/inkscape}label", "data-name")
    return " ".join(element.get(key, "") for key in keys).strip()


@dataclass(frozen=True)
class _Style:
    """What is inherited from group to group."""

    stroke: float = 0.0
    """Width of lines."""
    is_filled: bool = True

    def of(self, element: Element) -> _Style:
        """The style of an element in one of this style."""
        written = dict(re.findall(r"([\w-]+)\s*:\s*([^;]+)", element.get("style", "")))
        width = written.get("stroke-width", element.get("stroke-width"))
        fill = written.get("fill", element.get("fill"))
        stroke = (numbers(width) or [0.0])[0] if width else self.stroke
        return _Style(stroke, fill.strip() != "none" if fill else self.is_filled)


def _visit(
    element: Element, matrix: FloatArray, meaning: str, found: _Found, style: _Style | None = None
) -> None:
    """Collect what this element and all in it draw. Matrix: from its own units to the root's."""
    if element.get("display") == "none" and meaning != "room":
        return
    if local_name(element) in ("defs", "clipPath", "mask", "pattern", "symbol", "style"):
        return
    matrix = matrix @ transform(element)
    style = (style or _Style()).of(element)
    said = _meaning(element)
    own = said or meaning
    if own == "skip":
        return
    if local_name(element) == "text":
        _add_label(element, matrix, found)
        return
    if said and local_name(element) == "g" and _is_thing(element, said):
        _add_group(element, matrix, said, found)
        return
    for points in _outlines(element, found) if own else ():
        _add(own, _mapped(points, matrix), _said(element), style, found)
    for child in element:
        _visit(child, matrix, own, found, style)


def _outlines(element: Element, found: _Found) -> Iterator[FloatArray]:
    """Counted before they are computed. Raises PlanError where all together are too many."""
    found.numbers += sum(len(numbers(element.get(key, ""))) for key in ("d", "points"))
    if found.numbers > _MOST_NUMBERS:
        raise PlanError(
            f"draws walls, rooms and openings with more than {_MOST_NUMBERS:,} numbers",
            where=found.where, expected=_EXPECTED, try_="simplify its paths, or export it as PNG",
        )  # fmt: skip
    return outlines(element)


def _meaning(element: Element) -> str:
    said = re.sub(r"[_\-]+|(?<=[a-z])(?=[A-Z])|\d+", " ", _said(element))
    return next((name for name, pattern in _MEANINGS if pattern.search(said)), "")


def _is_thing(group: Element, meaning: str) -> bool:
    """Whether a group is one door, window or room, and not all of them together."""
    shapes = [e for e in group if local_name(e) in ("polygon", "polyline", "rect", "path")]
    return meaning != "wall" and len(shapes) == 1 and bool(group.get("class") or group.get("id"))


def _add_group(group: Element, matrix: FloatArray, meaning: str, found: _Found) -> None:
    """A group's first shape is the thing itself; the rest draws leaves and names."""
    shape = next(e for e in group if local_name(e) in ("polygon", "polyline", "rect", "path"))
    for points in _outlines(shape, found):
        _add(meaning, _mapped(points, matrix @ transform(shape)), _said(group), _Style(), found)
    for text in (e for e in group.iter() if local_name(e) == "text"):
        # Its place in a nested group is of no weight: it lies in the room it names.
        inner = _matrix_above(group, text)
        _add_label(text, matrix @ inner @ transform(text), found)
    for child in group:
        if meaning == "wall" or _meaning(child) in ("door", "window"):
            _visit(child, matrix, "", found)


def _mapped(points: FloatArray, matrix: FloatArray) -> FloatArray:
    """Points in the root's units, y up."""
    mapped = points @ matrix[:2, :2].T + matrix[:2, 2]
    return mapped * (1.0, -1.0)


def _add(meaning: str, points: FloatArray, said: str, style: _Style, found: _Found) -> None:
    closed = len(points) >= 3
    if meaning == "wall" and closed and style.is_filled:
        found.walls += polygons_of(Polygon(points).buffer(0))
    elif meaning == "wall" and style.stroke > 0.0:
        line = LineString(points).buffer(style.stroke / 2, cap_style="square", join_style="mitre")
        found.walls += polygons_of(line)
    elif meaning == "room" and closed:
        found.rooms.append(RoomShape(Polygon(points), _room_name(said)))
    elif meaning in ("door", "window", "passage"):
        opening = _opening(meaning, points)
        if opening is not None:
            found.openings.append(opening)


def _room_name(said: str) -> str:
    """The words of a class or id that name the room."""
    words = [
        w for w in re.split(r"[\s_\-]+", said) if not re.fullmatch(r"(?i)space|rooms?|floor", w)
    ]
    known = [word for word in words if room_kind(word) != "unknown"]
    return " ".join(dict.fromkeys(known or words)) if words else ""


def _opening(kind: str, points: FloatArray) -> OpeningShape | None:
    meanings: dict[str, OpeningKind] = {"door": "door", "window": "window", "passage": "passage"}
    if len(points) == 2:
        return OpeningShape(meanings[kind], points[0], points[1])
    box = Polygon(points).minimum_rotated_rectangle
    if not isinstance(box, Polygon) or box.area <= 0.0:
        return None
    corners = np.array(box.exterior.coords[:4])
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    first = int(np.argmax(lengths[:2]))
    middle, half = corners.mean(axis=0), edges[first] / 2
    return OpeningShape(meanings[kind], middle - half, middle + half, float(lengths[1 - first]))


def _add_label(element: Element, matrix: FloatArray, found: _Found) -> None:
    said = " ".join(" ".join(_words(element)).split())
    x, y = (float((numbers(element.get(key, "0")) or [0.0])[0]) for key in ("x", "y"))
    if said:
        found.labels.append(Label(said, _mapped(np.array([[x, y]]), matrix)[0]))


def _words(element: Element) -> Iterator[str]:
    return (part for part in element.itertext())


def _m_per_unit(root: Element) -> float | None:
    """From a width with a unit and the view box, where that is a house at full size."""
    match = re.fullmatch(r"\s*([\d.]+)\s*(mm|cm|m|in|ft)\s*", root.get("width", ""))
    box = numbers(root.get("viewBox", ""))
    if not match or len(box) != 4 or box[2] <= 0.0:
        return None
    width_m = float(match[1]) * _M_PER_LENGTH[match[2]]
    return width_m / box[2] if width_m >= _LEAST_HOUSE_M else None
