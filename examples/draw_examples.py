"""Draws the plans in this folder; run it again after a change to the house generator.

python examples/draw_examples.py
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.workshop.data.houses import random_plan


@dataclass(frozen=True)
class Example:
    """A procedural house that shows something."""

    name: str
    seed: int
    rooms: int
    shaded: bool = True
    """Rooms in the grey of their kind; white rooms leave the kind to be guessed."""


EXAMPLES = (
    Example("studio.png", 2041, 3),
    Example("two_bedrooms.png", 2004, 7),
    Example("cut_corner.png", 2019, 6),
    Example("unlabelled.png", 2013, 9, shaded=False),
    Example("family_house.png", 2014, 12),
    Example("large_house.png", 2023, 16),
    Example("balcony_flat.json", 2005, 9),
)


def main() -> None:
    """Writes every example beside this script."""
    folder = Path(__file__).parent
    for example in EXAMPLES:
        plan = random_plan(np.random.default_rng(example.seed), example.rooms)
        path = folder / example.name
        if path.suffix == ".json":
            write_plan(plan, path)
        else:
            write_raster(draw_plan(plan, shade=example.shaded), path)


if __name__ == "__main__":
    main()
