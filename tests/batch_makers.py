"""What the tests of a batch let its workers do, in place of furnishing. Imported by the workers."""

from __future__ import annotations

import errno
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.files import output_folder
from chord_usd.faces.batch.engine import Load, Result, attempt
from chord_usd.faces.batch.make import STAGE_FILE, Make
from chord_usd.faces.batch.records import HOUSE_RECORD, Record, files_in, hashes_of, write_record
from chord_usd.faces.batch.run import Done, run_batch
from chord_usd.faces.batch.shared import share_files
from chord_usd.faces.batch.work_units import Order, Unit
from chord_usd.line.pipeline import Settings

FIGURES = {
    "rooms": 1, "furniture": 2, "items": 2, "openings": 1, "m_per_px": 0.04, "holds": True,
    "errors": 0, "collisions": 0, "out_of_room": 0, "blocked_openings": 0, "unsupported": 0,
    "empty_rooms": 0, "walkable": 1.0, "reachable_rooms": 1.0, "por": 0.0, "piou": 0.0,
    "complete": 1.0, "right": 1.0,
}  # fmt: skip


LONG_SECONDS = 3.0
"""Of a long unit: Ray needs less to see that a worker or a node died."""


def order(folder: Path) -> Order:
    return Order(folder, Settings())


def unit(name: str, seed: int = 0) -> Unit:
    return Unit(name, seed, 0, {"name": name, "seed": seed})


def units(*names: str) -> list[Unit]:
    return [unit(name) for name in names]


class Here:
    """An engine that makes the units in this process."""

    def run(self, units: Sequence[Unit], load: Load) -> Iterator[Result]:
        make = load()
        for unit in units:
            yield attempt(make, unit)


def honest(folder: Path) -> Load:
    """Writes a small house for every unit, and a line in made.txt."""
    return partial(_maker, folder, _write)


def troubled(folder: Path) -> Load:
    """As honest, but a unit's name may say what happens to its worker."""
    return partial(_maker, folder, _suffer)


def batch(
    folder: Path, units: list[Unit], load: Callable[[Path], Load] = honest, **options: Any
) -> Done:
    """A batch in this process."""
    return run_batch(units, order(folder), Here(), load=load(folder), **options)


def made(folder: Path) -> list[str]:
    """What was made so far, in all runs, in its order."""
    log = folder.parent / "made.txt"
    return log.read_text().split() if log.exists() else []


def slow(folder: Path) -> Load:
    """Half writes every unit but the first, and waits."""
    return partial(_maker, folder, _dawdle)


def _maker(folder: Path, make: object) -> Make:
    return partial(make, folder)  # type: ignore[arg-type]


def _write(folder: Path, unit: Unit) -> None:
    with (folder.parent / "made.txt").open("a") as log:
        log.write(f"{unit.name}\n")
    with output_folder(folder / unit.name, "renew") as house:
        (house / STAGE_FILE).write_text(f"#usda 1.0 {unit.name}\n" * 20)
        for name in ("plan.png", "layout.png", "scene.json"):
            (house / name).write_text(f"{name} of {unit.name}\n" * 20)
        mesh = house / "assets" / "Chair" / "Chair.usda"
        mesh.parent.mkdir(parents=True)
        mesh.write_text("a chair\n" * 20)
        share_files(house, folder)
        files = hashes_of(files_in(house), house)
        told = {**FIGURES, "plan": unit.source, "seed": unit.seed}
        write_record(Record(unit.recipe, files, told), house / HOUSE_RECORD)


def _suffer(folder: Path, unit: Unit) -> None:
    if "long" in unit.name:
        (folder.parent / f"{unit.name}.pid").write_text(f"{os.getpid()} {os.getppid()}")
        time.sleep(LONG_SECONDS)
    if "crash" in unit.name:
        with output_folder(folder / unit.name, "renew") as house:
            (house / STAGE_FILE).write_text("half of it")
            os.abort()
    if "killed_once" in unit.name and not (folder.parent / "killed").exists():
        (folder.parent / "killed").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if "unreadable" in unit.name:
        raise PlanError("shows no rooms", where=unit.name)
    if "bug" in unit.name:
        raise ZeroDivisionError("two\nlines")
    if "full" in unit.name:
        with output_folder(folder / unit.name, "renew") as house:
            (house / STAGE_FILE).write_text("half of it")
            raise OSError(errno.ENOSPC, "No space left on device", str(house))
    if "large" in unit.name:
        with output_folder(folder / unit.name, "renew") as house:
            (house / STAGE_FILE).write_bytes(bytes(2**20))
    _write(folder, unit)


def _dawdle(folder: Path, unit: Unit) -> None:
    if (folder / "first").is_dir():
        with output_folder(folder / unit.name, "renew") as house:
            (house / STAGE_FILE).write_text("half of it")
            (folder.parent / "worker.pid").write_text(str(os.getpid()))
            time.sleep(60.0)
    _write(folder, unit)
