"""What lies and stands on floors: rugs, mats, lamps, plants, baskets, bins."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from chord_usd.base.places.taken_space import as_underfoot
from chord_usd.base.places.wall_frames import Hole, WallFace
from chord_usd.base.scene.geometry import footprint_polygon, to_own, to_world
from chord_usd.base.scene.palette import Mount, category, having
from chord_usd.base.scene.types import WET_KINDS, Asset, Box, FloatArray, Item
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import within

_FROM_WALL_M = 0.06
_RUG_FROM_WALL_M = 0.04
_MOST = 1.35
"""A rug's sides over those wanted, at most."""

"""What may stand on a rug in part."""

_ALL_BUT_PIECES = ("clear", "pane", "dressing", "open", "front", "swing")
_DOORS_SWING = ("piece", "dressing", "pane", "open", "front", "swing")
_MEETS_M = 0.02


def dress_rugs(frame: RoomFrame) -> None:
    """One rug or mat for what a room is about."""
    if frame.kind in WET_KINDS:
        _bath_mat(frame)
    elif frame.kind == "corridor":
        _runner(frame)
    elif frame.kind == "kitchen":
        _kitchen_mat(frame)
    if frame.entrance is not None:
        _doormat(frame, *frame.entrance)
    if frame.kind in ("living", "bedroom", "study", "dining", "unknown") and frame.draws.chance(
        "rug", frame.taste.rugs
    ):
        _rugs(frame)


def _rugs(frame: RoomFrame) -> None:
    for sofa in frame.of("sofa"):
        if _under_sofa(frame, sofa):
            break
    for bed in frame.of("bed"):
        if _under_bed(frame, bed):
            break
    for table in frame.of("dining_table"):
        if frame.draws.chance("dining_rug", 0.6):
            size_m = table.box.size_m
            _lay(frame, table.box, (0.0, 0.0), (size_m[0] + 1.1, size_m[1] + 1.1), least=0.85)
    if frame.kind == "study":
        for desk in frame.of("table")[:1]:
            _lay(frame, desk.box, (0.0, -0.5 * desk.box.size_m[1] - 0.25), (1.7, 1.3), least=0.7)
    if not frame.dressed("rug") and not frame.of("sofa", "bed", "dining_table"):
        for seat in frame.of("leisure_sofa", "single_sofa")[:1]:
            _lay(frame, seat.box, (0.0, -0.35), (1.4, 1.4), least=0.6)


def _under_sofa(frame: RoomFrame, sofa: Item) -> bool:
    """Its back edge under the sofa's front, the coffee table on it."""
    length, depth, _ = sofa.box.size_m
    wanted = (min(length + 0.3, 3.2), 1.9)
    back = -depth / 2 + 0.25
    tables = frame.of("coffee_table")
    if tables:
        front = min(to_own(sofa.box, table.box.center_m[:2])[1] for table in tables)
        wanted = (wanted[0], float(np.clip(back - (front - 0.55), 1.3, 2.4)))
    return _lay(frame, sofa.box, (0.0, back), wanted, least=0.55, anchored=True)


def _under_bed(frame: RoomFrame, bed: Item) -> bool:
    """Under the lower two thirds of a wide bed; beside a narrow one."""
    length, depth, _ = bed.box.size_m
    if length >= 1.35:
        wanted = (length + 1.1, 1.7)
        at = -depth / 2 + 0.6 - wanted[1] / 2 + 0.55
        if _lay(frame, bed.box, (0.0, at), wanted, least=0.8):
            return True
    for side in (1, -1):
        at_side = (side * (length / 2 + 0.5), -0.1)
        if _lay(frame, bed.box, at_side, (0.7, 1.4), least=0.7):
            return True
    return False


