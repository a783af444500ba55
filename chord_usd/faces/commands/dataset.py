"""dataset: procedural houses, readers, cleaning, statistics, splits, pictures and releases.

A data set is a folder of CHOrD JSON files, one house each.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import output_folder, write_atomic
from chord_usd.faces.commands import dataset_keep, dataset_release, dataset_twins
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_group,
    add_output,
    add_output_folder,
    add_verb,
    existing_file,
    folder_mode,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.dataset_furnish import add_furnisher, furnisher_of
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.base.scene.types import SceneGraph
    from chord_usd.workshop.data.distributions import Samples
    from chord_usd.workshop.data.foreign import Found

MOST_TOLD = 5
"""Reasons printed for houses that cannot be read; --json lists all."""


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(
        verbs, "dataset", "procedural houses, readers, statistics, splits, pictures, releases"
    )
    _add_synth(group)
    _add_import(group)
    cleaner = add_verb(
        group, "clean", run_clean, "take out what is empty, out of its room, colliding or blocking"
    )
    cleaner.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    add_output_folder(cleaner, "folder for the clean houses")
    stats = add_verb(group, "stats", run_stats, "count what the paper's data set tables count")
    stats.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    stats.add_argument("--plot", type=output_file, metavar="PNG", help="also draw the tables")
    stats.add_argument(
        "--against",
        type=Path,
        metavar="SOURCE",
        help="also compare sizes and distances with these houses or rooms, e.g. of 3D-FRONT",
    )
    split = add_verb(
        group, "split", run_split, "divide houses into training and test, by their names"
    )
    split.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    add_output(split, "the split, a JSON file of names", suffixes=(".json",))
    draw = add_verb(group, "draw", run_draw, "draw layout rasters on one sheet, to look at")
    draw.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    add_output(draw, "the sheet, a PNG", suffixes=(".png",))
    draw.add_argument(
        "--most", type=whole_number(1, 10_000), default=24, metavar="N", help="houses to draw (24)"
    )
    dataset_keep.add(group)
    dataset_release.add(group)
    dataset_twins.add(group)


def _add_synth(group: Verbs) -> None:
    synth = add_verb(group, "synth", run_synth, "draw and furnish procedural houses")
    add_output_folder(synth, "folder for the houses")
    synth.add_argument(
        "--count", type=whole_number(1, 1_000_000), default=10, metavar="N", help="(10)"
    )
    synth.add_argument(
        "--rooms", type=whole_number(1, 100), metavar="N", help="rooms per house (as the paper's)"
    )
    synth.add_argument(
        "--rasters", action="store_true", help="also draw plan and layout rasters beside them"
    )
    add_furnisher(synth)
    add_options(synth, "seed")


def _add_import(group: Verbs) -> None:
    reader = add_verb(group, "import", run_import, "read houses from elsewhere as CHOrD JSON")
    reader.add_argument(
        "source",
        type=Path,
        metavar="SOURCE",
        help="CHOrD JSON, 3D-FRONT, ATISS, ProcTHOR, RoboCasa, ThreeDWorld or flats: a folder, a "
        ".json, a .yaml, a .npz, a .jsonl, a .jsonl.gz",
    )
    reader.add_argument(
        "--models",
        type=Path,
        metavar="JSON",
        help="3D-FUTURE's model_info.json, ProcTHOR's asset-database.json, ATISS's "
        "dataset_stats.txt or ThreeDWorld's models_core.json",
    )
    add_output_folder(reader, "folder for the houses")
    reader.add_argument(
        "--furnish", action="store_true", help="furnish plans that hold no furniture"
    )
    reader.add_argument(
        "--arrange", action="store_true",
        help="move pieces out of each other, of walls and off openings, or else leave them out",
    )  # fmt: skip
    add_furnisher(reader)
    add_options(reader, "seed")


def run_synth(options: argparse.Namespace) -> Outcome:
    """Runs dataset synth. House i depends on seed + i only."""
    import numpy as np

    from chord_usd.workshop.data.floorplans.programme import spread_room_count
    from chord_usd.workshop.data.houses import random_plan

    watch, lacks, furnish = stopwatch(options), _Lacking(), furnisher_of(options)
    with (
        output_folder(options.output, folder_mode(options)) as folder,
        watch.step("synth") as progress,
    ):
        for index in range(options.count):
            seed = options.seed + index
            rooms = options.rooms or spread_room_count(seed)
            rng = np.random.default_rng(seed)
            plan = random_plan(rng, rooms)
            scene = furnish(plan, rng)
            lacks.note(f"house_{seed:06d}", scene)
            _write_house(scene, folder / f"house_{seed:06d}", options.rasters)
            progress(index + 1, options.count)
    data = {
        "folder": str(options.output), "houses": options.count, "lacking": lacks.rooms,
        "seconds": watch.seconds,
    }  # fmt: skip
    return Outcome(
        f"{options.output}: {counted(options.count, 'house')}", data, warnings=lacks.warnings()
    )


def run_import(options: argparse.Namespace) -> Outcome:
    """Runs dataset import. What cannot be read is passed over, counted and listed."""
    import numpy as np

    from chord_usd.line.pipeline import arrange_given
    from chord_usd.workshop.data.foreign import Models, foreign_houses, read_models_file

    models = read_models_file(existing_file(options.models)) if options.models else Models()
    if not options.source.is_dir():
        existing_file(options.source)
    reading, lacks, furnish = _Reading(), _Lacking(), furnisher_of(options)
    watch = stopwatch(options)
    arranged = {"pieces": 0, "moved": 0, "left_out": 0}
    with output_folder(options.output, folder_mode(options)) as folder, watch.step("import"):
        for name, scene in reading.of(foreign_houses(options.source, models)):
            if options.furnish and not scene.items:
                rng = np.random.default_rng((options.seed, reading.count))
                try:
                    scene = furnish(scene.plan, rng)
                except ChordError as error:
                    reading.pass_over(name, error.what)
                    continue
                lacks.note(name, scene)
            if options.arrange:
                arranged["pieces"] += len(scene.items)
                scene, given = arrange_given(scene), len(scene.items)
                arranged["moved"] += sum(bool(item.facts.edits) for item in scene.items)
                arranged["left_out"] += given - len(scene.items)
            _write_house(scene, folder / name, rasters=False)
        reading.refuse_none(options.source)
    data = {
        "folder": str(options.output), "houses": reading.count, "lacking": lacks.rooms,
        "seconds": watch.seconds,
    }  # fmt: skip
    text = f"{options.output}: {counted(reading.count, 'house')}"
    if options.arrange:
        data["arranged"] = arranged
        text += (
            f"; of {counted(arranged['pieces'], 'piece')} {arranged['moved']} moved, "
            f"{arranged['left_out']} left out"
        )
    outcome = reading.outcome(text, data)
    return replace(outcome, warnings=[*outcome.warnings, *lacks.warnings()])


def run_stats(options: argparse.Namespace) -> Outcome:
    """Runs dataset stats."""
    from chord_usd.workshop.data import distributions
    from chord_usd.workshop.data.statistics import as_text, count_houses

    reading = _Reading()
    with stopwatch(options).step("stats"):
        scenes = [scene for _, scene in reading.of(_houses(options.houses))]
        reading.refuse_none(options.houses)
        statistics = count_houses(scenes)
    if options.plot:
        from chord_usd.workshop.data.statistics_plots import plot_statistics

        plot_statistics(statistics, options.plot)
    text, data = as_text(statistics), statistics.as_json()
    if options.against:
        rows = distributions.compare(
            distributions.measure(scenes), _measured(options.against, reading)
        )
        text += "\n\n" + distributions.as_text(rows)
        data["against"] = [row._asdict() for row in rows]
    return reading.outcome(text, data)


def run_clean(options: argparse.Namespace) -> Outcome:
    """Runs dataset clean."""
    from collections import Counter

    from chord_usd.workshop.data.cleaning import clean

    reading = _Reading()
    removed: Counter[str] = Counter()
    dropped: dict[str, str] = {}
    watch = stopwatch(options)
    with output_folder(options.output, folder_mode(options)) as folder, watch.step("clean"):
        for name, scene in reading.of(_houses(options.houses)):
            cleaned = clean(scene)
            removed.update(cleaned.counts())
            if cleaned.is_kept:
                _write_house(cleaned.house, folder / name, rasters=False)
            else:
                dropped[name] = f"{len(cleaned.empty)} rooms are empty"
        reading.refuse_none(options.houses)
    kept = reading.count - len(dropped)
    faults = ", ".join(f"{count} {fault}" for fault, count in sorted(removed.items())) or "none"
    data = {"folder": str(options.output), "houses": kept, "dropped": dropped, "removed": removed}
    text = (
        f"{options.output}: {kept} of {counted(reading.count, 'house')}; items taken out: {faults}"
    )
    return reading.outcome(text, data)


def run_split(options: argparse.Namespace) -> Outcome:
    """Runs dataset split. A house keeps its part whatever other houses come and go."""
    from chord_usd.workshop.data.splits import part_of, split_hash

    names = [path.stem for path in _house_files(options.houses)]
    parts: dict[str, list[str]] = {"train": [], "test": []}
    for name in names:
        parts[part_of(name)].append(name)
    data = {"hash": split_hash(names), **parts}
    write_atomic(options.output, json.dumps(data, indent=1) + "\n")
    sizes = ", ".join(f"{len(part)} {name}" for name, part in parts.items())
    counts = {name: len(part) for name, part in parts.items()}
    return Outcome(
        f"{options.output}: {sizes}, hash {data['hash']}",
        {"split": str(options.output), "hash": data["hash"], **counts},
    )


def run_draw(options: argparse.Namespace) -> Outcome:
    """Runs dataset draw."""
    from itertools import islice

    from chord_usd.workshop.data.pictures import draw_sheet

    reading = _Reading()
    scenes = [s for _, s in islice(reading.of(_houses(options.houses)), options.most)]
    reading.refuse_none(options.houses)
    draw_sheet(scenes, options.output)
    return reading.outcome(
        f"{options.output}: {counted(len(scenes), 'house')}",
        {"sheet": str(options.output), "houses": len(scenes)},
    )


def _write_house(scene: SceneGraph, stem: Path, rasters: bool) -> None:
    from chord_usd.base.raster.canvas import draw_plan, layout_image
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import write_scene

    def file(suffix: str) -> Path:
        return stem.with_name(f"{stem.name}{suffix}")

    write_scene(scene, file(".json"))
    if rasters:
        plan_image = draw_plan(scene.plan)
        write_raster(plan_image, file(".plan.png"))
        write_raster(layout_image(plan_image, scene.items), file(".layout.png"))


@dataclass
class _Lacking:
    """Rooms that the furnisher found too small, or too full of doors, for what they need."""

    rooms: list[dict[str, Any]] = field(default_factory=list)

    def note(self, house: str, scene: SceneGraph) -> None:
        from chord_usd.base.metrics.complete import homely_rooms

        for room in homely_rooms(scene):
            if room.missing:
                name = scene.plan.room(room.room).name or room.room
                row = {"house": house, "room": name, "missing": list(room.missing)}
                self.rooms.append(row)

    def warnings(self) -> list[str]:
        """The first of them in words, and how many there are."""
        lines = [
            f"{row['house']}: {row['room']} has no room for {' and '.join(row['missing'])}"
            for row in self.rooms[:MOST_TOLD]
        ]
        more = len(self.rooms) - len(lines)
        return [*lines, f"{more} more rooms are too small for their kind"] if more else lines


@dataclass
class _Reading:
    """Counts the houses that pass through it, and keeps why others could not be read."""

    count: int = 0
    skipped: dict[str, str] = field(default_factory=dict)

    def of(self, houses: Iterable[Found]) -> Iterator[tuple[str, SceneGraph]]:
        for name, house, why in houses:
            if house is None:
                self.skipped[name] = why
                continue
            self.count += 1
            yield name, house

    def pass_over(self, name: str, why: str) -> None:
        """A house that was read, and that nothing can be made of."""
        self.count -= 1
        self.skipped[name] = why

    def refuse_none(self, source: Path) -> None:
        """Raises UsageError where nothing could be read."""
        if not self.count:
            why = next(iter(self.skipped.values()), "")
            raise UsageError("holds no house", where=str(source), expected=why)

    def outcome(self, text: str, data: dict[str, Any]) -> Outcome:
        """With a warning for each of the first that could not be read, and how many there are."""
        warnings = [f"{name}: {why}" for name, why in self.skipped.items()][:MOST_TOLD]
        if self.skipped:
            warnings.append(f"{len(self.skipped)} of {self.count + len(self.skipped)} passed over")
        return Outcome(text, {**data, "skipped": self.skipped}, warnings=warnings)


def _measured(source: Path, reading: _Reading) -> Samples:
    """Measures of others' houses; the report names the houses that cannot be read."""
    from chord_usd.workshop.data.distributions import measure
    from chord_usd.workshop.data.foreign import Models, foreign_houses

    if not source.is_dir():
        existing_file(source)
    others = _Reading(skipped=reading.skipped)
    samples = measure(scene for _, scene in others.of(foreign_houses(source, Models())))
    others.refuse_none(source)
    return samples


def _houses(folder: Path) -> Iterator[Found]:
    from chord_usd.workshop.data.foreign import Models, foreign_houses

    _house_files(folder)
    return foreign_houses(folder, Models())


def _house_files(folder: Path) -> list[Path]:
    """CHOrD JSON files in a folder, by name. Raises UsageError."""
    if not folder.is_dir():
        raise UsageError("no such folder", where=str(folder), try_="chord-usd dataset synth")
    files = sorted(folder.glob("*.json"))
    if not files:
        raise UsageError("holds no house", where=str(folder), expected="CHOrD JSON files")
    return files
