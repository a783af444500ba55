"""Doors and windows of crowded pages, with the sector that each leaf sweeps and where it hangs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.raster.page_labels import DOOR, NOTHING, PASSAGE, SWING, WINDOW
from chord_usd.base.scene.types import FloatArray
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas, rectangle
from chord_usd.workshop.data.drawn.masonry import Gap
from chord_usd.workshop.data.drawn.page_looks import DoorKind, Look, WindowKind

_DOUBLE_M = 1.25
"""Wider doors have two leaves, or slide."""

_ARC_STEPS = 16

_THINNEST_WINDOW_M = 0.09
"""In walls that are mere strokes, windows stand out as boxes."""


@dataclass(frozen=True, eq=False)
class Leaf:
    """A leaf that hangs at a point."""

    opening_id: str
    hinge: FloatArray
    tip: FloatArray
    """Of the leaf when it is open."""


def draw_gap(canvas: Canvas, gap: Gap, look: Look, rng: np.random.Generator) -> list[Leaf]:
    """Draw an opening and label it; returns its leaves."""
    if gap.kind == "window":
        _draw_window(canvas, gap, look, rng)
        return []
    if gap.kind == "passage":
        canvas.fill(gap.shape, None, built=PASSAGE)
        if rng.random() < 0.15:
            for line in _faces(gap):
                canvas.line(line, look.door_rgb, 1, dash_m=0.12 if rng.random() < 0.6 else 0.0)
        return []
    kind = look.doors[0] if rng.random() < 0.85 else look.doors[-1]
    if gap.length_m >= _DOUBLE_M and kind == "plain":
        kind = "sliding"
    # A hole without any leaf looks like a passage.
    plain = kind == "plain" and not gap.is_outer
    canvas.fill(gap.shape, None, built=PASSAGE if plain else DOOR)
    if look.has_thresholds and kind != "filled":
        for line in _faces(gap):
            canvas.line(line, look.door_rgb, 1)
    leaves = _draw_door(canvas, gap, kind, look, rng)
    if gap.is_outer and look.has_arrow:
        _arrow(canvas, gap, look)
    return leaves


def _faces(gap: Gap) -> list[FloatArray]:
    """The opening's edges along both faces of the wall."""
    half, deep = gap.along * gap.length_m / 2, gap.across * gap.depth_m / 2
    return [np.array([gap.middle + side * deep - half, gap.middle + side * deep + half])
            for side in (-1.0, 1.0)]  # fmt: skip


def _draw_door(
    canvas: Canvas, gap: Gap, kind: DoorKind, look: Look, rng: np.random.Generator
) -> list[Leaf]:
    if kind in ("sliding", "pocket", "folding", "plain"):
        _draw_without_hinge(canvas, gap, kind, look, rng)
        return []
    if kind == "filled":
        fill = look.door_fill_rgb
        canvas.fill(gap.shape, fill if fill is not None else look.paper_rgb)
        canvas.outline(gap.shape, look.door_rgb, look.line_px)
        return []
    half = gap.along * gap.length_m / 2
    ends = [(gap.middle - half, gap.along, gap.length_m)]
    if gap.length_m >= _DOUBLE_M:
        ends = [(gap.middle - half, gap.along, gap.length_m / 2),
                (gap.middle + half, -gap.along, gap.length_m / 2)]  # fmt: skip
    # Leaves hang flush with the wall's face, or within its thickness.
    inset = gap.across * gap.depth_m / 2 * float(rng.choice([1.0, 1.0, 0.0, -1.0]))
    return [
        _draw_leaf(canvas, gap, kind, (hinge + inset, along, reach), look, rng)
        for hinge, along, reach in ends
    ]


def _draw_leaf(
    canvas: Canvas,
    gap: Gap,
    kind: DoorKind,
    hung: tuple[FloatArray, FloatArray, float],
    look: Look,
    rng: np.random.Generator,
) -> Leaf:
    """hung: where, along which direction when it is shut, and how long it is."""
    hinge, along, reach = hung
    open_deg = 90.0
    if kind in ("ajar", "slanted"):
        open_deg = float(rng.choice([30.0, 45.0, 60.0, 75.0]))
    angles = np.radians(np.linspace(0.0, open_deg, _ARC_STEPS))[:, None]
    arc = hinge + reach * (np.cos(angles) * along + np.sin(angles) * gap.across)
    sector = Polygon([hinge, *arc])
    canvas.fill(sector.difference(gap.shape), None, laid=SWING)
    canvas.fill(gap.shape.intersection(sector), None, laid=NOTHING)
    if look.door_fill_rgb is not None and rng.random() < 0.7:
        canvas.fill(sector, look.door_fill_rgb)
    if kind not in ("leaf", "slanted"):
        thick = 2 if kind == "thick_arc" and canvas.px_per_m > 40 else 1
        canvas.line(arc, look.door_rgb, thick, dash_m=0.08 if kind == "dashed_arc" else 0.0)
    if kind == "thick_arc" or (kind == "arc" and rng.random() < 0.2):
        turned = np.array([along, gap.across])[int(open_deg < 90.0)]
        panel = Polygon([hinge, arc[-1], arc[-1] + turned * 0.05, hinge + turned * 0.05])
        canvas.fill(panel, look.paper_rgb if rng.random() < 0.6 else look.door_rgb)
        canvas.outline(panel, look.door_rgb, 1)
    else:
        canvas.line(np.array([hinge, arc[-1]]), look.door_rgb, max(1, look.line_px))
    return Leaf(gap.opening.id, hinge, arc[-1])


