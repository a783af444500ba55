"""Blinds in a window's reveal: rolled, slatted, folded, sliding panels."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    joined,
    pair,
    tube,
    welded,
)

_SLAT_EACH_M = 0.04


def roller(size_m: Size) -> tuple[Part, ...]:
    """A roll between two end plates, its cloth down to a weighted hem."""
    length, width, height = size_m
    radius = 0.021
    y, z = width / 2 - 0.026, height - 0.026
    roll = cylinder(radius, length - 0.034, 0.0, 24).moved(z=-(length - 0.034) / 2)
    plate = block((0.004, min(0.05, width - 0.002), 0.052), 0.001)
    plates = joined(
        pair(plate.moved(y=y if width > 0.05 else 0.0, z=height - 0.052), x=(length - 0.004) / 2)
    )
    front = y - radius
    hem_m = 0.02
    sheet = _sheet(length - 0.04, front, hem_m * 0.5, z)
    bar = block((length - 0.04, 0.011, hem_m), 0.003).moved(y=front)
    chain_x = length / 2 - 0.014
    chain = tube([[chain_x, y, z], [chain_x, y, max(z - 0.8, 0.03)]], 0.0015, 6)
    return (
        Part("Roll", roll.turned("y", 90).moved(y=y, z=z), "cloth", None),
        Part("Cloth", sheet, "cloth", None, two_sided=True),
        Part("Hem", bar, "cloth", None),
        Part("Plates", plates + chain, "metal", None),
    )


def _sheet(length: float, y: float, low: float, high: float) -> Solid:
    points = [[-length / 2, y, low], [length / 2, y, low], [length / 2, y, high],
              [-length / 2, y, high]]  # fmt: skip
    return welded(np.array(points), np.array([[0, 1, 2], [0, 2, 3]]))


def venetian(size_m: Size, *, tilt_deg: float = 32.0, slat_m: float = 0.046) -> tuple[Part, ...]:
    """Slats that are tilted, on cords between a head box and a bottom bar."""
    length, width, height = size_m
    head_m, bar_m = 0.04, 0.016
    head = block((length, width, head_m), 0.003).moved(z=height - head_m)
    bar = block((length - 0.01, slat_m, bar_m), 0.004)
    low, high = bar_m + 0.02, height - head_m - 0.02
    count = max(round((high - low) / _SLAT_EACH_M), 2)
    slat = _slat(length - 0.012, slat_m).turned("x", tilt_deg)
    slats = [slat.moved(z=low + (high - low) * i / (count - 1)) for i in range(count)]
    side = length / 2 - min(0.12, 0.2 * length)
    cords = [
        box((0.0025, 0.001, height - head_m - 0.005)).moved(s * side, dy, 0.006)
        for s in (-1, 1)
        for dy in (-slat_m * 0.42, slat_m * 0.42)
    ]
    path = [
        [-length / 2 + 0.05, -width / 2 + 0.004, z]
        for z in (height - 0.03, max(height - 0.75, 0.05))
    ]
    wand = tube(path, 0.003, 8)
    return (
        Part("Head", head, "slat", None),
        Part("Slats", joined(slats), "slat", None),
        Part("Bottom", bar, "slat", None),
        Part("Cords", joined(cords), "cord", None),
        Part("Wand", wand, "slat", None),
    )


def _slat(length: float, wide: float) -> Solid:
    """Thin and a little arched."""
    y = np.linspace(-wide / 2, wide / 2, 4)
    z = 0.0018 * (1 - (2 * y / wide) ** 2)
    rim = np.concatenate([np.stack([y, z + 0.0016], -1), np.stack([y, z], -1)[::-1]])
    return _bar_along_x(rim[::-1], length)


def _bar_along_x(outline: FloatArray, length: float) -> Solid:
    """A bar of this (y, z) outline, its ends closed by a strip across; outline in two halves."""
    count = len(outline)
    ends = [np.column_stack([np.full(count, s * length / 2), outline]) for s in (-1, 1)]
    here, after = np.arange(count), (np.arange(count) + 1) % count
    faces = [np.stack([here, after, after + count], -1), np.stack([here, after + count,
                                                                  here + count], -1)]  # fmt: skip
    half = count // 2
    for i in range(half - 1):
        a, b, c, d = i, i + 1, count - 2 - i, count - 1 - i
        faces.append(np.array([[a, c, b], [a, d, c]]))
        faces.append(np.array([[a, b, c], [a, c, d]]) + count)
    made = welded(np.concatenate(ends), np.concatenate(faces))
    return made if _volume(made) > 0.0 else Solid(made.points_m, made.faces[:, ::-1].copy())


def _volume(solid: Solid) -> float:
    a, b, c = (solid.points_m[solid.faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


def roman(size_m: Size) -> tuple[Part, ...]:
    """A cloth drawn up in soft folds that lie on one another, the lowest the fullest."""
    length, width, height = size_m
    folds = max(round(height / 0.22), 2)
    each = (height - 0.04) / folds
    back = width / 2 - 0.006
    profile = [(back, height), (back - 0.012, height - 0.004), (back - 0.012, height - 0.03)]
    for fold in range(folds):
        top = height - 0.04 - each * fold
        belly = (width - 0.024) * (0.35 + 0.65 * (fold + 1) / folds)
        for share in np.linspace(0.08, 1.0, 9):
            out = belly * math.sin(math.pi * 0.5 * min(share / 0.78, 1.0)) ** 1.5
            if share > 0.8:
                out *= 1.0 - ((share - 0.8) / 0.2) ** 2 * 0.85
            profile.append((back - 0.008 - out, top - each * (share - 0.08) * 1.02))
    front = np.array(profile)
    front[:, 1] -= front[:, 1].min()
    columns = np.linspace(-0.5, 0.5, 17)
    rng = np.random.default_rng(round(1000 * length))
    waver = np.interp(columns, np.linspace(-0.5, 0.5, 6), rng.normal(0.0, 1.0, 6))
    grid = np.empty((len(front), len(columns), 3))
    grid[..., 0] = columns * (length - 0.004)
    deep = (back - front[:, 0])[:, None]
    grid[..., 1] = front[:, :1] + 0.1 * deep * waver
    grid[..., 2] = front[:, 1:] - 0.006 * waver * (1 - front[:, 1:] / height)
    low, high = grid.min(axis=(0, 1)), grid.max(axis=(0, 1))
    grid[..., 2] = (grid[..., 2] - low[2]) * height / (high[2] - low[2])
    grid[..., 1] = back - (high[1] - grid[..., 1]) * (width - 0.006) / (high[1] - low[1])
    index = np.arange(grid.shape[0] * grid.shape[1]).reshape(grid.shape[:2])
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    steps = np.linalg.norm(np.diff(front, axis=0), axis=1)
    v = -np.concatenate([[0.0], np.cumsum(steps)])
    uv = np.stack(np.broadcast_arrays(grid[..., 0], v[:, None]), axis=-1).reshape(-1, 2)
    head = block((length, 0.02, 0.03), 0.002).moved(y=back - 0.005, z=height - 0.03)
    cloth = Solid(grid.reshape(-1, 3), faces)
    return (
        Part("Cloth", cloth, "cloth", None, uvs=uv[faces.reshape(-1)], two_sided=True),
        Part("Head", head, "cloth", None),
    )


def panels(size_m: Size) -> tuple[Part, ...]:
    """Flat panels on a track of as many grooves, slid partly over each other."""
    length, width, height = size_m
    count = max(round(length / 0.5), 2)
    track = block((length, width, 0.024), 0.002).moved(z=height - 0.024)
    wide = length / count * 1.08
    step = (length - wide - 0.004) / (count - 1)
    groove = (width - 0.016) / count
    sheets, bars = [], []
    for i in range(count):
        x, y = -length / 2 + 0.002 + wide / 2 + step * i, (i - (count - 1) / 2) * groove
        sheets.append(box((wide - 0.002, 0.0016, height - 0.034)).moved(x, y, 0.008))
        bars += [
            block((wide, min(0.007, groove * 0.8), 0.018), 0.001).moved(x, y, z)
            for z in (0.0, height - 0.04)
        ]
    return (
        Part("Track", track, "metal", None),
        Part("Panels", joined(sheets), "cloth", None),
        Part("Battens", joined(bars), "metal", None),
    )
