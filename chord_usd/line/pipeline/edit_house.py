"""stage and a sentence -> stage: what the sentence asks for is done, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from chord_usd.base.errors import ChordError, StageError
from chord_usd.base.runtime.house_history import Deed
from chord_usd.base.runtime.progress import Stopwatch
from chord_usd.base.scene.settings import Settings
from chord_usd.base.scene.styles import MIXED, HomeStyle, style_named
from chord_usd.base.scene.types import Box, Item, Provenance, Room, SceneGraph
from chord_usd.line.pipeline.worse_planned import lines_worse_planned

if TYPE_CHECKING:
    from chord_usd.library.database import AssetDatabase
    from chord_usd.line.arrange.asked_work import Work
    from chord_usd.line.lists.sentences import Understood
    from chord_usd.line.stage.check.check_stage import Report
    from chord_usd.line.stage.edit.edit_rooms import PieceChange, RoomsChange
    from chord_usd.line.stage.edit.staged_house import StagedHouse


_TRIES = 3
"""So many outcomes are written and checked: the first may run into a curtain."""


@dataclass(frozen=True, eq=False)
class Reading:
    """A house, and what a sentence means in it."""

    source: Path
    house: StagedHouse
    """As it is seen, with the layer of edits over it."""
    understood: Understood
    written: StagedHouse
    """As it is at source."""
    sentence: str
    is_past: bool = False
    """Whether the house went along its history."""

    @property
    def is_change(self) -> bool:
        """Whether the house is another one after it."""
        return self.is_past or not self.understood.answer

    @property
    def rooms(self) -> tuple[str, ...]:
        """Names of the prims of the rooms that it changes, in the house's order."""
        changed = {room for intent in self.understood.intents for room in intent.rooms}
        return tuple(name for name, room_id in self.house.room_ids.items() if room_id in changed)


@dataclass(frozen=True)
class Done:
    """What an edit did to the pieces of a house, by the ids that its graph has."""

    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    """Or turned."""
    notes: tuple[str, ...] = ()
    """How what is done differs from what was asked, or says it more exactly; a line each."""
    taken_over: tuple[str, ...] = ()
    """Paths of pieces that the stage now has where the layer of edits had them, or has no more."""


def read_sentence(
    source: Path, sentence: str, edits: Path | None = None, storey: str = ""
) -> Reading:
    """What a sentence means in the house at source, as it is seen with a layer of edits over it.

    storey: name or number of the one that is meant, in a house of several; without one it is the
    one where the sentence means something.

    Raises ChordError, also where a part of the sentence means nothing there.
    """
    from chord_usd.base.runtime.stages import look_through

    look_through([source], meanwhile=_load_what_edits)
    from chord_usd.line.lists.referents import ROOM_TOO
    from chord_usd.line.stage.read.storey_rooms import storey_names

    storeys = storey_names(source)
    meant = _storey_meant(storeys, storey)
    readings: dict[str, Reading] = {}
    refused: list[ChordError] = []
    for room_name in [meant] if meant is not None else storeys:
        try:
            readings[storeys[room_name]] = _read_on(source, sentence, edits, room_name)
        except ChordError as error:
            refused.append(error)
    vague = [error for error in refused if error.expected == ROOM_TOO]
    if vague or not readings:
        raise _with_nearest((vague or refused)[0])
    first = next(iter(readings.values()))
    if len(readings) > 1 and not first.understood.answer:
        raise ChordError(
            f"the sentence means something on several storeys: {', '.join(readings)}",
            where=str(source), expected="one storey", try_=f'<storey="{next(iter(readings))}">',
        )  # fmt: skip
    if first.understood.answer:
        answers = dict.fromkeys(reading.understood.answer for reading in readings.values())
        return replace(first, understood=replace(first.understood, answer="; ".join(answers)))
    return first


def _with_nearest(error: ChordError) -> ChordError:
    """An error that names an unknown piece, with the known ones of like meaning."""
    from chord_usd.line.lists.edit_words import known_things
    from chord_usd.line.lists.said_clauses import UnknownThingError
    from chord_usd.line.pipeline.nearest_things import nearest_things

    if not isinstance(error, UnknownThingError):
        return error
    near = nearest_things(error.thing, known_things())
    return ChordError(
        f"there is no '{error.thing}' in the catalogue", where=error.where,
        expected=f"a piece that it has, such as {', '.join(near)}" if near else error.expected,
        try_=error.try_,
    )  # fmt: skip


