"""Beds: frame, headboard, mattress, pillows and a duvet with the folds of cloth."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import frozen_array
from chord_usd.library.beds.headboards import THICK_M, Headboard, headboard
from chord_usd.library.cloth.bedding import MATTRESS_INSET_M
from chord_usd.library.cloth.stored import Cloth, stored
from chord_usd.library.cloth.stuffed import Filling, stuffed
from chord_usd.library.kit.joinery import four_legs
from chord_usd.library.kit.model import Collider, Part
from chord_usd.library.kit.solids import Size, Solid, block, joined, pair, rounded_slab, soft_block

Bedding = Literal["smooth", "rumpled"]
Base = Literal["rails", "box", "platform", "tubes"]

_TOP_M: dict[str, float] = {"rails": 0.5, "box": 0.52, "platform": 0.42, "tubes": 0.5}
"""Upper side of the mattress."""

_HANG_M: dict[str, float] = {"rails": 0.3, "box": 0.3, "platform": 0.17, "tubes": 0.3}
"""How far the duvet may hang down."""

_MATTRESS_M = 0.22
_DOUBLE_FROM_M = 1.3


def bed(
    size_m: Size, *, board: Headboard, bedding: Bedding, base: Base = "rails", rows: int = 2
) -> tuple[Part, ...]:
    """A bed with its head at the back (+y); length runs across the bed, width along it.

    rows: of pillows, where two sleep.
    """
    length, width, height = size_m
    head, top = THICK_M[board], _TOP_M[base]
    foot = -width / 2 + MATTRESS_INSET_M
    lying = width / 2 - head - foot
    wide = length - 2 * MATTRESS_INSET_M
    mattress = soft_block((wide, lying - 0.01, _MATTRESS_M), 0.05, (4, 4, 1))
    mattress = mattress.moved(y=foot + (lying - 0.01) / 2, z=top - _MATTRESS_M)
    return (
        *_base(base, length, width, head),
        *headboard(board, length, height, width / 2),
        Part("Mattress", mattress, "sheet"),
        *_bedding(bedding, length, foot, top, _HANG_M[base]),
        *_pillows(length, width / 2 - head, top, rows, flat=base == "platform"),
    )


def _base(kind: Base, length: float, width: float, head: float) -> tuple[Part, ...]:
    inset = MATTRESS_INSET_M - 0.027
    wide, deep = length - 2 * inset, width - inset - head
    y = (inset - head) / 2
    if kind == "platform":
        deck = block((length - 0.004, width - head - 0.004, 0.05), 0.004).moved(y=-head / 2, z=0.17)
        foot = block((length - 0.3, width - 0.4, 0.17), 0.003)
        return (Part("Rail", deck, "frame"), Part("Plinth", foot, "leg"))
    if kind == "box":
        body = rounded_slab((wide, deep, 0.26), 0.03, 0.014, 4, 2)
        return (
            *four_legs(wide - 0.08, width - 0.14, 0.06, 0.05, "leg"),
            Part("Rail", body.moved(y=y, z=0.05), "pad"),
        )
    if kind == "tubes":
        sides = pair(block((0.035, deep, 0.045), 0.004).moved(y=y, z=0.235), x=(wide - 0.035) / 2)
        ends = block((wide - 0.06, 0.035, 0.045), 0.004)
        slat, step = block((wide - 0.05, 0.06, 0.018), 0.003), (deep - 0.2) / 9
        slats = [slat.moved(y=y + (i - 4.5) * step, z=0.265) for i in range(10)]
        frame = joined([*sides, ends.moved(y=y - (deep - 0.035) / 2, z=0.235), *slats])
        return (
            *four_legs(wide, width - 0.12, 0.24, 0.034, "frame", is_round=True),
            Part("Rail", frame, "frame"),
        )
    rail = rounded_slab((wide, deep, 0.12), 0.02, 0.008, 4, 2).moved(y=y, z=0.18)
    return (
        *four_legs(wide - 0.03, width - 0.12, 0.19, 0.052, "leg", is_round=True, splay_m=0.012),
        Part("Rail", rail, "frame"),
    )


def _bedding(
    kind: Bedding, length: float, foot: float, top: float, hang: float
) -> tuple[Part, ...]:
    """The duvet and, where it is turned back, its end: as they fell on a bed of their size."""
    simulated = 1.6 if length >= _DOUBLE_FROM_M else 1.0
    name = f"{kind}_{100 * simulated:.0f}"
    parts = []
    for part, slot in (("duvet", "duvet"), ("band", "sheet")):
        if part == "band" and kind != "smooth":
            continue
        cloth = _stretched(stored(f"{part}_{name}"), simulated, length, hang)
        cloth = cloth.moved(y=foot, z=top)
        collider: Collider | None = "boundingCube" if part == "duvet" else None
        parts.append(Part(part.capitalize(), cloth.solid, slot, collider, uvs=cloth.corner_uvs_m()))
    return tuple(parts)


def _stretched(cloth: Cloth, simulated: float, length: float, hang: float) -> Cloth:
    """Wider or narrower in its middle; what hangs keeps its folds and ends within the bed."""
    inner = simulated / 2 - MATTRESS_INSET_M
    more = length / 2 - MATTRESS_INSET_M - inner

    def widened(x: np.ndarray) -> np.ndarray:
        return x + more * np.clip(x / (inner - 0.1), -1.0, 1.0)

    points, uvs = cloth.solid.points_m.copy(), cloth.uvs_m.copy()
    points[:, 0], uvs[:, 0] = widened(points[:, 0]), widened(uvs[:, 0])
    edge = length / 2 - MATTRESS_INSET_M
    room = MATTRESS_INSET_M - 0.002
    out = np.abs(points[:, 0]) - edge
    share = room / max(float(out.max()), 1e-6)
    points[:, 0] = np.sign(points[:, 0]) * (edge + np.where(out > 0.0, out * share, out))
    beyond = -points[:, 1]
    share = room / max(float(beyond.max()), 1e-6)
    points[:, 1] = np.where(beyond > 0.0, -beyond * share, points[:, 1])
    below = -points[:, 2] - 0.03
    share = min((hang - 0.03) / max(float(below.max()), 1e-6), 1.0)
    points[:, 2] = np.where(below > 0.0, -0.03 - below * share, points[:, 2])
    return Cloth(replace(cloth.solid, points_m=frozen_array(points)), frozen_array(uvs))


_PILLOWS = (
    Filling(0.19, 5, 0.018, slump=0.15, seed=11),
    Filling(0.16, 5, 0.022, slump=0.3, chop=0.04, seed=12),
)


def _pillows(
    length: float, head_y: float, top: float, rows: int, *, flat: bool
) -> tuple[Part, ...]:
    """Pillows that lean on the headboard, a second row before them; low beds have one, lying."""
    count = 2 if length >= _DOUBLE_FROM_M else 1
    wide = min(0.72, (length - 0.2) / count - 0.02)
    step = (length - 0.16) / count
    leans = (8.0,) if flat else (64.0, 34.0)[: rows if count == 2 else 1]
    if count == 1 and not flat:
        leans = (36.0,)
    parts = []
    back = head_y
    for row, lean in enumerate(leans):
        pieces = []
        for index in range(count):
            x = (index - (count - 1) / 2) * step
            filling = _PILLOWS[(row + index) % 2]
            pieces.append(_leaning(filling, wide * (1.0 - 0.08 * row), x, back, top, lean, index))
        uvs = np.concatenate([uvs for _, uvs in pieces])
        slot = "pillow" if row == 0 and len(leans) > 1 else "sheet"
        name = "Pillows" if row == 0 else "Front_Pillows"
        parts.append(Part(name, joined([one for one, _ in pieces]), slot, None, uvs=uvs))
        back -= 0.17
    return tuple(parts)


def _leaning(
    filling: Filling, wide: float, x: float, back: float, top: float, lean: float, index: int
) -> tuple[Solid, np.ndarray]:
    cloth = stuffed(wide, min(0.68 * wide, 0.48), filling, 16)
    solid = cloth.solid.turned("x", lean).turned("z", (-2.0, 2.6)[index % 2])
    low, high = solid.bounds_m()
    solid = solid.moved(x, back + 0.006 - float(high[1]), top - 0.03 - float(low[2]))
    return solid, cloth.corner_uvs_m()
