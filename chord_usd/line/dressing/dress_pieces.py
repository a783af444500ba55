"""What lies on seats and beds: cushions against the back, throws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.raster.relief import Relief
from chord_usd.base.scene.geometry import in_world
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Asset, Box, Item
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import nearest_length, stretched, within

_RISE_M = 0.07
"""What is so much higher than the seat is a back, an arm, a pillow."""

_SINKS_M = 0.012
"""How far a cushion sinks into what it lies on."""

_TALL_M = 0.36
"""Lower cushions lie before others."""

_GAP_M = 0.03
_HANGS_FROM_M = 0.06
"""What is so much lower than the seat is before its edge."""

_BEFORE_EDGE_M = 0.035
_THICK_M = 0.034
"""How far a throw hangs before the edge of a seat, and how high its folds lie."""

_ON_BED_M = 0.022
"""How high the folds of a throw lie on a duvet, which gives way."""


@dataclass(frozen=True)
class Seat:
    """The soft flat part of a piece, in its own frame."""

    left_m: float
    right_m: float
    back_m: float
    """y at which what one leans on begins."""
    front_m: float
    level_m: float


def dress_pieces(frame: RoomFrame) -> None:
    """Throws first, then cushions, since these stand before them."""
    for item in frame.of("bed"):
        seat = seat_of(frame.relief(item))
        if seat is not None:
            _throw_over_bed(frame, item, seat)
            _cushions_on_bed(frame, item, seat)
    for item in frame.of(*having("seat")):
        seat = seat_of(frame.relief(item))
        if seat is not None:
            _throw_over_seat(frame, item, seat)
            _cushions_on_sofa(frame, item, seat)


def seat_of(relief: Relief) -> Seat | None:
    """Where one sits or lies; None for a piece without a flat part before a back."""
    heights = relief.heights_m
    rows, columns = heights.shape
    if min(rows, columns) < 10:
        return None
    length, depth, _ = relief.size_m
    # Rows run from the back to the front; the front quarter may be rounded off.
    middle = heights[int(rows * 0.4) : int(rows * 0.85), int(columns * 0.2) : int(columns * 0.8)]
    level = float(np.median(middle))
    if level < 0.2:
        return None
    central = np.median(heights[:, int(columns * 0.3) : int(columns * 0.7)], axis=1)
    high = np.flatnonzero(central[: int(rows * 0.75)] > level + _RISE_M)
    back_row = int(high.max()) + 1 if high.size else 0
    seat_rows = heights[back_row : int(rows * 0.85)]
    flat = np.abs(np.median(seat_rows, axis=0) - level) < _RISE_M
    seats = np.flatnonzero(flat)
    if seats.size < columns * 0.4:
        return None
    cell_x, cell_y = length / columns, depth / rows
    return Seat(
        seats[0] * cell_x - length / 2,
        (seats[-1] + 1) * cell_x - length / 2,
        depth / 2 - back_row * cell_y,
        -depth / 2,
        level,
    )


def _cushions_on_sofa(frame: RoomFrame, item: Item, seat: Seat) -> None:
    """Larger ones at the ends, smaller ones before or beside them."""
    rng = frame.draws.rng(f"cushions/{item.id}")
    width = seat.right_m - seat.left_m
    most = frame.taste.cushions if item.category == "sofa" else 1
    count = min(most, max(1, int(width / 0.45)))
    if item.category != "sofa":
        count = int(rng.random() < 0.7)
    elif not frame.taste.symmetric:
        count = max(1, count - int(rng.integers(0, 2)))
    chosen = _choice(frame, rng, count)
    if not chosen:
        return
    if item.category != "sofa" or len(chosen) == 1:
        xs = [(seat.left_m + seat.right_m) / 2 if item.category != "sofa" else seat.right_m - 0.3]
    else:
        xs = _places(seat, [asset.size_m[0] for asset in chosen],
                     symmetric=frame.taste.symmetric, mirrored=rng.random() < 0.5)  # fmt: skip
    for asset, x in zip(chosen, xs, strict=False):
        _lean(frame, item, seat, asset, x)


def _choice(frame: RoomFrame, rng: np.random.Generator, count: int) -> list[Asset]:
    """Square cushions of one or two kinds, in pairs; a single last cushion is long or small."""
    offered = within(frame.stock.offered("cushion"), (0.7, 0.4, 0.6))
    tall = [asset for asset in offered if asset.size_m[2] >= _TALL_M]
    low = [asset for asset in offered if asset.size_m[2] < _TALL_M]
    kinds = frame.stock.some(tall or offered, rng, 1 + (count >= 4))
    if not kinds:
        return []
    chosen = [kinds[(index // 2) % len(kinds)] for index in range(count)]
    if count % 2 and count > 1:
        chosen[-1:] = frame.stock.some(low or tall, rng, 1)
    return chosen


def _places(seat: Seat, lengths: list[float], *, symmetric: bool, mirrored: bool) -> list[float]:
    """Middles: in turn from both ends; or two thirds at one end and the rest at the other."""
    left, right = seat.left_m + _GAP_M, seat.right_m - _GAP_M
    places = []
    for index, length in enumerate(lengths):
        to_left = index % 2 == 0 if symmetric else index % 3 != 1
        if to_left:
            places.append(left + length / 2)
            left += length + 0.01
        else:
            places.append(right - length / 2)
            right -= length + 0.01
    return [-place + seat.left_m + seat.right_m for place in places] if mirrored else places


def _lean(frame: RoomFrame, item: Item, seat: Seat, asset: Asset, x: float) -> bool:
    """A cushion with its back to the back of the piece, on what is below it."""
    relief = frame.relief(item)
    depth = asset.size_m[1]
    for step in range(12):
        y = seat.back_m - depth / 2 - 0.005 - 0.015 * step
        if y - depth / 2 < seat.front_m + 0.05:
            return False
        local = Box((x, y, 0.0), asset.size_m, 0.0)
        if relief.highest_m(local) <= seat.level_m + 0.045:
            break
    else:
        return False
    mask, window = relief.under(local)
    base_m = float(np.quantile(relief.heights_m[window][mask], 0.8)) - _SINKS_M
    box = in_world(Box((x, y, base_m), asset.size_m, 0.0), item.box)
    if frame.taken.hits(box, ("rug",), (item.id,)) or not frame.is_inside(box):
        return False
    frame.put(asset, box, rests_on=item.id)
    return True


def _cushions_on_bed(frame: RoomFrame, item: Item, seat: Seat) -> None:
    """Before the pillows: a pair and a small one, or one or two."""
    rng = frame.draws.rng(f"cushions/{item.id}")
    width = seat.right_m - seat.left_m
    count = 3 if width > 1.3 and frame.taste.cushions >= 4 else 2 if width > 1.1 else 1
    chosen = _choice(frame, rng, count)
    if not chosen:
        return
    middle = (seat.left_m + seat.right_m) / 2
    if len(chosen) == 1:
        xs = [middle]
    elif len(chosen) == 2:
        xs = [middle - chosen[0].size_m[0] / 2 - 0.03, middle + chosen[1].size_m[0] / 2 + 0.03]
    else:
        half = chosen[2].size_m[0] / 2 + 0.02
        xs = [middle - half - chosen[0].size_m[0] / 2, middle + half + chosen[1].size_m[0] / 2,
              middle]  # fmt: skip
    for asset, x in zip(chosen, xs, strict=True):
        _lean(frame, item, seat, asset, x)


def _throw_over_bed(frame: RoomFrame, item: Item, seat: Seat) -> None:
    """Over the foot, its hems hanging down at both sides."""
    if not frame.draws.chance(f"throw/{item.id}", frame.taste.throws):
        return
    length, depth, _ = item.box.size_m
    wanted = length + 0.06
    throws = [
        asset
        for asset in frame.stock.offered("throw", "bed")
        if abs(stretched(asset.size_m[0], wanted) - wanted) < 1e-6
        and asset.size_m[2] < seat.level_m
    ]
    family = frame.stock.family(throws, f"throw/{item.id}")
    asset = nearest_length(family, length + 0.06)
    if asset is None:
        return
    relief = frame.relief(item)
    size_m = (stretched(asset.size_m[0], length + 0.06), *asset.size_m[1:])
    y = -depth / 2 + size_m[1] / 2 + 0.18
    local = Box((0.0, y, 0.0), (length, size_m[1], 0.1), 0.0)
    top_m = relief.highest_m(local) + _ON_BED_M
    box = in_world(Box((0.0, y, top_m - size_m[2]), size_m, 0.0), item.box)
    if frame.is_inside(box) and not frame.taken.hits(box, ("rug",), (item.id,)):
        frame.put(asset, box, rests_on=item.id)


def _throw_over_seat(frame: RoomFrame, item: Item, seat: Seat) -> None:
    """Over the front edge of a seat at one end of a sofa, at the middle of a chair."""
    share = frame.draws.share(f"throw/{item.id}")
    if share > frame.taste.throws * (0.8 if item.category == "sofa" else 0.3):
        return
    offered = frame.stock.offered("throw", "seat")
    throws = frame.stock.family(offered, f"throw/{item.id}")
    width = seat.right_m - seat.left_m
    for asset in sorted(throws, key=lambda a: (-a.size_m[1], a.id)):
        length = min(asset.size_m[0], 0.9 * width)
        if length < 0.75 * asset.size_m[0]:
            continue
        aside = width / 2 - length / 2 - 0.12 if item.category == "sofa" else 0.0
        for x in (aside, -aside) if share % 0.02 < 0.01 else (-aside, aside):
            middle = (seat.left_m + seat.right_m) / 2 + max(-width / 2, x)
            box = _over_front(frame, item, seat, (middle, length), asset)
            if box is not None:
                frame.put(asset, box, rests_on=item.id)
                return


def _over_front(
    frame: RoomFrame, item: Item, seat: Seat, at: tuple[float, float], asset: Asset
) -> Box | None:
    """Where a throw lies with its fold at the front edge of the seat; None where it does not fit.

    at: middle and length along the seat, in the frame of the piece.
    """
    x, length = at
    relief = frame.relief(item)
    _, depth, height = asset.size_m
    strip = Box((x, 0.0, 0.0), (length, item.box.size_m[1], 0.1), 0.0)
    mask, window = relief.under(strip)
    along = np.where(mask, relief.heights_m[window], 0.0).max(axis=1)
    level = np.flatnonzero(along > seat.level_m - _HANGS_FROM_M)
    if not level.size:
        return None
    rows = relief.heights_m.shape[0]
    first_row = window[0].start or 0
    front = item.box.size_m[1] / 2 - (first_row + int(level.max()) + 1) * item.box.size_m[1] / rows
    y = front - _BEFORE_EDGE_M + depth / 2
    if y + depth / 2 > seat.back_m or height > seat.level_m:
        return None
    top_m = relief.highest_m(Box((x, y + 0.05, 0.0), (length, depth - 0.1, 0.1), 0.0))
    if top_m > seat.level_m + _RISE_M:
        return None
    local = Box((x, y, top_m + _THICK_M - height), (length, depth, height), 0.0)
    box = in_world(local, item.box)
    free = not frame.taken.hits(box, ("rug",), (item.id,))
    return box if free and frame.is_inside(box) else None
