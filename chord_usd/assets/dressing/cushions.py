"""Cushions that stand on sofas and beds, leaning back a little; throws over a bed's foot
or a seat's edge.

They are soft: what they sink into would be pushed away by their colliders, so they have none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from chord_usd.assets.cloth.stored import Cloth, stored
from chord_usd.assets.dressing.textiles import TEXTILES, dyed
from chord_usd.assets.model import Design, Part
from chord_usd.assets.solids import Size, Solid, lathe, loft
from chord_usd.scene.types import FloatArray, frozen_array

_LEAN_DEG = 72.0
_CORD_M = 0.0045


def cushion(size_m: Size, *, cloth: str, piped: bool = False, sag: float = 0.0) -> tuple[Part, ...]:
    """A stuffed cushion standing on its edge; sag: share by which its top sinks in the middle."""
    length, _, _ = size_m
    bag = stored(cloth)
    low, high = bag.solid.bounds_m()
    factor = length / float(high[0] - low[0])
    bag = bag.scaled(factor, factor, factor)
    solids = [_sagging(bag.solid, sag)]
    if piped:
        solids.append(_sagging(_cord(bag), sag))
    # Its underside becomes its back; then it is brought to its size as a whole.
    upright = [one.turned("x", _LEAN_DEG) for one in solids]
    bounds = np.array([one.bounds_m() for one in upright])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    middle = (low + high) / 2
    scale = np.array(size_m) / (high - low)
    placed = [
        one.moved(-float(middle[0]), -float(middle[1]), -float(low[2])).scaled(*scale)
        for one in upright
    ]
    parts = [Part("Cushion", placed[0], "cloth", None, uvs=bag.corner_uvs_m())]
    if piped:
        parts.append(Part("Piping", placed[1], "cord", None))
    return tuple(parts)


def _sagging(solid: Solid, sag: float) -> Solid:
    """The edge that will be on top gives way in the middle."""
    points = solid.points_m.copy()
    low, high = points.min(axis=0), points.max(axis=0)
    x = 2 * (points[:, 0] - low[0]) / (high[0] - low[0]) - 1
    up = (points[:, 1] - low[1]) / (high[1] - low[1])
    points[:, 1] -= sag * (high[1] - low[1]) * up**2 * np.exp(-((x / 0.45) ** 2))
    return Solid(frozen_array(points), solid.faces)


def _cord(bag: Cloth) -> Solid:
    """A cord along the seam: where the two sides of the bag meet."""
    uvs = bag.uvs_m
    half = np.abs(uvs).max(axis=0)
    on_edge = np.flatnonzero((np.abs(uvs) > half - 1e-4).any(axis=1))
    around = np.arctan2(uvs[on_edge, 1] / half[1], uvs[on_edge, 0] / half[0])
    path = bag.solid.points_m[on_edge[np.argsort(around)]]
    ahead, behind = np.roll(path, -1, axis=0), np.roll(path, 1, axis=0)
    along = ahead - behind
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = np.cross(along, [0.0, 0.0, 1.0])
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)
    up = np.cross(out, along)
    rings = [
        path + _CORD_M * (math.cos(a) * out + math.sin(a) * up)
        for a in np.linspace(0.0, 2 * math.pi, 6, endpoint=False)
    ]
    sections = np.stack(rings, axis=1)
    return loft(list(sections[::-1]), loop=True)


def bolster(size_m: Size) -> tuple[Part, ...]:
    """A roll with gathered ends and a button in each."""
    length, width, height = size_m
    radius, half = min(width, height) / 2, length / 2
    profile = [(0.012, -half + 0.012)]
    for share in (0.3, 0.6, 0.85):
        profile.append((radius * share, -half + 0.006 * (1 - share)))
    profile += [(radius * 0.96, -half + 0.012), (radius, -half + 0.03), (radius * 0.985, 0.0),
                (radius, half - 0.03), (radius * 0.96, half - 0.012)]  # fmt: skip
    for share in (0.85, 0.6, 0.3):
        profile.append((radius * share, half - 0.006 * (1 - share)))
    profile.append((0.012, half - 0.012))
    roll = lathe(profile, 36)
    roll = _gathered(roll, radius, half).turned("y", 90)
    stud = lathe([(0.012, -0.004), (0.018, 0.004), (0.012, 0.009), (0.0, 0.01)], 14)
    studs = [stud.turned("y", s * 90).moved(s * (half - 0.011), 0.0, radius) for s in (-1, 1)]
    return (
        Part("Cushion", roll.moved(z=radius), "cloth", None),
        Part("Buttons", studs[0] + studs[1], "cord", None),
    )


def _gathered(roll: Solid, radius: float, half: float) -> Solid:
    """Small pleats in the ends."""
    points = roll.points_m.copy()
    around = np.arctan2(points[:, 1], points[:, 0])
    near = np.clip((np.abs(points[:, 2]) - half + 0.025) / 0.02, 0.0, 1.0)
    points[:, 2] -= np.sign(points[:, 2]) * 0.005 * near * (1 + np.sin(18 * around))
    points[:, :2] *= (1.0 + 0.008 * np.sin(3 * around + 40 * points[:, 2]))[:, None]
    points[:, :2] *= radius / np.abs(points[:, :2]).max()
    return Solid(frozen_array(points), roll.faces)


def bed_throw(size_m: Size, *, fringed: bool = False) -> tuple[Part, ...]:
    """A throw across a bed's foot; its hems hang down at both sides, the lowest at z = 0."""
    length, width, height = size_m
    simulated = 1.6 if length >= 1.3 else 1.0
    cloth = stored(f"throw_bed_{100 * simulated:.0f}")
    points = cloth.solid.points_m.copy()
    more = (length - float(np.ptp(points[:, 0]))) / 2
    inner = simulated / 2 - 0.1
    shift = more * np.clip(points[:, 0] / inner, -1.0, 1.0)
    uvs = cloth.uvs_m + np.stack([more * np.clip(cloth.uvs_m[:, 0] / inner, -1, 1), 0 * shift], -1)
    points[:, 0] += shift
    low, high = points.min(axis=0), points.max(axis=0)
    points -= [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]
    span = high - low
    points *= [length / span[0], width / span[1], height / span[2]]
    solid = Solid(frozen_array(points), cloth.solid.faces)
    parts = [Part("Throw", solid, "cloth", None, uvs=_corners(uvs, solid))]
    return tuple(parts)


