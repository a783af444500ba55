"""Procedural houses of two storeys: the certificate, the rooms reached, and what a storey costs.

    python benchmarks/storeys_certificate.py [--houses N] [--first SEED] [--form FORM]
        [--records FILE]

Each house is furnished and checked. Every tenth is made by `chord-usd generate`, too, once whole
and once its ground floor alone; seconds are those of the processor, loading included. With
--records a measurement goes on where it stopped.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np

from chord_usd.base.runtime.json_text import json_text
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.json_stairs import storeys_to_json
from chord_usd.base.scene.storeys import StairForm
from chord_usd.line import pipeline
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.workshop.data.storey_houses import random_storeys

_APART = 50_000
"""Seeds of houses begin here: those of tests are smaller."""

_TIMED_EVERY = 10


def _house(
    seed: int, models: pipeline.Models, folder: Path, forms: Sequence[StairForm]
) -> dict[str, Any]:
    storeys = random_storeys(np.random.default_rng(_APART + seed), 2, forms)
    whole, ground = folder / "whole.json", folder / "ground.json"
    whole.write_text(json_text(storeys_to_json(storeys)))
    write_plan(storeys[0].plan, ground)
    settings = pipeline.Settings(seed=seed)
    made = pipeline.generate(whole, folder / "house.usda", settings, models=models)
    report = check_stage(folder / "house.usda", own=True)
    is_timed = seed % _TIMED_EVERY == 0
    return {
        "seed": seed, "form": made.building.climbs[0].built.stair.form, "holds": report.holds,
        "reached": report.reachable_rooms, "stairs": list(report.stairs),
        "complete": report.complete,
        "both_s": _generate_s(whole, seed, folder) if is_timed else None,
        "alone_s": _generate_s(ground, seed, folder) if is_timed else None,
    }  # fmt: skip


def _generate_s(plan: Path, seed: int, folder: Path) -> float:
    """Processor seconds of a run of its own."""
    command = [sys.executable, "-m", "chord_usd", "generate", str(plan), "--seed", str(seed)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = ["-o", str(folder / plan.stem / "house.usda"), "--no-check"]
    subprocess.run([*command, *output], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--houses", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--form", choices=get_args(StairForm), help="of the stairs; all of them")
    parser.add_argument("--records", type=Path, metavar="FILE")
    options = parser.parse_args()
    forms: tuple[StairForm, ...] = (options.form,) if options.form else get_args(StairForm)
    kept = options.records and options.records.is_file()
    rows = [json.loads(line) for line in options.records.read_text().splitlines()] if kept else []
    known = {row["seed"] for row in rows}
    models = pipeline.load_models(pipeline.Settings())
    for seed in range(options.first, options.first + options.houses):
        if seed in known:
            continue
        with tempfile.TemporaryDirectory() as folder:
            rows.append(_house(seed, models, Path(folder), forms))
        if options.records:
            with options.records.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
    pairs = [(row["both_s"], row["alone_s"]) for row in rows if row["alone_s"]]
    told = (
        f"{len(rows)} houses: certificate {sum(row['holds'] for row in rows)}, all rooms reached "
        f"{sum(row['reached'] == 1.0 for row in rows)}, rooms complete "
        f"{np.mean([row['complete'] for row in rows]):.3f}\n"
    )
    if pairs:
        both, alone = np.array(pairs).T
        told += f"two storeys cost {both.sum() / alone.sum():.2f} times one (n = {len(pairs)})\n"
    sys.stdout.write(told)


if __name__ == "__main__":
    main()
