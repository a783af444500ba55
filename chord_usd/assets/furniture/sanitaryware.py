"""Toilets and bathtubs."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np

from chord_usd.assets.furniture.joinery import felt_around
from chord_usd.assets.furniture.rims import felt_bowl
from chord_usd.assets.furniture.taps import tub_tap
from chord_usd.assets.model import Part, Style, editions, moving_part
from chord_usd.assets.moves import Hinge, Leaf, Moving, lid
from chord_usd.assets.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    joined,
    lathe,
    loft,
    mirrored_pair,
    ring,
    rounded_slab,
    tube,
)
from chord_usd.scene.types import FloatArray

ToiletKind = Literal["coupled", "framed", "classic", "washlet"]
TubKind = Literal["built_in", "oval", "claw_foot"]

_SEAT_Z_M = 0.4
_LID_DEG = 88.0
_SKIRTED = (
    (0.78, 0.72, 0.0),
    (0.795, 0.735, 0.006),
    (0.8, 0.74, 0.06),
    (0.82, 0.765, 0.14),
    (0.87, 0.83, 0.23),
    (0.935, 0.915, 0.31),
    (0.985, 0.98, 0.36),
    (1.0, 1.0, 0.386),
    (0.985, 0.99, 0.396),
)
_WAISTED = (
    (0.66, 0.68, 0.0),
    (0.67, 0.69, 0.008),
    (0.64, 0.655, 0.025),
    (0.55, 0.58, 0.07),
    (0.54, 0.56, 0.13),
    (0.6, 0.62, 0.2),
    (0.76, 0.76, 0.27),
    (0.92, 0.93, 0.33),
    (0.985, 0.985, 0.362),
    (1.0, 1.0, 0.386),
    (0.98, 0.987, 0.396),
)


def _egg(length: float, width: float, z: float, back: float, sides: int = 44) -> FloatArray:
    """An egg-shaped ring: square-ish at the back (ends at y = back), round at the front."""
    angles = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    cos, sin = np.cos(angles), np.sin(angles)
    power = np.where(sin > 0.0, 0.55, 1.0)
    x = np.sign(cos) * np.abs(cos) ** np.where(sin > 0.0, 0.6, 0.92) * length / 2
    split = width * 0.42
    y = np.where(sin > 0.0, np.abs(sin) ** power * split, sin * (width - split))
    return np.stack([x, y + back - split, np.full(sides, z)], axis=-1)


def toilet(size_m: Size, *, kind: ToiletKind = "coupled") -> tuple[Part, ...]:
    """A toilet: bowl, seat and closed lid, cistern or frame with what flushes it.

    framed hides the cistern in a slim tall frame and skirts the bowl. It stands on its foot all
    the same: not every toilet is drawn right at its wall.
    """
    length, width, _ = size_m
    tank_w = 0.12 if kind == "framed" else 0.165
    back = width / 2 - tank_w
    bowl_l, bowl_w = min(length * 0.96, 0.375), width - tank_w
    shape = _WAISTED if kind == "classic" else _SKIRTED
    bowl = loft([_egg(bowl_l * sx, bowl_w * sy, z, back + 0.008) for sx, sy, z in shape])
    parts = [Part("Bowl", bowl, "ceramic", collider="convexHull")]
    parts += (
        _washlet_seat(bowl_l, bowl_w, back) if kind == "washlet" else _seat(bowl_l, bowl_w, back)
    )
    make = {"framed": _frame, "classic": _moulded_cistern}.get(kind, _cistern)
    return (*parts, *make(size_m, tank_w))


def _seat(length: float, width: float, back: float) -> list[Part]:
    """A seat and its lid, with the shadow between them, on two hinges."""
    long, deep = length * 1.005, width - 0.045
    seat = _plate(long, deep, _SEAT_Z_M - 0.002, 0.015, back - 0.036)
    plate = _plate(long * 0.99, deep * 0.99, _SEAT_Z_M + 0.0165, 0.017, back - 0.037, crown=0.006)
    hinge = cylinder(0.011, 0.034, 0.003, 18).moved(length * 0.2, back - 0.022, _SEAT_Z_M - 0.006)
    return [
        Part("Seat", seat, "seat", collider=None),
        moving_part("Lid", [plate], "seat", [lid(plate, opens_deg=_LID_DEG)]),
        Part("Hinges", mirrored_pair(hinge), "metal", collider=None),
    ]


def _washlet_seat(length: float, width: float, back: float) -> list[Part]:
    """A heated seat: its works behind the lid, keys at the side."""
    works_m = 0.13
    levels = ((0.97, 0.0), (1.0, 0.012), (1.0, 0.06), (0.97, 0.085), (0.9, 0.094))
    works = loft(
        [
            ring(length * s, works_m * s, 0.03, _SEAT_Z_M - 0.003 + z, 5)
            + np.array([0.0, back - works_m / 2, 0.0])
            for s, z in levels
        ]
    )
    front = back - works_m + 0.03
    deep = width - works_m - 0.01
    seat = _plate(length * 1.005, deep, _SEAT_Z_M - 0.002, 0.02, front)
    plate = _plate(length * 0.985, deep * 0.99, _SEAT_Z_M + 0.021, 0.024, front, crown=0.014)
    keys = block((0.046, 0.11, 0.018), 0.004).moved(length / 2 + 0.0, back - 0.1, _SEAT_Z_M + 0.032)
    buttons = [
        cylinder(0.007, 0.004, 0.001, 12).moved(
            length / 2, back - 0.13 + 0.028 * n, _SEAT_Z_M + 0.049
        )
        for n in range(3)
    ]
    del keys
    pad = block((0.02, 0.11, 0.03), 0.004).moved(length / 2 - 0.006, back - 0.09, _SEAT_Z_M + 0.018)
    marks = [b.moved(x=-0.006) for b in buttons]
    return [
        Part("Works", works, "seat"),
        Part("Seat", seat, "seat", collider=None),
        _works_lid(plate, back - works_m),
        Part("Pad", pad, "seat", collider=None),
        Part(
            "Hinges",
            joined([m.scaled(1, 1, 1).moved(z=-0.002) for m in marks]),
            "metal",
            collider=None,
        ),
    ]


def _works_lid(plate: Solid, works_y: float) -> Part:
    """A lid that turns about its upper face where it reaches the works, and goes on into them."""
    low, high = plate.bounds_m()
    leaf = Leaf("Lid", Hinge((0.0, works_y, float(high[2])), "x", -_LID_DEG), inside="nothing")
    deep = works_y - float(low[1]) - 0.002
    felt = box((float(high[0] - low[0]), deep, float(high[2] - low[2])))
    felt = felt.moved(y=float(low[1]) + deep / 2, z=float(low[2]))
    return Part("Lid", plate, "seat", moves=(Moving(leaf, plate, (felt,)),))


def _plate(
    length: float, width: float, z: float, thick: float, back: float, crown: float = 0.0
) -> Solid:
    """A seat or lid: the egg with soft edges, perhaps a little arched."""
    soft = min(0.006, thick / 3)
    rings = []
    for inset, level in (
        (soft, 0.0),
        (soft * 0.3, soft * 0.4),
        (0.0, soft),
        (0.0, thick - soft - crown),
        (soft * 0.3, thick - soft * 0.4 - crown),
        (soft, thick - crown),
    ):
        rings.append(_egg(length - 2 * inset, width - 2 * inset, z + level, back - inset))
    if crown:
        last = rings[-1]
        middle = last.mean(axis=0)
        for share in (0.7, 0.35):
            rings.append((last - middle) * share + middle + [0.0, 0.0, crown * (1.0 - share**2)])
    return loft(rings)


def _cistern(size_m: Size, tank_w: float) -> list[Part]:
    """A tank that widens upwards under a flat lid, two buttons in it."""
    length, width, height = size_m
    y, low, top = width / 2 - tank_w / 2, 0.385, height - 0.034
    levels = (
        (0.9, 0.94, low),
        (0.92, 0.96, low + 0.008),
        (0.96, 0.985, low + 0.16),
        (0.985, 0.99, top),
    )
    tank = loft(
        [ring(length * a, tank_w * b, 0.035, z, 6) + np.array([0.0, y, 0.0]) for a, b, z in levels]
    )
    cover = rounded_slab((length, tank_w, 0.032), 0.036, 0.01, 6, 3).moved(y=y, z=top + 0.002)
    rim = lathe([(0.032, 0), (0.032, 0.004), (0.028, 0.0055), (0, 0.0055)], 26)
    halves = [block((0.022, 0.044, 0.003), 0.001).moved(s * 0.0115, z=0.005) for s in (-1, 1)]
    button = joined([rim, *halves]).moved(0.0, y, height - 0.0035)
    return [
        Part("Cistern", tank, "ceramic"),
        Part("Cistern_Lid", cover, "ceramic"),
        Part("Flush_Button", button.scaled(1.0, 1.0, 1.0), "metal", collider=None, above=True),
    ]


def _moulded_cistern(size_m: Size, tank_w: float) -> list[Part]:
    """A tank with a profiled lid and a lever at its side."""
    length, width, height = size_m
    y, low, top = width / 2 - tank_w / 2, 0.385, height - 0.06
    levels = (
        (0.86, 0.84, low),
        (0.88, 0.86, low + 0.012),
        (0.9, 0.9, top - 0.01),
        (0.9, 0.9, top + 0.001),
    )
    tank = loft(
        [
            ring(length * a, tank_w * b, 0.02, z, 4)
            + np.array([0.0, y + tank_w * (1 - b) / 2 * 0.9, 0.0])
            for a, b, z in levels
        ]
    )
    lid = (
        (0.91, 0.9, 0.0),
        (0.93, 0.92, 0.006),
        (0.945, 0.94, 0.016),
        (0.99, 0.985, 0.022),
        (1.0, 1.0, 0.026),
        (1.0, 1.0, 0.04),
        (0.97, 0.97, 0.047),
        (0.88, 0.86, 0.055),
        (0.84, 0.8, 0.06),
    )
    cover = loft(
        [
            ring(length * a, tank_w * b, 0.02, top + z, 4) + np.array([0.0, y, 0.0])
            for a, b, z in lid
        ]
    )
    front = y - tank_w * 0.405
    hub = (
        cylinder(0.017, 0.02, 0.003, 20)
        .turned("x", 90)
        .moved(-length * 0.3, front + 0.004, top - 0.06)
    )
    arm = tube(
        [
            [-length * 0.3, front - 0.012, top - 0.06],
            [-length * 0.3 + 0.085, front - 0.016, top - 0.068],
        ],
        0.006,
        10,
    )
    return [
        Part("Cistern", tank, "ceramic"),
        Part("Cistern_Lid", cover, "ceramic"),
        Part("Flush_Lever", hub + arm, "metal", collider=None),
    ]


def _frame(size_m: Size, tank_w: float) -> list[Part]:
    """A panel as high as the piece that hides the cistern, with a plate of two buttons."""
    length, width, height = size_m
    y = width / 2 - tank_w / 2
    panel = block((length, tank_w, height - 0.02), 0.003).moved(y=y)
    cap = block((length, tank_w, 0.02), 0.003).moved(y=y, z=height - 0.02)
    front = width / 2 - tank_w
    plate = (
        rounded_slab((0.23, 0.15, 0.008), 0.006, 0.002, 3)
        .turned("x", 90)
        .moved(0.0, front + 0.001, height - 0.15)
    )
    keys = [
        rounded_slab((wide, 0.1, 0.004), 0.004, 0.001, 3)
        .turned("x", 90)
        .moved(x, front - 0.0055, height - 0.15)
        for wide, x in ((0.115, -0.0365), (0.062, 0.0575))
    ]
    return [
        Part("Cistern", panel, "ceramic"),
        Part("Cistern_Lid", cap, "cap"),
        Part("Flush_Button", joined([plate, *keys]), "metal", collider=None),
    ]


def bathtub(size_m: Size, *, kind: TubKind = "built_in") -> tuple[Part, ...]:
    """A hollow tub with drain, overflow and tap: with an apron, oval, or on four claws."""
    length, width, height = size_m
    rim = {"built_in": 0.065, "oval": 0.028, "claw_foot": 0.06}[kind]
    inner_l, inner_w = length - 2 * rim, width - 2 * rim
    corner = min(inner_w / 2, 0.2) if kind == "built_in" else inner_w / 2
    floor = 0.1 if kind != "claw_foot" else 0.17
    shape = (
        (0.0, 1.0),
        (0.006, 0.994),
        (0.016, 0.96),
        (0.045, 0.62),
        (0.085, 0.3),
        (0.12, 0.1),
        (0.19, 0.02),
        (0.28, 0.0),
    )
    hollow = [
        ring(
            inner_l - 2.6 * i,
            inner_w - 2 * i,
            max(corner - 0.6 * i, 0.02),
            floor + (height - 0.001 - floor) * share,
            10,
        )
        for i, share in shape
    ]
    drain = lathe([(0.03, 0), (0.03, 0.004), (0.022, 0.005), (0.02, 0.008), (0, 0.009)], 26)
    overflow = lathe([(0.033, 0), (0.033, 0.006), (0.028, 0.012), (0, 0.013)], 26).turned("y", 90)
    at = -inner_l / 2 + 0.036
    tub = loft([*_tub_skin(size_m, kind), *hollow])
    parts = [
        Part("Tub", tub, "ceramic", felt=_felt_tub(tub, hollow[0][:, :2], rim, floor, kind)),
        Part("Drain", drain.moved(-inner_l * 0.27, 0.0, floor + 0.0005), "metal", collider=None),
        Part(
            "Overflow",
            overflow.moved(at, 0.0, floor + (height - floor) * 0.74),
            "metal",
            collider=None,
        ),
    ]
    if kind == "built_in":
        inset = 0.03
        panel = block((length - 0.05, 0.012, height - 0.11), 0.003).moved(
            y=-width / 2 + 0.0065 + inset * 0.0 + 0.004, z=0.03
        )
        parts.append(Part("Panel", panel, "ceramic", collider=None))
    if kind == "claw_foot":
        parts += _claws(size_m)
    if kind == "oval":
        return (*parts, *_deck_tap(size_m))
    tap = tub_tap(cross=kind == "claw_foot").moved(
        0.0, width / 2 - rim / 2 - (0.011 if kind == "claw_foot" else 0.003), height - 0.003
    )
    return (*parts, Part("Tap", tap, "metal", collider=None, above=True))


def _felt_tub(
    tub: Solid, mouth: FloatArray, rim: float, floor: float, kind: TubKind
) -> tuple[Solid, ...]:
    """Its sides and its floor. mouth: (N, 2) where the hollow begins; rim: width around it."""
    if kind == "built_in":
        length, width = (float(side) for side in np.ptp(mouth, axis=0))
        return (*felt_around(tub, [mouth]), box((length, width, floor)))
    low_m, height = (float(corner[2]) for corner in tub.bounds_m())
    middles = mouth * (1.0 + rim / np.abs(mouth).max(axis=0))
    return felt_bowl(middles, rim, low_m, floor, height)


def _tub_skin(size_m: Size, kind: TubKind) -> list[FloatArray]:
    """Rings of a tub's outside from its foot to the rim."""
    length, width, height = size_m
    if kind == "built_in":
        return [
            ring(length - 0.024, width - 0.024, 0.012, 0.0, 10),
            ring(length - 0.024, width - 0.024, 0.012, height - 0.045, 10),
            ring(length, width, 0.02, height - 0.043, 10),
            ring(length, width, 0.02, height - 0.008, 10),
            ring(length - 0.005, width - 0.005, 0.022, height - 0.002, 10),
            ring(length - 0.016, width - 0.016, 0.025, height, 10),
        ]
    foot = 0.0 if kind == "oval" else 0.12
    outer = (
        (
            (0.8, 0.72, 0.0),
            (0.815, 0.735, 0.012),
            (0.85, 0.8, 0.2),
            (0.9, 0.88, 0.48),
            (0.95, 0.945, 0.76),
            (0.99, 0.988, 0.95),
            (1.0, 1.0, 0.985),
            (0.998, 0.996, 1.0),
        )
        if kind == "oval"
        else (
            (0.5, 0.36, 0.0),
            (0.66, 0.56, 0.02),
            (0.78, 0.74, 0.12),
            (0.86, 0.84, 0.35),
            (0.91, 0.89, 0.7),
            (0.925, 0.905, 0.9),
            (0.945, 0.925, 0.94),
            (0.985, 0.97, 0.955),
            (1.0, 1.0, 0.97),
            (0.998, 0.995, 0.99),
            (0.985, 0.97, 1.0),
        )
    )
    return [
        ring(length * a, width * b, width * b * 0.5, foot + (height - foot) * z, 10)
        for a, b, z in outer
    ]


