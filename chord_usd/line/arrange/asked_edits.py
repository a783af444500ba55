"""SceneGraph -> SceneGraph: what somebody asked for, done to the pieces of a house.

Nothing is done half: what has no place raises a ChordError that says what is in its way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import NamedTuple

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.intents import Intent, NewPiece
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Asset, Box, Item
from chord_usd.library.colourways import colourway_like, offer_of
from chord_usd.library.component import COLOUR_VARIANT_SET as COLOUR
from chord_usd.library.looks.look_words import look_wanted
from chord_usd.line.arrange.asked_leeway import is_measured, leeways
from chord_usd.line.arrange.asked_moves import face, move, swap, turn
from chord_usd.line.arrange.asked_places import Floor
from chord_usd.line.arrange.asked_work import (
    Catalogue,
    Score,
    Work,
    best_place,
    called,
    refused,
    score_of,
    with_resting,
)

_ASIDE_M = 2.5
"""What gives way goes no farther."""

_LIKE, _ALIKE = 0.15, 0.5
"""Models whose length differs by no larger share are of like size; where a form is asked for, too,
by the second."""


def carry_out(work: Work, intents: Sequence[Intent]) -> Work:
    """The house with everything done, one after the other. Raises ChordError for what cannot be.

    Of the candidates of each (asked_leeway) the first is taken that makes nothing worse, as the
    work judges; where there is none, the first that can be done.
    """
    for intent in intents:
        touched = [item_id for item_id in intent.items if item_id in work.locked]
        if touched and intent.action not in ("lock", "unlock"):
            raise refused(intent, f"{touched[0].split('/')[-1]} is locked", try_="unlock it first")
        work = _done(work, intent)
    return work


def _done(work: Work, intent: Intent) -> Work:
    possible: list[Work] = []
    errors: list[ChordError] = []
    for leeway in leeways(intent):
        tried = work.tried(intent, leeway)
        try:
            _ACTIONS[intent.action](tried, intent)
            _give_way(tried, intent)
        except ChordError as error:
            errors.append(error)
            continue
        possible.append(tried)
        if not work.judge(work.graph, tried.graph):
            return tried
    if not possible:
        raise errors[0]
    return possible[0]


def _give_way(work: Work, intent: Intent) -> None:
    """Move things that may give way from under pieces that have moved."""
    assert work.start is not None
    stood = {item.id: item.box for item in work.start.items}
    came = [item for item in work.graph.items if stood.get(item.id) != item.box]
    moved = []
    for thing_id in sorted(work.aside):
        thing = work.item(thing_id)
        arrived = replace(work.graph, items=tuple(i for i in came if i.id != thing.id), dressing=())
        if not Floor(arrived, work.room(thing.room_id)).is_taken(thing):
            continue
        floor = Floor(work.graph, work.room(thing.room_id), with_resting(work, [thing]))
        place = best_place(replace(work, graph=work.graph.without({thing.id})), floor, thing,
                           _near(thing))  # fmt: skip
        if place is None:
            raise refused(intent, f"{category(thing.category).label.lower()} blocks it")
        work.move(thing, place.box)
        moved.append(category(thing.category).label.lower())
    if moved:
        work.notes.append(f"{', '.join(dict.fromkeys(moved))} moved aside")


def _near(thing: Item) -> Score:
    """The nearest place to where a thing is, within a few steps."""

    def score(placed: Item) -> tuple[float, ...] | None:
        away_m = math.dist(placed.box.center_m[:2], thing.box.center_m[:2])
        return (away_m,) if away_m < _ASIDE_M else None

    return score


def _add(work: Work, intent: Intent) -> None:
    assert intent.new is not None
    for _ in range(intent.count):
        _place_new(work, intent, intent.new)


def _place_new(work: Work, intent: Intent, new: NewPiece, old: Item | None = None) -> Item:
    """Put a new piece where the intent wants it; of smaller ones, where the usual has no place.

    old: the piece that it replaces, which is gone.
    """
    floor = work.floor(intent.room)
    candidates: list[tuple[Item, str]] = []
    model = None
    for model in _models(work, new, old):
        item = _new_item(work, new.category, model.asset, intent.room)
        placed = best_place(work, floor, item, score_of(work, floor, intent, old))
        candidates += [(placed, model.colour)] if placed else []
        if placed and not floor.stops_leaves(placed):
            break
    if model is None:
        raise refused(intent, "there is no such model", _wearable(work, new, old))
    if not candidates:
        where = called(work, intent.room)
        raise refused(intent, f"no place was found in {where}", "what the room has place for")
    placed, colour = min(candidates, key=lambda pair: floor.stops_leaves(pair[0]))
    work.put(placed)
    work.new.add(placed.id)
    if colour:
        work.colours[placed.id] = colour
    return placed


class _Model(NamedTuple):
    """What a new piece may look like."""

    asset: Asset
    colour: str
    """Its colourway; "" leaves it to the room."""


def _models(work: Work, new: NewPiece, old: Item | None) -> Iterator[_Model]:
    """Models to try, with their colourways: what was said, or that of the piece that they
    replace."""
    database = work.database().in_style(new.style) if new.style else work.database()
    worn = work.worn.get(old.id, "") if old else ""
    before = work.assets.get(old.id) if old else None
    forms = _forms(database, new, old) if new.is_other or new.form or new.coat else ()
    for asset in forms or _sized(database, new, old):
        colour = worn if worn in offer_of(asset.usd_path).variants.get(COLOUR, ()) else ""
        if new.coat:
            colour = colourway_like(asset.usd_path, new.coat)
        if (colour or not new.coat) and not (new.is_other and before and asset.id == before.id):
            yield _Model(asset, colour)


def _forms(database: Catalogue, new: NewPiece, old: Item | None) -> Iterator[Asset]:
    """The usual model, then one of each form, those of the style first, as near as it comes to the
    size of the piece that they replace, or to the size that is asked."""
    usual = next(_sized(database, new, old), None)
    if usual is None:
        return
    size_m = old.box.size_m if old and old.category == new.category else usual.size_m
    least, most = new.length_m
    size_m = (min(max(size_m[0], least), most), *size_m[1:])
    near = [asset for asset in database.of_category(new.category)
            if abs(asset.size_m[0] - size_m[0]) <= (_ALIKE if new.form else _LIKE) * size_m[0]
            and new.form.title() in (*asset.id.split("_"), "")]  # fmt: skip
    near.sort(key=lambda asset: (new.style not in (*asset.styles, ""),
                                 math.dist(asset.size_m[:2], size_m[:2]), asset.id))  # fmt: skip
    seen = set()
    for asset in near:
        form = asset.id.rpartition("_")[0]
        if form not in seen:  # each is drawn when it is asked for
            seen.add(form)
            yield database.named(asset.id)


def _sized(database: Catalogue, new: NewPiece, old: Item | None) -> Iterator[Asset]:
    """Models of the usual size of their kind, then smaller ones."""
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
        if old is not None and old.category == new.category:
            size_m = (size_m[0], *old.box.size_m[1:])
        asset = database.nearest(new.category, size_m)
        if asset.id not in seen and least - 0.08 <= asset.size_m[0] <= most + 0.08:
            seen.add(asset.id)
            yield asset


def _wearable(work: Work, new: NewPiece, old: Item | None) -> str:
    """The colours of the piece, in words."""
    asset = work.assets.get(old.id) if old else None
    names = offer_of(asset.usd_path).variants.get(COLOUR, ()) if asset and new.coat else ()
    return ", ".join(name.replace("_", " ") for name in names) or "another size or colour"


def _new_item(work: Work, name: str, asset: Asset, room_id: str) -> Item:
    ids = {item.id for item in (*work.graph.items, *work.graph.dressing)} | work.moved.keys()
    item_id = next(i for n in count() if (i := f"{room_id}/{name}_{n}") not in ids)
    row = category(name)
    x, y = work.room(room_id).polygon_m.mean(axis=0)
    box = Box((float(x), float(y), row.mount_height_m), asset.size_m, 0.0)
    return Item(item_id, name, box, room_id, asset)


def _replace(work: Work, intent: Intent) -> None:
    assert intent.new is not None
    old = work.item(intent.items[0])
    new, was_m = intent.new, old.box.size_m[0]
    share, asked_m = work.leeway.share, sum(intent.new.length_m) / 2
    if share < 1 and is_measured(new):
        by_m = (share - 1) * (asked_m - was_m)
        new = replace(new, length_m=(new.length_m[0] + by_m, new.length_m[1] + by_m))
    elif share < 1:
        least_m, most_m = (was_m + share * (end_m - was_m) for end_m in new.length_m)
        new = replace(new, length_m=(least_m, most_m))
    work.remove([old.id, *(item.id for item in work.resting_on(old.id))])
    placed = _place_new(work, intent, new, old)
    if math.isfinite(asked_m) and old.category == placed.category:
        is_other_size = not intent.new.length_m[0] <= was_m <= intent.new.length_m[1]
        if is_other_size and (placed.box.size_m[0] - was_m) * (asked_m - was_m) < 0:
            raise refused(intent, "there is no such model", "another size or colour")
        instead = (
            "" if share == 1 or not is_measured(new) else f", instead of {100 * asked_m:.0f} cm"
        )
        sizes = f"{100 * placed.box.size_m[0]:.0f} cm long, was {100 * was_m:.0f} cm"
        if is_other_size:
            work.notes.append(f"{sizes}{instead}")


def _remove(work: Work, intent: Intent) -> None:
    for item_id in intent.items:
        work.remove([item_id, *(item.id for item in work.resting_on(item_id))])


def _style(work: Work, intent: Intent) -> None:
    work.styles[intent.room] = intent.style


def _paint(work: Work, intent: Intent) -> None:
    """Colours of pieces are those of their models, or of others of like size."""
    assert intent.coat is not None
    if intent.surface:
        room = work.room(intent.room)
        look = look_wanted(intent.coat, intent.surface, room.kind)
        if look is None:
            raise refused(intent, f"{intent.surface}s are not made of that", "another material")
        work.looks[intent.room, intent.surface] = look
    for item_id in intent.items:
        item, worn = work.item(item_id), work.worn.get(item_id, "")
        asset = item.asset or work.assets.get(item_id)
        colour = colourway_like(asset.usd_path, intent.coat, worn) if asset else ""
        if colour:
            work.colours[item_id] = colour
            continue
        length_m = item.box.size_m[0]
        least, most = length_m * (1 - _LIKE), length_m * (1 + _LIKE)
        new = NewPiece(item.category, (least, most), coat=intent.coat)
        _replace(work, replace(intent, items=(item_id,), new=new))


def _lock(work: Work, intent: Intent) -> None:
    for item_id in intent.items:
        work.locks[item_id] = intent.action == "lock"
        (work.locked.add if intent.action == "lock" else work.locked.discard)(item_id)


_ACTIONS: dict[str, Callable[[Work, Intent], None]] = {
    "add": _add, "remove": _remove, "move": move, "turn": turn, "face": face, "swap": swap,
    "replace": _replace, "style": _style, "lock": _lock, "unlock": _lock, "paint": _paint,
}  # fmt: skip
