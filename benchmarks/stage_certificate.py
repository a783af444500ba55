"""What `check` says of many houses: furniture of procedural houses, or what the models draw.

    python benchmarks/stage_certificate.py --folder DIR [--houses N] [--first SEED]
    python benchmarks/stage_certificate.py --release DIR ...

Each house is drawn as a layout raster with the furniture of a procedural house, read back by the
detector, given meshes and tabletop items, written as a stage and checked, so what is found is the
doing of the steps behind the layout. Houses already in the folder are not made again: run it in
pieces. --release: of the whole line, what the houses of `chord-usd dataset release` were told.
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

from chord_usd.base.raster import canvas
from chord_usd.base.scene.types import Item, Plan, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.rules import arrange
from chord_usd.line.pipeline import Models, Settings, lay_tables, load_models, write_stage
from chord_usd.line.stage.check.check_stage import certificate, check_stage
from chord_usd.workshop.data.floorplans.programme import spread_room_count
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan

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
    kept = parser.add_mutually_exclusive_group(required=True)
    kept.add_argument("--folder", type=Path, help="where the houses are kept")
    kept.add_argument("--release", type=Path, nargs="+", help="data sets of dressed houses")
    parser.add_argument("--houses", type=int, default=200)
    parser.add_argument("--first", type=int, default=1000, metavar="SEED")
    options = parser.parse_args()
    if options.release:
        files = [file for one in options.release for file in sorted(one.glob("house_*/house.json"))]
        reports = [json.loads(file.read_text())["told"] for file in files]
        seeds = sorted(report["seed"] for report in reports)
        note = f"Houses of `chord-usd dataset release`, dressed; seeds {seeds[0]} to {seeds[-1]}."
        sys.stdout.write(write_section("stages: certificate, of a release", rows_of(reports), note))
        return
    options.folder.mkdir(parents=True, exist_ok=True)
    seeds = range(options.first, options.first + options.houses)
    missing = [seed for seed in seeds if not _told(options.folder, seed).is_file()]
    models = load_models(Settings()) if missing else None
    for seed in missing:
        assert models is not None
        told = furnish_and_check(seed, models, options.folder)
        _told(options.folder, seed).write_text(json.dumps(told) + "\n")
        found = {key: told[key] for key in FAULTS if told[key]}
        sys.stdout.write(f"{seed}: {found or 'holds'}\n")
        sys.stdout.flush()
    reports = [json.loads(_told(options.folder, seed).read_text()) for seed in seeds]
    note = (
        f"Plans of seeds {seeds.start} to {seeds.stop - 1}: "
        f"`python benchmarks/stage_certificate.py --folder DIR --houses {options.houses} "
        f"--first {options.first}`."
    )
    title = "stages: certificate, with procedural furniture"
    sys.stdout.write(write_section(title, rows_of(reports), note))


def _told(folder: Path, seed: int) -> Path:
    return folder / f"house_{seed:06d}.json"


def furnish_and_check(seed: int, models: Models, folder: Path) -> dict[str, Any]:
    """Makes the house of a seed in folder; its certificate, and what is in it."""
    settings = Settings(seed=seed)
    rng = np.random.default_rng(seed)
    plan = random_plan(rng, spread_room_count(seed))
    stage = folder / f"house_{seed:06d}.usda"
    graph = _read_back(plan, furnish(plan, rng).items, models, settings)
    write_stage(graph, stage, settings)
    report = check_stage(stage)
    told = certificate(report)
    faults = {key: len(told[key]) for key in FAULTS}
    return {**told, **faults, "holds": report.holds, **_counts(graph)}


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
        total.update({key: report.get(key, 0) for key in ("rooms", "items", "dressing")})
    rows = [
        (
            "houses",
            f"{len(reports)}, {total['rooms']} rooms, {total['items']} items, "
            f"{total['dressing']} of dressing",
        ),
        ("certificate holds", f"{sum(report['holds'] for report in reports)} houses"),
    ]
    for key in FAULTS:
        count = sum(report[key] for report in reports)
        houses = sum(bool(report[key]) for report in reports)
        rows.append((key.replace("_", " "), f"{count}, in {houses} houses"))
    for key in ("walkable", "reachable_rooms"):
        mean = sum(report[key] for report in reports) / max(len(reports), 1)
        rows.append((key.replace("_", " "), f"{mean:.3f}"))
    return rows


if __name__ == "__main__":
    main()
