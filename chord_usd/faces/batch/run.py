"""A batch from beginning to end: find what is due, have it made, list what came of it."""

from __future__ import annotations

import faulthandler
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import NoReturn

from chord_usd.base.errors import ChordError, OutputError, reason_of
from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.progress import Progress, Stopwatch
from chord_usd.base.runtime.scratch import sweep
from chord_usd.faces.batch.engine import Engine, Load, Result
from chord_usd.faces.batch.failures import forget_failures, note_failures
from chord_usd.faces.batch.index import rows, write_index, write_parquet
from chord_usd.faces.batch.lock import locked
from chord_usd.faces.batch.make import Make, Maker, pictures_recipe
from chord_usd.faces.batch.records import (
    HOUSE_RECORD,
    PICTURES_FOLDER,
    PICTURES_RECORD,
    Digests,
    finished,
)
from chord_usd.faces.batch.shards import write_shards
from chord_usd.faces.batch.work_units import Order, Unit


@dataclass(frozen=True)
class Exports:
    """What is written beside the houses, besides index.jsonl."""

    parquet: bool = False
    shards: bool = False
    named_only: bool = False
    """Of the units of this run alone, not of every house that is in the folder."""


@dataclass(frozen=True)
class Done:
    """What came of a batch."""

    made: tuple[Unit, ...]
    kept: tuple[Unit, ...]
    """Finished by an earlier run."""
    failures: tuple[Result, ...]
    files: tuple[Path, ...]
    """The index and what else was exported."""
    holding: int
    """Houses of all in the folder whose certificate holds."""
    not_holding: tuple[str, ...]
    """Names of those whose certificate does not."""
    pictures: int
    """Of all houses in the folder."""


def run_batch(
    units: Sequence[Unit],
    order: Order,
    engine: Engine,
    exports: Exports = Exports(),
    watch: Stopwatch | None = None,
    load: Load | None = None,
) -> Done:
    """Make all units that are not finished; those that cannot be made are listed.

    load: what makes a unit, for tests; by default a Maker of the order. The stopwatch times look,
    houses and index. Raises OutputError where another batch is at work in the folder or it cannot
    be written, also once the disk is full. Finished houses stay, whatever happens.
    """
    watch = watch or Stopwatch()
    folder = order.folder
    made_folder = _make_folder(folder)
    try:
        with locked(folder):
            _sweep(folder)
            interrupts.delivered.append(folder)
            try:
                with watch.step("look") as progress:
                    due = find_due(units, order, progress)
                with watch.step("houses") as progress:
                    loads = load or partial(Maker, order)
                    if order.timeout_s is not None:
                        loads = partial(limited, loads, order.timeout_s)
                    results = _make(due, engine, loads, progress)
            finally:
                # Of workers that were ended in the middle of a house.
                _sweep(folder)
            return _finish(units, results, order, exports, watch)
    finally:
        if made_folder:
            _remove_empty(folder)


def find_due(
    units: Sequence[Unit], order: Order, progress: Progress | None = None
) -> tuple[Unit, ...]:
    """The units that are not finished: something is missing, damaged, or made by other settings."""
    digests = Digests()
    due = []
    for done, unit in enumerate(units):
        house = order.folder / unit.name
        record = finished(house / HOUSE_RECORD, unit.recipe, digests)
        if record and order.renders:
            recipe = pictures_recipe(record, order.renders)
            record = finished(house / PICTURES_RECORD, recipe, digests)
        if not record:
            due.append(unit)
        if progress:
            progress(done + 1, len(units))
    return tuple(due)


def _make(due: Sequence[Unit], engine: Engine, load: Load, progress: Progress) -> list[Result]:
    results: list[Result] = []
    progress(0, len(due))
    with closing(engine.run(due, load)) as coming:  # type: ignore[type-var]
        for result in coming:
            results.append(result)
            if result.fatal:
                made = sum(not other.why for other in results)
                raise type(result.fatal)(
                    f"{result.fatal.what}; {made} of {len(due)} houses were made",
                    where=result.fatal.where,
                    expected=result.fatal.expected,
                    try_=result.fatal.try_,
                )
            progress(len(results), len(due))
    return results


def _finish(
    units: Sequence[Unit],
    results: Sequence[Result],
    order: Order,
    exports: Exports,
    watch: Stopwatch,
) -> Done:
    failures = tuple(sorted((r for r in results if r.why), key=lambda r: r.unit.name))
    tried = {result.unit for result in results}
    failed = {result.unit.name for result in failures}
    with watch.step("index"):
        note_failures(order.folder, failures)
        forget_failures(order.folder, (unit for unit in units if unit.name not in failed))
        names = {unit.name for unit in units} if exports.named_only else None
        listed = rows(order.folder, names)
        files = [write_index(listed, order.folder)]
        if exports.parquet:
            files.append(write_parquet(listed, order.folder))
        if exports.shards:
            files += write_shards(listed, order.folder)
    return Done(
        made=tuple(result.unit for result in results if not result.why),
        kept=tuple(unit for unit in units if unit not in tried),
        failures=failures,
        files=tuple(files),
        holding=sum(bool(row.get("holds")) for row in listed),
        not_holding=tuple(row["house"] for row in listed if row.get("holds") is False),
        pictures=sum(row["kind"] == "picture" for row in listed),
    )


def _make_folder(folder: Path) -> bool:
    """Returns whether it was not there. Raises OutputError."""
    new = not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(
            f"cannot be made ({reason_of(error)})",
            where=str(folder),
            expected="a folder for houses",
            try_="another -o",
        ) from error
    return new


def _sweep(folder: Path) -> None:
    """Remove what workers that were killed had half written."""
    for place in (folder, *folder.glob("*/"), *folder.glob(f"*/{PICTURES_FOLDER}/")):
        sweep(place)


def _remove_empty(folder: Path) -> None:
    with suppress(OSError):
        folder.rmdir()


# A limit to the time that a unit may take. Runs in the workers -----------------------------------

_GRACE_S = 60.0
"""What a library that hears no signal gets more; then the worker ends, with a traceback."""


class _Late(BaseException):
    """Not an Exception, which somebody on the way could take for another error."""


def limited(load: Load, seconds: float) -> Make:
    """What load makes, for as long as a unit takes no more than this. Picklable in part."""
    return partial(_make_in_time, load(), seconds)


def _make_in_time(make: Make, seconds: float, unit: Unit) -> None:
    try:
        with _alarm(seconds):
            make(unit)
    except _Late:
        raise ChordError(
            f"took longer than {seconds / 60:g} minutes", where=unit.name, try_="--timeout MINUTES"
        ) from None


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    stderr = sys.__stderr__ or sys.stderr
    faulthandler.dump_traceback_later(seconds + _GRACE_S, exit=True, file=stderr)
    before = signal.signal(signal.SIGALRM, _ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        faulthandler.cancel_dump_traceback_later()


def _ring(number: int, frame: FrameType | None) -> NoReturn:
    raise _Late
