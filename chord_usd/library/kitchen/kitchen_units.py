"""Kitchen floor cabinets that line up into a run, and the refrigerator.

All base cabinets of a form share height, plinth, fronts and worktop, so that a row of them reads
as one kitchen. There is one form for each style of a home (kitchen_fronts.FORM_STYLES).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from chord_usd.library.bath.taps import SinkTap, sink_tap
from chord_usd.library.kit.joinery import FRONT_M, cells, colliders_around, plinth, shifted
from chord_usd.library.kit.model import Part, hollow_part
from chord_usd.library.kit.solids import Size, block, box, extruded, joined, pair, ring
from chord_usd.library.kitchen.kitchen_appliances import hob, microwave, oven
from chord_usd.library.kitchen.kitchen_fronts import (
    FrontForm,
    kitchen_fronts,
    reach_m,
)
from chord_usd.library.kitchen.sinks import apron_sink, drainer_sink, undermount_bowl

PLINTH_M = 0.1
_OVERHANG_M = 0.018
"""Least distance between fronts and the edge of the worktop."""

CORNER_M = 0.6
"""Of a cabinet in a corner that the other run hides."""
CORNER_FILLER_M = 0.05
"""Beside that, so that doors and drawers pass each other's handles."""

_APRON_M = 0.225
_DRAINER_FROM_M = 0.88


@dataclass(frozen=True)
class _Form:
    """What the cabinets of one form have in common."""

    fronts: FrontForm
    worktop_m: float
    tap: SinkTap

    def face_y(self, width: float) -> float:
        """Plane of the fronts' backs."""
        return -width / 2 + max(reach_m(self.fronts), _OVERHANG_M) + FRONT_M

    def fronts_height(self, size_m: Size) -> float:
        """Between plinth and worktop."""
        return size_m[2] - PLINTH_M - self.worktop_m - 0.004

    def body(self, size_m: Size) -> tuple[Part, ...]:
        """Plinth and carcass of a base cabinet."""
        length, width, height = size_m
        y = self.face_y(width)
        depth = width / 2 - y
        tall = height - PLINTH_M - self.worktop_m + 0.001
        case = block((length, depth, tall), 0.0015).moved(y=y + depth / 2, z=PLINTH_M)
        return plinth(size_m, PLINTH_M, inset_m=0.09), hollow_part("Body", case)

    def worktop(self, size_m: Size) -> Part:
        """A plate over the footprint, cut straight at both ends so that a run has no joints."""
        length, width, height = size_m
        low, soft, front = height - self.worktop_m, 0.003, -width / 2
        profile = [
            [-low, front + soft],
            [-low, width / 2],
            [-height, width / 2],
            [-height, front + soft],
            [0.3 * soft - height, front + 0.3 * soft],
            [soft - height, front],
            [-low - soft, front],
        ]
        # Drawn lying with z to the left, then stood up: the plate's axis becomes the length.
        plate = extruded(profile, length).turned("y", 90).moved(x=-length / 2)
        return Part("Worktop", plate, "worktop")


BAR = _Form("bar", 0.038, "swan")
HANDLELESS = _Form("handleless", 0.022, "square")
SHAKER = _Form("shaker", 0.034, "bridge")
SLATTED = _Form("slatted", 0.028, "slim")


def door_cabinet(
    size_m: Size, *, form: _Form, columns: int = 1, has_drawers: bool = True
) -> tuple[Part, ...]:
    """A base cabinet: a drawer over each door, or doors only."""
    length, width, _ = size_m
    y, tall = form.face_y(width), form.fronts_height(size_m)
    rows = (3.6, 1.0) if has_drawers else (1.0,)
    face = list(cells(length, tall, columns, rows, PLINTH_M + 0.002))
    upper = [cell for cell in face if cell.row == 1]
    return (
        *form.body(size_m),
        *kitchen_fronts([cell for cell in face if cell.row == 0], y, form.fronts),
        *(kitchen_fronts(upper, y, form.fronts, drawers=True) if upper else ()),
        form.worktop(size_m),
    )


def drawer_cabinet(size_m: Size, *, form: _Form) -> tuple[Part, ...]:
    """A base cabinet of three deep drawers."""
    length, width, _ = size_m
    face = list(cells(length, form.fronts_height(size_m), 1, (2, 2, 1), PLINTH_M + 0.002))
    return (
        *form.body(size_m),
        *kitchen_fronts(face, form.face_y(width), form.fronts, drawers=True),
        form.worktop(size_m),
    )


def pull_out_cabinet(size_m: Size, *, form: _Form) -> tuple[Part, ...]:
    """A narrow base cabinet that is drawn out whole."""
    length, width, _ = size_m
    face = list(cells(length, form.fronts_height(size_m), 1, z_m=PLINTH_M + 0.002))
    return (
        *form.body(size_m),
        *kitchen_fronts(face, form.face_y(width), form.fronts, drawers=True),
        form.worktop(size_m),
    )


