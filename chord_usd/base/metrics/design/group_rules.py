"""Rules of pieces that belong to others: a bedside table has a bed, a side table a seat, a dining
cabinet a dining place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from chord_usd.base.metrics.design.rule import Measured, Rule
from chord_usd.base.metrics.design.view import View
from chord_usd.base.scene.palette import having

_SEATS = frozenset(("sofa", "lounge", "bed", *having("easy_chair")))
HEADS: Mapping[str, tuple[frozenset[str], float]] = {
    "bedside_table": (frozenset(("bed",)), 0.35),
    "bed_background": (frozenset(("bed",)), 0.35),
    "sofa_background": (frozenset(("sofa",)), 0.35),
    "side_coffee_table": (_SEATS, 0.5),
    "dining_cabinet": (frozenset(("dining_table",)), 4.0),
}
"""Of pieces, what they belong to, and how far from it they stand at most, metres."""


def strays(view: View) -> list[int]:
    """Pieces without what they belong to. Kitchens store what is eaten from."""
    alone = []
    for at, name in enumerate(view.categories):
        if name not in HEADS or (name == "dining_cabinet" and view.shell.kind == "kitchen"):
            continue
        heads, most_m = HEADS[name]
        there = view.of(*heads)
        if not there or view.gaps(at)[there].min() > most_m:
            alone.append(at)
    return alone


def _strays(view: View) -> Iterator[Measured]:
    if view.of(*HEADS):
        alone = strays(view)
        at = view.point(alone[0]) if alone else view.middle
        yield Measured(len(alone), at, tuple(view.items[piece].id for piece in alone))


RULES: tuple[Rule[View], ...] = (
    Rule("pieces without what they belong to", 0, "count", "planning guides", _strays,
         at_most=True),
)  # fmt: skip
