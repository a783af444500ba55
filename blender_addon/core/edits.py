"""What an artist changes in a house: pieces moved, removed or swapped, looks, lights, locks.

Changes are relative to the house itself, so that an undone change is no change any more.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import isclose
from typing import Any, TypeVar

from .tree import is_placed, room_of

Matrix = tuple[tuple[float, ...], ...]
"""Four rows of four, acting on columns, as Blender writes them; metres."""

MOVED_BY = 1e-5
"""Entries of a matrix that differ by less are the same."""

SCHEMA = 2

_PATH = re.compile(r"(?:/[^\W\d]\w*)+")
"""A path of a prim, as USD writes it."""

Size = tuple[float, float, float]

Entry = TypeVar("Entry")

Looks = Mapping[str, str]
"""Variant set to variant."""


@dataclass(frozen=True)
class Swap:
    """Another model in a piece's place."""

    usd: str
    """The model's layer, relative to the house."""
    slot_m: Size
    """Length, width and height of the piece that the house has there."""
    offset_m: tuple[float, float]
    """Where the model's middle lies in the slot, in the piece's own frame."""
    size_m: Size
    """What the model fills of the slot."""
    looks: Looks = field(default_factory=dict)
    kg_per_m3: float = 0.0
    """Of the piece, if it is one that people move; 0 for others."""


@dataclass(frozen=True)
class Edit:
    """What became of one piece."""

    was: Matrix
    """Its placement in the house itself."""
    matrix: Matrix | None
    """Its new placement in its parent; None where it was removed."""
    swap: Swap | None = None


@dataclass(frozen=True)
class Changes:
    """All that was changed in a house. Keys are USD paths."""

    pieces: Mapping[str, Edit] = field(default_factory=dict)
    looks: Mapping[str, Looks] = field(default_factory=dict)
    """Of rooms, of the house, and of pieces that are not swapped."""
    lights: Mapping[str, float] = field(default_factory=dict)
    """Brightness as a share of the house's, above 0."""
    locked: tuple[str, ...] = ()
    """Pieces that stay when their room is furnished again."""

    @property
    def is_nothing(self) -> bool:
        """Whether the house is as it was."""
        return not (self.pieces or self.looks or self.lights or self.locked)

    @property
    def swaps(self) -> dict[str, Swap]:
        """The swapped pieces."""
        return {path: edit.swap for path, edit in self.pieces.items() if edit.swap}


def moves(
    was: Mapping[str, Matrix], now: Mapping[str, Matrix], swaps: Mapping[str, Swap]
) -> dict[str, Edit]:
    """What is moved, removed or swapped. Pieces that are new are not ours.

    was: placements in the house itself; now: in the scene. What stood on a removed piece is gone
    with it.
    """
    edits: dict[str, Edit] = {}
    gone = {path for path in was if path not in now}
    for path, placed in was.items():
        if any(above in gone for above in _above(path)):
            continue
        if path in gone:
            edits[path] = Edit(placed, None)
        elif path in swaps or not same(placed, now[path]):
            edits[path] = Edit(placed, now[path], swaps.get(path))
    return edits


def as_saved(changes: Changes, saved: Changes) -> Changes:
    """The changes, with what an import has only rounded as it was saved.

    So a house that nobody touches in between is saved as it was, byte for byte.
    """
    pieces = dict(changes.pieces)
    for path in pieces.keys() & saved.pieces.keys():
        old, new = saved.pieces[path], pieces[path]
        pairs = [(old.was, new.was), (old.matrix, new.matrix)]
        if old.swap == new.swap and all(a == b or (a and b and same(a, b)) for a, b in pairs):
            pieces[path] = old
    lights = {
        path: saved.lights[path] if isclose(light, saved.lights.get(path, 0.0), rel_tol=1e-3)
        else light
        for path, light in changes.lights.items()
    }  # fmt: skip
    return replace(changes, pieces=pieces, lights=lights)


def placements_of_house(seen: Mapping[str, Matrix], changes: Changes) -> dict[str, Matrix]:
    """Where the house itself has its pieces, from where they are seen with the changes on.

    Changes of pieces that the house does not have any more are passed over.
    """
    was = {
        path: edit.was
        for path, edit in changes.pieces.items()
        if edit.matrix is None or path in seen
    }
    return {**seen, **was}


def without_room(changes: Changes, room: str) -> Changes:
    """The changes after a room was furnished again: there, only locked pieces keep theirs."""

    def stays(path: str) -> bool:
        lineage = [path, *_above(path)]
        is_meant = is_placed(path) and room_of(path) == room
        return not is_meant or any(locked in lineage for locked in changes.locked)

    return replace(
        changes,
        pieces={path: edit for path, edit in changes.pieces.items() if stays(path)},
        looks={path: looks for path, looks in changes.looks.items() if stays(path)},
    )