def _storey_meant(storeys: Mapping[str, str], said: str) -> str | None:
    """The name of a room on the storey that was said; None where none was. Raises ChordError."""
    if not said:
        return None
    names = {title.lower(): room for room, title in storeys.items() if title}
    names |= {str(number): room for number, room in enumerate(storeys) if len(storeys) > 1}
    if said.lower() not in names:
        raise ChordError(
            f"has no storey {said!r}", where="<storey>", value=said,
            expected=f"one of {', '.join(storeys.values())}" if names else "a house of several",
        )  # fmt: skip
    return names[said.lower()]


def _read_on(source: Path, sentence: str, edits: Path | None, room_name: str) -> Reading:
    """What it means on the storey of a room."""
    from chord_usd.base.scene.stair_cells import is_cell
    from chord_usd.line.lists.sentences import understand
    from chord_usd.line.stage.edit.staged_house import read_edited_house, read_house

    written = read_house(source, room_name)
    house = read_edited_house(edits, source, room_name) if edits else written
    named = {
        name: replace(house.graph.plan.room(room_id), name=house.titles[name])
        for name, room_id in house.room_ids.items()
    }
    graph = replace(house.graph, rooms=tuple(named.values()))
    house = replace(house, graph=graph)
    rooms = {name: room for name, room in named.items() if not is_cell(room)}
    return Reading(source, house, understand(sentence, graph, rooms), written, sentence)


def _load_what_edits() -> None:
    """Imports that take as long as a stage is tried."""
    import chord_usd.line.arrange.asked_edits
    import chord_usd.line.lists.sentences
    import chord_usd.line.stage.check.check_stage
    import chord_usd.line.stage.edit.edit_rooms  # noqa: F401


def edit(
    source: Path,
    sentence: str,
    target: Path,
    settings: Settings | None = None,
    stopwatch: Stopwatch | None = None,
    edits: Path | None = None,
    storey: str = "",
    *,
    force: bool = False,
    dry_run: bool = False,
) -> tuple[Reading, Done, Report]:
    """Do what a sentence asks for, and write the house to target, which may be source; returns
    what the house is like then.

    edits: a layer over the house that moves or removes pieces. The sentence means what is seen with
    it, and the rooms that it changes are written as they are seen; elsewhere the layer is not taken
    over. storey: as read_sentence has it. dry_run: try everything, and write nothing.

    All of it is done or, where a part is not understood or has no place, nothing is: a ChordError
    says why. So it is, without force, where the edit makes the house worse (stage.check.worse): the
    certificate has a new fault, or a room is less complete or right; or where a room keeps
    noticeably fewer planning rules, or the home a clause less of the standard it is planned to.
    Prims and files of rooms that the sentence does not mean stay as they are, byte for byte. The
    stopwatch times read, arrange, stage and check. A question writes nothing and is answered;
    "undo" and "redo" go one step along the history of a house that is its own target.
    """
    from chord_usd.base.runtime.alone import alone_with
    from chord_usd.line.lists.speech_acts import past_asked
    from chord_usd.line.stage.check.check_stage import check_stage

    watch = stopwatch or Stopwatch()
    if past := past_asked(sentence):
        return _gone_back(source, past, sentence, target, dry_run=dry_run)
    settings = settings or Settings(style="")
    with alone_with(source):
        with watch.step("read"):
            reading = read_sentence(source, sentence, edits, storey)
        if reading.understood.answer:
            with watch.step("check"):
                return reading, Done(), check_stage(source, trusted=True)
        write = partial(_write, reading, target=target, edits=edits, watch=watch, force=force,
                        dry_run=dry_run)  # fmt: skip
        work, change, report = _accepted(reading, settings, write, watch, force=force)
    done = _done(reading.house.graph, work)
    if edits:
        done = replace(done, taken_over=tuple(piece.path for piece in change.pieces))
    return reading, done, report