def seat_throw(size_m: Size) -> tuple[Part, ...]:
    """A throw on a seat that hangs over its front edge, the lower hem at z = 0."""
    cloth = stored("throw_seat")
    low, high = cloth.solid.bounds_m()
    cloth = cloth.moved(*(-(low + high) / 2 * [1, 1, 0] - low * [0, 0, 1]))
    cloth = cloth.scaled(*(np.array(size_m) / (high - low)))
    return (Part("Throw", cloth.solid, "cloth", None, uvs=cloth.corner_uvs_m()),)


def _corners(uvs: FloatArray, solid: Solid) -> FloatArray:
    return uvs[solid.faces.reshape(-1)]


_MODERN = ("teal_velvet", "mustard_velvet", "rust_velvet", "navy_velvet", "grey_cloth",
           "charcoal_cloth", "cream_boucle")  # fmt: skip
_SCANDI = ("sage_linen", "blush_linen", "blue_linen", "mustard_linen", "linen", "white_cotton",
           "grey_wool", "oat_boucle")  # fmt: skip
_CLASSIC = ("burgundy_velvet", "navy_velvet", "forest_velvet", "gold_velvet", "cream_cloth",
            "beige_linen")  # fmt: skip
_LOFT = ("rust_cloth", "mustard_linen", "tan_leather", "teal_linen", "charcoal_wool",
         "grey_cloth", "black_linen")  # fmt: skip
_EARTH = ("moss_linen", "indigo_linen", "charcoal_linen", "terracotta_linen", "linen",
          "oat_linen", "beige_cloth")  # fmt: skip