def _claws(size_m: Size) -> list[Part]:
    """Four bent feet under a tub."""
    length, width, _ = size_m
    profile = [
        [0.0, 0.05, 0.155],
        [0.0, 0.012, 0.14],
        [0.0, -0.012, 0.105],
        [0.0, 0.012, 0.06],
        [0.0, 0.008, 0.03],
        [0.0, -0.018, 0.016],
    ]
    leg = tube(profile, 0.016, 12)
    ball = lathe([(0, 0), (0.016, 0.002), (0.023, 0.014), (0.018, 0.028), (0, 0.034)], 18).moved(
        y=-0.018
    )
    feet = []
    for sx in (-1, 1):
        for sy, turn in ((-1, 24.0 * sx), (1, 180.0 - 24.0 * sx)):
            feet.append((leg + ball).turned("z", turn).moved(sx * length * 0.3, sy * width * 0.27))
    return [Part(f"Foot_{n}", foot, "metal") for n, foot in enumerate(feet, start=1)]


def _deck_tap(size_m: Size) -> list[Part]:
    """A slender column that stands behind the tub on its rim, spout over the water."""
    from chord_usd.assets.furniture.taps import tall_basin_tap

    _, width, height = size_m
    tap = tall_basin_tap(0.2).moved(0.0, width / 2 - 0.0285, height - 0.004)
    return [Part("Tap", tap, "metal", collider=None, above=True)]


