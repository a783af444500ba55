"""What the steps found out about an item, as keys of its JSON element."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, get_args

from chord_usd.base.scene.json_elements import Element
from chord_usd.base.scene.types import Box, Edit, Facts, FrontFrom

FACT_KEYS = (
    "source_px", "front_from", "detected", "below_sill_m", "asset_distance_m", "ood", "edits",
    "moved_m", "rests_on", "unit", "locked",
)  # fmt: skip
"""moved_m is of older files; it follows from the edits."""

_MOST_EDITS = 100

ReadBox = Callable[[Element], Box]


def read_facts(element: Element, read_box: ReadBox) -> Facts:
    """The facts of an item's element. Raises its error for what is none."""
    source_px = element.points(4, "source_px") if element.has("source_px") else []
    if source_px and len(source_px) != 4:
        raise element.error(f"source_px holds {len(source_px)} points", expected="four")
    return Facts(
        source_px=tuple((x, y) for x, y in source_px),
        front_from=_choice(element),
        detected=_truth(element, "detected"),
        below_sill_m=_number(element, "below_sill_m"),
        asset_distance_m=_number(element, "asset_distance_m"),
        ood=_number(element, "ood"),
        edits=_edits(element, read_box),
        rests_on=element.text("rests_on") if element.has("rests_on") else None,
        unit=element.text("unit") if element.has("unit") else None,
        locked=_truth(element, "locked") or False,
    )


def _choice(element: Element) -> FrontFrom | None:
    if not element.has("front_from"):
        return None
    choice: FrontFrom = element.choice("front_from", get_args(FrontFrom))
    return choice


def _number(element: Element, key: str) -> float | None:
    return element.number(key) if element.has(key) else None


def _truth(element: Element, key: str) -> bool | None:
    if not element.has(key):
        return None
    value = element.raw()[key]
    if not isinstance(value, bool):
        raise element.error(f"{key} is neither true nor false", expected="true or false")
    return value


def _edits(element: Element, read_box: ReadBox) -> tuple[Edit, ...]:
    if not element.has("edits"):
        return ()
    rows = element.elements("edits", "edit", _MOST_EDITS, name_key="rule")
    return tuple(Edit(row.text("rule"), read_box(row)) for row in rows)


def facts_to_json(facts: Facts, write_box: Callable[[Box], Any]) -> dict[str, Any]:
    """The keys of what is known."""
    values = {
        "source_px": [list(point) for point in facts.source_px] or None,
        "front_from": facts.front_from,
        "detected": facts.detected,
        "below_sill_m": facts.below_sill_m,
        "asset_distance_m": facts.asset_distance_m,
        "ood": facts.ood,
        "edits": [{"rule": e.rule, **write_box(e.before)} for e in facts.edits] or None,
        "rests_on": facts.rests_on,
        "unit": facts.unit,
        "locked": facts.locked or None,
    }
    return {key: value for key, value in values.items() if value is not None}
