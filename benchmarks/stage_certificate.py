"""What `check` says of many houses: furniture of procedural houses, or what the models draw.

    python benchmarks/stage_certificate.py --folder DIR [--houses N] [--first SEED] [--drawn]

Each house is drawn as a layout raster, read back by the detector, given meshes and tabletop items,
written as a stage and checked. By default the raster shows the furniture of the procedural house,
so what is found is the doing of the steps behind it; with --drawn the whole line runs on the plan.
Houses already in the folder are not made again: run it in pieces.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from results import write_section

from chord_usd.arrange.arrangement import Arrangement
from chord_usd.arrange.rules import arrange
from chord_usd.data.floorplans.programme import spread_room_count
from chord_usd.data.furnish import furnish
from chord_usd.data.houses import random_plan
from chord_usd.pipeline import (
    Models,
    Settings,
    generate,
    lay_tables,
    load_models,
    write_stage,
)
from chord_usd.raster import canvas
from chord_usd.scene.chord_json import write_plan
from chord_usd.scene.types import Item, Plan, SceneGraph
from chord_usd.stage.check import certificate, check_stage

FAULTS = (
    "errors",
    "collisions",
    "out_of_room",
    "blocked_openings",
    "unsupported",
    "empty_rooms",
)


def main() -> None:
    """Makes what is missing, then writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, required=True, help="where the houses are kept")
    parser.add_argument("--houses", type=int, default=200)
    parser.add_argument("--first", type=int, default=1000, metavar="SEED")
    parser.add_argument("--drawn", action="store_true", help="layouts by the layout model")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    seeds = range(options.first, options.first + options.houses)
    missing = [seed for seed in seeds if not _told(options.folder, seed).is_file()]
    models = load_models(Settings()) if missing else None
    for seed in missing:
        assert models is not None
        told = furnish_and_check(seed, models, options.folder, is_drawn=options.drawn)
        _told(options.folder, seed).write_text(json.dumps(told) + "\n")
        found = {key: len(told[key]) for key in FAULTS if told[key]}
        sys.stdout.write(f"{seed}: {found or 'holds'}\n")
        sys.stdout.flush()
    reports = [json.loads(_told(options.folder, seed).read_text()) for seed in seeds]
    source = "by the layout model" if options.drawn else "with procedural furniture"
    note = (
        f"Plans of seeds {seeds.start} to {seeds.stop - 1}: "
        f"`python benchmarks/stage_certificate.py --folder DIR --houses {options.houses} "
        f"--first {options.first}{' --drawn' * options.drawn}`."
    )
    sys.stdout.write(write_section(f"stages: certificate, {source}", rows_of(reports), note))


def _told(folder: Path, seed: int) -> Path:
    return folder / f"house_{seed:06d}.json"


def furnish_and_check(seed: int, models: Models, folder: Path, *, is_drawn: bool) -> dict[str, Any]:
    """Makes the house of a seed in folder; its certificate, and what is in it."""
    settings = Settings(seed=seed)
    rng = np.random.default_rng(seed)
    plan = random_plan(rng, spread_room_count(seed))
    stage = folder / f"house_{seed:06d}.usda"
    if is_drawn:
        plan_file = folder / f"plan_{seed:06d}.json"
        write_plan(plan, plan_file)
        graph = generate(plan_file, stage, settings, models=models).graph
    else:
        graph = _read_back(plan, furnish(plan, rng).items, models, settings)
        write_stage(graph, stage, settings)
    report = check_stage(stage)
    return {**certificate(report), "holds": report.holds, **_counts(graph)}


def _read_back(
    plan: Plan, items: tuple[Item, ...], models: Models, settings: Settings
) -> SceneGraph:
    """The house as it is read from its own raster, with things on its tables."""
    layout = canvas.layout_image(canvas.draw_plan(plan), items)
    graph = models.reader.read(layout, plan)
    assert models.table is not None
    graph = lay_tables(graph, models.table, models.reader.database, settings).graph
    return arrange(Arrangement.of(graph), "meshed")


def _counts(graph: SceneGraph) -> dict[str, Any]:
    items = [*graph.items, *(child for item in graph.items for child in item.children)]
    return {"rooms": len(graph.rooms), "openings": len(graph.openings), "items": len(items)}


def rows_of(reports: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Rows of the table: how many of each fault, and in how many houses."""
    total: Counter[str] = Counter()
    for report in reports:
        total.update({key: report[key] for key in ("rooms", "openings", "items", "pairs")})
    rows = [
        ("houses", f"{len(reports)}, {total['rooms']} rooms, {total['items']} items"),
        ("certificate holds", f"{sum(report['holds'] for report in reports)} houses"),
    ]
    for key in FAULTS:
        count = sum(len(report[key]) for report in reports)
        houses = sum(bool(report[key]) for report in reports)
        rows.append((key.replace("_", " "), f"{count}, in {houses} houses"))
    for key in ("walkable", "reachable_rooms"):
        mean = sum(report[key] for report in reports) / max(len(reports), 1)
        rows.append((key.replace("_", " "), f"{mean:.3f}"))
    return rows


if __name__ == "__main__":
    main()
