"""Pictures, mirrors, clocks and shelves: over furniture first, then where walls are bare."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.metrics.walk import PASSED_BY_M
from chord_usd.base.places.wall_frames import WallFace
from chord_usd.base.scene.types import WET_KINDS, Asset, Box, Item
from chord_usd.line.dressing.dress_bathrooms import back_face
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import within

EYE_M = 1.53
"""Height of the middle of what one looks at."""

_OVER_PIECE_M = 0.16
"""Least from a piece to the picture over it."""

_TOP_M = 2.25
"""Pictures end below this."""

_GAP_M = 0.06
"""Between the pictures of a group."""

_MARGIN_M = 0.12
"""Beside a picture on a bare wall."""

_BARE_FROM_M = 0.75
"""Narrower stretches of wall stay bare."""

_UNDER_ART = ("sofa", "bed", "dining_cabinet", "cabinet", "shoe_cabinet", "tv_cabinet", "table",
              "leisure_sofa", "single_sofa", "dining_table")  # fmt: skip
"""Pieces with a picture over them, the most wanted first."""

_AT_DOOR_M = 1.5
"""So far from the front door, places for coats and mirror are alike."""

_SHOWN = ("living", "dining", "bedroom", "study", "corridor", "unknown")
_EACH_M2 = 6.5
"""Floor for each place with pictures."""


@dataclass(frozen=True)
class Spot:
    """A stretch of wall for something to look at."""

    face: WallFace
    low_m: float
    high_m: float
    base_m: float
    over: Item | None = None
    """The piece below it."""

    @property
    def middle_m(self) -> float:
        """Along the wall."""
        return (self.low_m + self.high_m) / 2

    @property
    def width_m(self) -> float:
        """Along the wall."""
        return self.high_m - self.low_m


def dress_art(frame: RoomFrame) -> None:
    """What one looks at on the walls of a room."""
    if frame.kind == "corridor" or frame.entrance is not None:
        _hooks(frame)
    if frame.kind in ("corridor", "bedroom") or frame.entrance is not None:
        _tall_mirror(frame)
    if frame.kind in _SHOWN:
        _pictures(frame)
    if frame.kind in ("living", "bedroom", "study", "store", "bathroom", "washroom", "kitchen"):
        _shelves(frame)
    if frame.kind in ("kitchen", "living", "dining", "study"):
        _clock(frame)
    if frame.kind in ("kitchen", *WET_KINDS):
        _small_picture(frame)
    if frame.kind in ("bedroom", "corridor", "living", "balcony"):
        _wall_lamps(frame)


def spots_of(frame: RoomFrame, height_m: float = 0.4) -> list[Spot]:
    """Places for pictures: over furniture, then bare stretches, the widest first."""
    over = [
        spot for name in _UNDER_ART for item in frame.of(name)
        if (spot := _over(frame, item, height_m)) is not None
    ]  # fmt: skip
    bare = []
    for face in frame.faces:
        for low, high in face.free_spans(frame.taken, 0.9, _TOP_M - 0.2, 0.1):
            if high - low >= _BARE_FROM_M:
                spot = Spot(face, low + _MARGIN_M, high - _MARGIN_M, 0.95)
                if not any(_same(spot, other) for other in over):
                    bare.append(spot)
    return [*over, *sorted(bare, key=lambda spot: -round(spot.width_m, 3))]


def _same(a: Spot, b: Spot) -> bool:
    return a.face is b.face and a.low_m < b.high_m and b.low_m < a.high_m


def _over(frame: RoomFrame, item: Item, height_m: float) -> Spot | None:
    """The free wall over a piece, about its middle."""
    face = back_face(frame, item, 0.35)
    if face is None and item.category in ("table", "dining_table"):
        face = next(
            (f for f in frame.faces if -0.1 <= f.span_of(item.box)[2] < 0.35
             and 0.0 < sum(f.span_of(item.box)[:2]) / 2 < f.length_m), None)  # fmt: skip
    if face is None:
        return None
    low, high, _, _ = face.span_of(item.box)
    top_m = item.box.size_m[2]
    if item.category in ("bed", "sofa", "tv_cabinet"):
        top_m = max(top_m, float(frame.relief(item).heights_m.max()))
    for child in item.children:
        top_m = max(top_m, min(child.box.top_m, top_m + 0.25))
    base_m = top_m + _OVER_PIECE_M
    if base_m + height_m > _TOP_M:
        return None
    middle = (low + high) / 2
    for start, end in face.free_spans(frame.taken, base_m, base_m + height_m, 0.08):
        if start + 0.1 < middle < end - 0.1:
            half = min(middle - start, end - middle, (high - low) / 2 + 0.1) - 0.05
            return Spot(face, middle - half, middle + half, base_m, item) if half > 0.15 else None
    return None


def _pictures(frame: RoomFrame) -> None:
    """Groups or single ones, no picture twice."""
    rng = frame.draws.rng("pictures")
    most = 1 + int(frame.floor.area / _EACH_M2)
    used: set[str] = set()
    hung = 0
    for spot in spots_of(frame):
        if hung >= most:
            break
        if spot.over is None and rng.random() > frame.taste.pictures * 0.8:
            continue
        if spot.over is not None and rng.random() > frame.taste.pictures + 0.15:
            continue
        grouped = rng.random() < frame.taste.gallery and spot.width_m > 1.1
        hung += _group(frame, spot, rng, used) if grouped else _single(frame, spot, rng, used)


def _offer(frame: RoomFrame, used: set[str], most_m: tuple[float, float, float]) -> list[Asset]:
    """Pictures that fit, do not hang in the room yet, and may hang in no other room."""
    fitting = within(frame.stock.offered("picture"), most_m)
    return [asset for asset in fitting if asset.id not in used and frame.is_own(asset)]


def _centre_m(spot: Spot, height_m: float) -> float:
    """Height of the middle of what hangs in a spot: at eye level, if that is over the piece."""
    return max(EYE_M, spot.base_m + height_m / 2)


def _single(frame: RoomFrame, spot: Spot, rng: np.random.Generator, used: set[str]) -> int:
    """One picture at the middle, about two thirds of the piece's length at most."""
    share = 0.72 if spot.over is not None else 0.6
    most = (max(share * spot.width_m, 0.3), 0.2, _TOP_M - spot.base_m)
    offered = _offer(frame, used, most)
    # The larger ones of what fits: small pictures on large walls look lost.
    large = sorted(offered, key=lambda a: (-a.size_m[0] * a.size_m[2], a.id))
    for asset in frame.stock.some(large[: max(3, len(large) // 3)], rng, 3):
        base_m = _centre_m(spot, asset.size_m[2]) - asset.size_m[2] / 2
        box = spot.face.box(spot.middle_m, base_m, asset.size_m)
        if base_m + asset.size_m[2] <= _TOP_M + 0.05 and frame.put_where_free(asset, box):
            used.add(asset.id)
            return 1
    return 0


def _group(frame: RoomFrame, spot: Spot, rng: np.random.Generator, used: set[str]) -> int:
    """Two or three of one format in a row, or pairs above each other where there is height."""
    most = (spot.width_m * 0.45, 0.2, _TOP_M - spot.base_m)
    rows = _rows(_offer(frame, used, most), spot.width_m)
    if not rows:
        return _single(frame, spot, rng, used)
    _, length, height, count, alike = max(rows, key=lambda row: row[0])
    chosen = frame.stock.some(alike, rng, count)
    base_m = _centre_m(spot, height) - height / 2
    start = spot.middle_m - (count * (length + _GAP_M) - _GAP_M) / 2 + length / 2
    boxes = [
        spot.face.box(start + index * (length + _GAP_M), base_m, asset.size_m)
        for index, asset in enumerate(chosen)
    ]
    return _put_all(frame, chosen, boxes, used) or _single(frame, spot, rng, used)


def _rows(
    offered: Sequence[Asset], width_m: float
) -> list[tuple[float, float, float, int, list[Asset]]]:
    """Rows of pictures of one format that a width takes: area, length, height, how many, which."""
    formats: dict[tuple[float, float], list[Asset]] = {}
    for asset in offered:
        formats.setdefault((asset.size_m[0], asset.size_m[2]), []).append(asset)
    rows = []
    for (length, height), alike in sorted(formats.items()):
        count = min(len(alike), 3, int((width_m + _GAP_M) / (length + _GAP_M)))
        if count >= 2:
            rows.append((count * length * height, length, height, count, alike))
    return rows


def _put_all(
    frame: RoomFrame, assets: Sequence[Asset], boxes: Sequence[Box], used: set[str]
) -> int:
    """All of a group or none; 1 for a group that hangs."""
    if not frame.hang_group(list(zip(assets, boxes, strict=True))):
        return 0
    used.update(asset.id for asset in assets)
    return 1


def _small_picture(frame: RoomFrame) -> None:
    rng = frame.draws.rng("small_picture")
    if rng.random() > frame.taste.pictures * 0.7:
        return
    for spot in spots_of(frame):
        if _single_of(frame, spot, _offer(frame, set(), (0.55, 0.2, 0.75)), rng):
            return


def _single_of(
    frame: RoomFrame, spot: Spot, assets: Sequence[Asset], rng: np.random.Generator
) -> bool:
    fitting = within(assets, (spot.width_m, 0.3, _TOP_M - spot.base_m))
    for asset in frame.stock.some(fitting, rng, 2):
        base_m = _centre_m(spot, asset.size_m[2]) - asset.size_m[2] / 2
        if frame.put_where_free(asset, spot.face.box(spot.middle_m, base_m, asset.size_m)):
            return True
    return False


def _clock(frame: RoomFrame) -> None:
    """Above eye level on a bare stretch; in half of the rooms."""
    if not frame.draws.chance("clock", 0.9 if frame.kind == "kitchen" else 0.45):
        return
    clocks = frame.stock.family(frame.stock.offered("clock"), f"clock/{frame.kind}")
    for asset in clocks[:1]:
        base_m = 1.85 - asset.size_m[2] / 2
        for face in sorted(frame.faces, key=lambda face: -face.length_m):
            for low, high in face.free_spans(
                frame.taken, base_m - 0.08, base_m + asset.size_m[2] + 0.08, 0.1
            ):
                if high - low > asset.size_m[0] + 0.3:
                    box = face.box((low + high) / 2, base_m, asset.size_m)
                    if frame.put_where_free(asset, box):
                        return


def _hooks(frame: RoomFrame) -> None:
    """Coats at the entrance, where they leave the way free; else bare hooks on a bare wall."""
    offered = frame.stock.offered("hook_rail")
    with_coats = [asset for asset in offered if "coats" in asset.tags]
    bare = [asset for asset in offered if asset not in with_coats]
    for rails in (with_coats, bare):
        family = frame.stock.family(rails, "hook_rail")
        for asset in sorted(family, key=lambda a: (-a.size_m[0], a.id)):
            if _on_bare_wall(frame, asset, 1.72 - asset.size_m[2], from_floor=True):
                return


def _on_bare_wall(
    frame: RoomFrame, asset: Asset, base_m: float, *, from_floor: bool = False
) -> Item | None:
    """At the middle of the narrowest stretch that takes it; in the room of the front door, of
    those near it."""
    lowest = 0.1 if from_floor else base_m - 0.1
    spans = [
        (high - low + _away_m(frame, face, (low + high) / 2), face, (low + high) / 2)
        for face in frame.faces
        for low, high in face.free_spans(
            frame.taken, lowest, base_m + asset.size_m[2] + 0.05, asset.size_m[1] + 0.05
        )
        if high - low >= asset.size_m[0] + 0.2
    ]
    for _, face, middle in sorted(spans, key=lambda span: round(span[0], 3)):
        box = face.box(middle, base_m, asset.size_m)
        item = _put_beside_ways(frame, asset, box)
        if item is not None:
            return item
    return None


def _away_m(frame: RoomFrame, face: WallFace, along_m: float) -> float:
    """How much farther than AT_DOOR_M a place on a wall is from the front door of its room."""
    if frame.entrance is None:
        return 0.0
    door, hole = frame.entrance
    away = np.subtract(face.at(along_m, 0.0), door.at(hole.middle_m, 0.0))
    return max(0.0, float(np.hypot(*away)) - _AT_DOOR_M)


def _put_beside_ways(frame: RoomFrame, asset: Asset, box: Box) -> Item | None:
    """On the wall, where one still gets by."""
    is_in_way = asset.size_m[1] > PASSED_BY_M
    if is_in_way and not frame.walkways.stay_with(box):
        return None
    item = frame.put_where_free(asset, box)
    if item is not None and is_in_way:
        frame.walkways.take(box)
    return item


def _tall_mirror(frame: RoomFrame) -> None:
    """To see oneself whole, where a wall is bare to the floor."""
    if frame.entrance is None and not frame.draws.chance("tall_mirror", frame.taste.mirrors):
        return
    mirrors = within(frame.stock.offered("mirror"), (1.0, 0.1, 2.0), (0.3, 0.0, 0.7))
    tall = sorted(frame.stock.family(mirrors, "mirror/tall"), key=lambda a: (-a.size_m[2], a.id))
    for asset in tall[:2]:
        base_m = max(0.12, EYE_M + 0.1 - asset.size_m[2] / 2)
        if _on_bare_wall(frame, asset, base_m, from_floor=asset.size_m[2] > 1.2):
            return


def _shelves(frame: RoomFrame) -> None:
    """Over a desk, a cabinet, a toilet, or on a bare wall."""
    if not frame.draws.chance("shelf", min(1.0, frame.taste.shelves + (frame.kind == "store"))):
        return
    shelves = frame.stock.offered("wall_shelf")
    family = list(frame.stock.family(shelves, f"wall_shelf/{frame.kind}"))
    for item in [*frame.of("table"), *frame.of("toilet", "cabinet", "washing_machine")]:
        spot = _over(frame, item, 0.45)
        if spot is None:
            continue
        for asset in sorted(
            within(family, (spot.width_m, 0.35, 1.0)), key=lambda a: (-a.size_m[0], a.id)
        ):
            base_m = max(min(1.35, 1.9 - asset.size_m[2]), spot.base_m + 0.1)
            box = spot.face.box(spot.middle_m, base_m, asset.size_m)
            if frame.put_where_free(asset, box):
                return
    for asset in sorted(family, key=lambda a: (-a.size_m[0], a.id)):
        base_m = 1.4 if asset.size_m[2] < 0.5 else 1.0
        if _on_bare_wall(frame, asset, base_m, from_floor=frame.kind in ("store", "living")):
            return


def _wall_lamps(frame: RoomFrame) -> None:
    """At both sides of a bed whose tables carry no lamp; in corridors and outside one or two."""
    lamps = frame.stock.family(frame.stock.offered("wall_lamp"), f"wall_lamp/{frame.kind}")
    if not lamps or not frame.draws.chance("wall_lamps", frame.taste.wall_lamps):
        return
    asset = min(lamps, key=lambda a: (a.size_m[0], a.id))
    if frame.kind == "bedroom":
        for bed in frame.of("bed"):
            _beside_bed(frame, bed, asset)
    elif frame.kind in ("corridor", "balcony"):
        for face in sorted(frame.faces, key=lambda face: -face.length_m)[:3]:
            for low, high in face.free_spans(frame.taken, 1.4, 2.2, 0.25):
                is_dry = frame.kind == "corridor" or not face.is_outer
                box = face.box((low + high) / 2, 1.75, asset.size_m)
                if high - low > 1.0 and is_dry and _put_beside_ways(frame, asset, box):
                    return


def _beside_bed(frame: RoomFrame, bed: Item, asset: Asset) -> None:
    face = back_face(frame, bed, 0.35)
    lamps = [
        child for item in frame.of("bedside_table") for child in item.children
        if child.category == "table_lamp"
    ]  # fmt: skip
    if face is None or lamps:
        return
    low, high, _, _ = face.span_of(bed.box)
    aside = 0.22 + asset.size_m[0] / 2
    for middle in (low - aside, high + aside):
        frame.put_where_free(asset, face.box(middle, 1.35, asset.size_m))
