"""SceneGraph -> SceneGraph: what somebody asked for, done to the pieces of a house.

Nothing is done half: what has no place raises a ChordError that says what is in its way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import count

from chord_usd.base.scene.intents import Intent, NewPiece
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Asset, Box, Item
from chord_usd.line.arrange.asked_moves import face, move, swap, turn
from chord_usd.line.arrange.asked_places import Floor
from chord_usd.line.arrange.asked_work import Work, best_place, called, refused, score_of
from chord_usd.line.graph.match import Database


def carry_out(work: Work, intents: Sequence[Intent]) -> Work:
    """Do it, one after the other. Raises ChordError for what cannot be done."""
    for intent in intents:
        touched = [item_id for item_id in intent.items if item_id in work.locked]
        if touched and intent.action not in ("lock", "unlock"):
            raise refused(intent, f"{touched[0].split('/')[-1]} is locked", try_="unlock it first")
        _ACTIONS[intent.action](work, intent)
    return work


def _add(work: Work, intent: Intent) -> None:
    assert intent.new is not None
    for _ in range(intent.count):
        _place_new(work, intent, intent.new, frozenset())


def _place_new(work: Work, intent: Intent, new: NewPiece, gone: frozenset[str]) -> Item:
    """Put a new piece where the intent wants it; of smaller ones, where the usual has no place."""
    floor = Floor(work.graph, work.room(intent.room), gone)
    old = work.item(intent.items[0]) if intent.action == "replace" else None
    for asset in _assets(work.database(), new):
        item = _new_item(work, new.category, asset, intent.room)
        placed = best_place(work, floor, item, score_of(work, floor, intent, old))
        if placed:
            work.put(placed)
            work.new.add(placed.id)
            return placed
    raise refused(
        intent, f"no place was found in {called(work, intent.room)}", "what the room has place for"
    )


def _assets(database: Database, new: NewPiece) -> Iterator[Asset]:
    """Pieces to try, the usual one first, then smaller ones."""
    row = category(new.category)
    least, most = new.length_m
    low, high = max(row.length_m[0], least), min(row.length_m[1], most)
    shares = {"": (0.45, 0.2, 0.0), "small": (0.0,), "large": (0.9, 0.7)}[new.size]
    seen = set()
    for share in shares:
        size_m = (
            low + share * (high - low),
            row.width_m[0] + share * (row.width_m[1] - row.width_m[0]),
            sum(row.height_m) / 2,
        )
        asset = database.nearest(new.category, size_m)
        if asset.id not in seen and least - 0.08 <= asset.size_m[0] <= most + 0.08:
            seen.add(asset.id)
            yield asset


def _new_item(work: Work, name: str, asset: Asset, room_id: str) -> Item:
    ids = {item.id for item in (*work.graph.items, *work.graph.dressing)} | work.moved.keys()
    item_id = next(i for n in count() if (i := f"{room_id}/{name}_{n}") not in ids)
    row = category(name)
    x, y = work.room(room_id).polygon_m.mean(axis=0)
    box = Box((float(x), float(y), row.mount_height_m), asset.size_m, 0.0)
    return Item(item_id, name, box, room_id, asset)


def _replace(work: Work, intent: Intent) -> None:
    assert intent.new is not None
    (old_id,) = intent.items
    gone = frozenset([old_id, *(item.id for item in work.resting_on(old_id))])
    _place_new(work, intent, intent.new, gone)
    work.remove(list(gone))


def _remove(work: Work, intent: Intent) -> None:
    for item_id in intent.items:
        work.remove([item_id, *(item.id for item in work.resting_on(item_id))])


def _style(work: Work, intent: Intent) -> None:
    work.styles[intent.room] = intent.style


def _lock(work: Work, intent: Intent) -> None:
    for item_id in intent.items:
        work.locks[item_id] = intent.action == "lock"
        (work.locked.add if intent.action == "lock" else work.locked.discard)(item_id)


_ACTIONS: dict[str, Callable[[Work, Intent], None]] = {
    "add": _add, "remove": _remove, "move": move, "turn": turn, "face": face, "swap": swap,
    "replace": _replace, "style": _style, "lock": _lock, "unlock": _lock,
}  # fmt: skip
