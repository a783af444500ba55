"""SVG floor plans: CubiCasa's model.svg, and plain SVG whose ids or classes say what is what.

CubiCasa: groups with class "Wall External", "Door Swing Beside", "Window Regular" and "Space
Bedroom", each with a polygon. Plain: any shape that stands in a group, or has itself an id, class
or label, that speaks of walls, doors, windows or rooms.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from shapely.geometry import LineString, Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import FloatArray, OpeningKind
from chord_usd.line.plan.paper_scale import M_PER_POINT
from chord_usd.line.plan.vector.safe_xml import LARGEST_BYTES, local_name, parse_xml
from chord_usd.line.plan.vector.shapes import Label, OpeningShape, RoomShape, VectorDrawing
from chord_usd.line.plan.vector.svg_shapes import (
    IDENTITY,
    filled,
    numbers,
    outlines,
    transform,
    viewport,
)

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
_M_PER_LENGTH = {
    "mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "ft": 0.3048, "pt": M_PER_POINT,
}  # fmt: skip
_NOT_DRAWN = ("defs", "clipPath", "mask", "pattern", "symbol", "style")
"""Where they stand; a symbol is drawn where it is used."""
_HREF = ("href", "{http://www.w3.org/1999/xlink}href")
_MOST_NUMBERS = 200_000
"""In all outlines of walls, rooms and openings: a large house has some thousand."""
_MOST_USED = 100_000
"""Elements that `use` repeats."""
_PLAIN_ROOM = re.compile(r"(?i)space|rooms?|floor|\d*")
_M_PER_CSS_PX = 0.0254 / 96
_LEAST_HOUSE_M = 3.0
"""An SVG whose page is smaller is not drawn at full size, whatever its units say."""


@dataclass
class _Found:
    where: str
    sheet: StyleSheet
    by_id: dict[str, Element]
    top: Element
    used: list[str] = field(default_factory=list)
    """Ids of what is repeated at present, the outermost first."""
    shown: Element | None = None
    """The innermost of these."""
    repeated: int = 0
    """Elements that `use` repeated so far."""
    numbers: int = 0
    """In the outlines so far."""
    rooms: list[RoomShape] = field(default_factory=list)
    walls: list[Polygon] = field(default_factory=list)
    openings: list[OpeningShape] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)


def svg_root(path: Path) -> Element:
    """The root of an SVG. Raises PlanError."""
    with path.open("rb") as file:
        root = parse_xml(file.read(LARGEST_BYTES + 1), str(path), _EXPECTED)
    if local_name(root) != "svg":
        raise PlanError("is not an SVG", where=str(path), expected=_EXPECTED)
    return root


def read_svg(path: Path) -> list[VectorDrawing]:
    """What is named in an SVG; one drawing per CubiCasa floor, none where no wall or room is named.

    Raises PlanError.
    """
    root = svg_root(path)
    floors = [e for e in root.iter() if _said(e).split(" ")[0] in ("Floor", "Floorplan")]
    known = {id(floor) for floor in floors}
    inner = [e for e in floors if not any(id(child) in known for child in list(e.iter())[1:])]
    paper = paper_m_per_unit(root)
    is_full_size = paper is not None and is_house(root, paper)
    sheet, by_id = StyleSheet(root), {e.get("id", ""): e for e in root.iter()}
    drawings = []
    for top in inner or [root]:
        shapes = _Found(str(path), sheet, by_id, root)
        _visit(top, _matrix_above(root, top), "", shapes)
        if shapes.rooms or shapes.walls:
            drawings.append(
                VectorDrawing(
                    shapes.rooms, shapes.walls, shapes.openings, shapes.labels,
                    m_per_unit=paper if is_full_size else None, name=_said(top),
                    paper_m_per_unit=None if is_full_size else paper,
                )
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

    above = search(root, IDENTITY)
    return IDENTITY if above is None else above


def _said(element: Element) -> str:
    keys = ("class", "id", "{http://www.inkscape.org/namespaces/inkscape}label", "data-name")
    return " ".join(element.get(key, "") for key in keys).strip()


def _visit(
    element: Element, matrix: FloatArray, meaning: str, shapes: _Found, style: Style | None = None
) -> None:
    """Collect what this element and all in it draw. Matrix: from its own units to the root's."""
    name = local_name(element)
    style = shapes.sheet.style(element, style or Style())
    if not style.is_displayed and meaning != "room":
        return
    if name in _NOT_DRAWN and element is not shapes.shown:
        return
    matrix = matrix @ transform(element)
    said = _meaning(element)
    role = said or meaning
    if role == "skip":
        return
    if name == "text":
        _add_label(element, matrix, shapes)
        return
    if name == "use":
        _visit_used(element, matrix, role, shapes, style)
        return
    if name == "svg" and element not in (shapes.top, shapes.shown):
        matrix = matrix @ viewport(element)
    if said and name == "g" and _is_thing(element, said):
        _add_group(element, matrix, said, shapes)
        return
    if role and style.is_visible:
        _add_shape(element, matrix, role, shapes, style)
    for child in element:
        _visit(child, matrix, role, shapes, style)


