"""Vases, empty or with flowers, grasses and twigs."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.forms import (
    cup,
    lofted,
    outward,
    rng_of,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    joined,
    lathe,
    rounded_profile,
)
from chord_usd.library.plants.leaves import (
    LANCE,
    OVAL,
    bow,
    foliage,
    grown,
    leaf,
    tapered,
    turned,
)

_FORMS: dict[str, list[tuple[float, float]]] = {
    # (share of the radius, share of the height), foot to rim
    "bottle": [
        (0.0, 0.0),
        (0.62, 0.0),
        (0.9, 0.1),
        (1.0, 0.3),
        (0.86, 0.52),
        (0.36, 0.68),
        (0.28, 0.86),
        (0.36, 1.0),
    ],
    "ball": [
        (0.0, 0.0),
        (0.5, 0.0),
        (0.92, 0.22),
        (1.0, 0.5),
        (0.82, 0.78),
        (0.42, 0.92),
        (0.4, 1.0),
    ],
    "cone": [(0.0, 0.0), (0.5, 0.0), (0.56, 0.04), (1.0, 1.0)],
    "urn": [
        (0.0, 0.0),
        (0.6, 0.0),
        (0.52, 0.05),
        (0.3, 0.12),
        (0.34, 0.18),
        (0.9, 0.46),
        (1.0, 0.7),
        (0.7, 0.88),
        (0.82, 1.0),
    ],
    "cylinder": [(0.0, 0.0), (0.94, 0.0), (1.0, 0.03), (1.0, 1.0)],
    "tear": [
        (0.0, 0.0),
        (0.6, 0.0),
        (0.96, 0.14),
        (1.0, 0.28),
        (0.6, 0.58),
        (0.3, 0.8),
        (0.26, 0.94),
        (0.36, 1.0),
    ],
    "ring": [],
}


_SMOOTH = ("bottle", "ball", "urn", "tear")


def _body(
    form: str, radius_m: float, height_m: float, thick_m: float = 0.005, sides: int = 26
) -> Solid:
    profile = [(r * radius_m, z * height_m) for r, z in _FORMS[form]]
    if form in _SMOOTH:
        profile = [profile[0], *rounded_profile(profile[1:], 1)]
    neck = max(height_m * (0.55 if form in _SMOOTH else 0.1), 0.012)
    return cup(profile, thick_m, neck, sides)


def vase(size_m: Size, *, form: str = "bottle") -> tuple[Part, ...]:
    """An empty vase."""
    length, width, height = size_m
    body = _body(form, 0.5, height, 0.5 * 0.012 / length + 0.02).scaled(length, width, 1.0)
    return (Part("Vase", body, "pot"),)


def fluted_vase(size_m: Size) -> tuple[Part, ...]:
    """A vase with upright ribs."""
    length, _width, height = size_m
    body = _body("ball", length / 2, height, 0.005, 60)
    points = body.points_m.copy()
    angle = np.arctan2(points[:, 1], points[:, 0])
    points[:, :2] *= (1.0 - 0.035 * (np.round(angle * 30 / math.pi) % 2))[:, None]
    return (Part("Vase", Solid(points, body.faces), "pot"),)


def ring_vase(size_m: Size) -> tuple[Part, ...]:
    """A flat hoop with a short neck (a donut vase)."""
    length, width, height = size_m
    neck = height * 0.14
    outer = (height - neck) / 2
    bar = outer * 0.34
    turn = np.linspace(0, 2 * math.pi, 37)[:-1]
    section = np.linspace(0, 2 * math.pi, 13)[:-1]
    rings = []
    for a in turn:
        r = outer - bar + bar * np.cos(section)
        rings.append(
            np.stack([r * math.cos(a), width / 2 * np.sin(section), outer + r * math.sin(a)], -1)
        )
    hoop = lofted(rings, loop=True)
    spout = cup(
        [(0.0, 0.0), (bar * 0.6, 0.0), (bar * 0.5, neck * 0.6), (bar * 0.66, neck + 0.014)],
        0.004,
        neck * 0.5,
        20,
    )
    return (
        Part(
            "Vase",
            joined([hoop, spout.moved(z=2 * outer - 0.014)]).scaled(length / (2 * outer), 1, 1),
            "pot",
        ),
    )


def _tulips(
    top: FloatArray, rise: float, spread: float, count: int, rng: np.random.Generator
) -> list:
    stems, heads, grids = [], [], []
    for index in range(count):
        yaw = 137.5 * index
        share = math.sqrt((index + 0.3) / count)
        path = bow(
            (0.001 * math.cos(yaw), 0.001 * math.sin(yaw), top[2] - 0.06),
            yaw,
            spread * share * 0.8,
            (rise * (0.92 - 0.3 * share)) + 0.06,
            0.06,
        )
        stems.append(tapered(path, 0.0034, 0.003, 6))
        profile = [
            (0.003, 0.0),
            (0.016, 0.008),
            (0.021, 0.024),
            (0.018, 0.044),
            (0.009, 0.054),
            (0.0, 0.05),
        ]
        head = outward(lathe(profile, 12))
        points = head.points_m.copy()
        angle = np.arctan2(points[:, 1], points[:, 0])
        points[:, :2] *= (1 + 0.14 * np.cos(3 * angle))[:, None]
        tilt = 8 + 26 * share
        heads.append(
            Solid(points, head.faces)
            .turned("y", tilt)
            .turned("z", yaw)
            .moved(*map(float, path[-1] - [0, 0, 0.004]))
        )
        for side in (0, 1):
            at = path[2 + side]
            grid = leaf(
                float(rng.uniform(0.11, 0.16)),
                0.03,
                LANCE,
                pitch_deg=74,
                droop_deg=float(rng.uniform(30, 80)),
                fold=0.35,
                rows=6,
            )
            grids.append(turned(grid, yaw + 120 + 140 * side, at))
    return [
        ("Stems", joined(stems), "stem", False),
        ("Heads", joined(heads), "flower", False),
        ("Leaves", foliage(grids), "leaf", True),
    ]


def _pampas(
    top: FloatArray, rise: float, spread: float, count: int, rng: np.random.Generator
) -> list:
    stems, plumes = [], []
    for index in range(count):
        yaw = 137.5 * index
        share = math.sqrt((index + 0.3) / count)
        path = bow(
            (0.001 * math.cos(yaw), 0.001 * math.sin(yaw), top[2] - 0.06),
            yaw,
            spread * share,
            rise * (0.97 - 0.22 * share) + 0.06,
            0.0,
            8,
        )
        stems.append(tapered(path, 0.0022, 0.001, 5))
        for step in range(26):
            t = 0.52 + 0.48 * step / 25
            low = min(int(t * 8), 7)
            at = path[low] + (t * 8 - low) * (path[low + 1] - path[low])
            long = 0.085 * math.sin(math.pi * (0.12 + 0.82 * (t - 0.52) / 0.48)) + 0.012
            grid = leaf(
                long,
                0.009,
                (0.5, 1.0, 0.6, 0.0),
                pitch_deg=float(rng.uniform(52, 72)),
                droop_deg=float(rng.uniform(30, 90)),
                rows=4,
                columns=2,
            )
            plumes.append(turned(grid, 137.5 * step + yaw, at))
    return [("Stems", joined(stems), "twig", False), ("Plumes", foliage(plumes), "plume", True)]


def _boughs(
    top: FloatArray,
    rise: float,
    spread: float,
    count: int,
    rng: np.random.Generator,
    *,
    bloom: bool = False,
) -> list:
    wood, grids, buds = [], [], []
    for index in range(count):
        yaw = 137.5 * index + 20
        share = (index + 0.5) / count
        path = bow(
            (0.0, 0.0, top[2] - 0.06),
            yaw,
            spread * (0.35 + 0.65 * share),
            rise * (0.98 - 0.4 * share) + 0.06,
            0.05,
            9,
        )
        path[2:-1] += 0.007 * rng.standard_normal((len(path) - 3, 3))
        wood.append(tapered(path, 0.0034, 0.0012, 5))
        for step in range(3, 10):
            at = path[step]
            for side in (-1, 1):
                if bloom:
                    for petal in range(5):
                        grid = leaf(
                            0.014,
                            0.013,
                            (0.4, 1.0, 0.8, 0.2),
                            pitch_deg=35,
                            droop_deg=10,
                            rows=3,
                            columns=2,
                        )
                        buds.append(
                            turned(
                                grid,
                                72.0 * petal + 30 * step,
                                at + np.array([0.008 * side, 0.006 * side, 0.002]),
                            )
                        )
                else:
                    long = float(rng.uniform(0.035, 0.05))
                    grid = leaf(
                        long,
                        long * 0.72,
                        OVAL,
                        pitch_deg=float(rng.uniform(5, 50)),
                        droop_deg=30,
                        rows=4,
                        columns=3,
                    )
                    grids.append(turned(grid, yaw + side * 75 + float(rng.uniform(-20, 20)), at))
    named = [("Twigs", joined(wood), "twig", False)]
    if grids:
        named.append(("Leaves", foliage(grids), "leaf", True))
    if buds:
        named.append(("Blossom", foliage(buds), "flower", True))
    return named


_STEMS: dict[str, Callable] = {
    "tulips": _tulips,
    "pampas": _pampas,
    "boughs": _boughs,
    "blossom": partial(_boughs, bloom=True),
}


def filled_vase(
    size_m: Size,
    *,
    form: str,
    stems: str,
    count: int,
    vase_share: float = 0.45,
    radius_share: float = 0.5,
) -> tuple[Part, ...]:
    """A vase with flowers, grass or twigs in it."""
    length, width, height = size_m
    tall = height * vase_share
    radius = min(length, width) / 2 * radius_share
    body = _body(form, radius, tall)
    top = np.array([0.0, 0.0, tall])
    named = _STEMS[stems](top, height - tall, length / 2, count, rng_of(f"{form}/{stems}/{size_m}"))
    return (Part("Vase", body, "pot"), *grown(named, length, width, tall, height))
