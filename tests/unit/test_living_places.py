"""Living rooms whose group is placed first, with its television, and their other zones."""

from __future__ import annotations

from collections.abc import Sequence

from chord_usd.base.metrics.design import judged_room
from chord_usd.base.metrics.design.price import tight
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View
from chord_usd.base.scene.types import Box, Item, Opening, Room, frozen_array
from chord_usd.line.lists.improve import improved
from chord_usd.line.lists.other_places import changes_of

_DAY = (("sofa", Box((2.0, 0.45, 0.0), (2.2, 0.9, 0.85), 180.0)),
        ("coffee_table", Box((2.0, 1.6, 0.0), (0.9, 0.55, 0.42), 180.0)),
        ("single_sofa", Box((3.3, 1.7, 0.0), (0.8, 0.8, 0.85), -90.0)))  # fmt: skip


def _living(
    size: tuple[float, float], openings: Sequence[Opening], *more: tuple[str, Box]
) -> tuple[View, View, set[str]]:
    """A living room with a sofa at its south wall and more, before and after changes, and which
    rules it breaks then."""
    east, north = size
    outline = frozen_array([(0, 0), (east, 0), (east, north), (0, north)])
    room = Room("room", "living", outline)
    items = tuple(
        Item(f"room/{name}_{nth}", name, box, "room") for nth, (name, box) in
        enumerate((*_DAY, *more))
    )  # fmt: skip
    before = View(shells((room,), tuple(openings))["room"], items)
    after = improved(before, lambda _: 0.0, changes_of(before))
    return before, after, {one.rule for own in judged_room(after) for one in own.findings}


def test_a_dining_table_and_a_cabinet_give_their_place_to_a_television() -> None:
    """The sofa looks at windows, and its own wall is the only one for a television; a dining set
    and a cabinet stand where the sofa would be then."""
    windows = tuple(
        Opening(f"w{x}", "window", Box((x, 4.12, 0.3), (1.8, 0.24, 2.0), 0.0), ("room",))
        for x in (1.0, 3.0, 5.0)
    )
    chairs = (("chair", Box((4.4, 3.3 + side * 0.7, 0.0), (0.45, 0.5, 0.9), 90.0 - side * 90.0))
              for side in (-1, 1))  # fmt: skip
    table = ("dining_table", Box((4.4, 3.3, 0.0), (0.8, 0.8, 0.75), 0.0))
    cabinet = ("cabinet", Box((0.25, 2.6, 0.0), (1.2, 0.5, 2.0), 90.0))
    before, after, broken = _living((6.0, 4.0), windows, table, *chairs, cabinet)
    assert not before.televisions
    assert after.televisions
    assert not broken & {"television", "other furniture between sofa and television"}
    assert {"dining_table", "chair", "cabinet"} <= {*after.categories}
    assert tight(after) == 0


def test_a_television_stands_before_the_middle_of_its_sofa() -> None:
    """Its cabinet is a metre aside, nearer than 20 degrees from the sofa's front."""
    aside = ("tv_cabinet", Box((2.9, 3.8, 0.0), (1.4, 0.4, 0.47), 0.0))
    before, after, broken = _living((4.2, 4.0), (), aside)
    assert before.televisions
    assert "television aside of the middle of the sofa's view" not in broken
    (screen,) = after.televisions
    assert abs(after.own(after.of("sofa")[0], screen.at)[0]) < 0.4


def test_a_large_living_room_has_a_second_zone() -> None:
    screen = ("tv_cabinet", Box((2.0, 3.8, 0.0), (1.4, 0.4, 0.47), 0.0))
    before, after, broken = _living((8.0, 4.0), (), screen)
    found = {one.rule for own in judged_room(before) for one in own.findings}
    assert any("far from all furniture" in rule for rule in found)
    assert not any("far from all furniture" in rule for rule in broken)
    assert {"table", "cabinet"} & {*after.categories}