def _visit_used(
    use: Element, matrix: FloatArray, meaning: str, shapes: _Found, style: Style
) -> None:
    """What a use repeats. Raises PlanError where all uses together repeat too much."""
    name = next((use.get(key, "") for key in _HREF if use.get(key)), "")
    shown = shapes.by_id.get(name.removeprefix("#")) if name.startswith("#") else None
    if shown is None or name in shapes.used:
        return
    shapes.repeated += sum(1 for _ in shown.iter())
    if shapes.repeated > _MOST_USED:
        raise PlanError(
            f"repeats more than {_MOST_USED:,} elements", where=shapes.where, expected=_EXPECTED,
            try_="flatten it, or export it as PNG",
        )  # fmt: skip
    outer, shapes.shown = shapes.shown, shown
    shapes.used.append(name)
    is_sheet = local_name(shown) in ("symbol", "svg")
    _visit(shown, matrix @ viewport(use, shown if is_sheet else use), meaning, shapes, style)
    shapes.used.pop()
    shapes.shown = outer


def _outlines(element: Element, shapes: _Found) -> Iterator[FloatArray]:
    """Counted before they are computed. Raises PlanError where all together are too many."""
    shapes.numbers += sum(len(numbers(element.get(key, ""))) for key in ("d", "points"))
    if shapes.numbers > _MOST_NUMBERS:
        raise PlanError(
            f"draws walls, rooms and openings with more than {_MOST_NUMBERS:,} numbers",
            where=shapes.where, expected=_EXPECTED, try_="simplify its paths, or export it as PNG",
        )  # fmt: skip
    return outlines(element)


def _meaning(element: Element) -> str:
    said = re.sub(r"[_\-]+|(?<=[a-z])(?=[A-Z])|\d+", " ", _said(element))
    return next((name for name, pattern in _MEANINGS if pattern.search(said)), "")


def _is_thing(group: Element, meaning: str) -> bool:
    """Whether a group is one door, window or room, and not all of them together."""
    shapes = [e for e in group if local_name(e) in ("polygon", "polyline", "rect", "path")]
    return meaning != "wall" and len(shapes) == 1 and bool(group.get("class") or group.get("id"))


def _add_group(group: Element, matrix: FloatArray, meaning: str, shapes: _Found) -> None:
    """A group's first shape is the thing itself; the rest draws leaves and names."""
    shape = next(e for e in group if local_name(e) in ("polygon", "polyline", "rect", "path"))
    for points in _outlines(shape, shapes):
        _add(meaning, _mapped(points, matrix @ transform(shape)), _said(group), shapes)
    for text in (e for e in group.iter() if local_name(e) == "text"):
        # Its place in a nested group is of no weight: it lies in the room it names.
        inner = _matrix_above(group, text)
        _add_label(text, matrix @ inner @ transform(text), shapes)
    for child in group:
        if meaning == "wall" or _meaning(child) in ("door", "window"):
            _visit(child, matrix, "", shapes)


def _mapped(points: FloatArray, matrix: FloatArray) -> FloatArray:
    """Points in the root's units, y up."""
    mapped = points @ matrix[:2, :2].T + matrix[:2, 2]
    return mapped * (1.0, -1.0)


def _add_shape(
    element: Element, matrix: FloatArray, meaning: str, shapes: _Found, style: Style
) -> None:
    """Add what one element draws."""
    drawn = [_mapped(points, matrix) for points in _outlines(element, shapes)]
    if meaning == "wall":
        size = float(np.sqrt(abs(np.linalg.det(matrix[:2, :2]))))
        shapes.walls += _walls(drawn, style, size)
        return
    for points in drawn:
        _add(meaning, points, _said(element), shapes)


def _walls(drawn: Sequence[FloatArray], style: Style, size: float) -> list[Polygon]:
    """Filled outlines, or lines as wide as drawn. size: units of the root in one of the element."""
    if style.is_filled and any(len(points) >= 3 for points in drawn):
        return filled(drawn, is_even_odd=style.is_even_odd)
    if style.stroke <= 0.0:
        return []
    half = style.stroke * size / 2
    lines = (LineString(points) for points in drawn)
    areas = (line.buffer(half, cap_style="square", join_style="mitre") for line in lines)
    return [polygon for area in areas for polygon in polygons_of(area)]


def _add(meaning: str, points: FloatArray, said: str, shapes: _Found) -> None:
    if meaning == "room" and len(points) >= 3:
        shapes.rooms.append(RoomShape(Polygon(points), _room_name(said)))
    elif meaning in ("door", "window", "passage"):
        opening = _opening(meaning, points)
        if opening is not None:
            shapes.openings.append(opening)


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


