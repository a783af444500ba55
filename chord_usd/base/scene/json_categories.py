"""What is written of an element's category, style and support, and what does not fit together."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from difflib import get_close_matches

from chord_usd.base.errors import SceneError
from chord_usd.base.scene import palette
from chord_usd.base.scene.json_elements import Element, shown
from chord_usd.base.scene.palette import Level
from chord_usd.base.scene.styles import STYLES
from chord_usd.base.scene.types import Item


def spelling(name: str) -> str:
    """The name as the tables spell it: "Coffee Table" becomes coffee_table."""
    return re.sub(r"[\s_-]+", "_", name.strip().lower())


def read_category(element: Element, level: Level, *, is_child: bool) -> str:
    """Name of the category of an element in the list of this level (HOUSE or DRESSING).

    is_child: whether it is among the children of another.
    """
    given = element.text("type")
    try:
        row = palette.category(spelling(given))
    except SceneError as problem:
        raise element.error(
            f"unknown category '{shown(given)}'", expected=problem.expected, try_=problem.try_
        ) from None
    if row.level is Level.PLAN:
        raise element.error(f"'{given}' is no furniture", try_="move it to windowsDoors")
    if level is Level.DRESSING and row.level is not level:
        raise element.error(
            f"'{shown(given)}' is no dressing",
            expected="a category of the dressing level, such as curtain or rug",
            try_=(
                "move it to furniture"
                if row.level is Level.HOUSE
                else "put it into the children of what carries it"
            ),
        )
    if level is not Level.DRESSING and row.level is Level.DRESSING:
        raise element.error(
            f"'{shown(given)}' is dressing", expected="furniture", try_="move it to dressing"
        )
    if row.level is Level.TABLE and not is_child:
        raise element.error(
            f"'{shown(given)}' is a tabletop category",
            expected="a piece that stands in the room",
            try_="put it into the children of what carries it",
        )
    return row.name


def read_style(house: Element) -> str:
    """Name of the house's style; "" where it has none."""
    return str(house.choice("style", tuple(STYLES))) if house.has("style") else ""


def refuse_loose_ends(
    elements: Sequence[Element], dressing: Sequence[Item], items: Sequence[Item]
) -> None:
    """Refuse dressing that carries things, rests on what is not there, or in the end on itself.

    elements: of the dressing, in its order.
    """
    there = {item.id for item in _all(items)} | {item.id for item in dressing}
    rests_on = {item.id: item.facts.rests_on for item in dressing}
    for element, item in zip(elements, dressing, strict=True):
        carrier = rests_on[item.id]
        if item.children:
            raise element.error(
                "has children", expected="dressing of its own with rests_on, or none"
            )
        if carrier is not None and carrier not in there:
            near = get_close_matches(carrier[:100], sorted(there)[:1000], n=1)
            raise element.error(
                f"rests_on names '{shown(carrier)}', which is not there",
                expected="the id of furniture or dressing",
                try_=f"'{shown(near[0])}'" if near else "",
            )
    _refuse_rings(elements, dressing, rests_on)


def _refuse_rings(
    elements: Sequence[Element], dressing: Sequence[Item], rests_on: dict[str, str | None]
) -> None:
    sound: set[str] = set()
    for element, item in zip(elements, dressing, strict=True):
        way: dict[str, None] = {}
        here: str | None = item.id
        while here is not None and here not in sound:
            if here in way:
                raise element.error("rests_on leads back to itself", expected="what carries it")
            way[here] = None
            here = rests_on.get(here)
        sound.update(way)


def _all(items: Sequence[Item]) -> Iterator[Item]:
    for item in items:
        yield item
        yield from _all(item.children)
