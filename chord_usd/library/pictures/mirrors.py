"""Mirrors: round, arched, framed, for bathrooms with a shelf or a cabinet; backs at +y."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.forms import (
    flat_rail,
    frame_rails,
    moulded_rail,
    outward,
)
from chord_usd.library.kit.model import Part, moving_part
from chord_usd.library.kit.moves import door
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    extruded,
    joined,
    lathe,
    rounded_slab,
)


def _upright(plate: Solid, front_y_m: float, thick_m: float) -> Solid:
    """A plate drawn lying over (x, z), stood up with its front in the plane front_y_m."""
    return plate.turned("x", 90).moved(y=front_y_m + thick_m)


def round_mirror(size_m: Size) -> tuple[Part, ...]:
    """A round glass in a slim round rim."""
    length, width, height = size_m
    radius, rim = length / 2, 0.014
    section = [
        (radius, 0.0),
        (radius, width - 0.002),
        (radius - 0.003, width),
        (radius - rim + 0.002, width),
        (radius - rim, width - 0.003),
        (radius - rim, 0.0),
    ]
    hoop = outward(lathe(section, 64, loop=True)).turned("x", 90)
    glass = outward(
        lathe(
            [
                (radius - rim + 0.004, 0.0),
                (radius - rim + 0.004, width - 0.008),
                (0.0, width - 0.008),
            ],
            64,
        )
    ).turned("x", 90)
    at = {"y": width / 2, "z": height / 2}
    return (
        Part("Frame", hoop.moved(**at), "frame", None),
        Part("Glass", glass.moved(**at), "mirror", None),
    )


def _arch(length: float, height: float, inset: float, steps: int = 24) -> FloatArray:
    """(N, 2) outline of an arch that stands on z = inset."""
    radius = length / 2 - inset
    turn = np.linspace(0.0, math.pi, steps + 1)
    top = np.stack([radius * np.cos(turn), height - length / 2 + radius * np.sin(turn)], axis=-1)
    return np.concatenate([[[-radius, inset], [radius, inset]], top])


def arched(size_m: Size, *, rail_m: float = 0.02) -> tuple[Part, ...]:
    """A glass with a round head in a flat frame."""
    length, width, height = size_m
    hole = _arch(length, height, rail_m)
    frame = extruded(_arch(length, height, 0.0), width, [hole])
    glass = extruded(_arch(length, height, rail_m - 0.004), width * 0.5)
    return (
        Part("Frame", _upright(frame, -width / 2, width), "frame", None),
        Part("Glass", _upright(glass, 0.0, width / 2), "mirror", None),
    )


def framed(size_m: Size, *, rail_m: float = 0.025, moulded: bool = False) -> tuple[Part, ...]:
    """A rectangular glass between mitred rails."""
    length, width, height = size_m
    section = moulded_rail(rail_m, width) if moulded else flat_rail(rail_m, width)
    frame = frame_rails(length, height, section).moved(y=width / 2)
    inner = (length - 2 * rail_m + 0.008, width * 0.3, height - 2 * rail_m + 0.008)
    glass = box(inner).moved(y=width / 2 - width * 0.15 - 0.001, z=rail_m - 0.004)
    parts = [Part("Frame", frame, "frame", None), Part("Glass", glass, "mirror", None)]
    if moulded:
        thin = rail_m * 0.16
        slip = frame_rails(
            length - 2 * rail_m + 0.004,
            height - 2 * rail_m + 0.004,
            flat_rail(thin, width * 0.42, 0.001),
        )
        parts.append(Part("Slip", slip.moved(y=width / 2, z=rail_m - 0.002), "slip", None))
    return tuple(parts)


def bare(size_m: Size) -> tuple[Part, ...]:
    """A frameless glass with bevelled rims, off the wall on a dark board."""
    length, width, height = size_m
    thick = 0.006
    glass = rounded_slab((length, height, thick), 0.012, 0.003, 5)
    back = box((length - 0.06, width - thick, height - 0.06))
    return (
        Part("Glass", _upright(glass, -width / 2, thick).moved(z=height / 2), "mirror", None),
        Part("Back", back.moved(y=thick / 2, z=0.03), "back", None),
    )


def with_shelf(size_m: Size) -> tuple[Part, ...]:
    """A framed bathroom mirror over a narrow shelf."""
    length, width, height = size_m
    board, deep = 0.02, 0.026
    rails = frame_rails(length - 0.02, height - board - 0.02, flat_rail(0.022, deep))
    glass = box((length - 0.058, 0.008, height - board - 0.058))
    shelf = rounded_slab((length, width, board), 0.012, 0.004, 4)
    lip = block((length - 0.03, 0.006, 0.014), 0.002).moved(y=-width / 2 + 0.012, z=board - 0.001)
    return (
        Part("Frame", rails.moved(y=width / 2, z=board + 0.02), "frame", None),
        Part("Glass", glass.moved(y=width / 2 - 0.008, z=board + 0.039), "mirror", None),
        Part("Shelf", shelf, "frame"),
        Part("Lip", lip, "frame", None),
    )


def cabinet(size_m: Size) -> tuple[Part, ...]:
    """A bathroom cabinet with mirrored doors."""
    length, width, height = size_m
    doors, thick = 2 if length > 0.55 else 1, 0.018
    body = block((length - 0.006, width - thick - 0.002, height - 0.006), 0.003)
    wide = length / doors
    leaves, glasses = [], []
    for index in range(doors):
        x = -length / 2 + wide * (index + 0.5)
        y = -width / 2 + thick / 2 + 0.001
        leaves.append(block((wide - 0.003, thick - 0.004, height), 0.002).moved(x, y + 0.002))
        glass = rounded_slab((wide - 0.005, height - 0.002, 0.004), 0.004, 0.0015, 3)
        glasses.append(_upright(glass, -width / 2, 0.004).moved(x, z=height / 2))
    case = body.moved(y=(thick + 0.002) / 2, z=0.003)
    swings = [door(leaf, hung="right" if n else "left") for n, leaf in enumerate(leaves)]
    return (
        Part("Body", case, "frame", None, hollow=(case,)),
        moving_part("Doors", leaves, "frame", swings, None),
        moving_part("Glass", glasses, "mirror", swings, None),
    )


def sunburst(size_m: Size) -> tuple[Part, ...]:
    """A round glass in a wreath of rays."""
    length, width, height = size_m
    outer, inner = length / 2, length * 0.3
    rays = []
    for index in range(40):
        reach = (outer - inner) * (1.0 if index % 2 == 0 else 0.72)
        ray = block((reach + 0.02, 0.012, 0.008), 0.002).moved(x=inner - 0.02 + (reach + 0.02) / 2)
        rays.append(ray.turned("z", 9.0 * index))
    hoop = outward(
        lathe(
            [
                (inner, 0.0),
                (inner, 0.016),
                (inner - 0.008, width),
                (inner - 0.022, width),
                (inner - 0.024, 0.0),
            ],
            48,
            loop=True,
        )
    )
    glass = outward(
        lathe([(inner - 0.018, 0.0), (inner - 0.018, width * 0.6), (0, width * 0.6)], 48)
    )
    at = {"y": width / 2, "z": height / 2}
    star = joined(rays).turned("x", 90).moved(y=-0.004)
    return (
        Part("Rays", star.moved(**at), "frame", None),
        Part("Frame", hoop.turned("x", 90).moved(**at), "frame", None),
        Part("Glass", glass.turned("x", 90).moved(**at), "mirror", None),
    )
