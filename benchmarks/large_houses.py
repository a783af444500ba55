"""How time and memory grow with the size of a house, to 60 rooms and beyond.

python benchmarks/large_houses.py [--rooms N ...] [--seed N] [--keep DIR]
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from results import write_section

from chord_usd.base.metrics.scores import score_scenes
from chord_usd.base.runtime.progress import Progress, Stopwatch
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    Opening,
    OpeningKind,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.line.pipeline import Models, Settings, generate, load_models
from chord_usd.line.stage.check.check_stage import check_stage

ROOMS = (10, 20, 40, 60, 120)
ROOMS_PER_WING = 20
DEPTH_M = 4.8
CORRIDOR_M = 1.8
COURT_M = 6.0
_WIDTHS_M: dict[RoomKind, tuple[float, float]] = {
    "bedroom": (3.2, 4.4), "bathroom": (2.0, 2.8), "living": (4.8, 6.2), "kitchen": (2.8, 3.8),
    "study": (2.6, 3.4), "dining": (3.6, 4.6), "store": (1.6, 2.2),
}  # fmt: skip
_SERIES: tuple[RoomKind, ...] = (
    "living", "kitchen", "bathroom", "bedroom", "bedroom", "bathroom", "dining", "study",
    "bedroom", "store",
)  # fmt: skip
_HEIGHTS_M: dict[OpeningKind, tuple[float, float]] = {
    "door": (0.0, 2.1), "window": (0.9, 1.4), "passage": (0.0, 2.3),
}  # fmt: skip

_NOTE = (
    "Processor seconds per square metre of floor should not grow. Corridors are not counted as "
    "rooms; seed {}."
)


class Builder:
    """A house of wings: rooms on both sides of a corridor, all corridors off one hall."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self.rooms: list[Room] = []
        self.openings: list[Opening] = []

    def plan(self, rooms: int) -> Plan:
        """A house with this many rooms beside its corridors and hall."""
        counts = [min(ROOMS_PER_WING, rooms - done) for done in range(0, rooms, ROOMS_PER_WING)]
        pitch_m = 2 * (DEPTH_M + WALL_THICKNESS_M) + CORRIDOR_M + COURT_M
        for wing, count in enumerate(counts):
            self._wing(wing * pitch_m, count)
        top_m = (len(counts) - 1) * pitch_m + CORRIDOR_M
        hall = self._room("corridor", -2.0 - WALL_THICKNESS_M, 0.0, -WALL_THICKNESS_M, top_m)
        for wing in range(len(counts)):
            middle_m = wing * pitch_m + CORRIDOR_M / 2
            self._hole("passage", -WALL_THICKNESS_M / 2, middle_m, 1.2, 90.0)
        left_m = -2.0 - 1.5 * WALL_THICKNESS_M
        self._hole("door", left_m, CORRIDOR_M / 2, 1.0, 90.0, (hall.id,))
        return Plan(tuple(self.rooms), tuple(self.openings))

    def _wing(self, y_m: float, count: int) -> None:
        ends_m = [
            self._row(y_m + CORRIDOR_M + WALL_THICKNESS_M, 1.0, (count + 1) // 2),
            self._row(y_m - WALL_THICKNESS_M - DEPTH_M, -1.0, count // 2),
        ]
        self._room("corridor", 0.0, y_m, max(ends_m), y_m + CORRIDOR_M)

    def _row(self, y_m: float, side: float, count: int) -> float:
        """Rooms along a corridor, which lies below them where side is 1; where the row ends."""
        x_m, shift = 0.0, int(self._rng.integers(len(_SERIES)))
        for index in range(count):
            kind = _SERIES[(shift + index) % len(_SERIES)]
            width_m = round(float(self._rng.uniform(*_WIDTHS_M[kind])), 2)
            room = self._room(kind, x_m, y_m, x_m + width_m, y_m + DEPTH_M)
            middle_m = y_m + DEPTH_M / 2
            inner_m = middle_m - side * (DEPTH_M + WALL_THICKNESS_M) / 2
            outer_m = middle_m + side * (DEPTH_M + WALL_THICKNESS_M) / 2
            place_m = x_m + float(self._rng.choice([0.7, width_m - 0.7]))
            self._hole("door", place_m, inner_m, 0.9, 0.0)
            if kind != "store":
                size_m = min(1.8, width_m - 0.8)
                self._hole("window", x_m + width_m / 2, outer_m, size_m, 0.0, (room.id,))
            x_m += width_m + WALL_THICKNESS_M
        return x_m - WALL_THICKNESS_M

    def _room(self, kind: RoomKind, x0: float, y0: float, x1: float, y1: float) -> Room:
        corners = frozen_array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        room = Room(f"room{len(self.rooms) + 1}", kind, corners, kind.title())
        self.rooms.append(room)
        return room

    def _hole(
        self, kind: OpeningKind, x: float, y: float, width: float, yaw_deg: float,
        room_ids: tuple[str, ...] = (),
    ) -> None:  # fmt: skip
        base_m, height_m = _HEIGHTS_M[kind]
        box = Box((x, y, base_m), (width, WALL_THICKNESS_M, height_m), yaw_deg)
        name = f"{kind}{len(self.openings) + 1}"
        self.openings.append(Opening(name, kind, box, room_ids))


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rooms", type=int, nargs="+", default=ROOMS)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave the houses here")
    options = parser.parse_args()
    models = load_models(Settings())
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or Path(scratch)
        rows: list[tuple[str, str]] = []
        # A run that is cut off leaves what it has measured.
        for row in _rows(options.rooms, options.seed, folder, models):
            rows.append(row)
            text = write_section("large houses", rows, _NOTE.format(options.seed))
    sys.stdout.write(text)


def _rows(
    rooms: Sequence[int], seed: int, folder: Path, models: Models
) -> Iterator[tuple[str, str]]:
    for count in rooms:
        plan = Builder(seed).plan(count)
        plan_file = folder / f"{count}.json"
        write_plan(plan, plan_file)
        watch = _ProcessorTime()
        stage_path = folder / f"{count}" / "house.usda"
        house = generate(plan_file, stage_path, Settings(seed=seed), watch, models)
        with watch.step("check"):
            check_stage(stage_path)
        area_m2 = sum(room_polygon(room).area for room in plan.rooms)
        scores = {name: score.value for name, score in score_scenes(house.graphs).items()}
        total_s = sum(watch.seconds.values())
        steps = ", ".join(f"{name} {spent:.1f}" for name, spent in watch.seconds.items())
        peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        text = (
            f"{house.ground.plan_image.frame.height_px} px, {total_s:.1f} s ({steps}), "
            f"{1000 * total_s / area_m2:.0f} ms per m²; {peak_mib:.0f} MiB by then; "
            f"furnished {scores['furnished']:.2f}, POR {scores['por']:.4f}, "
            f"blocked openings {scores['blocked_openings']:.3f}"
        )
        sys.stderr.write(f"{count}: {text}\n")
        yield f"{count} rooms, {area_m2:.0f} m²", text


class _ProcessorTime(Stopwatch):
    """Seconds of processor time, which do not depend on what else the machine does."""

    @contextmanager
    def step(self, name: str) -> Iterator[Progress]:
        started = time.process_time()
        with super().step(name) as progress:
            yield progress
        self.seconds[name] = round(time.process_time() - started, 3)


if __name__ == "__main__":
    main()