def without_pieces(changes: Changes, paths: Iterable[str]) -> Changes:
    """The changes without some pieces' changes: the house itself has them now."""
    gone = frozenset(paths)
    kept = {path: edit for path, edit in changes.pieces.items() if path not in gone}
    return replace(changes, pieces=kept)


def as_it_was(changes: Changes, room: str) -> Changes:
    """The changes without any in this room."""

    def others(entries: Mapping[str, Any]) -> dict[str, Any]:
        return {p: e for p, e in entries.items() if not room or room_of(p) != room}

    return replace(
        changes,
        pieces=others(changes.pieces),
        looks=others(changes.looks),
        lights=others(changes.lights),
    )


def carried_over(wanted: Changes, before: Changes, now: Changes) -> Changes:
    """The changes wanted, and what the artist did while the program worked on them.

    before: the changes in the scene when the work began; now: when it ended.
    """
    return replace(
        wanted,
        pieces=_merged(wanted.pieces, before.pieces, now.pieces),
        lights=_merged(wanted.lights, before.lights, now.lights),
        locked=now.locked,
    )


def _merged(
    wanted: Mapping[str, Entry], before: Mapping[str, Entry], now: Mapping[str, Entry]
) -> dict[str, Entry]:
    touched = {path for path in {*before, *now} if before.get(path) != now.get(path)}
    # What was changed from both sides is as it was asked for.
    touched = {path for path in touched if wanted.get(path) == before.get(path)}
    kept = {path: entry for path, entry in wanted.items() if path not in touched}
    return {**kept, **{path: now[path] for path in touched if path in now}}


def with_look(changes: Changes, path: str, variant_set: str, variant: str) -> Changes:
    """The changes with one more look chosen, for a room, for the house, or for a swapped piece."""
    edit = changes.pieces.get(path)
    if edit and edit.swap:
        swap = replace(edit.swap, looks={**edit.swap.looks, variant_set: variant})
        return replace(changes, pieces={**changes.pieces, path: replace(edit, swap=swap)})
    choices = {**changes.looks.get(path, {}), variant_set: variant}
    return replace(changes, looks={**changes.looks, path: choices})


def to_json(changes: Changes) -> dict[str, Any]:
    """The changes as JSON holds them."""
    return {
        "schema": SCHEMA,
        "pieces": {
            path: {
                "was": edit.was,
                "matrix": edit.matrix,
                **({"swap": vars(edit.swap)} if edit.swap else {}),
            }
            for path, edit in sorted(changes.pieces.items())
        },
        "looks": {path: dict(looks) for path, looks in sorted(changes.looks.items())},
        "lights": dict(sorted(changes.lights.items())),
        "locked": sorted(changes.locked),
    }


def understood(data: Mapping[str, Any]) -> Changes:
    """The changes that JSON holds. Raises KeyError, TypeError or ValueError for anything else."""
    if data["schema"] != SCHEMA:
        raise ValueError(f"schema {data['schema']}")
    return Changes(
        pieces={path: _edit(entry) for path, entry in _named(data["pieces"])},
        looks={path: dict(looks) for path, looks in _named(data["looks"]) if all(looks)},
        lights={path: float(strength) for path, strength in _named(data["lights"])},
        locked=tuple(map(str, data["locked"])),
    )


def _named(entries: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Entries of paths that USD has; others would make a layer that no program opens."""
    return ((path, entry) for path, entry in entries.items() if _PATH.fullmatch(path))


def size_of(sides: Iterable[Any]) -> Size:
    """A size from its three sides. Raises ValueError or TypeError for anything else."""
    length, width, height = map(float, sides)
    return length, width, height


def same(a: Matrix, b: Matrix) -> bool:
    """Whether two placements are one."""
    pairs = zip((x for row in a for x in row), (x for row in b for x in row), strict=True)
    return all(abs(x - y) < MOVED_BY for x, y in pairs)


def _above(path: str) -> Iterable[str]:
    """The paths of what a piece belongs to: all groups above it."""
    parts = path.split("/")
    return ["/".join(parts[:count]) for count in range(2, len(parts))]


def _edit(entry: Mapping[str, Any]) -> Edit:
    swap = entry.get("swap")
    return Edit(
        was=_matrix(entry["was"]),
        matrix=_matrix(entry["matrix"]) if entry["matrix"] else None,
        swap=_swap(swap) if swap else None,
    )


def _swap(entry: Mapping[str, Any]) -> Swap:
    x, y = map(float, entry["offset_m"])
    return Swap(
        usd=str(entry["usd"]),
        slot_m=size_of(entry["slot_m"]),
        offset_m=(x, y),
        size_m=size_of(entry["size_m"]),
        looks=dict(entry["looks"]),
        kg_per_m3=float(entry.get("kg_per_m3", 0.0)),
    )


def _matrix(rows: Iterable[Iterable[Any]]) -> Matrix:
    return tuple(tuple(float(x) for x in row) for row in rows)
