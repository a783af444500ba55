"""Sweet Home 3D (.sh3d): a zip with Home.xml; lengths in centimetres, y down, angles clockwise."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from shapely.geometry import LineString, Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.archives import Archive
from chord_usd.base.scene.piece_names import piece_named
from chord_usd.base.scene.stair_places import StairShape
from chord_usd.base.scene.storeys import StairForm
from chord_usd.base.scene.types import FloatArray, OpeningKind
from chord_usd.base.scene.units import m_from_cm, wrap_deg
from chord_usd.line.plan.vector.safe_xml import LARGEST_BYTES, local_name, parse_xml
from chord_usd.line.plan.vector.shapes import (
    FARTHEST,
    MOST_SHAPES,
    OpeningShape,
    PieceShape,
    RoomShape,
    VectorDrawing,
    too_many_shapes,
)

_EXPECTED = "a Sweet Home 3D file (.sh3d)"
_WINDOW_NAMES = re.compile(r"window|fenster|fen[eê]tre|ventana|janela|fönster|ikkuna|窗|窓", re.I)
_DOOR_NAMES = re.compile(r"door|t(?:ü|u)r|porte|puerta|porta|dörr|ovi|门|門|ドア", re.I)
_PASSAGE_NAMES = re.compile(r"opening|doorway|arch", re.I)
_SPIRAL_NAMES = re.compile(r"spiral|wendel|colima|chiocciola|caracol|spil|snurr", re.I)
_STAIR_NAMES = re.compile(
    r"stair|treppe|escalier|escalera|scala|trap\b|trappa|portaat|schody", re.I
)
_SILL_CM = 20.0


def read_sweethome(path: Path) -> list[VectorDrawing]:
    """One drawing per level, in the file's order. Raises PlanError."""
    home = parse_xml(_home_xml(path), str(path), _EXPECTED)
    levels = {e.get("id"): e for e in home if local_name(e) == "level"}
    parts: dict[str | None, list[Element]] = defaultdict(list)
    for element in home.iter():
        if local_name(element) in ("wall", "room", "doorOrWindow", "pieceOfFurniture"):
            parts[element.get("level")].append(element)
    if sum(map(len, parts.values())) > MOST_SHAPES:
        raise too_many_shapes(path)
    if not parts:
        raise PlanError("holds neither walls nor rooms", where=str(path), expected=_EXPECTED)
    try:
        return [_drawing(parts[key], levels.get(key)) for key in parts]
    except ValueError as error:
        raise PlanError(f"is damaged ({error})", where=str(path), expected=_EXPECTED) from error


def _home_xml(path: Path) -> bytes:
    with Archive(path, PlanError, expected=_EXPECTED) as archive:
        if "Home.xml" not in archive.names:
            raise PlanError(
                "holds no Home.xml", where=str(path), expected=_EXPECTED,
                try_="save it again with Sweet Home 3D 5.3 or later",
            )  # fmt: skip
        return archive.read("Home.xml", LARGEST_BYTES)


def _drawing(elements: list[Element], level: Element | None) -> VectorDrawing:
    by_name: dict[str, list[Element]] = defaultdict(list)
    for element in elements:
        by_name[local_name(element)].append(element)
    return VectorDrawing(
        rooms=[room for e in by_name["room"] if (room := _room(e)) is not None],
        walls=[wall for e in by_name["wall"] if not (wall := _wall(e)).is_empty],
        openings=[_opening(e) for e in by_name["doorOrWindow"]],
        stairs=[_stair(e) for e in elements if _is_stair(e)],
        pieces=[p for e in by_name["pieceOfFurniture"] if (p := _piece(e)) is not None],
        m_per_unit=m_from_cm(1.0),
        name="" if level is None else level.get("name", ""),
        elevation=0.0 if level is None else _number(level, "elevation"),
    )


def _number(element: Element, key: str, otherwise: float = 0.0) -> float:
    value = float(element.get(key, otherwise))
    if not abs(value) <= FARTHEST:
        raise ValueError(f"{local_name(element)}: {key} is {value}")
    return value


def _point(element: Element, x: str, y: str) -> FloatArray:
    return np.array([_number(element, x), -_number(element, y)])


def _wall(element: Element) -> Polygon:
    start, stop = _point(element, "xStart", "yStart"), _point(element, "xEnd", "yEnd")
    thickness = _number(element, "thickness", 7.5)
    # Ends reach half a thickness on, so that walls that meet at a corner close it.
    return LineString([start, stop]).buffer(thickness / 2, cap_style="square")


def _room(element: Element) -> RoomShape | None:
    points = [_point(child, "x", "y") for child in element if local_name(child) == "point"]
    return RoomShape(Polygon(points), element.get("name", "")) if len(points) >= 3 else None


def _is_stair(element: Element) -> bool:
    said = f"{element.get('catalogId', '')} {element.get('name', '')}"
    return local_name(element) == "pieceOfFurniture" and bool(_STAIR_NAMES.search(said))


def _piece(element: Element) -> PieceShape | None:
    """A piece that stands on the floor; None for stairs and unknown names."""
    name = piece_named(element.get("name", "")) or piece_named(element.get("catalogId", ""))
    if _is_stair(element) or name is None or _number(element, "elevation") > _SILL_CM:
        return None
    return PieceShape(
        name, _point(element, "x", "y"), max(_number(element, "width"), 1.0),
        max(_number(element, "depth"), 1.0), wrap_deg(-math.degrees(_number(element, "angle"))),
    )  # fmt: skip


def _stair(element: Element) -> StairShape:
    center, angle = _point(element, "x", "y"), -_number(element, "angle")
    along = np.array([math.cos(angle), math.sin(angle)]) * _number(element, "width") / 2
    across = np.array([-math.sin(angle), math.cos(angle)]) * _number(element, "depth") / 2
    corners = [-along - across, along - across, along + across, -along + across]
    said = f"{element.get('catalogId', '')} {element.get('name', '')}"
    forms: tuple[StairForm, ...] = ("spiral",) if _SPIRAL_NAMES.search(said) else ()
    return StairShape(Polygon([center + corner for corner in corners]), forms=forms)


def _opening(element: Element) -> OpeningShape:
    center, width = _point(element, "x", "y"), _number(element, "width")
    angle = -_number(element, "angle")
    half = np.array([math.cos(angle), math.sin(angle)]) * width / 2
    base = _number(element, "elevation")
    return OpeningShape(
        _kind(element, base), center - half, center + half, base=base,
        height=_number(element, "height", 210.0),
    )  # fmt: skip


def _kind(element: Element, base_cm: float) -> OpeningKind:
    said = f"{element.get('catalogId', '')} {element.get('name', '')}"
    if _WINDOW_NAMES.search(said) and not _DOOR_NAMES.search(said):
        return "window"
    if _DOOR_NAMES.search(said):
        return "door"
    if _PASSAGE_NAMES.search(said):
        return "passage"
    return "window" if base_cm > _SILL_CM else "door"
