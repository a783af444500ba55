"""What stands on boards: shelves, sills, low cabinets, counters, worktops, wardrobes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.geometry import in_world
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import ROOM_HEIGHT_M, WET_KINDS, Asset, Box, Item, learned_kind
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import within

_STANDS_M = 0.0005
"""Above the board, so that nothing is in it."""

_SUNK_M, _PROUD_M = 0.008, 0.002
"""What a thing stands on may lie so far below the top of its piece, and above: the tip of a
television's foot lifts nothing."""

_LEANS_WITHIN_M = 0.045
"""From the wall to the back of what leans on it."""

_FROM_EDGE_M = 0.025
_GAP_M = 0.018
"""Between the things of a group."""

_STEP_M, _STEPS = 0.08, 6
"""How a thing is moved along its board to where it is free."""

Wish = tuple[str, ...]
"""Categories of which one is put."""

_DISPLAY: tuple[Wish, ...] = (
    ("vase", "trailing_plant"), ("book_row", "storage_box"), ("sculpture", "bowl"),
    ("candle",), ("trailing_plant", "vase"), ("book_row",), ("sculpture", "candle"),
)  # fmt: skip
_HALL: tuple[Wish, ...] = (("bowl",), ("vase", "trailing_plant"), ("candle", "sculpture"),
                           ("storage_box",))  # fmt: skip
_SHELF: tuple[Wish, ...] = (("book_row",), ("trailing_plant",), ("vase", "sculpture"),
                            ("storage_box", "book_row"), ("candle", "bowl"))  # fmt: skip
_WORKTOP: tuple[Wish, ...] = (
    ("kettle",), ("utensil_jar",), ("cutting_board",), ("jar",), ("knife_block",),
    ("toaster", "coffee_machine"), ("jar", "bottle"), ("bowl",), ("bottle",), ("plate_stack",),
)  # fmt: skip
_SINK: tuple[Wish, ...] = (("soap_dispenser",), ("bottle", "utensil_jar"))
_BASIN: tuple[Wish, ...] = (("soap_dispenser",), ("toothbrush_cup",), ("bottle", "candle"))
_BATH_SHELF: tuple[Wish, ...] = (("towel_stack",), ("bottle",), ("trailing_plant", "candle"),
                                 ("bottle", "soap_dispenser"))  # fmt: skip
_TUB: tuple[Wish, ...] = (("bottle",), ("soap_dispenser", "bottle"))
_SILL: tuple[Wish, ...] = (("trailing_plant", "vase"), ("candle", "sculpture"),
                           ("trailing_plant",))  # fmt: skip
_COOK_SILL: tuple[Wish, ...] = (("trailing_plant",), ("jar", "bottle"), ("utensil_jar",))
_HIGH: tuple[Wish, ...] = (("storage_box",), ("storage_box",))
_COOK_SHELF: tuple[Wish, ...] = (("jar",), ("bowl", "plate_stack"), ("bottle", "jar"),
                                 ("trailing_plant",))  # fmt: skip


@dataclass(frozen=True)
class Board:
    """A level stretch on which things stand, in the world; they face its front."""

    box: Box
    """Footprint and height of the board; size z is the clear height over it."""
    rests_on: str | None
    wishes: tuple[Wish, ...]
    most: int
    """Most things."""
    groups: int = 1
    at_back: bool = True
    """Whether things stand at the back edge rather than about the middle."""
    may_leave_room: bool = False
    """A sill lies in the wall."""
    host: Item | None = None
    """The piece whose relief says where it is level."""
    within: tuple[str, ...] = ()
    """Id of the piece that it is inside of."""


def dress_boards(frame: RoomFrame) -> None:
    """Boards in turn; the same thing does not stand twice in a room where others are offered."""
    used: dict[str, int] = {}
    for index, board in enumerate(_boards(frame)):
        _fill(frame, board, frame.draws.rng(f"board/{index}"), used)


def _boards(frame: RoomFrame) -> list[Board]:
    boards = []
    for item in (*frame.dressed("wall_shelf", "wall_cabinet"), *frame.pieces):
        if item.category in _OPEN:
            boards += _inside(frame, item)
    for item in frame.pieces:
        board = _on_piece(frame, item)
        if board is not None:
            boards.append(board)
    if frame.kind != "balcony":
        boards += _sills(frame)
    return boards


def _count(frame: RoomFrame, length_m: float, each_m: float, most: int) -> int:
    """How many things a length carries in this style."""
    return max(1, min(most, round(frame.taste.boards * 2.0 * length_m / each_m)))


_OPEN = ("wall_shelf", "wall_cabinet", "cabinet", "dining_cabinet", "tv_cabinet", "bedside_table",
         "shoe_cabinet")  # fmt: skip
"""Categories that may have open boards."""

_MOST_INSIDE = 14


