"""Hoods over cookers: chimneys, leaning panes, mantels, built into a cabinet."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.joinery import FRONT_M, cells
from chord_usd.library.kit.model import Part, hollow_part
from chord_usd.library.kit.solids import (
    Size,
    block,
    box,
    cylinder,
    extruded,
    joined,
    loft,
    pair,
    ring,
)
from chord_usd.library.kitchen.kitchen_fronts import (
    FrontForm,
    kitchen_fronts,
    reach_m,
)

_WIDEST_DOOR_M = 0.5


def _shifted_ring(
    long: float, deep: float, back: float, z: float, radius: float = 0.004
) -> np.ndarray:
    """A rectangle whose back side lies at y = back."""
    return ring(long, deep, radius, z, 1) + np.array([0.0, back - deep / 2, 0.0])


def chimney_hood(size_m: Size) -> tuple[Part, ...]:
    """A flat steel canopy under a chimney."""
    length, depth, height = size_m
    back = depth / 2
    levels = ((length, depth, 0.0), (length, depth, 0.05), (0.3, 0.26, 0.2), (0.296, 0.256, 0.21))
    canopy = loft([_shifted_ring(long, far, back, z) for long, far, z in levels])
    chimney = block((0.27, 0.23, height - 0.2), 0.002).moved(y=back - 0.116, z=0.2)
    sleeve = block((0.278, 0.238, height * 0.4), 0.002).moved(y=back - 0.121, z=0.198)
    return (
        Part("Canopy", canopy, "metal"),
        Part("Chimney", chimney + sleeve, "metal"),
        *_underside(length, depth, back, front=-depth / 2),
    )


def _underside(
    length: float, depth: float, back: float, front: float, z: float = 0.0
) -> tuple[Part, ...]:
    """Filters, lights and keys of a hood whose underside is at z."""
    filters = pair(
        block((length * 0.4, depth * 0.6, 0.006), 0.001).moved(y=back - depth * 0.45, z=z - 0.003),
        x=length * 0.21,
    )
    lights = pair(
        cylinder(0.028, 0.004, 0.0, 16).moved(y=front + 0.055, z=z - 0.002), x=length * 0.3
    )
    keys = [
        cylinder(0.006, 0.004, 0.001, 10).turned("x", 90).moved(0.025 * n, front + 0.001, z + 0.025)
        for n in range(-2, 3)
    ]
    return (
        Part("Filters", joined(filters), "filter", collider=None),
        Part("Lights", joined(lights), "glow", collider=None),
        Part("Keys", joined(keys), "dark_glass", collider=None),
    )


def slanted_hood(size_m: Size) -> tuple[Part, ...]:
    """A leaning pane of black glass before a slim chimney."""
    length, depth, height = size_m
    back, front = depth / 2, -depth / 2
    rise = 0.42
    side = [[front + 0.02, 0.0], [back, 0.0], [back, rise], [back - 0.18, rise]]
    body = extruded(side, length * 0.8).turned("x", 90).turned("z", 90).moved(x=-length * 0.4)
    lean = np.degrees(np.arctan2(rise, depth - 0.2))
    long = float(np.hypot(rise, depth - 0.2))
    pane = block((length, long + 0.02, 0.008), 0.002).moved(y=long / 2).turned("x", lean)
    pane = pane.moved(y=front + 0.006, z=0.004)
    chimney = block((0.26, 0.2, height - rise + 0.002), 0.002).moved(y=back - 0.1, z=rise - 0.002)
    keys = (
        box((0.12, 0.012, 0.001))
        .moved(y=0.06, z=0.008)
        .turned("x", lean)
        .moved(y=front + 0.006, z=0.004)
    )
    return (
        Part("Body", body, "metal"),
        Part("Pane", pane, "dark_glass"),
        Part("Chimney", chimney, "metal"),
        Part("Keys", keys, "glow", collider=None),
    )


def built_in_hood(size_m: Size, *, form: FrontForm) -> tuple[Part, ...]:
    """A wall cabinet whose underside draws: a slim steel lip below its doors."""
    length, depth, height = size_m
    lip = 0.04
    y = -depth / 2 + reach_m(form) + FRONT_M
    case = block((length, depth / 2 - y, height - lip), 0.002).moved(y=(depth / 2 + y) / 2, z=lip)
    columns = 1 if length <= _WIDEST_DOOR_M else 2
    face = list(cells(length, height - lip - 0.004, columns, z_m=lip + 0.002))
    plate = block((length, depth - 0.004, lip - 0.002), 0.003).moved(y=0.002)
    return (
        hollow_part("Body", case),
        *kitchen_fronts(face, y, form, low=True),
        Part("Lip", plate, "metal"),
        *_underside(length, depth, depth / 2, front=-depth / 2 + 0.004),
    )


def mantel_hood(size_m: Size) -> tuple[Part, ...]:
    """A plastered mantel on a moulded shelf, as in a country kitchen."""
    length, depth, height = size_m
    back = depth / 2
    levels = [
        (length - 0.05, depth - 0.03, 0.1),
        (length - 0.07, depth - 0.045, 0.12),
        (length * 0.66, depth * 0.72, height * 0.5),
        (length * 0.52, depth * 0.62, height * 0.8),
        (length * 0.5, depth * 0.6, height),
    ]
    shelf = [
        (length - 0.06, depth - 0.035, 0.0),
        (length - 0.05, depth - 0.03, 0.02),
        (length - 0.04, depth - 0.025, 0.055),
        (length - 0.012, depth - 0.012, 0.07),
        (length, depth, 0.076),
        (length, depth, 0.098),
        (length - 0.006, depth - 0.004, 0.102),
    ]
    hood = loft([_shifted_ring(a, b, back - 0.001, z) for a, b, z in levels])
    return (
        Part("Mantel", hood, "plaster"),
        Part("Shelf", loft([_shifted_ring(a, b, back, z) for a, b, z in shelf]), "front"),
        *_underside(length - 0.1, depth - 0.06, back, front=-depth / 2 + 0.02)[:2],
    )
