"""What stands on shelves and sills: vases, sculptures, candles, trailing plants."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from chord_usd.assets.dressing.dry_finishes import DRY
from chord_usd.assets.dressing.forms import (
    CLASSIC,
    INDUSTRIAL,
    JAPANESE,
    MODERN,
    SCANDINAVIAN,
    arc,
    ball,
    cup,
    hollow,
    lofted,
    outward,
    rng_of,
)
from chord_usd.assets.dressing.leaves import (
    HEART,
    LANCE,
    OVAL,
    bow,
    foliage,
    grown,
    leaf,
    pot,
    tapered,
    turned,
)
from chord_usd.assets.model import Design, Part
from chord_usd.assets.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    joined,
    lathe,
    rounded_profile,
    rounded_slab,
    tube,
)
from chord_usd.scene.types import FloatArray

Draw = Callable[[Size], tuple[Part, ...]]

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


def _rim_radius(form: str, radius_m: float) -> float:
    return _FORMS[form][-1][0] * radius_m - 0.006


def vase(size_m: Size, *, form: str = "bottle") -> tuple[Part, ...]:
    """An empty vase."""
    length, width, height = size_m
    body = _body(form, 0.5, height, 0.5 * 0.012 / length + 0.02).scaled(length, width, 1.0)
    return (Part("Vase", body, "pot"),)


def fluted_vase(size_m: Size) -> tuple[Part, ...]:
    """A vase with upright ribs."""
    length, width, height = size_m
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
            (0.0, 0.0, top[2] - 0.06),
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
            (0.0, 0.0, top[2] - 0.06),
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
                                at + [0.008 * side, 0.006 * side, 0.002],
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


def _stand(length: float, width: float, height: float, slot: str = "stone") -> Part:
    return Part("Plinth", block((length, width, height), 0.003), slot)


def knot(size_m: Size) -> tuple[Part, ...]:
    """A band that winds through itself (a trefoil), on a plinth."""
    length, width, height = size_m
    foot = height * 0.14
    t = np.linspace(0, 2 * math.pi, 61)[:-1]
    path = np.stack(
        [np.sin(t) + 2 * np.sin(2 * t), 0.9 * -np.sin(3 * t), np.cos(t) - 2 * np.cos(2 * t)], -1
    )
    tangent = np.roll(path, -1, 0) - np.roll(path, 1, 0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    section = np.linspace(0, 2 * math.pi, 10, endpoint=False)
    rings = []
    for p, d in zip(path, tangent, strict=True):
        side = np.cross(d, [0.0, 1.0, 0.0])
        side /= np.linalg.norm(side)
        up = np.cross(d, side)
        rings.append(p + 0.62 * (np.cos(section)[:, None] * side + np.sin(section)[:, None] * up))
    solid = lofted(rings, loop=True)
    low, high = solid.bounds_m()
    tall = height - foot + 0.006
    solid = solid.moved(*(-(low + high) / 2)).scaled(
        *(np.array([length, width, tall]) / (high - low))
    )
    return (
        _stand(length * 0.5, width * 0.8, foot),
        Part("Knot", solid.moved(z=foot - 0.006 + tall / 2), "body", collider="convexHull"),
    )


def arch_stack(size_m: Size) -> tuple[Part, ...]:
    """Arches set into each other, each a little lower."""
    length, width, height = size_m
    parts = []
    for index, share in enumerate((1.0, 0.62)):
        half = length / 2 * share
        thick = length * 0.14
        top = height * (1.0 if index == 0 else 0.64)
        turn = np.linspace(0, math.pi, 17)
        outer = np.concatenate(
            [
                [[half, 0.0]],
                np.stack([half * np.cos(turn), top - half + half * np.sin(turn)], -1),
                [[-half, 0.0]],
            ]
        )
        inner_r = half - thick
        inner = np.concatenate(
            [
                [[inner_r, 0.0]],
                np.stack([inner_r * np.cos(turn), top - half + inner_r * np.sin(turn)], -1),
                [[-inner_r, 0.0]],
            ]
        )
        deep = width * (1.0 - 0.12 * index) / 2
        rings = [np.column_stack([loop[:, 0], np.full(len(loop), y), loop[:, 1]]) for loop, y in
                 ((outer, -deep + 0.003), (outer * [0.985, 0.995], -deep), (inner * [1.02, 1.0], -deep), (inner, -deep + 0.003),
                  (inner, deep - 0.003), (inner * [1.02, 1.0], deep), (outer * [0.985, 0.995], deep), (outer, deep - 0.003))]  # fmt: skip
        # Sections across the arch, one after another along it.
        across = np.stack(rings, axis=1)
        parts.append(Part(f"Arch_{index + 1}", lofted(list(across)), ("body", "stone")[index]))
    return tuple(parts)


def pebbles(size_m: Size) -> tuple[Part, ...]:
    """Stones balanced on each other."""
    length, width, height = size_m
    rng = rng_of(f"pebbles/{size_m}")
    stones: dict[str, list[Solid]] = {"body": [], "stone": []}
    shares = np.array([0.34, 0.27, 0.22, 0.2])
    shares = shares / shares.sum()
    z = 0.0
    for index, share in enumerate(shares):
        tall = height * share * 1.03
        wide = (1.0, 0.78, 0.6, 0.42)[index]
        stone = ball(0.5, 10, 18)
        points = stone.points_m.copy()
        points[:, :2] *= (
            1.0 + 0.08 * np.sin(2 * np.arctan2(points[:, 1], points[:, 0]) + index)[:, None]
        )
        points[:, 2] = np.sign(points[:, 2]) * np.abs(points[:, 2] * 2) ** 0.8 / 2
        solid = Solid(points, stone.faces).scaled(length * wide * 0.93, width * wide * 0.93, tall)
        shift = float(rng.uniform(-0.03, 0.03)) * length * (index > 0)
        stones["body" if index % 2 == 0 else "stone"].append(solid.moved(shift, 0.0, z + tall / 2))
        z += height * share * 0.99
    return (
        Part(
            "Stones",
            joined(stones["body"]),
            "body",
            felt=(box((length * 0.6, width * 0.6, height)),),
        ),
        Part("Stones_Between", joined(stones["stone"]), "stone", None),
    )


def bust(size_m: Size) -> tuple[Part, ...]:
    """A head without features on a neck and a plinth."""
    length, width, height = size_m
    foot = height * 0.16
    sides = 24
    turn = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    rings = []
    # share of height, half width, half depth, forward shift, chin
    for z, wide, deep, ahead in ((0.0, 0.3, 0.26, 0.02), (0.1, 0.24, 0.25, 0.0), (0.2, 0.22, 0.24, -0.03), (0.27, 0.25, 0.3, -0.09),
                                 (0.33, 0.33, 0.4, -0.1), (0.45, 0.42, 0.46, -0.06), (0.6, 0.47, 0.49, -0.02), (0.75, 0.48, 0.5, 0.01),
                                 (0.88, 0.4, 0.43, 0.02), (0.96, 0.24, 0.27, 0.02), (1.0, 0.0, 0.0, 0.02)):  # fmt: skip
        x, y = wide * np.cos(turn), deep * np.sin(turn) + ahead
        if 0.4 < z < 0.7:
            nose = np.exp(-(((turn - 1.5 * math.pi) / 0.24) ** 2)) * (0.1 if z == 0.45 else 0.06)
            y = y - nose
        rings.append(
            np.stack(
                [
                    x * length,
                    0.88 * y * width,
                    np.full(sides, foot - 0.004 + z * (height - foot + 0.004)),
                ],
                -1,
            )
        )
    plinth = rounded_slab((length * 0.62, width * 0.62, foot), 0.004, 0.003, 3)
    return Part("Plinth", plinth, "stone"), Part(
        "Head", lofted(rings), "body", collider="convexHull"
    )


def discs(size_m: Size) -> tuple[Part, ...]:
    """Two discs that lean through each other, on a bar."""
    length, width, height = size_m
    foot = height * 0.1
    r = (height - foot) / 2
    thick = width * 0.3
    big = (
        cylinder(r * 0.98, thick, 0.004, 40)
        .turned("x", 90)
        .moved(-length / 2 + r * 0.98, thick / 2, foot + r * 0.98 - 0.005)
    )
    small_r = min(length - 1.55 * r, r * 1.1) * 0.62
    small = hollow([(small_r, 0.0), (small_r, thick * 0.8)], small_r * 0.4, 32).turned("x", 90)
    small = small.moved(
        length / 2 - small_r, -width / 2 + thick * 0.8 + 0.003, foot + small_r - 0.005
    )
    return (
        _stand(length * 0.8, width, foot),
        Part("Disc", big, "body", collider="convexHull"),
        Part("Hoop", small, "accent", None),
    )


def pillars(size_m: Size) -> tuple[Part, ...]:
    """Three candles of unlike height on a tray."""
    length, width, height = size_m
    tray = rounded_slab((length, width, 0.012), min(length, width) / 2, 0.004, 8)
    r = min(length * 0.16, width * 0.3)
    spots = ((-0.27, 0.12, 1.0), (0.06, -0.2, 0.55), (0.28, 0.14, 0.76))
    candles, wicks = [], []
    for x, y, share in spots:
        tall = (height - 0.024) * share
        profile = [
            (r - 0.002, 0.0),
            (r, 0.003),
            (r, tall - 0.003),
            (r - 0.002, tall),
            (r * 0.7, tall - 0.004),
            (0.0, tall - 0.006),
        ]
        candles.append(outward(lathe(profile, 24)).moved(x * length, y * width, 0.0115))
        wicks.append(
            tube([[0, 0, 0], [0.001, 0, 0.008], [0.003, 0.001, 0.016]], 0.0012, 6).moved(
                x * length, y * width, tall + 0.004
            )
        )
    return (
        Part("Tray", tray, "holder"),
        Part("Candles", joined(candles), "wax"),
        Part("Wicks", joined(wicks), "wick", None),
    )


def tapers(size_m: Size) -> tuple[Part, ...]:
    """Slim candles in turned holders of unlike height."""
    length, width, height = size_m
    holders, candles, wicks = [], [], []
    for x, share in ((-0.5, 0.62), (0.5, 1.0)):
        r = width / 2 * 0.98
        at = x * (length - 2 * r)
        tall = (height - 0.012) * share
        stem = tall * 0.42
        profile = [(0.0, 0.0), (r, 0.0), (r, 0.006), (r * 0.35, 0.016), (0.006, 0.026), (0.006, stem - 0.022), (0.016, stem - 0.012),
                   (0.014, stem), (0.0, stem)]  # fmt: skip
        holders.append(outward(lathe(profile, 28)).moved(at))
        candles.append(
            cylinder(0.0105, tall - stem + 0.006, 0.003, 14, top_m=0.008).moved(
                at, 0.0, stem - 0.006
            )
        )
        wicks.append(cylinder(0.001, 0.013, 0.0, 6).moved(at, 0.0, tall - 0.001))
    felt = tuple(
        box((width * 0.98, width * 0.98, height * 0.9)).moved(x * (length - width * 0.98))
        for x in (-0.5, 0.5)
    )
    return (
        Part("Holders", joined(holders), "holder", felt=felt),
        Part("Candles", joined(candles), "wax", None),
        Part("Wicks", joined(wicks), "wick", None),
    )


def lantern(size_m: Size) -> tuple[Part, ...]:
    """A glazed lantern with a candle."""
    length, width, height = size_m
    bar, foot = 0.009, 0.012
    top = height * 0.78
    posts = [
        block((bar, bar, top - foot), 0.001).moved(
            sx * (length / 2 - bar), sy * (width / 2 - bar), foot - 0.001
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    base = block((length, width, foot), 0.002)
    roof = lofted([np.array([[sx * length / 2 * s, sy * width / 2 * s, z] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
                   for s, z in ((1.0, top - 0.012), (1.0, top), (0.34, top + height * 0.1), (0.34, top + height * 0.12))])  # fmt: skip
    loop = tube(
        [
            [0.02 * math.cos(a), 0.0, top + height * 0.12 + 0.02 * math.sin(a)]
            for a in np.linspace(-0.2, math.pi + 0.2, 11)
        ],
        0.0025,
        6,
    )
    scale = (height - top - height * 0.12) / 0.0225
    loop = loop.moved(z=-(top + height * 0.12)).scaled(1.0, 1.0, scale).moved(z=top + height * 0.12)
    panes = [
        box((length - 2 * bar, 0.002, top - foot - 0.01)).moved(
            y=s * (width / 2 - bar), z=foot - 0.001
        )
        for s in (-1, 1)
    ]
    panes += [
        box((0.002, width - 2 * bar, top - foot - 0.01)).moved(
            x=s * (length / 2 - bar), z=foot - 0.001
        )
        for s in (-1, 1)
    ]
    wax = cylinder(length * 0.24, height * 0.3, 0.003, 24).moved(z=foot - 0.001)
    return (
        Part(
            "Frame",
            joined([base, *posts, roof, loop]),
            "holder",
            felt=(box((length, width, height * 0.8)),),
        ),
        Part("Glass", joined(panes), "glass", None),
        Part("Candle", wax, "wax", None),
        Part(
            "Wick",
            cylinder(0.0012, 0.014, 0.0, 6).moved(z=foot + height * 0.3 - 0.002),
            "wick",
            None,
        ),
    )


def jar_candle(size_m: Size) -> tuple[Part, ...]:
    """A scented candle in a glass with a label."""
    length, width, height = size_m
    r = length / 2
    glass = cup([(0.0, 0.0), (r - 0.003, 0.0), (r, 0.004), (r, height)], 0.003, 0.006, 32)
    wax = cylinder(r - 0.0036, height * 0.66, 0.0, 32).moved(z=0.0065)
    label = hollow([(r + 0.0006, height * 0.24), (r + 0.0006, height * 0.6)], 0.0004, 32)
    return (
        Part("Glass", glass.scaled(0.985, 0.985, 1.0), "glass"),
        Part("Wax", wax.scaled(0.98, 0.98, 1.0), "wax", None),
        Part("Label", label, "label", None),
        Part("Wick", cylinder(0.0012, 0.012, 0.0, 6).moved(z=height * 0.66), "wick", None),
    )


def trailing(size_m: Size, *, kind: str = "pothos") -> tuple[Part, ...]:
    """A pot from which vines spill over and lie around it."""
    length, width, height = size_m
    rng = rng_of(f"{kind}/{size_m}")
    r, h = min(length, width) * 0.26, height * 0.5
    vessel = pot("taper" if kind != "pearls" else "cylinder", r, h)
    stems, grids, pearls = [], [], []
    count = {"pothos": 12, "ivy": 11, "pearls": 13, "fern": 16}[kind]
    for index in range(count):
        yaw = 137.5 * index
        share = (index + 0.5) / count
        reach = length / 2 * (0.5 + 0.45 * share)
        peak = vessel.soil_m + (height - vessel.soil_m) * (0.9 - 0.65 * share)
        end = (
            max(0.012, vessel.soil_m * (0.9 - 1.3 * share))
            if kind != "fern"
            else vessel.soil_m * 0.9
        )
        t = np.linspace(0, 1, 9)
        out = reach * t**0.8
        z = (
            vessel.soil_m
            + (peak - vessel.soil_m) * np.sin(math.pi * np.clip(t * 1.25, 0, 1))
            + (end - vessel.soil_m) * t**2.4
        )
        # Over the rim, not through it.
        z = np.where((out < r * 1.25) & (out > r * 0.6), np.maximum(z, h + 0.008), z)
        z = np.maximum(z, 0.008)
        a = math.radians(yaw) + 0.5 * (t - 0.3) * float(rng.uniform(-1, 1))
        path = np.stack([out * np.cos(a), out * np.sin(a), z], -1)
        path[0] = [0.3 * r * math.cos(a[0]), 0.3 * r * math.sin(a[0]), vessel.soil_m - 0.008]
        stems.append(tapered(path, 0.0018, 0.001, 4))
        if kind == "pearls":
            for step in range(2, 9):
                for half in (0.0, 0.5):
                    low = min(step, 8)
                    at = path[low - 1] + half * (path[low] - path[low - 1])
                    pearls.append(
                        ball(0.006, 3, 6).moved(
                            *map(
                                float,
                                at + 0.004 * rng.standard_normal(3) * [1, 1, 0] + [0, 0, 0.004],
                            )
                        )
                    )
            continue
        for step in range(1, 9):
            for side in (-1, 1):
                if kind == "fern":
                    long = 0.045 * math.sin(math.pi * (0.2 + 0.75 * step / 9)) * length / 0.3
                    grid = leaf(
                        long, long * 0.34, LANCE, pitch_deg=12, droop_deg=40, rows=3, columns=3
                    )
                elif kind == "ivy":
                    long = float(rng.uniform(0.028, 0.04)) * length / 0.3
                    grid = leaf(
                        long,
                        long * 1.05,
                        (0.5, 1.0, 0.5, 0.62, 0.3, 0.0),
                        pitch_deg=float(rng.uniform(0, 40)),
                        droop_deg=60,
                        columns=3,
                    )
                else:
                    long = float(rng.uniform(0.045, 0.062)) * length / 0.3
                    grid = leaf(
                        long,
                        long * 0.8,
                        HEART,
                        pitch_deg=float(rng.uniform(5, 45)),
                        droop_deg=80,
                        columns=3,
                    )
                grids.append(
                    turned(
                        grid, yaw + side * float(rng.uniform(35, 85)), path[step] + [0, 0, 0.003]
                    )
                )
    named = [("Stems", joined(stems), "stem", False)]
    if grids:
        named.append(("Leaves", foliage(grids), "leaf", True))
    if pearls:
        named.append(("Pearls", joined(pearls), "leaf", False))
    corners = np.array([solid.bounds_m() for _, solid, _, _ in named])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    parts = list(vessel.parts)
    for name, solid, slot, two_sided in named:
        points = solid.points_m.copy()
        for axis, side in ((0, length / 2), (1, width / 2)):
            points[:, axis] *= np.where(points[:, axis] > 0, side / high[axis], side / -low[axis])
        above = points[:, 2] > h
        points[above, 2] = h + (points[above, 2] - h) * (height - h) / (high[2] - h)
        points[:, 2] = np.maximum(points[:, 2], 0.002 + 0.004 * (points[:, 2] - low[2]))
        parts.append(Part(name, Solid(points, solid.faces), slot, None, two_sided=two_sided))
    return tuple(parts)


def _looks(*pots: tuple[str, str], **more: str) -> dict[str, dict[str, str]]:
    base = {"soil": "earth", "leaf": "leaf_fresh", "stem": "green_stem", "twig": "twig", "plume": "pampas", "flower": "tulip_pink",
            "wick": "ink", "glass": "clear_glass", "label": "cream", "wax": "wax", "basket": "seagrass", "stand": "oak"}  # fmt: skip
    return {name: {**base, **more, "pot": finish} for name, finish in pots}


_CERAMIC = (
    ("white", "chalk"),
    ("stoneware", "stoneware"),
    ("black", "dark_stoneware"),
    ("clay", "clay"),
)
_GLAZED = (("celadon", "celadon"), ("indigo", "indigo_glaze"), ("black", "dark_stoneware"))
_GLASS = (("clear", "clear_glass"), ("green", "bottle_green"), ("amber", "amber_glass"))
_FINE = (("white", "ceramic"), ("celadon", "celadon"), ("blue", "indigo_glaze"))

_SCULPTURE = {
    name: {"body": body, "stone": stone, "accent": accent}
    for name, body, stone, accent in (
        ("white", "chalk", "walnut", "brass"), ("black", "dark_stoneware", "oak", "antique_brass"),
        ("bronze", "bronze", "dark_stone", "antique_brass"), ("clay", "clay", "chalk", "brass"),
    )
}  # fmt: skip
_STONES = {
    "grey": {"body": "raw_concrete", "stone": "stoneware"},
    "black": {"body": "dark_stoneware", "stone": "raw_concrete"},
}
_CANDLE = {
    name: {"holder": holder, "wax": wax, "wick": "ink", "glass": "clear_glass", "label": "cream"}
    for name, holder, wax in (
        ("brass", "antique_brass", "wax"), ("black", "black_metal", "wax"), ("oak", "oak", "wax_sage"), ("rust", "black_metal", "wax_rust"),
    )
}  # fmt: skip
_JAR = {
    name: {"glass": glass, "wax": "wax", "wick": "ink", "label": label}
    for name, glass, label in (("clear", "clear_glass", "cream"), ("amber", "amber_glass", "cream"), ("smoke", "smoked_glass", "book_ink"))
}  # fmt: skip

_MS = (MODERN, SCANDINAVIAN)


def _design(
    name: str, category: str, size_m: Size, draw: Draw, looks: dict, styles: tuple[str, ...] = ()
) -> Design:
    return Design(name, category, size_m, draw, looks, DRY, styles)


DESIGNS = (
    _design("Vase_Bottle", "vase", (0.14, 0.14, 0.3), partial(vase, form="bottle"), _looks(*_CERAMIC), ()),
    _design("Vase_Ball", "vase", (0.18, 0.18, 0.19), partial(vase, form="ball"), _looks(*_CERAMIC), _MS),
    _design("Vase_Tear", "vase", (0.13, 0.13, 0.36), partial(vase, form="tear"), _looks(*_GLASS), (MODERN, INDUSTRIAL)),
    _design("Vase_Fluted", "vase", (0.17, 0.17, 0.22), fluted_vase, _looks(*_CERAMIC), (MODERN, CLASSIC)),
    _design("Vase_Ring", "vase", (0.22, 0.08, 0.25), ring_vase, _looks(*_CERAMIC), _MS),
    _design("Vase_Urn", "vase", (0.18, 0.18, 0.28), partial(vase, form="urn"), _looks(*_FINE), (CLASSIC,)),
    _design("Vase_Glazed", "vase", (0.15, 0.15, 0.24), partial(vase, form="bottle"), _looks(*_GLAZED), (JAPANESE,)),
    _design("Vase_Tulips", "vase", (0.26, 0.26, 0.4), partial(filled_vase, form="cylinder", stems="tulips", count=11, vase_share=0.48, radius_share=0.42),
            {**_looks(*_GLASS[:1]), **_looks(("white", "chalk"), flower="tulip_white"), **_looks(("yellow", "celadon"), flower="tulip_yellow")},
            (SCANDINAVIAN, MODERN, CLASSIC)),
    _design("Vase_Pampas", "vase", (0.3, 0.3, 0.7), partial(filled_vase, form="bottle", stems="pampas", count=9, vase_share=0.36, radius_share=0.5),
            _looks(*_CERAMIC), (SCANDINAVIAN, MODERN)),
    _design("Vase_Eucalyptus", "vase", (0.3, 0.3, 0.52), partial(filled_vase, form="ball", stems="boughs", count=9, vase_share=0.34, radius_share=0.52),
            _looks(*_CERAMIC, leaf="leaf_dusty"), ()),
    _design("Vase_Boughs", "vase", (0.3, 0.3, 0.6), partial(filled_vase, form="tear", stems="boughs", count=6, vase_share=0.44, radius_share=0.44),
            _looks(*_GLASS), (INDUSTRIAL, MODERN, SCANDINAVIAN)),
    _design("Vase_Blossom", "vase", (0.3, 0.3, 0.56), partial(filled_vase, form="bottle", stems="blossom", count=4, vase_share=0.4, radius_share=0.46),
            _looks(*_GLAZED, flower="blossom"), (JAPANESE, CLASSIC)),
    _design("Sculpture_Knot", "sculpture", (0.22, 0.1, 0.26), knot, _SCULPTURE, (MODERN, SCANDINAVIAN)),
    _design("Sculpture_Arches", "sculpture", (0.18, 0.07, 0.2), arch_stack, _SCULPTURE, (MODERN, SCANDINAVIAN)),
    _design("Sculpture_Pebbles", "sculpture", (0.14, 0.1, 0.24), pebbles, _STONES, (JAPANESE, SCANDINAVIAN)),
    _design("Sculpture_Bust", "sculpture", (0.16, 0.2, 0.32), bust, _SCULPTURE, (CLASSIC, INDUSTRIAL)),
    _design("Sculpture_Discs", "sculpture", (0.26, 0.08, 0.24), discs, _SCULPTURE, (MODERN, INDUSTRIAL)),
    _design("Candles_Tray", "candle", (0.2, 0.15, 0.14), pillars, _CANDLE, ()),
    _design("Candles_Tapers", "candle", (0.19, 0.08, 0.3), tapers, _CANDLE, (SCANDINAVIAN, CLASSIC, MODERN)),
    _design("Candle_Lantern", "candle", (0.14, 0.14, 0.28), lantern, _CANDLE, (INDUSTRIAL, SCANDINAVIAN, JAPANESE)),
    _design("Candle_Jar", "candle", (0.085, 0.085, 0.1), jar_candle, _JAR, ()),
    _design("Trailing_Pothos", "trailing_plant", (0.36, 0.36, 0.24), trailing, _looks(*_CERAMIC), ()),
    _design("Trailing_Ivy", "trailing_plant", (0.34, 0.34, 0.22), partial(trailing, kind="ivy"), _looks(("clay", "clay"), *_CERAMIC[:3], leaf="leaf_deep"),
            (CLASSIC, SCANDINAVIAN, INDUSTRIAL)),
    _design("Trailing_Pearls", "trailing_plant", (0.24, 0.24, 0.16), partial(trailing, kind="pearls"), _looks(*_CERAMIC), _MS),
    _design("Trailing_Fern", "trailing_plant", (0.4, 0.4, 0.3), partial(trailing, kind="fern"), _looks(*_GLAZED, *_CERAMIC[:1]), ()),
)  # fmt: skip
