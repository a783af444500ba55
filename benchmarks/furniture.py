"""What the embedded furniture holds, and how far it misses the pieces that houses ask for.

python benchmarks/furniture.py [--houses N]
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np
from results import write_section

from chord_usd.base.scene.palette import HOUSE_CATEGORIES, TABLE_CATEGORIES, category
from chord_usd.base.scene.types import Item
from chord_usd.library.catalogue import designs
from chord_usd.library.database import AssetDatabase, embedded_assets
from chord_usd.line.graph.match import fitted_box
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan

NEAR_M = 0.05 + 1e-6
"""Retrieval misses by at most this (and a rounding error)..."""
FILLED_M = 0.01
"""...and a piece that is stretched to within this of its box leaves nothing to be seen."""
BUDGET = (500, 8000)
"""Triangles a piece."""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--houses", type=int, default=200)
    options = parser.parse_args()
    rows = [*stock_rows(), *retrieval_rows(options.houses)]
    note = f"`python benchmarks/furniture.py --houses {options.houses}`."
    sys.stdout.write(write_section("stages: furniture", rows, note))


def stock_rows() -> Iterator[tuple[str, str]]:
    """How much there is, and how heavy it is."""
    catalogue = designs()
    kinds = {design.category for design in catalogue}
    asked = {row.name for row in (*HOUSE_CATEGORIES, *TABLE_CATEGORIES)}
    yield "assets", f"{len(catalogue)}, in {len(kinds & asked)} of {len(asked)} categories"
    colours = statistics.mean(len(design.colourways) for design in catalogue)
    yield "colourways an asset", f"{colours:.1f}"
    for level, rows in (("house", HOUSE_CATEGORIES), ("table", TABLE_CATEGORIES)):
        names = {row.name for row in rows}
        counts = {
            design.id: sum(len(part.solid.faces) for part in design.parts())
            for design in catalogue
            if design.category in names
        }
        sizes = list(counts.values())
        yield f"triangles, {level} level", _spread(sizes)
        low, high = BUDGET
        over, under = sum(n > high for n in sizes), sum(n < low for n in sizes)
        yield f"out of {low} to {high}, {level} level", f"{over} above, {under} below"


def retrieval_rows(houses: int) -> Iterator[tuple[str, str]]:
    """How far the nearest mesh misses what procedural houses ask for."""
    database = AssetDatabase(embedded_assets())
    missed: dict[str, list[float]] = defaultdict(list)
    left: list[float] = []
    for item in _items(houses):
        asset = database.nearest(item.category, item.box.size_m)
        off = np.abs(np.subtract(asset.size_m[:2], item.box.size_m[:2]))
        missed[item.category].append(float(off.max()))
        row = category(item.category)
        filled = fitted_box(item.box, asset, row, is_guess=True).size_m
        left.append(float(np.max(np.subtract(item.box.size_m[:2], filled[:2]))))
    every = np.concatenate(list(missed.values()))
    yield "pieces asked for", f"{len(every)} in {houses} houses"
    yield f"nearest within {100 * NEAR_M:.0f} cm", f"{np.mean(every <= NEAR_M):.3f}"
    shares = np.percentile(every, (50, 90, 99)) * 100
    yield "missed by, median, 90th, 99th percentile", ", ".join(f"{x:.1f} cm" for x in shares)
    worst = min(missed, key=lambda name: float(np.mean(np.array(missed[name]) <= NEAR_M)))
    share = float(np.mean(np.array(missed[worst]) <= NEAR_M))
    yield "worst category", f"{worst}, {share:.2f} of {len(missed[worst])}"
    yield "box filled after the stretch", f"{np.mean(np.array(left) <= FILLED_M):.3f}"


def _items(houses: int) -> Iterator[Item]:
    for seed in range(houses):
        rng = np.random.default_rng(seed)
        yield from furnish(random_plan(rng), rng).items


def _spread(counts: Sequence[int]) -> str:
    return f"{min(counts)} to {max(counts)}, median {statistics.median(counts):.0f}"


if __name__ == "__main__":
    main()
