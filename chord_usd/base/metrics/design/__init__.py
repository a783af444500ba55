"""Planning: one table of published numbers that a room or home keeps or does not.

    shell      a room without its pieces
    view       a room with its pieces as arrays, and what rules measure in it
    rule       what a rule is, what it finds
    *_rules    the rows, by what they are asked of
    price      rules and faults on one scale

Sources are those of docs/design.md; "planning guides" have no number in a standard.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from chord_usd.base.metrics.design import (
    bathroom_rules,
    bedroom_rules,
    dining_rules,
    home_rules,
    kitchen_rules,
    living_rules,
)
from chord_usd.base.metrics.design.rule import Finding, Judged, Rule, judge
from chord_usd.base.metrics.design.view import HomeView, View, view_home
from chord_usd.base.scene.types import RoomKind, SceneGraph

__all__ = ["ROOM_RULES", "Design", "Finding", "Judged", "design_of", "judged_home", "judged_room"]

ROOM_RULES: Mapping[RoomKind, tuple[Rule[View], ...]] = {
    "kitchen": kitchen_rules.RULES,
    "bedroom": bedroom_rules.RULES,
    "living": living_rules.RULES,
    "bathroom": bathroom_rules.RULES,
}


@dataclass(frozen=True)
class Design:
    """How a home is planned."""

    rooms: tuple[Judged, ...]
    """Those that rules are asked of; a room with a dining table or a kitchen in it comes again."""
    home: Judged


def judged_room(view: View) -> Iterator[Judged]:
    """A room by the rules of its kind, of a kitchen in it, and of its dining table."""
    shell = view.shell
    rules = ROOM_RULES.get(shell.kind)
    if rules:
        yield judge(rules, view, shell.room.id, shell.kind, shell.area_m2)
    if shell.kind != "kitchen" and view.of("sink_cabinet") and view.of("cooker_cabinet"):
        yield judge(kitchen_rules.RULES, view, shell.room.id, "kitchen", max(shell.area_m2, 8.0))
    if view.of("dining_table"):
        yield judge(dining_rules.RULES, view, shell.room.id, "dining table", shell.area_m2)


def judged_home(view: HomeView) -> Judged:
    """A home by its rules."""
    area_m2 = sum(room.shell.area_m2 for room in view.rooms)
    return judge(home_rules.RULES, view, "", "home", area_m2)


def design_of(graph: SceneGraph, screens: frozenset[str] | None = None) -> Design:
    """How a house of one storey is planned. screens: ids of cabinets with a television."""
    view = view_home(graph, screens)
    rooms = tuple(one for room in view.rooms for one in judged_room(room))
    return Design(rooms, judged_home(view))
