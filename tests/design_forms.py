"""Designs that differ in size only are one form: what its ends have, its other sizes have, too."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable

from chord_usd.library.kit.model import Design


def forms(designs: Iterable[Design]) -> list[list[Design]]:
    """The designs by form, each from its smallest footprint to its largest."""
    found: dict[str, list[Design]] = defaultdict(list)
    for design in designs:
        found[re.sub(r"(_\d+(x\d+)?)+$", "", design.id)].append(design)
    return [sorted(form, key=_area_m2) for form in found.values()]


def ends(designs: Iterable[Design]) -> list[Design]:
    """Of every form the smallest and the largest, or the only one."""
    return [design for form in forms(designs) for design in form[:: max(len(form) - 1, 1)]]


def _area_m2(design: Design) -> tuple[float, str]:
    return design.size_m[0] * design.size_m[1], design.id
