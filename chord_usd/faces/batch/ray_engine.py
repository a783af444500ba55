"""Units as tasks of a Ray cluster: as many at a time as there are cores or GPUs for, on any node.

All nodes see the folder of the batch at the same path and have chord-usd installed. Houses go
straight to that folder; only what became of them travels through Ray.
"""

from __future__ import annotations

import os
import pickle
import socket
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError, OutputError
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.offline import refuse_telemetry, stay_offline
from chord_usd.faces.batch.engine import MOST_TRIES, Load, Result, attempt
from chord_usd.faces.batch.lock import LOCK_FILE
from chord_usd.faces.batch.make import Make
from chord_usd.faces.batch.work_units import Unit

KNOCK_SECONDS = 10.0
"""How long a head node may take to answer."""

PLACE_SECONDS = 60.0
"""How long a worker may wait for room: nodes may be starting, or busy with other work."""

LOOK_SECONDS = 5.0
"""How often the nodes are counted while nothing else happens."""

_ALONE = {
    # Loopback is this node's address, and where its services listen: what Ray does by itself where
    # a firewall would ask. It also asks the way to a public name server otherwise.
    "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0",
    # Ray asks the metadata services of three clouds where it runs, usage reports or not, and looks
    # up a name for it. Whatever it asks by HTTP goes where nobody listens.
    **dict.fromkeys(("http_proxy", "https_proxy"), "http://127.0.0.1:9"),
    "no_proxy": "127.0.0.1,localhost",
}
"""Environment of a cluster on this machine that nobody else can see."""