_CREAM = {"cord": "cream_cloth"}
_GOLD = {"cord": "gold_cotton"}


def _cushions() -> Iterator[Design]:
    full = partial(cushion, cloth="cushion_square")
    slack = partial(cushion, cloth="cushion_slack", sag=0.1)
    low = partial(cushion, cloth="cushion_lumbar")
    piped = partial(full, piped=True)
    kinds: tuple[tuple[Any, ...], ...] = (
        ("Velvet", full, _MODERN, {}, ("modern",), ((0.5, 0.5), (0.42, 0.42))),
        ("Linen", slack, _SCANDI, {}, ("scandinavian",), ((0.5, 0.5), (0.44, 0.44))),
        ("Piped", piped, _CLASSIC, _GOLD, ("classic",), ((0.5, 0.5), (0.42, 0.42))),
        ("Canvas", slack, _LOFT, {}, ("industrial",), ((0.5, 0.5), (0.44, 0.44))),
        ("Zabuton", full, _EARTH, {}, ("japanese",), ((0.48, 0.48), (0.4, 0.4))),
        ("Lumbar", low, _MODERN, {}, ("modern",), ((0.56, 0.34),)),
        ("Lumbar_Linen", low, _SCANDI, {}, ("scandinavian", "japanese"), ((0.56, 0.34),)),
        ("Lumbar_Piped", partial(low, piped=True), _CLASSIC, _CREAM, ("classic",), ((0.56, 0.34),)),
        ("Lumbar_Canvas", low, _LOFT, {}, ("industrial",), ((0.56, 0.34),)),
    )
    for name, draw, finishes, others, styles, sizes in kinds:
        for length, tall in sizes:
            size_m = (length, round(0.12 + 0.22 * tall, 3), round(0.94 * tall, 3))
            id_ = f"Cushion_{name}_{100 * length:.0f}x{100 * tall:.0f}"
            ways = dyed("cloth", finishes, others)
            yield Design(id_, "cushion", size_m, draw, ways, TEXTILES, styles)
    for name, finishes, styles in (
        ("Bolster", _CLASSIC, ("classic",)),
        ("Roll", _EARTH, ("japanese", "modern")),
    ):
        ways = {key: {**way, "cord": way["cloth"]} for key, way in dyed("cloth", finishes).items()}
        for length in (0.42, 0.6):
            size_m = (length, 0.25, 0.25)
            id_ = f"Cushion_{name}_{100 * length:.0f}"
            yield Design(id_, "cushion", size_m, bolster, ways, TEXTILES, styles)


_THROW_LENGTHS_M = tuple(round(length + 0.06, 2) for length in (0.9, 1.0, 1.2, 1.35, 1.5, 1.8, 2.0))


def _throws() -> Iterator[Design]:
    kinds = (
        ("Velvet", _MODERN, ("modern",)),
        ("Knit", ("sage_wool", "blush_wool", "blue_wool", "mustard_wool", "cream_wool",
                  "grey_wool"), ("scandinavian",)),
        ("Quilt", _CLASSIC, ("classic",)),
        ("Wool", ("rust_wool", "mustard_wool", "tan_wool", "teal_wool", "charcoal_wool"),
         ("industrial",)),
        ("Linen", _EARTH, ("japanese",)),
    )  # fmt: skip
    for name, finishes, styles in kinds:
        for length in _THROW_LENGTHS_M:
            size_m = (length, 0.6, 0.3)
            id_ = f"Throw_Bed_{name}_{100 * length:.0f}"
            ways = dyed("cloth", finishes)
            yield Design(id_, "throw", size_m, bed_throw, ways, TEXTILES, styles)
        for depth in (0.42, 0.52, 0.64):
            size_m = (0.55, depth, 0.28)
            id_ = f"Throw_Seat_{name}_{100 * depth:.0f}"
            yield Design(
                id_, "throw", size_m, seat_throw, dyed("cloth", finishes), TEXTILES, styles
            )


DESIGNS = (*_cushions(), *_throws())