def _lay(
    frame: RoomFrame,
    about: Box,
    at: tuple[float, float],
    wanted: tuple[float, float],
    *,
    least: float,
    anchored: bool = False,
    category: str = "rug",
) -> bool:
    """A rug in the frame of a piece, the one nearest in size that can lie there.

    at: its middle; with anchored, the middle of its back edge. least: share of what is wanted that
    its sides must have.
    """
    offered = frame.stock.offered(category)
    rugs = [_Turned(asset, turned) for asset in offered for turned in (False, True)]
    rugs = [rug for rug in rugs if rug.suits(wanted, least)]
    chosen = frame.stock.family([rug.asset for rug in rugs], f"{category}/{frame.room.id}")
    rugs.sort(key=lambda rug: (rug.asset not in chosen, rug.misses(wanted), rug.asset.id))
    for rug in rugs[:14]:
        local = (at[0], at[1] - rug.across_m / 2) if anchored else at
        x, y = to_world(about, local)
        yaw_deg = about.yaw_deg + (90.0 if rug.turned else 0.0)
        box = Box((float(x), float(y), 0.0), rug.asset.size_m, yaw_deg)
        if can_lie(frame, box):
            frame.put(rug.asset, box, reason=as_underfoot(box))
            return True
    return False


@dataclass(frozen=True)
class _Turned:
    """A rug that lies along a piece or, turned, across it."""

    asset: Asset
    turned: bool

    @property
    def along_m(self) -> float:
        return self.asset.size_m[int(self.turned)]

    @property
    def across_m(self) -> float:
        return self.asset.size_m[1 - int(self.turned)]

    def suits(self, wanted: tuple[float, float], least: float) -> bool:
        """Whether both sides are near enough to what is wanted."""
        sides = zip((self.along_m, self.across_m), wanted, strict=True)
        return all(least * want <= side <= _MOST * want for side, want in sides)

    def misses(self, wanted: tuple[float, float]) -> float:
        """By how much it is too large or too small."""
        sides = zip((self.along_m, self.across_m), wanted, strict=True)
        return round(sum(abs(math.log(side / want)) for side, want in sides), 2)


def can_lie(frame: RoomFrame, box: Box) -> bool:
    """Whether a rug is in the room, off its walls and doors, and under nothing built in.

    Nothing stands in the pile of a thick one.
    """
    shape = footprint_polygon(box)
    if not frame.floor.buffer(-_RUG_FROM_WALL_M).covers(shape):
        return False
    if frame.taken.hits(box, _DOORS_SWING):
        return False
    return not _is_stood_in(frame, box)


def _is_stood_in(frame: RoomFrame, box: Box) -> bool:
    """Whether something stands where a rug would lie that cannot stand on it."""
    shape, is_flat = footprint_polygon(box), as_underfoot(box) == "rug"
    return any(
        shapely.intersection(shape, footprint_polygon(item.box)).area > (0.02 if is_flat else 1e-4)
        for item in _standing(frame)
        if not (is_flat and item.category in having("on_rug"))
    )


def _standing(frame: RoomFrame) -> Iterator[Item]:
    """What stands on the floor of a room so far."""
    yield from (item for item in frame.pieces if item.box.center_m[2] < 0.5)
    for item in frame.placed:
        if category(item.category).mount is Mount.FLOOR and item.facts.rests_on is None:
            yield item


def _indoor_mats(frame: RoomFrame) -> list[Asset]:
    """Mats but for those that shoes are wiped on."""
    offered = frame.stock.offered("mat")
    return [asset for asset in offered if "doormat" not in asset.tags]


def _bath_mat(frame: RoomFrame) -> None:
    """Before the tub or the shower, else before the basin."""
    mats = frame.stock.family(_indoor_mats(frame), "mat/bath")
    for piece in frame.of("bathtub", "shower", "washbasin"):
        for asset in sorted(mats, key=lambda a: (-a.size_m[0], a.id)):
            for way in _ways(piece.box):
                box = _before(piece.box, way, asset)
                if can_lie(frame, box):
                    frame.put(asset, box, reason=as_underfoot(box))
                    return


def _ways(box: Box) -> Iterator[tuple[int, int]]:
    """Sides of a piece, its front first; of a tub the long side before the ends."""
    yield 0, -1
    if box.size_m[0] >= box.size_m[1]:
        yield 0, 1
    yield 1, 0
    yield -1, 0


