"""Rows of books for shelves: bound volumes of unlike size, some leaning, some lying."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import (
    rng_of,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, Solid, box, extruded, joined

SLOTS = ("cover_a", "cover_b", "cover_c", "cover_d")


def bound(thick_m: float, deep_m: float, tall_m: float, spine: int = 6) -> tuple[Solid, Solid]:
    """(cover, pages) of an upright book, its round spine to -y, centred on the origin.

    spine: points around the spine; 2 make it flat.
    """
    board = min(0.0028, thick_m / 5)
    half, back = thick_m / 2, deep_m / 2
    angles = np.linspace(0, -math.pi, spine)
    curve = [(half * math.cos(a), -back + 0.0045 + 0.0045 * math.sin(a)) for a in angles]
    curve = curve if spine > 2 else [(half, -back), (-half, -back)]
    inner = [(-half + board, -back + 0.006), (half - board, -back + 0.006)]
    outline = [
        (half, back),
        *curve,
        (-half, back),
        (-half + board, back),
        *inner,
        (half - board, back),
    ]
    cover = extruded(np.array(outline)[::-1], tall_m)
    edge = 0.0035
    pages = box((thick_m - 2 * board + 0.0004, deep_m - 0.006 - edge, tall_m - 2 * edge))
    return cover, pages.moved(y=(0.006 - edge) / 2, z=edge)


def _bands(thick_m: float, deep_m: float, tall_m: float, kind: int) -> list[Solid]:
    """Print on a spine: a title's block, or two lines and a mark."""
    y = -deep_m / 2 + 0.0004
    wide = thick_m * 0.62
    if kind == 0:
        return []
    spots: tuple[tuple[float, float, float], ...]
    if kind == 1:
        spots = ((0.72, 0.12, 1.0), (0.2, 0.008, 1.0))
    elif kind == 2:
        spots = ((0.86, 0.004, 1.25), (0.66, 0.14, 0.5), (0.14, 0.004, 1.25))
    else:
        spots = ((0.78, 0.02, 1.0), (0.72, 0.02, 0.8), (0.1, 0.03, 0.5))
    return [
        box((min(wide * share, thick_m * 0.8), 0.002, tall_m * tall)).moved(
            y=y, z=tall_m * at - tall_m * tall / 2
        )
        for at, tall, share in spots
    ]


def book_row(
    size_m: Size, *, seed: str, lean: bool = True, lying: bool = False
) -> tuple[Part, ...]:
    """Books side by side, spines to the front; the last ones lean, or some lie beside the row."""
    length, width, height = size_m
    rng = rng_of(f"{seed}/{size_m}")
    stack = min(0.22, 0.45 * length) if lying else 0.0
    covers: dict[str, list[Solid]] = {slot: [] for slot in SLOTS}
    pages: list[Solid] = []
    prints: list[Solid] = []
    x, end = -length / 2, length / 2 - stack
    slope = height * 0.2 if lean and length > 0.25 else 0.0
    count, last = 0, ""
    tallest = False
    while end - slope - x > 0.012:
        thick = float(rng.choice([0.014, 0.019, 0.024, 0.031, 0.042])) * float(
            rng.uniform(0.92, 1.1)
        )
        thick = min(thick, end - slope - x)
        tall = height * float(rng.choice([0.7, 0.78, 0.86, 0.93, 1.0]))
        if not tallest and end - slope - x < 0.09:
            tall, tallest = height, True
        tallest = tallest or tall == height
        deep = min(width, max(tall * 0.7, width * 0.7))
        if count == 0:
            deep = width
        slot = str(rng.choice([s for s in SLOTS if s != last]))
        _stand(
            covers,
            pages,
            prints,
            (thick - 0.0008, deep, tall),
            slot,
            rng,
            x + thick / 2,
            -width / 2 + deep / 2,
            0.0,
        )
        x, count, last = x + thick, count + 1, slot
    if slope:
        thick, tall = float(rng.uniform(0.018, 0.026)), height * 0.84
        room = end - x
        angle = math.degrees(math.asin(min((room - thick) / tall, 0.4)))
        deep = width * 0.84
        _stand(
            covers,
            pages,
            prints,
            (thick, deep, tall),
            SLOTS[count % 4],
            rng,
            x,
            -width / 2 + deep / 2,
            -angle,
            foot=end,
        )
    z = 0.0
    for index in range(4 if lying else 0):
        thick = float(rng.uniform(0.018, 0.034))
        if z + thick > height:
            break
        tall, deep = stack - 0.012 * index, width * (0.98 - 0.06 * index)
        cover, leaves = bound(thick - 0.0006, deep, tall)
        turn = float(rng.uniform(-5, 5)) if index else 0.0
        for solid, group in ((cover, covers[SLOTS[(index + count) % 4]]), (leaves, pages)):
            flat = solid.moved(z=-tall / 2).turned("y", 90).turned("z", turn)
            group.append(flat.moved(end + stack / 2, -0.0, z + thick / 2))
        z += thick
    parts = [
        Part(f"Covers_{slot[-1].upper()}", joined(solids), slot, None)
        for slot, solids in covers.items()
        if solids
    ]
    parts.append(Part("Pages", joined(pages), "page", None))
    if prints:
        parts.append(Part("Titles", joined(prints), "print", None))
    # One upright box collides, so that the row stands steadily.
    collider = box((length, width, height * 0.96))
    first = parts[0]
    parts[0] = Part(first.name, first.solid, first.slot, "boundingCube", colliders=(collider,))
    return tuple(parts)


def _stand(
    covers: dict,
    pages: list,
    prints: list,
    size: Size,
    slot: str,
    rng: np.random.Generator,
    x: float,
    y: float,
    lean_deg: float,
    foot: float = 0.0,
) -> None:
    """Put one book in the row; a leaning one has its right lower edge at foot."""
    cover, leaves = bound(*size)
    marks = _bands(*size, int(rng.integers(4)))

    def tipped(solid: Solid) -> Solid:
        """Turned about its right lower edge, its left upper edge against the row."""
        return solid.moved(x=-size[0] / 2).turned("y", lean_deg)

    sunk_m = tipped(cover).bounds_m()[0, 2] if lean_deg else 0.0
    for solid, group in (
        (cover, covers[slot]),
        (leaves, pages),
        *((mark, prints) for mark in marks),
    ):
        if lean_deg:
            group.append(tipped(solid).moved(foot, y, -sunk_m))
        else:
            group.append(solid.moved(x, y))
