"""What an upholsterer makes: boxed cushions with cords, stuffed arms and backs, rolled arms."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.kit.solids import Size, Solid, joined, loft, ring, soft_block

_CORD_M = 0.0055


def boxed_cushion(
    size_m: Size, *, crown_m: float = 0.03, belly_m: float = 0.012, dent_m: float = 0.0,
    seed: int = 0, cords: int = 2, corner_m: float = 0.045,
) -> Solid:  # fmt: skip
    """A cushion of two covers and a border, lying; it fills its size at the crown.

    crown_m: how much higher its middle is than its edges; belly_m: how far its sides swell;
    dent_m: how deep it is sat in. cords: none, one around the upper cover, or two.
    """
    length, width, height = size_m
    edge = height - crown_m
    inset = belly_m + (_CORD_M if cords else 0.0)
    core = (length - 2 * inset, width - 2 * inset, edge)
    cells = (max(round(length / 0.14), 3), max(round(width / 0.14), 3), 1)
    body = soft_block(core, min(corner_m, 0.4 * edge), cells)
    points = _swollen(body.points_m.copy(), core, crown_m, belly_m, dent_m, seed)
    made = Solid(frozen_array(points), body.faces)
    if not cords:
        return made
    round_m = min(corner_m, 0.4 * edge)
    lines = []
    for z in (edge - 0.3 * round_m, 0.3 * round_m)[:cords]:
        path = _around(core, round_m, z)
        path = _swollen(path, core, crown_m, belly_m, dent_m, seed)
        lines.append(cord(path, _CORD_M))
    return joined([made, *lines])


def _around(core: Size, round_m: float, z: float) -> FloatArray:
    """Where the cover meets the border: just inside the block's outermost line."""
    inset = 0.3 * round_m
    outline = ring(core[0] - 2 * inset, core[1] - 2 * inset, max(round_m - inset, 0.012), z, 2)
    points = []
    for here, after in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        count = max(round(float(np.linalg.norm(after - here)) / 0.17), 1)
        points += [here + (after - here) * n / count for n in range(count)]
    return np.array(points)


def _swollen(
    points: FloatArray, core: Size, crown: float, belly: float, dent: float, seed: int
) -> FloatArray:
    length, width, edge = core
    u = np.clip(2 * points[:, 0] / length, -1, 1)
    v = np.clip(2 * points[:, 1] / width, -1, 1)
    up = np.clip(points[:, 2] / edge, 0, 1)
    dome = (1 - u**2) * (1 - v**2)
    dome = dome**0.6
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0, 2 * math.pi, 4)
    ripple = 0.0016 * (
        np.sin(points[:, 0] * 31 + 14 * points[:, 1] + phase[0])
        + np.sin(points[:, 1] * 27 - 11 * points[:, 0] + phase[1])
    )
    sat = dent * np.exp(-((u - 0.06 * np.sin(phase[2])) ** 2 / 0.3 + (v + 0.05) ** 2 / 0.35))
    rise = crown * dome + ripple * dome - sat
    mid = 1 - (2 * up - 1) ** 2
    across = 0.15 * np.sin(9 * v + phase[3]) * mid
    out_x = belly * mid * (1 - v**2) ** 0.5 * (1 + across)
    out_y = belly * mid * (1 - u**2) ** 0.5 * (1 + across)
    swollen = points.copy()
    swollen[:, 2] += rise * np.where(up > 0.5, 2 * up - 1, 0.0)
    swollen[:, 0] += np.sign(u) * np.abs(u) ** 6 * out_x
    swollen[:, 1] += np.sign(v) * np.abs(v) ** 6 * out_y
    return swollen


def cord(path: FloatArray, radius_m: float, sides: int = 4) -> Solid:
    """A round cord along a closed path (N, 3), counter-clockwise seen from above."""
    along = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    out = np.stack([along[:, 1], -along[:, 0], np.zeros(len(along))], axis=-1)
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)
    up = np.cross(out, along)
    angles = np.linspace(0.0, 2 * math.pi, sides, endpoint=False)
    rings = [path + radius_m * (math.cos(a) * out - math.sin(a) * up) for a in angles]
    sections = np.stack(rings, axis=1)
    made = loft(list(sections), loop=True)
    a, b, c = (made.points_m[made.faces[:, corner]] for corner in range(3))
    if float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) < 0.0:
        made = Solid(made.points_m, frozen_array(made.faces[:, ::-1], np.int64))
    return made


def stood_up(lying: Solid, lean_deg: float, back_y: float, top_z: float) -> Solid:
    """A cushion that was drawn lying, its upper side now to the front, leaning on its back.

    Its hindmost point comes to y = back_y, its highest to z = top_z.
    """
    upright = lying.turned("x", lean_deg)
    high = upright.bounds_m()[1]
    return upright.moved(0.0, back_y - float(high[1]), top_z - float(high[2]))


def rolled_arm(wide: float, deep: float, tall: float) -> Solid:
    """An arm whose top rolls outwards (+x) in a scroll; stands on z = 0, runs along y."""
    radius = 0.088
    inner = -wide / 2
    stem = wide - 0.075
    turns = np.radians(np.linspace(-60.0, 172.0, 18))
    cx, cz = wide / 2 - radius, tall - radius
    scroll = [(cx + radius * math.cos(a), cz + radius * math.sin(a)) for a in turns]
    outline = np.array([
        (inner, 0.0), (inner + stem, 0.0), (inner + stem, tall - 2 * radius - 0.06),
        (inner + stem + 0.012, tall - 2 * radius), *scroll, (inner, cz - 0.02), (inner, 0.5 * cz),
    ])  # fmt: skip
    middle = np.array([0.5 * (inner + inner + stem), 0.55 * tall])
    rings = []
    for y, share in ((-deep / 2, 0.93), (-deep / 2 + 0.006, 0.985), (-deep / 2 + 0.02, 1.0),
                     (0.0, 1.0), (deep / 2 - 0.02, 1.0), (deep / 2, 0.96)):  # fmt: skip
        flat = middle + (outline - middle) * share
        flat[:, 1] = np.maximum(flat[:, 1], 0.0)
        rings.append(np.column_stack([flat[:, 0], np.full(len(flat), y), flat[:, 1]]))
    made = loft(rings)
    a, b, c = (made.points_m[made.faces[:, corner]] for corner in range(3))
    if float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) < 0.0:
        made = Solid(made.points_m, frozen_array(made.faces[:, ::-1], np.int64))
    return made
