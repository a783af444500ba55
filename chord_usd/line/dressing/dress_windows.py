"""What hangs before windows: curtains on a rail, or a blind in the reveal."""

from __future__ import annotations

from dataclasses import dataclass

from chord_usd.base.places.taken_space import TakenSpace
from chord_usd.base.places.wall_frames import Hole, WallFace
from chord_usd.base.scene.trim import BOARD_FROM_M, BOARD_M, HANDLE_M, boards
from chord_usd.base.scene.types import ROOM_HEIGHT_M, WET_KINDS, Asset, Box
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import nearest_length, stretched, within

CURTAINED = ("living", "dining", "bedroom", "study", "unknown")
"""Kinds of rooms with curtains, in a house that has curtains."""

SCREENED = ("kitchen", *WET_KINDS, "corridor")
"""Kinds with blinds in any house."""

_OVER_M = 0.12
"""From the top of a window to the top of its rail."""

_LEAST_OVER_M = 0.05
_BELOW_CEILING_M = 0.02
_OFF_FLOOR_M = 0.015
_BELOW_SILL_M = 0.15
"""How far a curtain of sill length hangs below the sill, at most."""

_RAIL_DEPTH_M = 0.16

_BEFORE_BOARD_M = 0.05
"""From the wall to the back of a curtain: window boards stand out less."""

_STACK_M = 0.3
"""How far beside the window the rail goes on, for a curtain drawn aside."""

_COVERS = 0.22
"""Share of a window that a curtain drawn aside may cover."""

_GLASS_DOOR_FROM_M = 1.4
_BLIND_PROUD_M = 0.06
"""How far a blind in a reveal may stand out of it, so as to hang clear of handles."""

_REVEAL_SIDE_M = 0.006
_CLEAR_M = 0.004
_IN_WALL_M = 0.01
_WALL = ("pane", "rug", "front", "swing")


def dress_windows(frame: RoomFrame) -> None:
    """Curtains or blinds on every window where they fit; curtains beside glass doors."""
    curtains = frame.kind in CURTAINED and frame.house.chance("curtains", frame.taste.curtains)
    drawn = curtains and frame.draws.chance("sheers", frame.taste.sheers)
    for index, (face, hole) in enumerate(frame.holes("window")):
        if curtains and _curtain(frame, face, hole, drawn=drawn):
            continue
        if frame.kind in (*CURTAINED, *SCREENED):
            _blind(frame, face, hole, f"blind/{index}")
    if curtains:
        for face, hole in frame.holes("door"):
            if hole.width_m >= _GLASS_DOOR_FROM_M and (face.is_outer or _to_balcony(frame, hole)):
                _curtain(frame, face, hole, drawn=False)


def _to_balcony(frame: RoomFrame, hole: Hole) -> bool:
    return hole.opening.id in frame.balcony_doors


@dataclass(frozen=True)
class _Place:
    """Where a rail can be over a hole."""

    face: WallFace
    hole: Hole
    left_m: float
    right_m: float
    rail_top_m: float


def _curtain(frame: RoomFrame, face: WallFace, hole: Hole, *, drawn: bool) -> bool:
    """A rail with curtains; whether there is place for them."""
    place = _place_for(frame, face, hole)
    rails = frame.stock.family(frame.stock.offered("curtain_rail"), "curtain_rail")
    if place is None or not rails:
        return False
    rail = nearest_length(rails, place.right_m - place.left_m)
    assert rail is not None
    length = stretched(rail.size_m[0], place.right_m - place.left_m)
    if length > place.right_m - place.left_m + 1e-6 or length < hole.width_m * 0.8:
        return False
    middle = min(max(hole.middle_m, place.left_m + length / 2), place.right_m - length / 2)
    rail_box = face.box(middle, place.rail_top_m - rail.size_m[2], (length, *rail.size_m[1:]))
    hung = _hung(frame, place, rail_box, drawn=drawn) if drawn else []
    hung = hung or _hung(frame, place, rail_box, drawn=False)
    if not hung or not frame.fits(rail_box, _WALL):
        return False
    hanger = frame.put(rail, rail_box)
    for asset, box in hung:
        frame.put(asset, box, rests_on=hanger.id)
    return True


def _place_for(frame: RoomFrame, face: WallFace, hole: Hole) -> _Place | None:
    """The stretch over a hole where a rail can be."""
    top_m = min(hole.high_m + _OVER_M, ROOM_HEIGHT_M - _BELOW_CEILING_M)
    if top_m < hole.high_m + _LEAST_OVER_M:
        return None
    spans = face.free_spans(frame.taken, hole.high_m + 0.01, top_m, _RAIL_DEPTH_M, _WALL)
    for low, high in spans:
        if low <= hole.left_m + 0.05 and hole.right_m - 0.05 <= high:
            return _Place(
                face,
                hole,
                max(low + 0.02, hole.left_m - _STACK_M),
                min(high - 0.02, hole.right_m + _STACK_M),
                top_m,
            )
    return None


