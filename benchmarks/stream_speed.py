"""How many furnished houses a second one core draws, rasters included.

python benchmarks/stream_speed.py [--seconds N]
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator

import cv2
import numpy as np
from results import write_section

from chord_usd.base.raster.canvas import draw_items, draw_plan, fit_frame
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    options = parser.parse_args()
    cv2.setNumThreads(1)
    parts = {"plan": 0.0, "furniture": 0.0, "rasters": 0.0}
    houses = rooms = items = 0
    for seconds, room_count, item_count in _houses(options.seconds):
        for name, spent in seconds.items():
            parts[name] += spent
        houses, rooms, items = houses + 1, rooms + room_count, items + item_count
    total = sum(parts.values())
    size = f"{rooms / houses:.1f} rooms and {items / houses:.1f} items each"
    rows = [
        ("houses per second, one core", f"{houses / total:.0f}"),
        ("houses drawn", f"{houses}, {size}"),
    ]
    rows += [(f"{part}, per house", f"{s / houses * 1000:.2f} ms") for part, s in parts.items()]
    sys.stdout.write(write_section("houses", rows))


def _houses(budget_s: float) -> Iterator[tuple[dict[str, float], int, int]]:
    """Seconds per part, rooms and items of one house after the other, until the budget is spent."""
    rng = np.random.default_rng(0)
    furnish(random_plan(rng), rng)
    started = time.perf_counter()
    while time.perf_counter() - started < budget_s:
        marks = [time.perf_counter()]
        plan = random_plan(rng)
        marks.append(time.perf_counter())
        scene = furnish(plan, rng)
        marks.append(time.perf_counter())
        frame = fit_frame(plan)
        draw_plan(plan, frame)
        draw_items(scene.items, frame)
        marks.append(time.perf_counter())
        spent = dict(zip(("plan", "furniture", "rasters"), np.diff(marks).tolist(), strict=True))
        yield spent, len(plan.rooms), len(scene.items)


if __name__ == "__main__":
    main()