def corner_cabinet(
    size_m: Size, *, form: _Form, at: int, hidden_m: float = 0.0, columns: int = 1
) -> tuple[Part, ...]:
    """A base cabinet in or beside the corner of two runs.

    at: 1 where the corner is at its right end (own x), -1 at its left one. hidden_m: what stands
    behind the other run there. A filler follows, so that fronts pass the handles of the other run.
    """
    length, width, _ = size_m
    y, tall = form.face_y(width), form.fronts_height(size_m)
    blind = hidden_m + CORNER_FILLER_M
    face = list(cells(length - blind, tall, columns, z_m=PLINTH_M + 0.002))
    if columns == 1 and at < 0:
        face = [replace(cell, column=1) for cell in face]  # hung away from the corner
    filler = block((CORNER_FILLER_M + 0.002, FRONT_M, tall - 0.004), 0.0015).moved(
        at * (length / 2 - hidden_m - CORNER_FILLER_M / 2), y - FRONT_M / 2, PLINTH_M + 0.004
    )
    return (
        *form.body(size_m),
        *kitchen_fronts(shifted(face, -at * blind / 2), y, form.fronts),
        Part("Filler", filler, "front", collider=None),
        form.worktop(size_m),
    )


def dishwasher(size_m: Size, *, form: _Form) -> tuple[Part, ...]:
    """A dishwasher behind a front of the kitchen, which falls open."""
    length, width, _ = size_m
    face = list(cells(length, form.fronts_height(size_m), 1, z_m=PLINTH_M + 0.002))
    return (
        *form.body(size_m),
        *kitchen_fronts(face, form.face_y(width), form.fronts, falls=True, name="Dishwasher_Door"),
        form.worktop(size_m),
    )


def cooker_cabinet(size_m: Size, *, form: _Form, gas: bool = True) -> tuple[Part, ...]:
    """A cabinet with a hob in its worktop, gas or electric, and an oven below."""
    length, width, height = size_m
    y, tall = form.face_y(width), form.fronts_height(size_m)
    oven_length = min(0.6, length) - 0.006
    side = (length - oven_length) / 2
    parts = [
        *form.body(size_m),
        *oven(oven_length, tall - 0.004, y, PLINTH_M + 0.004),
        form.worktop(size_m),
        *hob(length, width, height, gas=gas),
    ]
    if side > 0.1:
        fillers = pair(
            block((side - 0.006, FRONT_M, tall - 0.004), 0.0015).moved(
                y=y - FRONT_M / 2, z=PLINTH_M + 0.004
            ),
            x=(length - side) / 2,
        )
        parts.append(Part("Side_Fronts", joined(fillers), "front", colliders=tuple(fillers)))
    return tuple(parts)


def sink_cabinet(size_m: Size, *, form: _Form) -> tuple[Part, ...]:
    """A cabinet with a bowl in its worktop, a tap behind it, a drainer where there is room."""
    if form.fronts == "shaker":
        return _apron_cabinet(size_m, form)
    length, width, height = size_m
    y, tall = form.face_y(width), form.fronts_height(size_m)
    face = list(cells(length, tall, 2, z_m=PLINTH_M + 0.002))
    at_y, bowl_w = -0.035, min(0.4, width - 0.18)
    if length >= _DRAINER_FROM_M and form.fronts == "bar":
        bowl_l = length * 0.42
        sheet_l, sheet_w = length - 0.05, bowl_w + 0.05
        x = -sheet_l / 2 + bowl_l / 2 + 0.045
        bowl = drainer_sink(sheet_l, sheet_w, bowl_l, bowl_w, 0.17).moved(y=at_y, z=height)
        hole = (bowl_l - 0.004, bowl_w - 0.004, 0.055)
    else:
        bowl_l = min(0.54, length - 0.12)
        x = 0.0
        bowl = undermount_bowl(bowl_l, bowl_w, 0.19, form.worktop_m).moved(y=at_y, z=height)
        hole = (bowl_l, bowl_w, 0.024)
    cut = ring(*hole, 0.0, 5)[:, :2] + [x, at_y]
    outline = ring(length, width, 0.0, 0.0, 0)[:, :2]
    plate = extruded(outline, form.worktop_m, [cut]).moved(z=height - form.worktop_m)
    tap = sink_tap(form.tap).moved(x, at_y + bowl_w / 2 + 0.052, height - 0.001)
    return (
        *_sink_body(size_m, form),
        *kitchen_fronts(face, y, form.fronts),
        Part("Worktop", plate, "worktop", colliders=colliders_around(plate, [cut])),
        Part("Bowl", bowl, "steel", collider=None, above=bool(x)),
        Part("Tap", tap, "tap", collider=None, above=True),
    )


