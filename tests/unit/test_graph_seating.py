"""Chairs without a front mark face their table; all others face what they faced."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.geometry import footprint_polygon, front_direction
from chord_usd.graph.seating import face_tables
from chord_usd.types import Box, Item

TABLE = Item("table", "dining_table", Box((2.0, 2.0, 0.0), (1.8, 0.8, 0.75), 30.0), "r")


def chair(own_x_m: float, own_y_m: float, yaw_deg: float = 75.0, seen: str = "wall") -> Item:
    """At this place of the table's own frame."""
    turn = np.radians(TABLE.box.yaw_deg)
    x_m = 2.0 + own_x_m * np.cos(turn) - own_y_m * np.sin(turn)
    y_m = 2.0 + own_x_m * np.sin(turn) + own_y_m * np.cos(turn)
    box = Box((float(x_m), float(y_m), 0.0), (0.45, 0.55, 0.9), yaw_deg)
    return Item("chair", "chair", box, "r", extra={"front_from": seen})


def test_at_every_side_of_a_table_it_faces_across() -> None:
    for own_x_m, own_y_m, yaw_deg in (
        (0.0, 0.5, 30.0), (0.7, 0.6, 30.0), (0.6, 0.2, 30.0), (-0.8, -0.5, -150.0),
        (1.1, 0.1, -60.0), (-1.0, 0.0, 120.0), (0.0, 0.4, 30.0),
    ):  # fmt: skip
        for before_deg in (30.0, 120.0, -150.0, -60.0):
            before = chair(own_x_m, own_y_m, before_deg)
            after = face_tables([TABLE, before])[1]
            assert after.box.yaw_deg == pytest.approx(yaw_deg), (own_x_m, own_y_m)
            assert after.extra["front_from"] == "table"
            same = footprint_polygon(after.box).symmetric_difference(footprint_polygon(before.box))
            assert same.area < 1e-9


def test_of_two_tables_it_faces_the_nearer() -> None:
    other = Item("other", "table", Box((2.0, 3.4, 0.0), (1.2, 0.6, 0.75), 0.0), "r")
    near = Item("c", "chair", Box((2.0, 2.95, 0.0), (0.4, 0.4, 0.9), 0.0), "r", extra={
        "front_from": "wall"
    })  # fmt: skip
    turned = face_tables([TABLE, other, near])[2]
    assert front_direction(turned.box.yaw_deg) == pytest.approx((0.0, 1.0))


@pytest.mark.parametrize(
    "item",
    [
        chair(0.0, 0.5, 120.0, "mark"),
        chair(0.0, 1.2, 120.0),
        Item("s", "single_sofa", chair(0.0, 0.5, 120.0).box, "r", extra={"front_from": "wall"}),
        Item("c", "chair", chair(0.0, 0.5, 120.0).box, "next", extra={"front_from": "wall"}),
    ],
    ids=["its mark was seen", "too far off", "no chair", "in another room"],
)
def test_others_stay_as_they_are(item: Item) -> None:
    assert face_tables([TABLE, item]) == (TABLE, item)