def _inside(frame: RoomFrame, item: Item) -> list[Board]:
    """The open boards of a shelf or cabinet."""
    wishes = {"bathroom": _BATH_SHELF, "kitchen": _COOK_SHELF, "store": _HIGH}.get(
        learned_kind(frame.kind), _SHELF
    )
    inner = []
    size_m = item.asset.size_m if item.asset else item.box.size_m
    share = np.tile(np.divide(item.box.size_m, size_m), 2)
    for low_x, front, low_z, high_x, back, high_z in frame.boards(item) * share:
        local = Box(
            ((low_x + high_x) / 2, (front + back) / 2, low_z),
            (high_x - low_x - 0.02, back - front, high_z - low_z - 0.01), 0.0,
        )  # fmt: skip
        most = _count(frame, high_x - low_x, 0.22, 6)
        groups = 1 + (high_x - low_x > 0.7)
        inner.append(
            Board(in_world(local, item.box), item.id, wishes, most, groups, within=(item.id,))
        )
    return inner[:_MOST_INSIDE]


def _top_of(item: Item, clear_m: float) -> Box:
    length, depth, height = item.box.size_m
    clear = min(clear_m, ROOM_HEIGHT_M - height - 0.03)
    top = Box((0.0, 0.0, height), (length, depth, clear), 0.0)
    return in_world(top, item.box)


_LOW, _WORKTOPS = having("sideboard"), having("floor_cabinet")


def _on_piece(frame: RoomFrame, item: Item) -> Board | None:
    """The top of a piece of furniture, if it is one that carries things."""
    length, _, height = item.box.size_m
    name = item.category
    if name in _LOW and height <= 1.35:
        wishes = _HALL if name == "shoe_cabinet" or frame.kind == "corridor" else _DISPLAY
        most = _count(frame, length, 0.3, 7) - len(item.children)
        return Board(_top_of(item, 0.6), item.id, wishes, most, 1 + (length > 0.9), host=item
                     if name == "tv_cabinet" else None) if most > 0 else None  # fmt: skip
    if name in _LOW and height > 1.7:
        return Board(_top_of(item, 0.45), item.id, _HIGH, 2 if length > 0.8 else 1)
    if name in _WORKTOPS and height < 1.0:
        most = max(0, min(4, int(length / 0.2)) - len(item.children))
        return Board(_top_of(item, 0.48), item.id, _WORKTOP, most, host=item) if most else None
    if name == "sink_cabinet":
        return Board(_top_of(item, 0.4), item.id, _SINK, 2, host=item)
    if name == "cooker_cabinet":
        return None
    if name == "washbasin":
        return Board(_top_of(item, 0.35), item.id, _BASIN, 3, host=item)
    if name == "bathtub":
        return Board(_top_of(item, 0.4), item.id, _TUB, 2, host=item)
    if name == "washing_machine":
        return Board(_top_of(item, 0.45), item.id, _BATH_SHELF, 2)
    return None


def _sills(frame: RoomFrame) -> list[Board]:
    """Window boards, but for those behind curtains that are drawn."""
    boards = []
    for index, (face, hole) in enumerate(frame.holes("window")):
        if not 0.5 < hole.low_m < 1.4 or not frame.draws.chance(f"sill/{index}", 0.6):
            continue
        reveal_m = hole.opening.box.size_m[1] / 2 - 0.04
        box = face.box(
            hole.middle_m, hole.low_m + 0.0225, (hole.width_m - 0.2, reveal_m, 0.4), -reveal_m
        )
        wishes = _COOK_SILL if frame.kind == "kitchen" else (
            _BATH_SHELF[1:] if frame.kind in WET_KINDS else _SILL)  # fmt: skip
        boards.append(Board(box, None, wishes, _count(frame, hole.width_m, 0.6, 3),
                            may_leave_room=True))  # fmt: skip
    return boards