class RayEngine:
    """Tasks of a Ray cluster, one for each unit; Ray retries those whose worker or node dies."""

    def __init__(
        self, address: str | None, workers: int | None, cpus: int, gpus: float, folder: Path
    ) -> None:
        """address: of the cluster; None starts one on this machine for as long as it is needed.

        workers: how many at most; None for as many as there is room for. cpus, gpus: what each
        takes, gpus may be a fraction. folder: of the batch.
        """
        self._address, self._workers, self._folder = address, workers, folder
        self._need = {"CPU": float(cpus), **({"GPU": gpus} if gpus else {})}

    def run(self, units: Sequence[Unit], load: Load) -> Iterator[Result]:
        """As Engine.run. Raises MissingExtraError without ray, ChordError without a cluster or
        where no worker can be placed on it."""
        if not units:
            return
        with _environment(_ALONE if self._address is None else {}):
            ray = _import_ray()
            connection = ExitStack()
            connection.enter_context(_connected(ray, self._address))
        with connection:
            lock = self._folder / LOCK_FILE
            seen = (lock, lock.read_text())
            self._place(ray)
            yield from self._spread(ray, deque(units), (pickle.dumps(load), seen))

    def _task(self, ray: Any, function: Callable[..., Any]) -> Any:
        # The cores also say how many threads a worker has: Ray sets OMP_NUM_THREADS to them.
        return ray.remote(
            num_cpus=self._need["CPU"],
            num_gpus=self._need.get("GPU", 0.0),
            max_retries=MOST_TRIES - 1,
            max_calls=0,  # else a worker with a GPU ends after each unit, its networks with it
            scheduling_strategy="SPREAD",
        )(function)

    def _place(self, ray: Any) -> None:
        """Wait until a worker has room. Raises ChordError."""
        first = self._task(ray, _nothing).remote()
        placed, _ = ray.wait(
            [first], timeout=PLACE_SECONDS if self._address or self._room(ray) else 0.0
        )
        if not placed:
            ray.cancel(first, force=True)
            raise self._no_room(ray)

    def _spread(
        self, ray: Any, waiting: deque[Unit], common: tuple[bytes, Seen]
    ) -> Iterator[Result]:
        task = self._task(ray, _attempt)
        running: dict[Any, Unit] = {}
        room_at = time.monotonic()
        try:
            while waiting or running:
                while waiting and len(running) < (self._workers or 2 * self._room(ray) or 1):
                    unit = waiting.popleft()
                    running[task.remote(*common, unit)] = unit
                done, _ = ray.wait(list(running), timeout=LOOK_SECONDS)
                for answer in done:
                    yield _result(ray, running.pop(answer), answer)
                if done or self._room(ray):
                    room_at = time.monotonic()
                elif time.monotonic() - room_at > PLACE_SECONDS:
                    raise self._no_room(ray)
        finally:
            for answer in running:
                ray.cancel(answer, force=True)

    def _room(self, ray: Any) -> int:
        """Workers that the nodes which are alive have room for."""
        return sum(
            int(min(node["Resources"].get(name, 0.0) // much for name, much in self._need.items()))
            for node in ray.nodes()
            if node["Alive"]
        )

    def _no_room(self, ray: Any) -> ChordError:
        words = [
            f"{much:g} {name} ({ray.available_resources().get(name, 0.0):g} of "
            f"{ray.cluster_resources().get(name, 0.0):g} free)"
            for name, much in self._need.items()
        ]
        return ChordError(
            f"no node has room for a worker of {' and '.join(words)}",
            where=self._address or "this machine",
            try_="smaller --cpus and --gpus, or wait until the cluster is free",
        )


Seen = tuple[Path, str]
"""A file in the batch's folder and what it holds: by it a worker knows the folder."""


def _nothing() -> None:
    """What is run to see whether a worker finds room."""


def _attempt(load: bytes, seen: Seen, unit: Unit) -> Result:
    """As engine.attempt, in a worker of Ray."""
    stay_offline()
    file, text = seen
    if not file.is_file() or file.read_text() != text:
        error = OutputError(
            f"is not seen by {os.uname().nodename}",
            where=str(file.parent),
            expected="a folder that all nodes share, at the same path",
            try_="-o on a network file system",
        )
        return Result(unit, str(error), fatal=error)
    return attempt(_loaded(load), unit)


@lru_cache(maxsize=1)
def _loaded(load: bytes) -> Make:
    """What makes units; a worker keeps it, with its networks, from one unit to the next."""
    loader: Load = pickle.loads(load)
    return loader()


def _result(ray: Any, unit: Unit, answer: Any) -> Result:
    try:
        result: Result = ray.get(answer)
    except ray.exceptions.RayTaskError as error:
        return _unable(unit, _lines(error)[-1])
    except ray.exceptions.RayError as error:
        return Result(unit, f"its worker died {MOST_TRIES} times: {_lines(error)[0]}")
    return result


def _lines(error: Exception) -> list[str]:
    return [line.strip() for line in str(error).splitlines() if line.strip()] or ["no reason given"]


def _unable(unit: Unit, how: str) -> Result:
    """A node on which no worker can start would fail every unit it is given."""
    error = ChordError(
        f"a Ray worker cannot start ({how})",
        where="--engine ray",
        try_="install this version of chord-usd on every node",
    )
    return Result(unit, str(error), fatal=error)


def _import_ray() -> Any:
    refuse_telemetry()
    with needed_for("the Ray engine", "--engine local"):
        import ray
    return ray


@contextmanager
def _environment(variables: Mapping[str, str]) -> Iterator[None]:
    """What is imported or started meanwhile sees these variables."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


@contextmanager
def _connected(ray: Any, address: str | None) -> Iterator[None]:
    """A connection to the cluster; one that was there before stays."""
    if ray.is_initialized():
        yield
        return
    try:
        _knock(address)
        ray.init(
            address=address or "local",
            include_dashboard=False if address is None else None,
            log_to_driver=False,
            logging_level="ERROR",
        )
    except Exception as error:  # Ray raises that itself where a node of this machine does not start
        why = _lines(error)[0]
        if address is None:
            raise ChordError(
                f"a Ray cluster cannot start ({why})", where="this machine", try_="--engine local"
            ) from error
        raise ChordError(
            f"no Ray cluster answers ({why})",
            where=f"--address {address}",
            expected="HOST:PORT of a head node, and its token where it asks for one",
            try_="ray start --head",
        ) from error
    try:
        yield
    finally:
        ray.shutdown()


def _knock(address: str | None) -> None:
    """Ray itself waits for minutes where nobody listens. Raises OSError, ValueError."""
    host, colon, port = (address or "").removeprefix("ray://").rpartition(":")
    if colon:
        socket.create_connection((host, int(port)), KNOCK_SECONDS).close()