def _draw_without_hinge(
    canvas: Canvas, gap: Gap, kind: DoorKind, look: Look, rng: np.random.Generator
) -> None:
    half, deep = gap.along * gap.length_m / 2, gap.across * gap.depth_m
    start, stop = gap.middle - half, gap.middle + half
    thickness = max(0.04, 1.5 / canvas.px_per_m)
    if kind == "sliding":
        for share, side in ((0.0, 0.16), (0.45, -0.16)):
            middle = start + (stop - start) * (share + 0.275) + deep * side
            panel = rectangle(middle, gap.along, 0.55 * gap.length_m, thickness)
            canvas.fill(panel, look.paper_rgb)
            canvas.outline(panel, look.door_rgb, 1)
    elif kind == "pocket":
        middle = start + gap.along * gap.length_m * rng.uniform(-0.3, 0.2)
        panel = rectangle(middle, gap.along, gap.length_m, thickness)
        canvas.fill(panel, look.paper_rgb)
        canvas.outline(panel, look.door_rgb, 1)
    elif kind == "folding":
        count = 2 * max(1, round(gap.length_m / 0.6))
        sides = np.tile([0.0, 1.0], count)[: count + 1, None]
        shares = np.linspace(0.0, 1.0, count + 1)[:, None]
        height = min(0.35, gap.length_m / count)
        canvas.line(start + shares * (stop - start) + sides * gap.across * height, look.door_rgb, 1)
    elif gap.is_outer:
        canvas.line(np.array([start, stop]), look.door_rgb, 1)


def _arrow(canvas: Canvas, gap: Gap, look: Look) -> None:
    """The mark of an entrance: outside, pointing in."""
    for side in (1.0, -1.0):
        tip = gap.middle + gap.across * side * (gap.depth_m / 2 + 1.1 * gap.length_m)
        if canvas.is_free(*canvas.px(tip)):
            back = tip + gap.across * side * 0.4
            canvas.fill(
                Polygon([tip, back + gap.along * 0.25, back - gap.along * 0.25]), look.ink_rgb
            )
            return


# Windows -----------------------------------------------------------------------------------------

_LINES: dict[WindowKind, tuple[float, ...]] = {
    "one": (0.0,), "two": (-0.15, 0.15), "three": (-0.5, 0.0, 0.5),
    "four": (-0.5, -0.17, 0.17, 0.5), "filled": (-0.5, 0.5), "framed": (-0.5, 0.5),
    "sill": (-0.5, 0.5, 0.8), "bold": (0.0,), "black": (), "open": (-0.5, 0.5), "box": (),
}  # fmt: skip
"""Where lines run along a window, in shares of the wall's depth from its middle."""


def _draw_window(canvas: Canvas, gap: Gap, look: Look, rng: np.random.Generator) -> None:
    kind = look.windows[0] if rng.random() < 0.85 else look.windows[-1]
    is_thin = gap.depth_m < _THINNEST_WINDOW_M
    if is_thin:
        depth = rng.uniform(_THINNEST_WINDOW_M, 2 * _THINNEST_WINDOW_M)
        shape = rectangle(gap.middle, gap.along, gap.length_m, depth)
        gap = replace(gap, depth_m=depth, shape=shape)
    glass = look.glass_rgb if kind in ("filled", "framed") else look.paper_rgb
    canvas.fill(gap.shape, glass, built=WINDOW, laid=NOTHING)
    half, deep = gap.along * gap.length_m / 2, gap.across * gap.depth_m
    width = 2 if kind == "bold" else 1
    for share in _LINES[kind]:
        middle = gap.middle + deep * share
        canvas.line(np.array([middle - half, middle + half]), look.window_rgb, width)
    # A single line where the wall is one, too, would show nothing.
    if is_thin or kind in ("box", "framed", "filled", "three", "two") or rng.random() < 0.4:
        canvas.outline(gap.shape, look.window_rgb, 1)
    if kind == "framed" and gap.length_m > 1.0:
        panes = max(2, round(gap.length_m / 0.8))
        for share in np.linspace(-0.5, 0.5, panes + 1)[1:-1]:
            place = gap.middle + gap.along * gap.length_m * share
            canvas.line(np.array([place - deep / 2, place + deep / 2]), look.window_rgb, 1)
    if kind == "open":
        _draw_casements(canvas, gap, look)


def _draw_casements(canvas: Canvas, gap: Gap, look: Look) -> None:
    """Window leaves, a little open, with their arcs."""
    reach = min(gap.length_m / 2, 0.7)
    for side in (-1.0, 1.0):
        hinge = gap.middle + gap.along * side * gap.length_m / 2
        angles = np.radians(np.linspace(0.0, 45.0, 8))[:, None]
        arc = hinge + reach * (np.cos(angles) * -side * gap.along + np.sin(angles) * gap.across)
        canvas.line(arc, look.window_rgb, 1)
        canvas.line(np.array([hinge, arc[-1]]), look.window_rgb, 1)
