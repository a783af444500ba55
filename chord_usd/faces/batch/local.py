"""Workers as processes of this machine, each of which makes unit after unit.

A worker that dies takes down the one unit it had; another worker starts in its place.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import re
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from pathlib import Path

from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.networks import THREADS_VARIABLE, usable_cores
from chord_usd.base.runtime.offline import stay_offline
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.faces.batch.engine import Load, Queue, Result, attempt
from chord_usd.faces.batch.work_units import Unit

WORKER_MIB = 1024
"""Memory a worker needs, its Blender not counted (benchmarks/batch_throughput.py)."""

STOP_SECONDS = 0.8
"""How long a worker has to clean up after SIGTERM."""

LOG_LINES = 200
"""Kept of a worker that died."""

_spawn = get_context("spawn")
"""Fresh interpreters: networks and USD have threads, which do not survive a fork."""


def usual_workers() -> int:
    """One for each core, as far as the memory goes that is free."""
    return max(min(usable_cores(), _available_mib() // WORKER_MIB), 1)


def _available_mib() -> int:
    available = re.search(r"MemAvailable:\s*(\d+) kB", Path("/proc/meminfo").read_text())
    return int(available[1]) // 1024 if available else WORKER_MIB


class LocalEngine:
    """Processes on this machine."""

    def __init__(self, workers: int) -> None:
        self._count = workers

    def run(self, units: Sequence[Unit], load: Load) -> Iterator[Result]:
        """As Engine.run."""
        queue = Queue(units)
        count = min(self._count, len(units))
        threads = max(usable_cores() // max(count, 1), 1)
        with scratch_folder() as logs:
            team: list[_Worker] = []
            try:
                while queue or any(worker.unit for worker in team):
                    idle = [worker for worker in team if not worker.unit]
                    while queue and (idle or len(team) < count):
                        if not idle:
                            idle.append(_Worker(load, logs, threads))
                            team.append(idle[0])
                        idle.pop().begin(queue.take())
                    yield from _answers(team, queue)
            finally:
                for worker in team:
                    worker.ask_to_end()
                deadline = time.monotonic() + STOP_SECONDS
                for worker in team:
                    worker.end(deadline)


def _answers(team: list[_Worker], queue: Queue) -> Iterator[Result]:
    """Wait until some have answered or died; the dead leave the team, their units wait again."""
    ready = wait([worker.connection for worker in team])
    for worker in [worker for worker in team if worker.connection in ready]:
        unit, worker.unit = worker.unit, None
        result = worker.result()
        if result is None:
            team.remove(worker)
            result = queue.died(unit, *worker.how_it_died()) if unit else None
        if result:
            yield result


class _Worker:
    """One process and the unit it has."""

    def __init__(self, load: Load, logs: Path, threads: int) -> None:
        self.unit: Unit | None = None
        self.connection, there = _spawn.Pipe()
        handle, name = tempfile.mkstemp(dir=logs)
        os.close(handle)
        self._log = Path(name)
        self._process = _spawn.Process(target=_serve, args=(there, load, self._log), daemon=True)
        with _threads(threads):
            self._process.start()
        # Only the worker may hold the other end, so that its death closes it.
        there.close()

    def begin(self, unit: Unit) -> None:
        """Hand it a unit."""
        self.unit = unit
        # A worker that is dead already is noticed when its answer is read.
        with contextlib.suppress(ConnectionError):
            self.connection.send(unit)

    def result(self) -> Result | None:
        """What came of its unit; None where the process died."""
        try:
            result: Result = self.connection.recv()
        except (EOFError, ConnectionError):
            self._process.join()
            return None
        return result

    def how_it_died(self) -> tuple[str, str]:
        """The signal or exit code with the last line it wrote, and all of its last lines."""
        code = self._process.exitcode or 0
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        said = [line.strip() for line in self._log.read_text(errors="replace").splitlines()]
        last = next((line for line in reversed(said) if line), "")
        log = "\n".join(said[-LOG_LINES:])
        return f"{how} ({last})" if last else how, log

    def ask_to_end(self) -> None:
        """Without a unit it ends by itself; otherwise it drops what it does and cleans up."""
        self.connection.close()
        if self.unit:
            self._process.terminate()

    def end(self, deadline: float) -> None:
        """Wait for it, not for long. deadline: by time.monotonic()."""
        self._process.join(max(deadline - time.monotonic(), 0.0))
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


@contextlib.contextmanager
def _threads(count: int) -> Iterator[None]:
    """Environment that limits the threads of a new process."""
    before = os.environ.get(THREADS_VARIABLE)
    os.environ[THREADS_VARIABLE] = str(count)
    try:
        yield
    finally:
        del os.environ[THREADS_VARIABLE]
        if before is not None:
            os.environ[THREADS_VARIABLE] = before


def _serve(connection: Connection, load: Load, log: Path) -> None:
    """The worker's own main function."""
    # Ctrl-C reaches the whole terminal; the driver stops its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    interrupts.obey()
    with log.open("w") as file:
        # What libraries print must spoil neither the driver's answer nor its progress.
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    stay_offline()
    faulthandler.enable()
    threading.Thread(target=_end_with_driver, daemon=True).start()
    try:
        make = load()
        with contextlib.suppress(EOFError, ConnectionError):
            while True:
                unit: Unit = connection.recv()
                connection.send(attempt(make, unit))
    except interrupts.Terminated:
        sys.exit(interrupts.TERMINATED)


def _end_with_driver() -> None:
    """A killed driver cannot stop its workers."""
    driver = parent_process()
    assert driver is not None
    wait([driver.sentinel])
    os._exit(interrupts.TERMINATED)
