"""Kitchens: composed runs of units, as houses get them."""

from __future__ import annotations

from chord_usd.base.scene.types import Plan
from chord_usd.line.compose.composer import compose
from chord_usd.workshop.data.furnish.floor import Floor


def furnish_kitchen(floor: Floor, plan: Plan) -> None:
    """A composed kitchen; the refrigerator and appliances as often as the mix has them."""
    dice, mix = floor.dice, floor.mix
    without = {"refrigerator"} if dice.random() >= mix.refrigerator else set()
    if dice.random() >= mix.electrical:
        without.add("electrical_floor_cabinet")
    floor.new_group()
    units = compose(
        plan.scene(), floor.room, dice.getrandbits(32), hints=floor.hints, without=without,
        effort=_EFFORT, compact=False,
    )  # fmt: skip
    for unit in units:
        is_single = unit.category == "single_door_floor_cabinet"
        if is_single and mix.single_door < 1.0 and dice.random() >= mix.single_door:
            continue
        floor.put_box(unit.category, unit.box, core=unit.category != "refrigerator")


_EFFORT = 6
"""Shapes of kitchens looked at: a stream of houses has no time for more."""
