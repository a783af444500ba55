"""dataset: procedural houses, readers, statistics, splits and pictures.

A data set is a folder of CHOrD JSON files, one house each.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_group,
    add_output,
    add_seed,
    add_verb,
    existing_file,
    stopwatch,
    whole_number,
)
from chord_usd.files import output_folder, write_atomic

if TYPE_CHECKING:
    from chord_usd.types import SceneGraph


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "dataset", "procedural houses, readers, statistics, splits, pictures")
    _add_synth(group)
    _add_import(group)
    stats = add_verb(group, "stats", run_stats, "count what the paper's data set tables count")
    stats.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    stats.add_argument("--plot", type=Path, metavar="PNG", help="also draw the tables")
    split = add_verb(
        group, "split", run_split, "divide houses into training and test, by their names"
    )
    split.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    add_output(split, "the split, a JSON file of names")
    draw = add_verb(group, "draw", run_draw, "draw layout rasters on one sheet, to look at")
    draw.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    add_output(draw, "the sheet, a PNG")
    draw.add_argument(
        "--most", type=whole_number(1), default=24, metavar="N", help="houses to draw (24)"
    )


def _add_synth(group: Verbs) -> None:
    synth = add_verb(group, "synth", run_synth, "draw and furnish procedural houses")
    add_output(synth, "folder for the houses, replaced as a whole")
    synth.add_argument("--count", type=whole_number(1), default=10, metavar="N", help="(10)")
    synth.add_argument(
        "--rooms", type=whole_number(1), metavar="N", help="rooms per house (as the paper's)"
    )
    synth.add_argument(
        "--rasters", action="store_true", help="also draw plan and layout rasters beside them"
    )
    add_seed(synth)


def _add_import(group: Verbs) -> None:
    reader = add_verb(group, "import", run_import, "read houses from elsewhere as CHOrD JSON")
    reader.add_argument(
        "source", type=Path, metavar="SOURCE", help="a CHOrD JSON folder, or flats (.jsonl, .gz)"
    )
    add_output(reader, "folder for the houses, replaced as a whole")
    reader.add_argument(
        "--furnish", action="store_true", help="furnish plans that hold no furniture"
    )
    add_seed(reader)


def run_synth(options: argparse.Namespace) -> Outcome:
    """Runs dataset synth. House i depends on seed + i only."""
    import numpy as np

    from chord_usd.data.floorplans.programme import spread_room_count
    from chord_usd.data.furnish import furnish
    from chord_usd.data.houses import random_plan

    watch = stopwatch(options)
    with output_folder(options.output) as folder, watch.step("synth") as progress:
        for index in range(options.count):
            seed = options.seed + index
            rooms = options.rooms or spread_room_count(seed)
            rng = np.random.default_rng(seed)
            scene = furnish(random_plan(rng, rooms), rng)
            _write_house(scene, folder / f"house_{seed:06d}", options.rasters)
            progress(index + 1, options.count)
    data = {"folder": str(options.output), "houses": options.count, "seconds": watch.seconds}
    return Outcome(f"{options.output}: {options.count} houses", data)


def run_import(options: argparse.Namespace) -> Outcome:
    """Runs dataset import."""
    import numpy as np

    from chord_usd.data.furnish import furnish

    count = 0
    watch = stopwatch(options)
    with output_folder(options.output) as folder, watch.step("import"):
        for name, scene in _foreign_houses(options.source):
            if options.furnish and not scene.items:
                scene = furnish(scene.plan, np.random.default_rng((options.seed, count)))
            _write_house(scene, folder / name, rasters=False)
            count += 1
        if not count:
            raise UsageError("holds no house", where=str(options.source))
    data = {"folder": str(options.output), "houses": count, "seconds": watch.seconds}
    return Outcome(f"{options.output}: {count} houses", data)


def run_stats(options: argparse.Namespace) -> Outcome:
    """Runs dataset stats."""
    from chord_usd.data.statistics import as_text, count_houses

    with stopwatch(options).step("stats"):
        statistics = count_houses(scene for _, scene in _houses(options.houses))
    if options.plot:
        from chord_usd.data.statistics_plots import plot_statistics

        plot_statistics(statistics, options.plot)
    return Outcome(as_text(statistics), statistics.as_json())


def run_split(options: argparse.Namespace) -> Outcome:
    """Runs dataset split. A house keeps its part whatever other houses come and go."""
    from chord_usd.data.splits import part_of, split_hash

    names = [path.stem for path in _house_files(options.houses)]
    parts: dict[str, list[str]] = {"train": [], "test": []}
    for name in names:
        parts[part_of(name)].append(name)
    data = {"hash": split_hash(names), **parts}
    write_atomic(options.output, json.dumps(data, indent=1) + "\n")
    told = ", ".join(f"{len(part)} {name}" for name, part in parts.items())
    counts = {name: len(part) for name, part in parts.items()}
    return Outcome(
        f"{options.output}: {told}, hash {data['hash']}",
        {"split": str(options.output), "hash": data["hash"], **counts},
    )


def run_draw(options: argparse.Namespace) -> Outcome:
    """Runs dataset draw."""
    from itertools import islice

    from chord_usd.data.pictures import draw_sheet

    scenes = [scene for _, scene in islice(_houses(options.houses), options.most)]
    draw_sheet(scenes, options.output)
    return Outcome(
        f"{options.output}: {len(scenes)} houses",
        {"sheet": str(options.output), "houses": len(scenes)},
    )


def _write_house(scene: SceneGraph, stem: Path, rasters: bool) -> None:
    from chord_usd.chord_json import write_scene
    from chord_usd.raster import draw_plan, layout_image
    from chord_usd.raster_files import write_raster

    write_scene(scene, stem.with_suffix(".json"))
    if rasters:
        plan_image = draw_plan(scene.plan)
        write_raster(plan_image, stem.with_suffix(".plan.png"))
        write_raster(layout_image(plan_image, scene.items), stem.with_suffix(".layout.png"))


def _foreign_houses(source: Path) -> Iterator[tuple[str, SceneGraph]]:
    """(name, house) of a folder of CHOrD JSON, one CHOrD JSON file, or a file of flats."""
    from chord_usd.chord_json import read_scene
    from chord_usd.data.flats import read_flats
    from chord_usd.types import SceneGraph

    if source.is_dir():
        yield from _houses(source)
    elif source.suffix == ".json":
        yield source.stem, read_scene(existing_file(source))
    else:
        for index, plan in enumerate(read_flats(existing_file(source))):
            name = str(plan.extra.get("source", f"flat_{index:06d}")).replace("/", "_")
            yield name, SceneGraph(plan.rooms, plan.openings, (), extra=plan.extra)


def _houses(folder: Path) -> Iterator[tuple[str, SceneGraph]]:
    from chord_usd.chord_json import read_scene

    for path in _house_files(folder):
        yield path.stem, read_scene(path)


def _house_files(folder: Path) -> list[Path]:
    """CHOrD JSON files in a folder, by name. Raises UsageError."""
    if not folder.is_dir():
        raise UsageError("no such folder", where=str(folder), try_="chord-usd dataset synth")
    files = sorted(folder.glob("*.json"))
    if not files:
        raise UsageError("holds no house", where=str(folder), expected="CHOrD JSON files")
    return files
