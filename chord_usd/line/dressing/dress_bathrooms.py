"""Bathrooms: a mirror over every basin, paper beside the toilet, towels, a screen at the tub."""

from __future__ import annotations

import numpy as np
import shapely

from chord_usd.base.places.wall_frames import WallFace
from chord_usd.base.scene.geometry import in_world, to_own, to_world
from chord_usd.base.scene.types import Asset, Box, Item
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import within

_MIRROR_BASE_M, _MIRROR_TOP_M = 1.02, 2.1
_OVER_TAP_M = 0.08
_PAPER_BASE_M = 0.66
_TOWEL_BASE_M = 0.95
_NEAR_TOILET_M = 0.55
_SHIFTS_M = (0.0, 0.03, -0.03, 0.06, -0.06, 0.1, -0.1)
"""How far a mirror hangs beside the middle of its basin, where that is in a corner."""


def dress_bathroom(frame: RoomFrame) -> None:
    """Fittings on the walls first, then what stands on the floor."""
    for basin in frame.of("washbasin"):
        _mirror(frame, basin)
    for toilet in frame.of("toilet"):
        _paper(frame, toilet)
        _beside_toilet(frame, toilet)
    for tub in frame.of("bathtub"):
        _screen(frame, tub)
    _towels(frame)


def _screen(frame: RoomFrame, tub: Item) -> None:
    """On the rim along the open side, at the end that is at a wall."""
    screens = frame.stock.family(frame.stock.offered("shower_screen"), "shower_screen")
    length, depth, _ = tub.box.size_m
    relief = frame.relief(tub)
    for asset in screens:
        for side in (1, -1):
            x = side * (length - asset.size_m[0]) / 2
            end = to_world(tub.box, (side * (length / 2 + 0.08), 0.0))
            if frame.floor.covers(shapely.Point(end)):
                continue
            y = -depth / 2 + asset.size_m[1] / 2 + 0.01
            local = Box((x, y, 0.0), asset.size_m, 0.0)
            base_m = relief.highest_m(local)
            box = in_world(Box((x, y, base_m), asset.size_m, 0.0), tub.box)
            if base_m > 0.4 and frame.put_where_free(asset, box, rests_on=tub.id, but=(tub.id,)):
                return


def back_face(frame: RoomFrame, item: Item, within_m: float = 0.15) -> WallFace | None:
    """The wall that a piece has its back to."""
    return next((face for face in frame.faces if face.has_back_of(item.box, within_m)), None)


def _mirror(frame: RoomFrame, basin: Item) -> None:
    face = back_face(frame, basin)
    if face is None:
        return
    low, high, _, _ = face.span_of(basin.box)
    middle = (low + high) / 2
    base_m = max(_MIRROR_BASE_M, float(frame.relief(basin).heights_m.max()) + _OVER_TAP_M)
    widest = max(high - low, 0.5) + 0.1
    most_m = (widest, 0.2, _MIRROR_TOP_M - base_m)
    mirrors = within(frame.stock.offered("mirror"), most_m, (0.3, 0.0, 0.35))
    mirrors = list(frame.stock.family(mirrors, "mirror/basin")) + mirrors
    wanted = 0.8 * (high - low)
    ranked = sorted(
        dict.fromkeys(mirrors), key=lambda a: (round(abs(a.size_m[0] - wanted), 3), a.id)
    )
    # A basin without a mirror is worse than a mirror of another style.
    others = within(frame.stock.every("mirror"), (widest, 0.2, _MIRROR_TOP_M - base_m),
                    (0.3, 0.0, 0.35))  # fmt: skip
    ranked += sorted((a for a in others if a not in ranked), key=lambda a: (a.size_m[0], a.id))
    for mirror in ranked:
        centre = max(base_m + mirror.size_m[2] / 2, 1.5)
        for shift in _SHIFTS_M:
            box = face.box(middle + shift, centre - mirror.size_m[2] / 2, mirror.size_m)
            item = frame.put_where_free(mirror, box)
            if item is not None:
                _mirror_lamp(frame, face, item, middle + shift)
                return