def _before(piece: Box, way: tuple[int, int], asset: Asset) -> Box:
    across = way[0] != 0
    reach = piece.size_m[0] / 2 if across else piece.size_m[1] / 2
    off = reach + 0.04 + asset.size_m[1] / 2
    x, y = to_world(piece, (way[0] * off, way[1] * off))
    yaw = piece.yaw_deg + (90.0 if across else 0.0)
    return Box((float(x), float(y), 0.0), asset.size_m, yaw)


def _kitchen_mat(frame: RoomFrame) -> None:
    if not frame.draws.chance("kitchen_mat", 0.6):
        return
    mats = [*_indoor_mats(frame), *within(frame.stock.offered("rug"), (1.6, 0.75, 1.0))]
    for piece in frame.of("sink_cabinet"):
        for asset in frame.stock.some(mats, frame.draws.rng("kitchen_mat"), 4):
            box = _before(piece.box, (0, -1), asset)
            if can_lie(frame, box):
                frame.put(asset, box, reason=as_underfoot(box))
                return


def _runner(frame: RoomFrame) -> None:
    """Along the middle of a corridor, clear of its walls and of doors that swing into it."""
    corners = np.asarray(shapely.minimum_rotated_rectangle(frame.floor).exterior.coords)
    side = corners[1:3] - corners[:2]
    lengths = np.hypot(*side.T)
    x, y = side[int(np.argmax(lengths))]
    yaw = math.degrees(math.atan2(y, x))
    long, wide = float(lengths.max()), float(lengths.min())
    rugs = within(frame.stock.offered("rug"), (0.8 * long, 0.75 * wide, 1.0))
    runners = [a for a in rugs if a.size_m[0] > 1.8 * a.size_m[1]]
    middle = frame.floor.centroid
    for asset in sorted(runners, key=lambda a: (-a.size_m[0], a.id))[:6]:
        for step in (0.0, 0.2, -0.2, 0.4, -0.4, 0.7, -0.7):
            at = np.array([middle.x, middle.y]) + step * np.array([x, y]) / max(long, 1e-6)
            box = Box((float(at[0]), float(at[1]), 0.0), asset.size_m, yaw)
            # Leaves open over a runner: it is thin, but rugs at thresholds fray and trip.
            if can_lie(frame, box):
                frame.put(asset, box, reason=as_underfoot(box))
                return


def _doormat(frame: RoomFrame, face: WallFace, hole: Hole) -> None:
    """Just inside the front door."""
    mats = frame.stock.family(frame.stock.offered("mat", "doormat") or frame.stock.offered("mat"),
                              "mat/door")  # fmt: skip
    for asset in sorted(mats, key=lambda a: (-a.size_m[0], a.id)):
        if asset.size_m[0] <= hole.width_m:
            box = face.box(hole.middle_m, 0.0, asset.size_m, 0.08)
            lies = frame.is_inside(box) and not _is_stood_in(frame, box)
            if lies and not frame.taken.hits(
                box, ("clear", "pane", "dressing", "open", "front", "swing")
            ):
                frame.put(asset, box, reason=as_underfoot(box))
                return


def dress_floor(frame: RoomFrame) -> None:
    """What stands on the floor, at most what keeps the ways through the room."""
    kind, rng = frame.kind, frame.draws.rng("floor")
    area = frame.floor.area
    if kind in ("living", "study", "bedroom") and area > 8.0:
        near = frame.of("sofa", "leisure_sofa", "single_sofa", "table")
        if near and (kind != "bedroom" or rng.random() < 0.4):
            _stand(frame, "floor_lamp", near[0], rng, beside=True)
    if kind in ("living", "dining", "study", "bedroom", "balcony", "corridor", "unknown"):
        most = frame.taste.plants if area > 9.0 else 1
        count = int(rng.integers(1, most + 1)) + (2 if kind == "balcony" else 0)
        for _ in range(count):
            _stand(frame, "floor_plant", None, rng)
    if kind in ("living", "bedroom", "bathroom", "washroom"):
        near = frame.of("sofa", "bed", "washbasin", "washing_machine")
        if rng.random() < 0.75:
            _stand(frame, "basket", near[0] if near else None, rng, beside=True)
    if kind in ("study", "kitchen"):
        near = frame.of("table", "sink_cabinet", "single_door_floor_cabinet")
        _stand(frame, "bin", near[0] if near else None, rng, beside=True)
    if kind == "corridor":
        _stand(frame, "umbrella_stand", None, rng)
    if kind == "store":
        for _ in range(3):
            _stand(frame, "basket", None, rng)


