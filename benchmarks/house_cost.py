"""What the pictures of a house cost, in processor seconds; and whether a large house costs more.

    python benchmarks/house_cost.py STAGE LARGE_STAGE [--size WxH] [--samples N]

Drafts of all rooms of STAGE, as `chord-usd render --quality draft` takes them; then one camera of
either stage with equal samples, at the size of drafts.
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from time import perf_counter

from results import write_section

from chord_usd.line.image.options import QUALITIES, RenderOptions
from chord_usd.line.image.render import render_stage
from chord_usd.line.image.stage_cameras import read_views


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    options = _options()
    width, height = map(int, options.size.split("x"))
    draft = RenderOptions(resolution_px=(width, height), quality=QUALITIES["draft"], device="cpu")
    rows = [_drafts(options.stage, draft)]
    equal = replace(draft, samples=options.samples)
    rows += [_one_room(stage, equal) for stage in (options.stage, options.large)]
    note = (
        f"Processor seconds, user and system, of all threads; {options.size}. One picture: "
        f"{options.samples} samples, metered; its seconds hold Blender's start and the import."
    )
    sys.stdout.write(write_section("render: a house", rows, note))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stage", type=Path)
    parser.add_argument("large", type=Path)
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--samples", type=int, default=8)
    return parser.parse_args()


def _drafts(stage: Path, options: RenderOptions) -> tuple[str, str]:
    rooms = read_views(stage).rooms
    cpu_s, wall_s = _seconds(stage, replace(options, rooms=rooms))
    return (
        f"drafts of all {len(rooms)} rooms, {options.traced.samples} samples",
        f"{cpu_s:.0f} s ({wall_s:.0f} s by the clock)",
    )


def _one_room(stage: Path, options: RenderOptions) -> tuple[str, str]:
    views = read_views(stage)
    room = next(camera.room for camera in views.cameras if camera.room in views.rooms)
    cpu_s, _ = _seconds(stage, replace(options, rooms=(room,)))
    return f"one picture of a house of {len(views.rooms)} rooms", f"{cpu_s:.1f} s ({room})"


def _seconds(stage: Path, options: RenderOptions) -> tuple[float, float]:
    """Of the processor and by the clock, to take the pictures in a Blender of their own."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        render_stage(stage, Path(folder), options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu_s, perf_counter() - started


if __name__ == "__main__":
    main()