_CERAMIC = {
    "white": {"ceramic": "ceramic", "seat": "plastic_white", "metal": "chrome", "cap": "ceramic"},
    "black_metal": {
        "ceramic": "ceramic",
        "seat": "plastic_white",
        "metal": "black_metal",
        "cap": "black",
    },
    "brass": {"ceramic": "ceramic", "seat": "plastic_white", "metal": "brass", "cap": "marble"},
}
_WOODEN_SEAT = {
    "walnut": {"ceramic": "ceramic", "seat": "walnut", "metal": "brass"},
    "oak": {"ceramic": "ceramic", "seat": "oak", "metal": "chrome"},
    "white": {"ceramic": "ceramic", "seat": "plastic_white", "metal": "chrome"},
}
_COUPLED = Style("Toilet", toilet, _CERAMIC, 0.8, ("scandinavian", "industrial"))
_FRAMED = Style(
    "Toilet_Wall_Frame", partial(toilet, kind="framed"), _CERAMIC, 0.85, ("modern", "industrial")
)
_CLASSIC = Style(
    "Toilet_Classic", partial(toilet, kind="classic"), _WOODEN_SEAT, 0.82, ("classic",)
)
_WASHLET = Style("Toilet_Washlet", partial(toilet, kind="washlet"), _CERAMIC, 0.78, ("japanese",))
_TUB = Style("Bathtub_Built_In", bathtub, _CERAMIC, 0.56)
_OVAL = Style(
    "Bathtub_Oval",
    partial(bathtub, kind="oval"),
    _CERAMIC,
    0.58,
    ("modern", "scandinavian", "japanese"),
)
_CLAWS = Style(
    "Bathtub_Claw_Foot",
    partial(bathtub, kind="claw_foot"),
    _CERAMIC,
    0.6,
    ("classic", "industrial"),
)

_TUBS_M = (1.4, 1.5, 1.6, 1.7, 1.8)
DESIGNS = (
    *(
        design
        for style in (_COUPLED, _FRAMED, _CLASSIC, _WASHLET)
        for design in (
            *editions("toilet", (style,), (0.37,), (0.54, 0.6)),
            *editions("toilet", (style,), (0.4,), (0.63, 0.68, 0.74)),
        )
    ),
    *editions("bathtub", (_TUB,), (1.33, *_TUBS_M), (0.72, 0.8, 0.87)),
    *editions("bathtub", (_OVAL, _CLAWS), _TUBS_M, (0.75, 0.85)),
)