def _apron_cabinet(size_m: Size, form: _Form) -> tuple[Part, ...]:
    """A ceramic sink with its front to be seen, doors below it."""
    length, width, height = size_m
    y, tall = form.face_y(width), form.fronts_height(size_m)
    bowl_l, bowl_w = min(0.72, length - 0.09), min(0.46, width - 0.11)
    low = _APRON_M - form.worktop_m
    face = list(cells(length, tall - low, 2, z_m=PLINTH_M + 0.002))
    at_y = -width / 2 + bowl_w / 2 + 0.002
    cheek = (length - bowl_l) / 2 - 0.002
    fillers = pair(
        block((cheek, FRONT_M, low - 0.002), 0.0015).moved(
            y=y - FRONT_M / 2, z=PLINTH_M + 0.002 + tall - low
        ),
        x=(length - cheek) / 2,
    )
    front, back = at_y - bowl_w / 2, at_y + bowl_w / 2 + 0.001
    half, hole = length / 2, bowl_l / 2 + 0.001
    outline = [
        [-half, -width / 2],
        [-hole, -width / 2],
        [-hole, back],
        [hole, back],
        [hole, -width / 2],
        [half, -width / 2],
        [half, width / 2],
        [-half, width / 2],
    ]
    del front
    plate = extruded(outline, form.worktop_m).moved(z=height - form.worktop_m)
    bowl = apron_sink(bowl_l, bowl_w, _APRON_M).moved(y=at_y, z=height - 0.004)
    return (
        *_sink_body(size_m, form),
        *kitchen_fronts(face, y, form.fronts),
        Part("Side_Fronts", joined(fillers), "front", collider=None),
        Part(
            "Worktop", plate, "worktop", colliders=colliders_around(plate, [np.array(outline[1:5])])
        ),
        Part("Bowl", bowl, "sink", collider=None),
        Part(
            "Tap",
            sink_tap(form.tap).moved(y=back + 0.045, z=height - 0.001),
            "tap",
            collider=None,
            above=True,
        ),
    )


def _sink_body(size_m: Size, form: _Form) -> tuple[Part, ...]:
    """A carcass that leaves room for the bowl: low box, two cheeks and a back."""
    length, width, height = size_m
    y, upper = form.face_y(width), 0.235
    depth = width / 2 - y
    tall = height - PLINTH_M - form.worktop_m + 0.001
    low = block((length, depth, tall - upper), 0.0015).moved(y=y + depth / 2, z=PLINTH_M)
    z = PLINTH_M + tall - upper - 0.001
    cheeks = pair(
        box((0.02, depth - 0.002, upper + 0.001)).moved(y=y + depth / 2, z=z),
        x=(length - 0.022) / 2,
    )
    walls = [box((length - 0.03, 0.016, upper - 0.001)).moved(y=width / 2 - 0.01, z=z + 0.001)]
    if form.fronts != "shaker":
        walls.append(box((length - 0.03, 0.016, upper - 0.001)).moved(y=y + 0.01, z=z + 0.001))
    return (
        plinth(size_m, PLINTH_M, inset_m=0.09),
        hollow_part("Body", low),
        Part("Upper_Body", joined([*cheeks, *walls]), "body", collider=None),
    )


def electrical_cabinet(size_m: Size, *, form: _Form) -> tuple[Part, ...]:
    """A cabinet for built-in appliances: an oven low down; tall ones add a microwave above."""
    length, width, height = size_m
    y = form.face_y(width)
    if height < 1.2:
        tall, high = form.fronts_height(size_m), 0.58
        face = list(cells(length, tall - high - 0.006, 1, z_m=PLINTH_M + 0.002))
        return (
            *form.body(size_m),
            *kitchen_fronts(face, y, form.fronts, drawers=True),
            *oven(length - 0.008, high, y, PLINTH_M + 0.004 + tall - high - 0.006),
            form.worktop(size_m),
        )
    depth = width / 2 - y
    case = block((length, depth, height - PLINTH_M), 0.002).moved(y=y + depth / 2, z=PLINTH_M)
    oven_z, micro_z, top_z = 0.62, 1.22, 1.62
    low = list(cells(length, oven_z - PLINTH_M - 0.004, 1, (1, 1), PLINTH_M + 0.002))
    upper = list(cells(length, height - top_z - 0.004, 1, z_m=top_z))
    return (
        plinth(size_m, PLINTH_M, inset_m=0.09),
        hollow_part("Body", case),
        *kitchen_fronts(low, y, form.fronts, drawers=True),
        *oven(length - 0.008, 0.592, y, oven_z),
        *microwave(length - 0.008, 0.385, y, micro_z + 0.002),
        *kitchen_fronts(upper, y, form.fronts, low=True),
    )