def _stand(
    frame: RoomFrame,
    category: str,
    near: Item | None,
    rng: np.random.Generator,
    *,
    beside: bool = False,
) -> bool:
    """Stand one thing beside a piece, in a corner or at the end of a free stretch of wall."""
    offered = frame.stock.offered(category)
    used = {item.asset.id for item in frame.dressed(category) if item.asset}
    fresh = [asset for asset in offered if asset.id not in used] or list(offered)
    if category in ("floor_lamp", "bin", "umbrella_stand"):
        fresh = list(frame.stock.family(fresh, f"{category}/{frame.kind}"))
    for asset in frame.stock.some(fresh, rng, 3):
        for box in _floor_places(frame, asset, near, beside=beside):
            if frame.fits(box) and frame.walkways.stay_with(box):
                frame.put(asset, box)
                frame.walkways.take(box)
                return True
    return False


def _floor_places(frame: RoomFrame, asset: Asset, near: Item | None, *, beside: bool) -> list[Box]:
    """Places in the order in which they are wanted."""
    size_m = asset.size_m
    first: list[Box] = []
    if near is not None and beside:
        length, depth, _ = near.box.size_m
        for side in (1, -1):
            x = side * (length / 2 + size_m[0] / 2 + 0.05)
            y = depth / 2 - size_m[1] / 2 - 0.03
            at = to_world(near.box, (x, y))
            first.append(Box((float(at[0]), float(at[1]), 0.0), size_m, near.box.yaw_deg))
    at_walls = [*_corners(frame, size_m), *_ends(frame, size_m)]
    if near is not None:
        at_walls.sort(key=lambda box: round(math.dist(box.center_m[:2], near.box.center_m[:2]), 2))
    return [*first, *at_walls[:16]]


def _corners(frame: RoomFrame, size_m: tuple[float, float, float]) -> list[Box]:
    """Convex corners of the room, those near windows first."""
    boxes = []
    for face in frame.faces:
        for other in frame.faces:
            # Where a wall begins at its left, another ends at its right.
            right_end = other.start_m + other.along * other.length_m
            meets = other is not face and math.dist(right_end, face.start_m) < _MEETS_M
            is_square = abs(float(face.inward @ other.inward)) < 0.1
            if (
                meets
                and is_square
                and _is_floor(frame, face.start_m + 0.05 * (face.inward + other.inward))
            ):
                u = _FROM_WALL_M + size_m[0] / 2
                boxes.append(face.box(u, 0.0, size_m, _FROM_WALL_M))
    windows = [hole.opening.box.center_m[:2] for _, hole in frame.holes("window")]
    if windows:
        boxes.sort(key=lambda box: round(min(math.dist(box.center_m[:2], w) for w in windows), 2))
    return boxes


def _is_floor(frame: RoomFrame, point_m: FloatArray) -> bool:
    return bool(frame.floor.covers(shapely.Point(point_m)))


def _ends(frame: RoomFrame, size_m: Sequence[float]) -> list[Box]:
    """Beside what stands at walls: the ends of the free stretches."""
    boxes = []
    for face in frame.faces:
        spans = face.free_spans(frame.taken, 0.0, size_m[2], size_m[1] + _FROM_WALL_M)
        for low, high in spans:
            if high - low < size_m[0] + 0.1:
                continue
            for middle in (low + 0.05 + size_m[0] / 2, high - 0.05 - size_m[0] / 2):
                boxes.append(face.box(middle, 0.0, (size_m[0], size_m[1], size_m[2]), _FROM_WALL_M))
    return boxes
