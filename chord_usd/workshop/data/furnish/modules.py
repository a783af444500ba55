"""Filling a stretch of kitchen counter with modules, without a gap."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import NamedTuple

from chord_usd.base.scene.palette import CATEGORIES

LEAST_M = 0.3
"""Nothing narrower stands in a run."""

WIDTHS_M = 0.3, 0.4, 0.45, 0.5, 0.6, 0.6, 0.6, 0.8
"""What floor cabinets are sold in; 60 cm most often, for what is built in is as wide."""

WIDEST_SINGLE_M, NARROWEST_DOUBLE_M = 0.55, 0.6
"""Of cabinets with one door and with two."""

SINK_M = 0.6, 0.8, 0.8
COOKER_M = 0.6, 0.6, 0.75

SINGLE = "single_door_floor_cabinet"
DOUBLE = "double_door_floor_cabinet"


class Module(NamedTuple):
    """One floor cabinet of a run."""

    category: str
    length_m: float


def pack(
    dice: random.Random,
    length: float,
    wanted: set[str],
    window_m: float | None,
    blind_start: bool,
    blind_end: bool,
    blind_m: float,
    tall_at_end: bool,
    widths_m: Sequence[float] = WIDTHS_M,
) -> list[Module]:
    """Modules from the run's start to its end that fill `length` metres.

    wanted: categories to place if there is room. window_m: where the sink would like its middle.
    Blind ends begin with a corner cabinet of blind_m, since the neighbour run hides one depth.
    tall_at_end: refrigerator and oven stand at the end, else at the start. widths_m: of cabinets
    that fill the rest.
    """
    head = [Module(DOUBLE, blind_m)] if blind_start else []
    tail = [Module(DOUBLE, blind_m)] if blind_end else []
    free = length - blind_m * (blind_start + blind_end)
    if free < 0.3:
        return [*head, *tail]
    ends: list[Module] = []
    needed = 0.6 * len(wanted & {"sink_cabinet", "cooker_cabinet"})
    has_end = not (blind_start and blind_end)
    if "refrigerator" in wanted and free >= needed + 0.6 and has_end:
        ends.append(Module("refrigerator", 0.7 if free > needed + 1.2 else 0.6))
    left = free - _total(ends)
    if "electrical_floor_cabinet" in wanted and left >= needed + 0.6 and has_end:
        ends.append(Module("electrical_floor_cabinet", 0.6))
    free -= _total(ends)
    offset = _total(head) + (0.0 if tall_at_end else _total(ends))
    middle = _middle(dice, free, wanted, None if window_m is None else window_m - offset, widths_m)
    row = [*middle, *reversed(ends)] if tall_at_end else [*ends, *middle]
    return [*head, *_stretched(row, free + _total(ends)), *tail]


def _stretched(row: list[Module], length: float) -> list[Module]:
    """The modules a little wider, as far as their kinds allow, to leave no slit at the wall."""
    spare = length - _total(row)
    if not 1e-6 < spare < LEAST_M:
        return row
    wider = []
    for module in row:
        more = min(spare, max(0.0, CATEGORIES[module.category].length_m[1] - module.length_m))
        wider.append(Module(module.category, module.length_m + more))
        spare -= more
    return wider


def _total(modules: list[Module]) -> float:
    return sum(module.length_m for module in modules)


def _middle(
    dice: random.Random,
    free: float,
    wanted: set[str],
    window_m: float | None,
    widths_m: Sequence[float],
) -> list[Module]:
    """Sink, cooker and what fills the rest."""
    names: list[str] = [n for n in ("sink_cabinet", "cooker_cabinet") if n in wanted]
    if not names or free < 0.6:
        return fill(dice, free, widths_m)
    if len(names) == 2 and free < 1.2:
        names = names[:1]
    lengths = {"sink_cabinet": dice.choice(SINK_M), "cooker_cabinet": dice.choice(COOKER_M)}
    if free < sum(lengths[n] for n in names) + 0.35:
        return _tight(names, free)
    if len(names) == 1:
        return _around(dice, names[0], lengths[names[0]], free, window_m, widths_m)
    return _sink_and_cooker(dice, free, lengths, window_m, widths_m)


def _tight(names: list[str], free: float) -> list[Module]:
    """The wanted modules alone, stretched or shrunk to fill the run."""
    most = {"sink_cabinet": 1.1, "cooker_cabinet": 0.95}
    each = free / len(names)
    modules = [Module(name, min(each, most[name])) for name in names]
    rest = free - _total(modules)
    return modules if rest < 0.3 else [*modules, Module(SINGLE, min(rest, 0.55))]


def _around(
    dice: random.Random,
    name: str,
    length: float,
    free: float,
    window_m: float | None,
    widths_m: Sequence[float],
) -> list[Module]:
    start = (free - length) / 2 if window_m is None else window_m - length / 2
    start = _fillable(min(max(0.0, start), free - length), free - length)
    rest = free - length - start
    return [*fill(dice, start, widths_m), Module(name, length), *fill(dice, rest, widths_m)]


def _sink_and_cooker(
    dice: random.Random,
    free: float,
    lengths: dict[str, float],
    window_m: float | None,
    widths_m: Sequence[float],
) -> list[Module]:
    """Sink at the window, the cooker on its longer side with counter between them."""
    sink, cooker = lengths["sink_cabinet"], lengths["cooker_cabinet"]
    spare = free - sink - cooker
    middle = free * dice.choice((0.25, 0.75)) if window_m is None else window_m
    sink_first = middle < free / 2
    start = middle - sink / 2 if sink_first else free - middle - sink / 2
    before = _fillable(min(max(0.0, start), spare - 0.3), spare)
    rest = spare - before
    after = _fillable(rest / 2 if rest > 1.2 else 0.0, rest)
    between = rest - after
    row = [
        *fill(dice, before, widths_m),
        Module("sink_cabinet", sink),
        *fill(dice, between, widths_m),
        Module("cooker_cabinet", cooker),
        *fill(dice, after, widths_m),
    ]
    return row if sink_first else row[::-1]


def _fillable(part: float, whole: float) -> float:
    """The nearest way to split `whole` such that cabinets fill both parts."""
    options = [part, 0.0, 0.3, 0.4, 0.5, 0.6, 0.8, whole - 0.3, whole - 0.4, whole - 0.6, whole]
    good = [o for o in options if _is_fillable(o) and _is_fillable(whole - o)]
    return min(good, key=lambda o: abs(o - part)) if good else 0.0


def _is_fillable(length: float) -> bool:
    return -1e-9 <= length < 1e-6 or 0.3 - 1e-6 <= length <= 0.55 + 1e-6 or length >= 0.6 - 1e-6


def fill(dice: random.Random, length: float, widths_m: Sequence[float]) -> list[Module]:
    """Floor cabinets of the usual widths, the last one to measure; [] below 0.3 m."""
    if length < LEAST_M - 1e-6:
        return []
    if length <= WIDEST_SINGLE_M + 1e-6:
        return [Module(SINGLE, length)]
    widths = [width for width in widths_m if _is_fillable(length - width)]
    # No cabinet is between the widest with one door and the narrowest with two.
    own = length if length >= NARROWEST_DOUBLE_M - 1e-6 else WIDEST_SINGLE_M
    first = dice.choice(widths) if widths else own
    module = Module(SINGLE if first <= WIDEST_SINGLE_M + 1e-6 else DOUBLE, first)
    return [module, *fill(dice, length - first, widths_m)]