def _fill(frame: RoomFrame, board: Board, rng: np.random.Generator, used: dict[str, int]) -> None:
    """Groups along the board: the tallest at one end of each, the others stepping down."""
    things = _chosen(frame, board, rng, used)
    if not things:
        return
    groups = _grouped(things, min(board.groups, max(1, len(things) // 2)))
    length = board.box.size_m[0]
    anchors = _anchors(len(groups), symmetric=frame.taste.symmetric, rng=rng)
    for group, anchor in zip(groups, anchors, strict=True):
        _stand_group(frame, board, group, (anchor - 0.5) * length, rng)


def _chosen(
    frame: RoomFrame, board: Board, rng: np.random.Generator, used: dict[str, int]
) -> list[Asset]:
    """Things for a board, of different kinds before any kind twice."""
    length, depth, clear = board.box.size_m
    most_m = (length - 2 * _FROM_EDGE_M, depth - 0.01, clear - 0.02)
    start = int(rng.integers(0, len(board.wishes)))
    wishes = [*board.wishes[start:], *board.wishes[:start]] * 2
    if board.wishes in (_WORKTOP, _BASIN, _SINK):
        wishes = list(board.wishes)
    assets: list[Asset] = []
    for wish in wishes[: board.most + 3]:
        if len(assets) >= board.most:
            break
        if rng.random() > frame.taste.little + 0.15:
            continue
        names = [name for name in wish if _offered(frame, name)]
        if not names:
            continue
        name = names[int(rng.integers(0, len(names)))]
        if board.wishes is _WORKTOP and used.get(name, 0) >= (
            2 if name in ("jar", "bottle") else 1
        ):
            continue
        fitting = within(_offered(frame, name), most_m)
        least = min((used.get(a.id, 0) for a in fitting), default=0)
        fresh = [a for a in fitting if used.get(a.id, 0) == least]
        for asset in frame.stock.some(fresh, rng, 1):
            assets.append(asset)
            used[asset.id] = used.get(asset.id, 0) + 1
            used[name] = used.get(name, 0) + 1
    return assets


def _offered(frame: RoomFrame, name: str) -> Sequence[Asset]:
    """The assets of a category; bottles suit the room's kind."""
    if name == "bottle":
        tag = "bath" if frame.kind in WET_KINDS else "kitchen"
        return frame.stock.offered(name, tag) or frame.stock.offered(name)
    return frame.stock.offered(name)


def _grouped(things: list[Asset], count: int) -> list[list[Asset]]:
    """The things dealt to groups, each with its tallest first."""
    ranked = sorted(things, key=lambda a: (-a.size_m[2], a.id))
    groups = [ranked[index::count] for index in range(count)]
    return [group for group in groups if group]


def _anchors(count: int, *, symmetric: bool, rng: np.random.Generator) -> list[float]:
    """Shares of the board's length about which groups stand."""
    if count == 1:
        if symmetric:
            return [0.5]
        return [0.3 if rng.random() < 0.5 else 0.7]
    ends = [0.2, 0.8]
    if not symmetric and rng.random() < 0.5:
        ends.reverse()
    return [*ends, 0.5][:count]


def _stand_group(
    frame: RoomFrame, board: Board, group: Sequence[Asset], about: float, rng: np.random.Generator
) -> None:
    """Side by side, touching nothing; where that is taken, a little farther along the board."""
    length = board.box.size_m[0]
    total = sum(a.size_m[0] for a in group) + _GAP_M * (len(group) - 1)
    half = length / 2 - _FROM_EDGE_M
    start = float(np.clip(about - total / 2, -half, max(-half, half - total)))
    outward = about >= 0.0
    ordered = list(reversed(group)) if outward else list(group)
    x = start
    for asset in ordered:
        placed = None
        for step in range(_STEPS):
            middle = x + asset.size_m[0] / 2 + _STEP_M * step
            if middle + asset.size_m[0] / 2 > half + 1e-6:
                break
            placed = _stand(frame, board, asset, middle, rng)
            if placed:
                x = middle + asset.size_m[0] / 2 + _GAP_M
                break


def _stand(
    frame: RoomFrame, board: Board, asset: Asset, x: float, rng: np.random.Generator
) -> bool:
    """One thing at this place along the board."""
    _, depth, _ = board.box.size_m
    room = (depth - asset.size_m[1]) / 2 - 0.005
    if room < 0.0:
        return False
    is_flat = asset.category in ("cutting_board", "book_row", "toaster")
    jitter = 0.0 if is_flat else float(rng.uniform(-0.3, 0.3))
    share = (1.0 if is_flat else 0.35 + 0.4 * jitter) if board.at_back else 0.4 * jitter
    # What leans needs the wall behind it.
    leans = asset.category == "cutting_board"
    for part in (0.93, 0.88, 0.84) if leans else (share, 0.9, 0.0):
        y = room * part
        box = in_world(Box((x, y, _STANDS_M), asset.size_m, 0.0), board.box)
        if not _carries(frame, board, box, x, y, asset):
            continue
        if leans and not frame.has_wall_behind(box, _LEANS_WITHIN_M):
            continue
        ignoring = ("rug", "pane") if board.may_leave_room else ("rug",)
        free = not frame.taken.hits(box, ignoring, board.within)
        if free and (board.may_leave_room or frame.is_inside(box)):
            frame.put(asset, box, rests_on=board.rests_on)
            return True
    return False


def _carries(frame: RoomFrame, board: Board, box: Box, x: float, y: float, asset: Asset) -> bool:
    """Whether the piece is level below a thing."""
    if board.host is None:
        return True
    relief = frame.relief(board.host)
    local = Box((x, y, 0.0), asset.size_m, 0.0)
    top_m = board.host.box.size_m[2]
    mask, window = relief.under(local)
    heights = relief.heights_m[window][mask]
    over_m = heights - top_m
    return bool(heights.size) and bool(np.all((over_m > -_SUNK_M) & (over_m < _PROUD_M)))