def _add_label(element: Element, matrix: FloatArray, shapes: _Found) -> None:
    said = " ".join(" ".join(_words(element)).split())
    x, y = (float((numbers(element.get(key, "0")) or [0.0])[0]) for key in ("x", "y"))
    if said:
        shapes.labels.append(Label(said, _mapped(np.array([[x, y]]), matrix)[0]))


def _words(element: Element) -> Iterator[str]:
    return (part for part in element.itertext())


def paper_m_per_unit(root: Element) -> float | None:
    """Metres on the page per unit of the root; None where its width is no length, as 100%."""
    match = re.fullmatch(r"\s*([\d.]+)\s*([a-z]+)\s*", root.get("width", ""))
    if not match or match[2] not in _M_PER_LENGTH:
        return None
    box = numbers(root.get("viewBox", ""))
    if not box:
        return _M_PER_CSS_PX
    width_m = float(match[1]) * _M_PER_LENGTH[match[2]]
    return width_m / box[2] if len(box) == 4 and min(width_m, box[2]) > 0.0 else None


def is_house(root: Element, m_per_unit: float) -> bool:
    """Whether a page is as wide as a house, and so is drawn at full size."""
    box = numbers(root.get("viewBox", ""))
    return len(box) == 4 and box[2] * m_per_unit >= _LEAST_HOUSE_M


# What an SVG's style sheets and attributes say of how its shapes are drawn -----------------------

_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_COMMENT = re.compile(r"/\*.*?\*/", re.S)
_SELECTOR = re.compile(r"([\w-]+|\*)?((?:[.#][\w-]+)*)")
_DECLARATION = re.compile(r"([\w-]+)\s*:\s*([^;!]+)")
_PROPERTIES = ("display", "visibility", "fill", "fill-rule", "stroke-width")
_INVISIBLE = ("none", "transparent")


@dataclass(frozen=True)
class _Rule:
    tag: str
    parts: frozenset[str]
    """Classes and ids, as ".wall" and "#walls"."""
    declared: Mapping[str, str]

    @property
    def weight(self) -> tuple[int, int, int]:
        """What overrules what: ids, classes, tags."""
        ids = sum(part.startswith("#") for part in self.parts)
        return ids, len(self.parts) - ids, int(bool(self.tag))


@dataclass(frozen=True)
class Style:
    """How an element is drawn; most of it is inherited from group to group."""

    stroke: float = 0.0
    """Width of lines, units of the element."""
    is_filled: bool = True
    is_even_odd: bool = False
    """By which rule outlines in one another are holes; else by their directions."""
    is_visible: bool = True
    is_displayed: bool = True
    """Not inherited: what is not displayed hides all in it."""


class StyleSheet:
    """The rules of an SVG's style elements: those for one tag, its classes and its id."""

    def __init__(self, root: Element) -> None:
        texts = ("".join(e.itertext()) for e in root.iter() if local_name(e) == "style")
        rules = (rule for text in texts for rule in _rules(_COMMENT.sub(" ", text)))
        self._rules = sorted(rules, key=lambda rule: rule.weight)

    def style(self, element: Element, outer: Style) -> Style:
        """The style of an element in one of the style `outer`."""
        said = self._declared(element)
        width = numbers(said.get("stroke-width", ""))
        fill, visibility = said.get("fill"), said.get("visibility")
        rule = said.get("fill-rule")
        return Style(
            width[0] if width else outer.stroke,
            fill not in _INVISIBLE if fill else outer.is_filled,
            rule == "evenodd" if rule else outer.is_even_odd,
            visibility == "visible" if visibility else outer.is_visible,
            said.get("display") != "none",
        )

    def _declared(self, element: Element) -> Mapping[str, str]:
        said = {name: element.get(name, "") for name in _PROPERTIES if element.get(name)}
        selectors = {f".{name}" for name in element.get("class", "").split()}
        selectors |= {f"#{element.get('id')}"}
        for rule in self._rules:
            if rule.tag in ("", local_name(element)) and rule.parts <= selectors:
                said |= rule.declared
        said |= _declarations(element.get("style", ""))
        return {name: value.strip().lower() for name, value in said.items()}


def _rules(text: str) -> Iterator[_Rule]:
    for selectors, body in _RULE.findall(text):
        for selector in selectors.split(","):
            match = _SELECTOR.fullmatch(selector.strip())
            if match and selector.strip():
                parts = frozenset(re.findall(r"[.#][\w-]+", match[2]))
                yield _Rule((match[1] or "").replace("*", ""), parts, _declarations(body))


def _declarations(text: str) -> dict[str, str]:
    return dict(_DECLARATION.findall(text))
