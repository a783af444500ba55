"""Stairs and storeys in CHOrD JSON.

A plan may hold `stairs`: boxes as of furniture, with `form` (straight, L, U, winder_L,
winder_U, spiral), `turn` (left, right) and `leads` (up, down). A house of storeys is
`{"storeys": [...]}`, one plan each, the lowest first, with an optional `name` and `shift` ([x, y],
centimetres: where its origin lies in the ground floor's). Plans without `shift` are registered by
what they show.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.json_text import json_text
from chord_usd.base.scene.chord_json import (
    box_to_json,
    plan_from_json,
    plan_to_json,
    portable_scene,
    read_box,
    write_scene,
)
from chord_usd.base.scene.json_elements import Element
from chord_usd.base.scene.limits import MOST_STAIRS, MOST_STOREYS
from chord_usd.base.scene.storeys import STAIRS, Leads, Stair, StairForm, StoreyPlan, Turn
from chord_usd.base.scene.types import Plan, SceneGraph
from chord_usd.base.scene.units import cm_from_m, m_from_cm

STOREYS = "storeys"
_NAME, _SHIFT = "name", "shift"


def write_storeys(graphs: Sequence[SceneGraph], names: Sequence[str], path: Path) -> None:
    """Write the storeys of a house as CHOrD JSON, the lowest first; of one, its scene graph.

    Raises OutputError.
    """
    if len(graphs) == 1:
        return write_scene(graphs[0], path)
    rows = [
        {_NAME: name, **portable_scene(graph, path)}
        for name, graph in zip(names, graphs, strict=True)
    ]
    write_atomic(path, json_text({STOREYS: rows}))


def stairs_of(plan: Plan, where: str = "plan") -> tuple[Stair, ...]:
    """The stairs that a plan notes. Raises PlanError."""
    house = Element({STAIRS: plan.extra.get(STAIRS, [])}, where, PlanError)
    stairs = [_read_stair(element) for element in house.elements(STAIRS, "stair", MOST_STAIRS)]
    return tuple(
        stair if stair.id else Stair(f"stair{index + 1}", *_rest(stair))
        for index, stair in enumerate(stairs)
    )


def _rest(stair: Stair) -> tuple[Any, ...]:
    return stair.form, stair.box, stair.turn, stair.leads


def _read_stair(element: Element) -> Stair:
    return Stair(
        id=element.text("id") if element.has("id") else "",
        form=element.choice("form", get_args(StairForm)) if element.has("form") else "straight",
        box=read_box(element),
        turn=element.choice("turn", get_args(Turn)) if element.has("turn") else "right",
        leads=element.choice("leads", get_args(Leads)) if element.has("leads") else "up",
    )


def stair_to_json(stair: Stair) -> dict[str, Any]:
    """The JSON object of a stair; stairs_of gives it back."""
    return {
        "id": stair.id, "form": stair.form, "turn": stair.turn, "leads": stair.leads,
        **box_to_json(stair.box),
    }  # fmt: skip


def is_storeys(data: object) -> bool:
    """Whether parsed JSON is a house of storeys, not a single plan."""
    return isinstance(data, Mapping) and STOREYS in data


def storeys_from_json(data: object, where: str = "plan") -> tuple[StoreyPlan, ...]:
    """The storeys of a house, the lowest first. Raises PlanError."""
    house = Element(data, where, PlanError)
    storeys = []
    for index, element in enumerate(house.elements(STOREYS, "storey", MOST_STOREYS, _NAME)):
        plan = plan_from_json(element.rest((_NAME, _SHIFT)), f"{where}: storey {index + 1}")
        shift = element.numbers(_SHIFT, 2) if element.has(_SHIFT) else None
        storeys.append(
            StoreyPlan(
                plan, element.text(_NAME) if element.has(_NAME) else "",
                (m_from_cm(shift[0]), m_from_cm(shift[1])) if shift else None,
            )
        )  # fmt: skip
    if not storeys:
        raise house.error("holds no storey", expected="one plan or more")
    return tuple(storeys)


def storeys_to_json(storeys: Sequence[StoreyPlan]) -> dict[str, Any]:
    """The JSON object of a house of storeys; storeys_from_json gives it back."""
    rows = []
    for storey in storeys:
        shift = {} if storey.shift_m is None else {_SHIFT: [cm_from_m(at) for at in storey.shift_m]}
        name = {_NAME: storey.name} if storey.name else {}
        rows.append({**name, **shift, **plan_to_json(storey.plan)})
    return {STOREYS: rows}
