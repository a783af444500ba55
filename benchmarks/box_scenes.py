"""What arranging does to rooms that somebody else's program placed box by box.

    python benchmarks/box_scenes.py ROOMS.jsonl.gz [--kind living] [--rooms 300] [--paint] [--write]

Rooms of 3D-FRONT (chord_usd.workshop.data.threed_front.read_rooms) as they are, and with every box
moved and turned by noise, as a graph pipeline's samples would be: each row before and after
`dataset import --arrange` does its work. --paint: after the layout model has painted over them
instead, as it paints over lists, read back and nothing arranged. 3D-FRONT's terms forbid commercial
use: it is measured here, and nothing of it is kept.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
from results import write_section

from chord_usd.base.metrics.overlap import scene_overlap
from chord_usd.base.metrics.rooms import out_of_room
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.line.layout.upright import sample_upright
from chord_usd.line.pipeline import Settings, arrange_given, draw_plan, load_model
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.data.threed_front import read_rooms
from chord_usd.workshop.evaluation.cases import Case
from chord_usd.workshop.evaluation.layouts import read_back

NOISES = ((0.0, 0.0), (0.1, 5.0), (0.3, 15.0))
"""Standard deviations of each box: metres along x and y, degrees."""


def main() -> None:
    """Measures; with --write also into benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("source", type=Path, help="rooms of 3D-FRONT, JSON lines")
    parser.add_argument("--kind", default="bedroom", help="bedroom or living (bedroom)")
    parser.add_argument("--rooms", type=int, default=300, help="(300)")
    parser.add_argument("--paint", action="store_true", help="by the layout model, not arranged")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    rooms = list(islice(_rooms(options.source, options.kind), options.rooms))
    rows = [("split", split_hash(str(room.extra["source"]) for room in rooms))]
    for move_m, turn_deg in NOISES:
        rng = np.random.default_rng(0)
        given = [_shaken(room, move_m, turn_deg, rng) for room in rooms]
        after = _painted(given) if options.paint else [arrange_given(room) for room in given]
        noise = (
            f"moved by {move_m * 100:g} cm, turned by {turn_deg:g}°" if move_m else "as they are"
        )
        rows.append((noise, _told(given)))
        if options.paint:
            rows.append(("the same, painted over", _told(after)))
        else:
            rows.append(("the same, arranged", f"{_told(after)}; {_changes(given, after)}"))
        sys.stderr.write("\n".join(" | ".join(row) for row in rows[-2:]) + "\n")
    note = (
        f"`python benchmarks/box_scenes.py ROOMS --kind {options.kind} --rooms {options.rooms}"
        f"{' --paint' * options.paint}`: "
        f"the file's first {len(rooms)} with two pieces or more; overlaps that are "
        "natural, such as a chair under its table, are none."
    )
    if options.write:
        how = "painted over" if options.paint else "arranged"
        sys.stdout.write(write_section(f"box scenes, {how}: {options.kind} rooms", rows, note))


def _rooms(source: Path, kind: str) -> Iterator[SceneGraph]:
    return (
        room for room in read_rooms(source) if room.rooms[0].kind == kind and len(room.items) > 1
    )


def _shaken(
    room: SceneGraph, move_m: float, turn_deg: float, rng: np.random.Generator
) -> SceneGraph:
    def shaken(item: Item) -> Item:
        x, y = np.array(item.box.center_m[:2]) + rng.normal(0.0, move_m, 2)
        yaw_deg = item.box.yaw_deg + float(rng.normal(0.0, turn_deg))
        center = (float(x), float(y), item.box.center_m[2])
        return replace(item, box=replace(item.box, center_m=center, yaw_deg=yaw_deg))

    return replace(room, items=tuple(map(shaken, room.items)))


def _painted(rooms: Sequence[SceneGraph]) -> list[SceneGraph]:
    """The rooms as the layout model paints them with their boxes for a draft, read back."""
    model = load_model(Settings())
    found = []
    for seed, room in enumerate(rooms):
        plan_image = draw_plan(room.plan)
        layout = sample_upright(model, room.plan, plan_image, listed=room, seed=seed)
        found.append(read_back(Case(str(seed), room.plan), layout).scene)
    return found


def _told(rooms: Sequence[SceneGraph]) -> str:
    overlaps = [scene_overlap(room) for room in rooms]
    free = np.mean([not any(not p.natural for p in one.overlapping) for one in overlaps])
    pieces = sum(len(room.items) for room in rooms)
    out = sum(len(out_of_room(room)) for room in rooms) / pieces
    # Rooms of which one piece is left have no pair: nothing in them overlaps.
    return (
        f"POR {np.mean([one.por for one in overlaps]):.4f}, PIoU "
        f"{np.mean([one.piou for one in overlaps]):.5f}, rooms without collision {free:.3f}, "
        f"out of room {out:.4f} of {pieces} pieces"
    )


def _changes(before: Sequence[SceneGraph], after: Sequence[SceneGraph]) -> str:
    total = sum(len(room.items) for room in before)
    kept = [item for room in after for item in room.items]
    moved = [item.moved_m for item in kept if item.facts.edits]
    return (
        f"moved {len(moved) / total:.3f} of the pieces, by {np.median(moved) * 100:.0f} cm in the "
        f"median; left out {1 - len(kept) / total:.4f}"
    )


if __name__ == "__main__":
    main()