def _accepted(
    reading: Reading, settings: Settings, write: Callable[[RoomsChange, Sequence[str]], Report],
    watch: Stopwatch, *, force: bool,
) -> tuple[Work, RoomsChange, Report]:  # fmt: skip
    """The first outcome that the certificate holds for, once it is written; meshes run into what
    their boxes do not. Raises the first WorseError where none is."""
    house = reading.house
    style = style_named(house.graph.style or MIXED, house.seed)
    failed: dict[tuple[Box, ...], WorseError] = {}
    while len(failed) < _TRIES:
        with watch.step("arrange"):
            work = _carried_out(reading, style, settings, failed, force=force)
            boxes = _boxes(work.graph)
            if boxes in failed:
                break
            lost = [] if force else lines_worse_planned(house, house.graph, work.graph)
            change = _change(reading, work, style, settings)
        try:
            return work, change, write(change, lost)
        except WorseError as error:
            failed[boxes] = error
    raise next(iter(failed.values()))


def _gone_back(
    source: Path, way: Literal["undo", "redo"], sentence: str, target: Path, *, dry_run: bool
) -> tuple[Reading, Done, Report]:
    from chord_usd.base.runtime.house_history import redo, undo
    from chord_usd.base.runtime.locations import absolute
    from chord_usd.line.lists.sentences import Understood
    from chord_usd.line.stage.check.check_stage import check_stage
    from chord_usd.line.stage.edit.staged_house import read_house

    if dry_run or absolute(source) != absolute(target):
        raise ChordError(
            f"{sentence!r} changes a house in its place", where="the sentence",
            expected="no dry run and no other output",
        )  # fmt: skip
    change = undo(source) if way == "undo" else redo(source)
    house = read_house(source)
    wording = f"{'taken back' if way == 'undo' else 'done again'}: {change.summary}"
    reading = Reading(source, house, Understood((), answer=wording), house, sentence, is_past=True)
    return reading, Done(), check_stage(source, trusted=True)


def _boxes(graph: SceneGraph) -> tuple[Box, ...]:
    """All places and sizes, by which an outcome is recognised."""
    return tuple(item.box for item in sorted(graph.items, key=lambda item: item.id))


def _database(settings: Settings, style: HomeStyle) -> AssetDatabase:
    from chord_usd.library.database import load_database

    return load_database(settings.asset_folders, style.name, settings.texture_px)


def _carried_out(
    reading: Reading, style: HomeStyle, settings: Settings,
    failed: Container[tuple[Box, ...]] = (), *, force: bool = False,
) -> Work:  # fmt: skip
    """The house with everything done. failed: what the certificate did not hold for. force: as it
    was said, though that is worse."""
    from chord_usd.line.arrange.asked_edits import carry_out
    from chord_usd.line.arrange.asked_leeway import worse
    from chord_usd.line.arrange.asked_work import Work
    from chord_usd.line.pipeline import settle

    house = reading.house
    # Most edits need no new piece, and to load the database takes as long as they do.
    database = cache(lambda: _database(settings, style))

    def judge(before: SceneGraph, after: SceneGraph) -> Sequence[str]:
        if force:
            return ()
        if _boxes(after) in failed:
            return ("the certificate does not hold",)
        return (*worse(before, after), *lines_worse_planned(house, before, after))

    work = Work(house.graph, database, set(house.locked), assets=house.assets, worn=house.colours,
                judge=judge)  # fmt: skip
    work = carry_out(work, reading.understood.intents)
    for room_id, name in work.styles.items():
        _restyle(work, house, room_id, database().in_style(name), settings)
    placed = {item.id for item in work.graph.items if item.id in work.new}
    rooms = tuple({item.room_id for item in work.graph.items if item.id in placed})
    if placed:
        worn = tuple(_wearing(item, house) for item in work.graph.items)
        stay = [item.id for item in worn if item.id not in placed]
        settled = settle(replace(work.graph, items=worn), settings, rooms, stay)
        lost = placed - {item.id for item in settled.items}
        if lost:
            raise ChordError(f"no place was found for {', '.join(sorted(lost))}")
        work.graph = replace(work.graph, items=tuple(
            item if item.id in placed else old
            for item, old in _paired(settled.items, work.graph.items)
        ))  # fmt: skip
    return work


