"""Workers as actors on a Ray cluster: as many as there are cores or GPUs for, on any node.

All nodes see the folder of the batch at the same path and have chord-usd installed. Houses go
straight to that folder; only what became of them travels through Ray.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from chord_usd.batch.engine import Load, Queue, Result, attempt
from chord_usd.batch.lock import LOCK_FILE
from chord_usd.batch.work_units import Unit
from chord_usd.errors import ChordError, OutputError
from chord_usd.runtime.extras import needed_for
from chord_usd.runtime.offline import refuse_telemetry, stay_offline

KNOCK_SECONDS = 10.0
"""How long a head node may take to answer."""

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
    """Actors of a Ray cluster."""

    def __init__(
        self, address: str | None, workers: int | None, cpus: int, gpus: float, folder: Path
    ) -> None:
        """address: of the cluster; None starts one on this machine for as long as it is needed.

        workers: how many; None for as many as there is room for. cpus, gpus: what each takes, gpus
        may be a fraction. folder: of the batch.
        """
        self._address, self._workers, self._cpus, self._gpus = address, workers, cpus, gpus
        self._folder = folder

    def run(self, units: Sequence[Unit], load: Load) -> Iterator[Result]:
        """As Engine.run. Raises MissingExtraError without ray, ChordError without a cluster."""
        if not units:
            return
        with _environment(_ALONE if self._address is None else {}):
            ray = _import_ray()
            connection = ExitStack()
            connection.enter_context(_connected(ray, self._address))
        with connection:
            count = min(self._workers or self._room(ray), len(units))
            team = _Team(ray, self._actor_class(ray), (load, self._seen()))
            try:
                yield from _spread(ray, team, Queue(units), count)
            finally:
                team.dismiss()

    def _room(self, ray: Any) -> int:
        """Workers that the cluster has room for."""
        there = ray.cluster_resources()
        room = there.get("CPU", 0.0) // self._cpus
        if self._gpus:
            room = min(room, there.get("GPU", 0.0) // self._gpus)
        if room < 1:
            raise ChordError(
                f"no node has room for a worker of --cpus {self._cpus} --gpus {self._gpus:g}",
                where=self._address or "this machine",
                try_="smaller --cpus and --gpus",
            )
        return int(room)

    def _actor_class(self, ray: Any) -> Any:
        # An actor's cores also say how many threads it starts: Ray sets OMP_NUM_THREADS to them.
        return ray.remote(
            num_cpus=self._cpus, num_gpus=self._gpus, max_restarts=0, scheduling_strategy="SPREAD"
        )(RayWorker)

    def _seen(self) -> tuple[Path, str]:
        """What a worker must see to be at work in the right folder."""
        lock = self._folder / LOCK_FILE
        return lock, lock.read_text()


class RayWorker:
    """One actor."""

    def __init__(self, load: Load, seen: tuple[Path, str]) -> None:
        stay_offline()
        self._seen = seen
        self._make = load()

    def attempt(self, unit: Unit) -> Result:
        """As engine.attempt."""
        file, text = self._seen
        if not file.is_file() or file.read_text() != text:
            error = OutputError(
                f"is not seen by {os.uname().nodename}",
                where=str(file.parent),
                expected="a folder that all nodes share, at the same path",
                try_="-o on a network file system",
            )
            return Result(unit, str(error), fatal=error)
        return attempt(self._make, unit)


class _Team:
    """The actors that are alive."""

    def __init__(self, ray: Any, actor_class: Any, arguments: tuple[Any, ...]) -> None:
        self._ray, self._class, self._arguments = ray, actor_class, arguments
        self._idle: list[Any] = []
        self._all: list[Any] = []

    def borrow(self) -> Any:
        """An actor that has nothing to do."""
        if not self._idle:
            self._idle.append(self._class.remote(*self._arguments))
            self._all.append(self._idle[-1])
        return self._idle.pop()

    def give_back(self, actor: Any) -> None:
        """It is done with its unit."""
        self._idle.append(actor)

    def dismiss(self) -> None:
        """End all of them, whatever they are at."""
        for actor in self._all:
            self._ray.kill(actor)


def _spread(ray: Any, team: _Team, queue: Queue, count: int) -> Iterator[Result]:
    running: dict[Any, tuple[Any, Unit]] = {}
    while queue or running:
        while queue and len(running) < count:
            actor, unit = team.borrow(), queue.take()
            running[actor.attempt.remote(unit)] = actor, unit
        (answer,), _ = ray.wait(list(running), num_returns=1)
        actor, unit = running.pop(answer)
        result: Result | None
        try:
            result = ray.get(answer)
            team.give_back(actor)
        except ray.exceptions.RayActorError as error:
            told = [line.strip() for line in str(error).splitlines() if line.strip()]
            result = _unable(unit, told[-1]) if error.actor_init_failed else None
            result = result or queue.died(unit, told[0])
        if result:
            yield result


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
    except (OSError, RuntimeError, ValueError) as error:
        raise ChordError(
            f"no Ray cluster answers ({str(error).strip().splitlines()[0]})",
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
