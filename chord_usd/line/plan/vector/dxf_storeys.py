"""Storeys in a DXF drawing: layers that begin with their names, as chord-usd writes them."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from shapely.geometry import Polygon
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.stair_places import StairShape
from chord_usd.base.scene.storeys import StairForm

_STOREY = re.compile(r"(Storey_\d{1,2})-")
_STEPS = "-STAIRS"
_TOUCH = 0.01
"""Steps that are no farther apart are of one stair; in units, which are metres."""

_RECTANGULAR = 0.95
"""Share of the least rectangle around it that a step fills, where it is not tapered."""


def by_storey(flat: Sequence[Any]) -> list[tuple[str, list[Any]]]:
    """What is drawn of each storey, by layers that begin with its name, as chord-usd writes them;
    all of it, without a name, where no layer does."""
    by_name: dict[str, list[Any]] = {}
    for entity in flat:
        named = _STOREY.match(entity.dxf.layer) if entity.dxf.hasattr("layer") else None
        if named:
            by_name.setdefault(named[1], []).append(entity)
    return sorted(by_name.items()) or [("", list(flat))]


def stairs_of(
    entities: Sequence[Any], points_of: Callable[[Any], list[tuple[float, float]]]
) -> list[StairShape]:
    """The stairs up from a storey, by the outlines of their steps."""
    steps = [
        (float(entity.dxf.elevation), Polygon(points))
        for entity in entities
        if entity.dxftype() == "LWPOLYLINE" and entity.closed and entity.dxf.layer.endswith(_STEPS)
        and len(points := points_of(entity)) > 3
    ]  # fmt: skip
    shapes = []
    for part in polygons_of(unary_union([area.buffer(_TOUCH) for _, area in steps])):
        part_steps = sorted((row for row in steps if part.covers(row[1])), key=lambda row: row[0])
        ends = [np.array(area.centroid.coords[0]) for _, area in (part_steps[0], part_steps[-1])]
        rise = float(np.hypot(*(ends[1] - ends[0])))
        up = (ends[1] - ends[0]) / rise if rise > 0.0 else None
        are_tapered = [_is_tapered(area) for _, area in part_steps]
        forms: tuple[StairForm, ...] = ("winder_L", "winder_U") if any(are_tapered) else ()
        forms = ("spiral",) if all(are_tapered) else forms
        whole = max(polygons_of(part.buffer(-_TOUCH)), key=lambda area: area.area)
        shapes.append(StairShape(whole, up, (ends[0], ends[1]), forms))
    return shapes


def _is_tapered(step: Polygon) -> bool:
    return bool(step.area < _RECTANGULAR * step.minimum_rotated_rectangle.area)
