"""stage and states in words -> stage: doors opened and closed, lamps switched on and off."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.alone import alone_with
from chord_usd.base.runtime.stages import open_stage, reading
from chord_usd.base.scene.states import WHERE, Clause, read_states
from chord_usd.base.scene.types import Room

if TYPE_CHECKING:
    from chord_usd.line.stage.edit.leaves_and_lamps import ThingThere

_EVERY = frozenset(["all", "every", "each", "both", "the", "my", "our"])
_ALL = (["everything"], ["house"])
_OPENINGS = ("door", "window")
_DOORS_OUT = ("front door", "entrance door", "entrance")
_IN = re.compile(r"(.+?) (?:in|of|inside) (?:the |all )?(.+)")


@dataclass(frozen=True)
class Stated:
    """A clause, and what it means in a house."""

    subject: str
    state: str
    paths: tuple[str, ...]
    """Of the prims of leaves and lights."""


def set_states(
    source: Path, target: Path, text: str, *, dry_run: bool = False
) -> tuple[Stated, ...]:
    """Write a house with doors and lamps in the states of a text to target, which may be source.

    dry_run: only understand the text. Raises ChordError for a subject that is not there, and what
    edit.refurnish.rewrite raises; then nothing is written.
    """
    from chord_usd.line.stage.edit.leaves_and_lamps import give_states, things_there
    from chord_usd.line.stage.read.titled_rooms import titled_rooms

    clauses = read_states(text)
    with alone_with(source):
        rooms = titled_rooms(source)
        with reading(source):
            stage = open_stage(source)
            there = things_there(stage)
            meant = [(clause, _meant(clause, there, rooms)) for clause in clauses]
        if not dry_run:
            states = [(entry, clause.state) for clause, things in meant for entry in things]
            give_states(source, target, stage, states, text)
    return tuple(
        Stated(clause.subject, clause.state, tuple(str(entry.path) for entry in things))
        for clause, things in meant
    )


def _meant(
    clause: Clause, there: Sequence[ThingThere], rooms: Mapping[str, Room]
) -> list[ThingThere]:
    """The leaves and lights that a clause means. Raises ChordError where there are none."""
    from chord_usd.line.lists.wishes import rooms_meant
    from chord_usd.line.stage.edit.leaves_and_lamps import LeafThere

    able = [entry for entry in there if clause.fits(leaf=isinstance(entry, LeafThere))]
    said = re.sub(r"[^\w]+", " ", clause.subject.lower()).strip()
    inside = _IN.fullmatch(said)
    words = f"{inside[2]} {inside[1]}".split() if inside else said.split()
    words = [word for word in words if word not in _EVERY]
    if words in _ALL:
        return able
    for at in range(len(words) + 1):
        place, noun = " ".join(words[:at]), words[at:]
        known = [entry for entry in able if _is_called(entry, noun, rooms)]
        if place and known:
            try:
                names = {room.id for room in rooms_meant(place, rooms, WHERE)}
            except ChordError:
                continue
            known = [entry for entry in known if names.intersection(entry.rooms)]
        if known:
            return known
    raise ChordError(
        f"'{clause.subject}' is nothing here that can be {clause.state}", where=WHERE,
        expected=f"one of {', '.join(_calls(able))}; all or in one of {', '.join(rooms)}",
    )  # fmt: skip


def _is_called(entry: ThingThere, noun: Sequence[str], rooms: Mapping[str, Room]) -> bool:
    """Whether a noun, in small letters, means a leaf or a light."""
    from chord_usd.line.lists.vocabulary import HERE, named
    from chord_usd.line.stage.edit.leaves_and_lamps import LeafThere

    word = " ".join(noun)
    if word in entry.names:
        return True
    if isinstance(entry, LeafThere):
        if word in _DOORS_OUT:
            return entry.category == "door" and len(entry.rooms) < 2
        if word in ("drawer", "drawers"):
            return entry.path.name.startswith("Drawer")
        if word in ("furniture", "pieces"):
            return entry.piece is not None
        if word.removesuffix("s") in ("door", "window"):
            return entry.category == word.removesuffix("s")
    elif not noun or word in ("light", "lights"):
        return True
    elif word in ("lamp", "lamps"):
        return entry.category != ""
    meant = named(list(noun)) if noun else None
    if meant is None:
        return False
    here = {HERE.get(rooms[name].kind, {}).get(meant.word) for name in entry.rooms if name in rooms}
    return entry.category in {meant.category, *here}


def _calls(able: Sequence[ThingThere]) -> Iterator[str]:
    """What leaves and lights are called in general."""
    from chord_usd.line.stage.edit.leaves_and_lamps import LeafThere

    categories = sorted({entry.category for entry in able if entry.category})
    yield from (f"{name}s" if name in _OPENINGS else name.replace("_", " ") for name in categories)
    if any(not isinstance(entry, LeafThere) for entry in able):
        yield from ("lamps", "lights")
