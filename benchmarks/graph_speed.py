"""How long a layout raster takes to become a scene graph, part by part.

python benchmarks/graph_speed.py [--houses N] [--threads N]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable, Sequence

import cv2
import torch
from results import write_section

from chord_usd.line.graph.colours import read_pixels
from chord_usd.line.graph.detect import load_item_detector, load_room_segmenter
from chord_usd.line.graph.extract import extract_graph
from chord_usd.workshop.evaluation.detector_cases import Case, clean_cases


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--houses", type=int, default=40)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    cv2.setNumThreads(options.threads)
    started = time.perf_counter()
    items, rooms = load_item_detector(), load_room_segmenter()
    loaded_s = time.perf_counter() - started
    cases = list(clean_cases(options.houses))
    parts: dict[str, Callable[[Case], object]] = {
        "detect items": lambda case: items.detect(case.layout.rgb),
        "segment rooms": lambda case: rooms.segment(case.layout.rgb),
        "read pixels": lambda case: read_pixels(case.layout.rgb),
        "graph, plan known": lambda case: extract_graph(case.layout, case.plan, items, rooms),
        "graph, picture alone": lambda case: extract_graph(case.layout, None, items, rooms),
    }
    rows = [("load both networks, torch and ultralytics", f"{loaded_s:.1f} s")]
    rows += [(name, _spread(_times_ms(part, cases))) for name, part in parts.items()]
    pieces = sum(len(case.items) for case in cases) / len(cases)
    note = (
        f"Per layout, median and 95th percentile over {len(cases)} held-out houses with "
        f"{pieces:.0f} pieces each, half of them unshaded; {options.threads} threads. "
        "Detection is part of the graph; rooms are segmented where their kinds are not painted."
    )
    sys.stdout.write(write_section("graph", rows, note))


def _times_ms(part: Callable[[Case], object], cases: Sequence[Case]) -> list[float]:
    """One time per case; what is made at first use is not counted."""
    part(cases[0])
    times = []
    for case in cases:
        started = time.perf_counter()
        part(case)
        times.append((time.perf_counter() - started) * 1000.0)
    return times


def _spread(times_ms: Sequence[float]) -> str:
    high = statistics.quantiles(times_ms, n=20)[-1]
    return f"{statistics.median(times_ms):.0f} ms ({high:.0f} ms)"


if __name__ == "__main__":
    main()
