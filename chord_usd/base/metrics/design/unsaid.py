"""Rules that a layout does not say enough for: never passed in silence.

Layouts of others leave facts out: single rooms have no doors, lists of boxes no windows. A rule
reads facts while it measures, so its reading is noted; where it reads one that the layout leaves
out, the rule is not judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, cast

from chord_usd.base.metrics.design.rule import Rule, RuleKind, Seen
from chord_usd.base.metrics.design.shell import Shell
from chord_usd.base.metrics.design.view import HomeView, View
from chord_usd.base.scene.types import FloatArray, SceneGraph

Fact = Literal["doors", "windows", "walls", "heights", "sizes", "home"]
FACTS: dict[Fact, str] = {
    "doors": "where doors and passages are",
    "windows": "where windows are",
    "walls": "where the walls of its rooms are",
    "heights": "how high its pieces are",
    "sizes": "how large its pieces are",
    "home": "which other rooms the home has",
}
"""What a layout may leave out."""
UNSAID = "unsaid"
"""Key of SceneGraph.extra: facts that its format has no place for."""

_OF_SHELL: dict[str, tuple[Fact, ...]] = {
    "walls": ("walls",), "sides": ("walls",), "room": ("walls",),
    "holes": ("doors", "windows"), "ways": ("doors",), "entries": ("doors",),
    "borders": ("doors",), "windows": ("windows",), "below_glass": ("windows",),
    "clear": ("doors", "windows"), "clear_from_m": ("doors", "windows"),
    "joins_kitchen": ("doors", "home"), "is_largest": ("home",), "is_lived_in": ("home",),
    "ground": ("walls",),
}  # fmt: skip
_OF_GROUND: dict[str, tuple[Fact, ...]] = {
    "ways": ("doors",), "goals": ("doors",), "way_m": ("doors",),
}  # fmt: skip


def unsaid_of(graphs: Sequence[SceneGraph]) -> frozenset[Fact]:
    """What the storeys of a layout leave out: what their formats do, and openings of a kind that
    none of its rooms has.

    A room without any way in is no room that was planned so.
    """
    unsaid: set[Fact] = {
        fact
        for graph in graphs
        if isinstance(names := graph.extra.get(UNSAID), list)
        for fact in FACTS
        if fact in names
    }
    kinds = {opening.kind for graph in graphs for opening in graph.openings}
    if not kinds & {"door", "passage"}:
        unsaid.add("doors")
    if "window" not in kinds:
        unsaid.add("windows")
    return frozenset(unsaid)


@dataclass(frozen=True)
class Unjudged:
    """A rule that was not judged."""

    place: str
    """Id of the room; empty for the home."""
    kind: RuleKind
    rule: str
    facts: tuple[Fact, ...]
    """What it reads and the layout leaves out."""


@dataclass
class Said:
    """Which rules a layout says enough for; notes the others."""

    unsaid: frozenset[Fact]
    unjudged: list[Unjudged] = field(default_factory=list)

    def __call__(
        self, rules: Sequence[Rule[Seen]], seen: Seen, kind: RuleKind, area_m2: float
    ) -> Sequence[Rule[Seen]]:
        """The rules that can be judged. The others are noted, where their area is asked."""
        if not self.unsaid:
            return rules
        place = seen.shell.room.id if isinstance(seen, View) else ""
        judged = []
        for rule in rules:
            facts = self._lacking(rule, seen) if rule.from_m2 <= area_m2 < rule.below_m2 else ()
            if facts:
                self.unjudged.append(Unjudged(place, kind, rule.name, facts))
            else:
                judged.append(rule)
        return judged

    def _lacking(self, rule: Rule[Any], seen: View | HomeView) -> tuple[Fact, ...]:
        if "sizes" in self.unsaid:
            return ("sizes",)
        if isinstance(seen, HomeView) and "home" in self.unsaid:
            return ("home",)
        return tuple(sorted(read_by(rule, seen) & self.unsaid))


def read_by(rule: Rule[Any], seen: View | HomeView) -> set[Fact]:
    """The facts that a rule reads where it measures a room or a home."""
    notes: set[Fact] = set()
    noted: View | HomeView
    if isinstance(seen, View):
        noted = _noted(seen, notes)
    else:
        noted = _NotedHome(tuple(_noted(room, notes) for room in seen.rooms), seen.entrance)
        noted.__dict__["notes"] = notes
    notes.clear()  # to build a view is not yet to ask
    list(rule.measure(noted))
    return notes


def _noted(view: View, notes: set[Fact]) -> View:
    shell = cast(Shell, _Noting(view.shell, notes, _OF_SHELL))
    noted = _NotedView(shell, view.items, view.hung)
    noted.notes = notes
    return noted


class _Noting:
    """A shell, or its ground, that notes what is read of it."""

    def __init__(self, of: object, notes: set[Fact], facts: dict[str, tuple[Fact, ...]]) -> None:
        self._of, self._notes, self._facts = of, notes, facts

    def __getattr__(self, name: str) -> Any:
        self._notes.update(self._facts.get(name, ()))
        value = getattr(self._of, name)
        return _Noting(value, self._notes, _OF_GROUND) if name == "ground" else value


class _NotedView(View):
    """A view that notes where heights are read, and free floor up to walls."""

    notes: set[Fact] | None = None

    @property
    def height(self) -> FloatArray:
        """(N,) of the pieces."""
        if self.notes is not None:
            self.notes.add("heights")
        return self._height

    @height.setter
    def height(self, values: FloatArray) -> None:
        self._height = values

    def _depth(self, *args: Any) -> float:
        if self.notes is not None:
            self.notes.add("walls")
        return super()._depth(*args)


class _NotedHome(HomeView):
    """A home that notes where its entrance is read."""

    def __getattribute__(self, name: str) -> Any:
        notes = object.__getattribute__(self, "__dict__").get("notes")
        if notes is not None and name == "entrance":
            notes.add("doors")
        return object.__getattribute__(self, name)