def _paired(new: Sequence[Item], old: Sequence[Item]) -> list[tuple[Item, Item]]:
    by_id = {item.id: item for item in old}
    return [(item, by_id[item.id]) for item in new]


def _wearing(item: Item, house: StagedHouse) -> Item:
    return replace(item, asset=item.asset or house.assets.get(item.id))


def _restyle(
    work: Work, house: StagedHouse, room_id: str, database: AssetDatabase, settings: Settings
) -> None:
    """Give a room furniture of another style where the old stands, and lay and dress it again."""
    from chord_usd.line.graph.match import match_assets
    from chord_usd.line.pipeline import dress_rooms, lay_tables
    from chord_usd.line.pipeline.loading import load_table_model

    pieces = [item for item in work.graph.items_of(room_id) if item.id not in work.locked]
    ids = {item.id for item in pieces}
    bare = tuple(
        replace(item, asset=None, children=()) if item.id in ids else _wearing(item, house)
        for item in work.graph.items
    )
    graph = replace(work.graph, items=bare, style=database.style)
    had_things = any(item.children for item in pieces)
    graph = match_assets(graph, database, but=[i.id for i in (*bare, *graph.dressing)
                                               if i.id not in ids])  # fmt: skip
    names = {own_id: name for name, own_id in house.room_ids.items()}
    seeded = replace(settings, seed=house.seeds[names[room_id]])
    table = load_table_model(settings) if had_things else None
    if table:
        but = [item.id for item in graph.items if item.id not in ids]
        graph = lay_tables(graph, table, database, seeded, None, (room_id,), but).graph
    old = {item.id for item in graph.dressing if item.room_id == room_id}
    if old:
        kept = work.locked & old
        stays = tuple(item for item in graph.dressing if item.id not in old - kept)
        graph = dress_rooms(replace(graph, dressing=stays), database, seeded, (room_id,), kept)
    work.graph = replace(graph, style=house.graph.style)
    work.new |= ids | {item.id for item in graph.dressing_of(room_id)} - work.locked


def _done(before: SceneGraph, work: Work) -> Done:
    old = {item.id for item in (*before.items, *before.dressing)}
    now = {item.id for item in (*work.graph.items, *work.graph.dressing)}
    restyled = {
        item.id for item in (*before.items, *before.dressing) if item.room_id in work.styles
    }
    moved = [item_id for item_id in work.moved if item_id in now and item_id not in restyled]
    notes = tuple(work.notes)
    return Done(tuple(sorted(now - old)), tuple(sorted(old - now)), tuple(moved), notes)


class WorseError(StageError):
    """An edit would make the house worse; it is done only with force."""

    code = "worse"


class _TriedError(ChordError):
    """Ends a dry run before anything is delivered."""


def _write(
    reading: Reading, change: RoomsChange, planned: Sequence[str], *, target: Path,
    edits: Path | None, watch: Stopwatch, force: bool, dry_run: bool,
) -> Report:  # fmt: skip
    """Write the house as it is changed, if that makes nothing worse; returns its report.

    planned: what is worse planned, a line each.
    """
    from chord_usd.line.stage.check.check_stage import check_stage
    from chord_usd.line.stage.edit.edit_rooms import edit_rooms

    reports: list[Report] = []

    def accept(staged: Path) -> None:
        with watch.step("check"):
            reports.append(check_stage(staged, trusted=True))
            if not force:
                _refuse_worse(reading.source, edits, reports[0], planned)
        if dry_run:
            raise _TriedError("a dry run")

    with watch.step("stage"), suppress(_TriedError):
        edit_rooms(reading.source, target, change, Deed("edit", reading.sentence), accept)
    return reports[0]


def _refuse_worse(source: Path, edits: Path | None, after: Report, planned: Sequence[str]) -> None:
    """Raises WorseError for an edit after which something is wrong that was not before, neither in
    the house nor in what is seen of it. planned: what is worse planned, in the same way."""
    from chord_usd.line.stage.check.check_stage import check_stage, worse

    lost = (*after.faults, *after.flaws)
    for before in (source, *([edits] if edits else [])) if lost else ():
        known = worse(check_stage(before), after)
        lost = tuple(line for line in lost if line in known)
    lost = (*lost, *planned)
    if lost:
        more = f", and {len(lost) - 1} more" if len(lost) > 1 else ""
        raise WorseError(
            f"the edit makes the house worse: {lost[0]}{more}", where=str(source),
            expected="an edit after which nothing is wrong that was right",
            try_=("another place or piece", "<force>"),
        )  # fmt: skip