def _mirror_lamp(frame: RoomFrame, face: WallFace, mirror: Item, middle: float) -> None:
    """Over the mirror, or one at either side."""
    lamps = frame.stock.family(frame.stock.offered("wall_lamp"), "wall_lamp/bath")
    top_m = mirror.box.top_m
    for lamp in sorted(lamps, key=lambda a: (-a.size_m[0], a.id)):
        if lamp.size_m[0] >= 0.25:
            box = face.box(middle, top_m + 0.06, lamp.size_m)
            if box.center_m[2] + lamp.size_m[2] < 2.4 and frame.put_where_free(lamp, box):
                return
            continue
        aside = mirror.box.size_m[0] / 2 + 0.06 + lamp.size_m[0] / 2
        base_m = top_m - 0.35 - lamp.size_m[2] / 2
        pair = [face.box(middle + side * aside, base_m, lamp.size_m) for side in (-1, 1)]
        if frame.hang_group([(lamp, box) for box in pair]):
            return


def _paper(frame: RoomFrame, toilet: Item) -> None:
    """On the wall beside the toilet, a little before it; else behind it."""
    holders = frame.stock.family(frame.stock.offered("paper_holder"), "paper_holder")
    length, depth, _ = toilet.box.size_m
    front = np.array([to_world(toilet.box, (0.0, -0.35 * depth))])
    for asset in holders:
        for face in frame.faces:
            u, v = face.local(front)[0]
            turned = abs((toilet.box.yaw_deg - face.yaw_deg + 180.0) % 360.0 - 180.0)
            if not 60.0 < turned < 120.0 or v > length / 2 + _NEAR_TOILET_M:
                continue
            box = face.box(float(u), _PAPER_BASE_M, asset.size_m)
            if frame.put_where_free(asset, box):
                return
        face_behind = back_face(frame, toilet)
        if face_behind is not None:
            low, high, _, _ = face_behind.span_of(toilet.box)
            for middle in (high + 0.2, low - 0.2):
                if frame.put_where_free(
                    asset, face_behind.box(middle, _PAPER_BASE_M, asset.size_m)
                ):
                    return


def _beside_toilet(frame: RoomFrame, toilet: Item) -> None:
    """The brush at the wall on one side, a bin on the other, or wherever there is room."""
    for category in ("toilet_brush", "bin"):
        for asset in _small(frame, category):
            if _stand_beside(frame, toilet, asset):
                break


def _small(frame: RoomFrame, category: str) -> list[Asset]:
    family = frame.stock.family(
        within(frame.stock.offered(category), (0.3, 0.3, 0.6)), f"{category}/bath"
    )
    return sorted(family, key=lambda a: (a.size_m[0], a.id))


def _stand_beside(frame: RoomFrame, piece: Item, asset: Asset) -> bool:
    length, depth, _ = piece.box.size_m
    for side in (1, -1):
        x = side * (length / 2 + asset.size_m[0] / 2 + 0.06)
        y = depth / 2 - asset.size_m[1] / 2 - 0.04
        at = to_world(piece.box, (x, y))
        box = Box((float(at[0]), float(at[1]), 0.0), asset.size_m, piece.box.yaw_deg)
        if frame.fits(box) and frame.walkways.stay_with(box):
            frame.put(asset, box)
            frame.walkways.take(box)
            return True
    return False


def _towel_base_m(height_m: float) -> float:
    """A bare rail; one whose towels hang down; a ladder."""
    if height_m < 0.3:
        return _TOWEL_BASE_M + 0.3
    return max(0.2, (1.38 if height_m < 0.8 else 1.75) - height_m)


def _towels(frame: RoomFrame) -> None:
    """A rail with towels near basin, tub or shower; a radiator for towels where there is none."""
    family = list(frame.stock.family(frame.stock.offered("towel_rail"), "towel_rail"))
    near = [item.box.center_m[:2] for item in frame.of("shower", "bathtub", "washbasin")]
    if not family:
        return
    best = None
    for asset in family:
        base_m = _towel_base_m(asset.size_m[2])
        for face in frame.faces:
            spans = face.free_spans(
                frame.taken, base_m - 0.05, base_m + max(asset.size_m[2], 0.1) + 0.05,
                asset.size_m[1] + 0.1,
            )  # fmt: skip
            for low, high in spans:
                if high - low < asset.size_m[0] + 0.1:
                    continue
                for middle in (low + 0.1 + asset.size_m[0] / 2, high - 0.1 - asset.size_m[0] / 2):
                    box = face.box(middle, base_m, asset.size_m)
                    far = min((_far(box, at) for at in near), default=0.0)
                    if (best is None or far < best[0] - 1e-6) and frame.fits(box):
                        best = far, asset, box
    if best is not None:
        frame.put(best[1], best[2])


def _far(box: Box, at_m: tuple[float, float]) -> float:
    return float(np.hypot(*to_own(box, at_m)))
