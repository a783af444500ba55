"""Planning: one table of published numbers that a room or home keeps or does not.

    shell      a room without its pieces
    view       a room with its pieces as arrays, and what rules measure in it
    rule       what a rule is, what it finds
    *_rules    the rows, by what they are asked of
    price      rules and faults on one scale

Each row names its source; "planning guides" have no number in a standard.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from chord_usd.base.metrics.complete import Homely
from chord_usd.base.metrics.design import (
    bathroom_rules,
    bedroom_rules,
    dining_rules,
    group_rules,
    home_rules,
    kitchen_rules,
    living_rules,
    way_rules,
)
from chord_usd.base.metrics.design.rule import Finding, Judged, Rule, RuleKind, judge
from chord_usd.base.metrics.design.unsaid import Said, Unjudged
from chord_usd.base.metrics.design.view import HomeView, View, view_home
from chord_usd.base.scene.types import WET_KINDS, RoomKind, SceneGraph

__all__ = ["ROOM_RULES", "Design", "Finding", "Judged", "design_of", "judged_home", "judged_room"]

ROOM_RULES: Mapping[RoomKind, tuple[Rule[View], ...]] = {
    "kitchen": kitchen_rules.RULES,
    "bedroom": bedroom_rules.RULES,
    "living": living_rules.RULES,
    **dict.fromkeys(WET_KINDS, bathroom_rules.RULES),
}
EVERY_ROOM: tuple[Rule[View], ...] = (*way_rules.RULES, *group_rules.RULES)
"""Asked of rooms of each kind."""
EVERYTHING = Said(frozenset())
"""Of layouts that leave nothing out."""


@dataclass(frozen=True)
class Design:
    """How a home is planned."""

    rooms: tuple[Judged, ...]
    """Those that rules are asked of; one with a table, a bed or a kitchen in it comes again."""
    home: Judged

    @property
    def share(self) -> float:
        """Rules kept / rules asked, of all rooms and the home; 1 where none was asked."""
        every = (*self.rooms, self.home)
        asked = sum(judged.asked for judged in every)
        return sum(len(judged.kept) for judged in every) / asked if asked else 1.0


def judged_room(view: View, said: Said = EVERYTHING) -> Iterator[Judged]:
    """A room by the rules of its kind, of a bed and a kitchen in it, and of its dining table.

    said: which of them the layout says enough for.
    """
    for rules, kind, area_m2 in rules_of(view):
        asked = said(rules, view, kind, area_m2)
        judged = judge(asked, view, view.shell.room.id, kind, area_m2)
        if kind in ROOM_RULES or judged.asked:
            yield judged


def rules_of(view: View) -> Iterator[tuple[Sequence[Rule[View]], RuleKind, float]]:
    """The rules of a room, of a bed and a kitchen in it, and of its dining table, each with the
    kind and the area in m² that they are asked of."""
    kind, area_m2 = view.shell.kind, view.shell.area_m2
    yield (*ROOM_RULES.get(kind, ()), *EVERY_ROOM), kind, area_m2
    if kind != "bedroom" and view.of("bed"):
        yield bedroom_rules.RULES, "bedroom", area_m2
    if kind != "kitchen" and view.of("sink_cabinet") and view.of("cooker_cabinet"):
        yield kitchen_rules.RULES, "kitchen", max(area_m2, 8.0)
    if view.of("dining_table"):
        yield dining_rules.RULES, "dining table", area_m2


def judged_home(view: HomeView, said: Said = EVERYTHING) -> Judged:
    """A home by its rules, or by those that the layout says enough for."""
    area_m2 = sum(room.shell.area_m2 for room in view.rooms)
    rules = said(home_rules.RULES, view, "home", area_m2)
    return judge(rules, view, "", "home", area_m2)


def design_of(
    graphs: Sequence[SceneGraph], homely: Iterable[Homely] = (), said: Said = EVERYTHING
) -> Design:
    """How a home is planned. graphs: its storeys, the lowest first. homely: of its rooms, whose
    "complete" and "right" are rows of the table, too. said: notes the rules that the layout does
    not say enough for, which are not judged."""
    views = [view_home(graph, is_dressed=True) for graph in graphs]
    rooms = tuple(room for view in views for room in view.rooms)
    front = next((view.entrance for view in views if view.entrance is not None), None)
    lived = {room.room: room for room in homely if room.is_judged}
    judged = []
    for room in rooms:
        for nth, verdict in enumerate(judged_room(room, said)):
            lived_in = lived.get(verdict.place) if nth == 0 else None
            judged.append(_with_homely(verdict, lived_in, room, said) if lived_in else verdict)
    return Design(tuple(judged), judged_home(HomeView(rooms, front), said))


NOTICEABLE = 0.15
"""A room of whose rules so large a share breaks is noticeably worse planned."""


def worse_planned(before: Design, after: Design) -> dict[str, str]:
    """By room that is noticeably worse planned than before, the rules that broke, in words.

    Counts are left out: pieces that are gone were removed by request.
    """
    known = {(judged.place, judged.kind): judged for judged in before.rooms}
    worse = {}
    for judged in after.rooms:
        old = known.get((judged.place, judged.kind))
        broken = {
            finding.rule: finding.said
            for finding in judged.findings
            if old and finding.rule in old.kept and finding.unit != "count"
        }
        if old and len(broken) >= NOTICEABLE * old.asked:
            worse[judged.place] = "; ".join(broken.values())
    return worse


COMPLETE, RIGHT = "what rooms of its kind cannot do without", "pieces that stand wrongly"
_OWN = "metrics.complete"


def _with_homely(judged: Judged, homely: Homely, room: View, said: Said) -> Judged:
    """With the rows "complete" and "right"; pieces stand wrongly by walls, too."""
    places = {item.id: room.point(at) for at, item in enumerate(room.items)}
    lacks = [Finding(f"{COMPLETE}, {name}", _OWN, "count", 1, 0, room.middle, ())
             for name in homely.missing]  # fmt: skip
    wrong = [
        Finding(f"{RIGHT}, {piece.fault}", _OWN, "count", 0, 1,
                places.get(piece.item, room.middle), (piece.item,))
        for piece in homely.misplaced
    ]  # fmt: skip
    rows = [(COMPLETE, lacks)]
    if facts := said.unsaid & {"walls", "sizes"}:
        said.unjudged.append(Unjudged(judged.place, judged.kind, RIGHT, tuple(sorted(facts))))
    else:
        rows.append((RIGHT, wrong))
    kept = [name for name, findings in rows if not findings]
    broken = [finding for _, findings in rows for finding in findings]
    return replace(
        judged,
        kept=(*judged.kept, *kept),
        findings=(*judged.findings, *broken),
        won=judged.won + len(kept),
        weight=judged.weight + len(rows),
    )