def _hung(frame: RoomFrame, place: _Place, rail: Box, *, drawn: bool) -> list[tuple[Asset, Box]]:
    """Curtains at both sides, as long as furniture lets them be; none where none fit."""
    hole, is_door = place.hole, place.hole.opening.kind == "door"
    curtains = _of_kind(frame, drawn=drawn)
    if not curtains:
        return []
    top_m = rail.center_m[2]
    to_floor = top_m - _OFF_FLOOR_M
    wanted = [(to_floor, to_floor)]
    if not is_door:
        wanted.append((top_m - hole.low_m, top_m - hole.low_m + _BELOW_SILL_M))
    for least, most in wanted:
        heights = {asset: stretched(asset.size_m[2], most) for asset in curtains}
        fitting = [
            curtain for curtain in curtains if least - 1e-6 <= heights[curtain] <= most + 1e-6
        ]
        if fitting:
            pair = _pair(frame, place, rail, fitting, heights[fitting[0]], drawn=drawn)
            if pair:
                return pair
    return []


def _of_kind(frame: RoomFrame, *, drawn: bool) -> tuple[Asset, ...]:
    """Curtains of the house's family, open or drawn."""
    offered = frame.stock.offered("curtain", "drawn" if drawn else "open")
    sheer = tuple(a for a in offered if "sheer" in a.tags)
    thick = tuple(asset for asset in offered if asset not in sheer)
    return frame.stock.family((sheer if drawn else thick) or offered, "curtain")


def _pair(
    frame: RoomFrame,
    place: _Place,
    rail: Box,
    curtains: list[Asset],
    height: float,
    *,
    drawn: bool,
) -> list[tuple[Asset, Box]]:
    """One at each end of the rail; a window by furniture may have but one."""
    hole, face = place.hole, place.face
    rail_from, rail_to, _, _ = face.span_of(rail)
    is_door = hole.opening.kind == "door"
    other_boards = _on_other_boards(frame, face)
    pair = []
    for is_left in (True, False):
        if drawn:
            wanted = (rail_to - rail_from) / 2
        else:
            beside = hole.left_m - rail_from if is_left else rail_to - hole.right_m
            wanted = beside + (0.0 if is_door else _COVERS * hole.width_m)
        asset = _of_length(curtains, wanted, drawn=drawn)
        if asset is None:
            continue
        length = stretched(asset.size_m[0], wanted) if drawn else min(
            asset.size_m[0], max(wanted, asset.size_m[0] * 0.85))  # fmt: skip
        if length > wanted + 1e-6:
            continue
        middle = rail_from + length / 2 if is_left else rail_to - length / 2
        v_m = max(_BEFORE_BOARD_M, face_depth(rail) / 2 - asset.size_m[1] / 2)
        size_m = (length, asset.size_m[1], height)
        box = face.box(middle, rail.center_m[2] - height, size_m, v_m)
        ignoring = ("rug", "front", "swing") if is_door else _WALL
        if frame.fits(box, ignoring) and not other_boards.hits(box):
            pair.append((asset, box))
    is_whole = len(pair) == 2 or (len(pair) == 1 and not drawn and hole.width_m < 1.3)
    return pair if is_whole else []


def _on_other_boards(frame: RoomFrame, face: WallFace) -> TakenSpace:
    """The boards of windows in other walls: two windows may meet in a corner."""
    taken = TakenSpace()
    for other in frame.faces:
        for hole in other.holes if other is not face else ():
            for board in boards(hole.opening, frame.room):
                taken.add(board, "pane")
    return taken


def face_depth(box: Box) -> float:
    """How far what hangs on a wall stands out from it."""
    return box.size_m[1]


def _of_length(curtains: list[Asset], wanted: float, *, drawn: bool) -> Asset | None:
    """The widest that is no wider than wanted, stretching included."""
    fitting = [a for a in curtains if a.size_m[0] * 0.85 <= wanted + 1e-6]
    if drawn:
        return nearest_length(curtains, wanted) if fitting else None
    return max(fitting, key=lambda a: (a.size_m[0], a.id), default=None)


def _blind(frame: RoomFrame, face: WallFace, hole: Hole, topic: str) -> bool:
    """A blind in the reveal; a wide window has several of one width."""
    free_m = hole.opening.box.size_m[1] / 2 - HANDLE_M - _CLEAR_M
    low, high = max(hole.left_m, 0.0), min(hole.right_m, face.length_m)
    width = high - low - 2 * _REVEAL_SIDE_M
    board_m = BOARD_M[0] if hole.low_m >= BOARD_FROM_M else 0.0
    tall = hole.high_m - hole.low_m - board_m - _IN_WALL_M
    blinds = within(frame.stock.offered("blind"), (9.0, free_m + _BLIND_PROUD_M, tall * 1.15))
    blinds = list(frame.stock.family(blinds, "blind"))
    if not blinds or width < 0.3:
        return False
    wanted = tall * (0.25 + 0.4 * frame.draws.share("blind"))
    best = None
    for count in range(1, 6):
        asset = min(
            blinds,
            key=lambda a: (
                round(abs(a.size_m[0] - width / count), 3),
                round(abs(a.size_m[2] - wanted), 3),
                a.id,
            ),
        )
        miss = abs(stretched(asset.size_m[0], width / count) - width / count)
        if miss < 1e-6:
            best = asset, count
            break
    if best is None:
        return False
    asset, count = best
    length, depth, height = width / count, asset.size_m[1], min(asset.size_m[2], tall)
    for index in range(count):
        middle = low + _REVEAL_SIDE_M + length * (index + 0.5)
        box = face.box(
            middle, hole.high_m - _IN_WALL_M / 2 - height, (length - 0.004, depth, height),
            -min(depth + _CLEAR_M, free_m),
        )  # fmt: skip
        if not frame.taken.hits(box, _WALL):
            frame.put(asset, box)
    return True