def _change(reading: Reading, work: Work, style: HomeStyle, settings: Settings) -> RoomsChange:
    """The same, as the stage takes it: prims in place of ids."""
    from chord_usd.base.scene.look_families import family_named
    from chord_usd.library.looks.look_library import drawn_look
    from chord_usd.line.stage.edit.edit_rooms import RoomsChange
    from chord_usd.line.stage.edit.refurnish import NewFurniture

    house = reading.house
    pieces = list(_piece_changes(reading, work))
    rooms: dict[str, Any] = {}
    shells = {name: house.graph.plan.room(room_id) for name, room_id in house.room_ids.items()}
    name_of = {room.id: name for name, room in shells.items()}
    now = (*work.graph.items, *work.graph.dressing)
    placed = {item.room_id for item in now if item.id in work.new}
    others = {room for intent in reading.understood.intents if intent.action != "paint"
              for room in intent.rooms}  # fmt: skip
    for name in reading.rooms:
        room: Room = shells[name]
        if room.id not in placed | others:
            continue  # a colour alone leaves its furniture as it is
        worn = work.styles.get(room.id) or style.name
        rooms[name] = NewFurniture(
            name, room, [i for i in work.graph.items_of(room.id) if i.id in work.new],
            Provenance(seed=house.seeds[name]),
            [i for i in work.graph.dressing_of(room.id) if i.id in work.new],
            style=worn, home_seed=house.seed, requests=_still_asked(reading, work, name, room.id),
        )  # fmt: skip
    px = settings.texture_px // 2 * 2
    looks = {
        (name_of[room_id], part): drawn_look(family_named(look.family), look.settings, px)
        for (room_id, part), look in work.looks.items()
    }  # fmt: skip
    return RoomsChange(pieces, rooms, work.colours, looks, shells, house.seed)


def _still_asked(reading: Reading, work: Work, name: str, room_id: str) -> str:
    """What is asked for in a room from now on, in words."""
    from chord_usd.line.lists.kept_requests import kept_requests

    house = reading.house
    then, now = ([item.category for item in graph.items_of(room_id)]
                 for graph in (house.graph, work.graph))  # fmt: skip
    here = (intent for intent in reading.understood.intents if intent.room == room_id)
    return kept_requests(house.requests.get(name, ""), here, then, now)


def _piece_changes(reading: Reading, work: Work) -> Iterator[PieceChange]:
    """What becomes of the pieces that the stage has."""
    from chord_usd.line.stage.edit.edit_rooms import PieceChange

    house, written = reading.house, reading.written
    path_of = {item_id: path for path, item_id in written.item_ids.items()}
    name_of = {room_id: name for name, room_id in house.room_ids.items()}
    seen = {item.id: item for item in (*house.graph.items, *house.graph.dressing)}
    now = {item.id: item for item in (*work.graph.items, *work.graph.dressing)}
    for item in (*written.graph.items, *written.graph.dressing):
        new = None if item.id in work.new else now.get(item.id)
        if new == seen.get(item.id) and name_of[item.room_id] not in reading.rooms:
            continue  # the layer of edits may have moved it, not the sentence
        locked = work.locks.get(item.id)
        if new is None:
            yield PieceChange(path_of[item.id], item.box, None)
        elif house.assets.get(item.id) != written.assets.get(item.id):
            if new != seen[item.id]:
                raise ChordError(
                    f"{path_of[item.id]} has another model in the layer of edits",
                    expected="a sentence about other pieces",
                    try_="remove it, and ask for a new one",
                )  # fmt: skip
        elif new.box != item.box or new.room_id != item.room_id or locked is not None:
            other = name_of[new.room_id] if new.room_id != item.room_id else ""
            yield PieceChange(path_of[item.id], item.box, new.box, other, locked)
