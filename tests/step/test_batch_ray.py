"""Batches on a Ray cluster on this machine whose workers and nodes are killed."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import batch_makers as makers
import pytest

from chord_usd.base.errors import ChordError
from chord_usd.faces.batch import ray_engine
from chord_usd.faces.batch.ray_engine import RayEngine
from chord_usd.faces.batch.run import Done, run_batch
from chord_usd.faces.batch.work_units import Unit

ray = pytest.importorskip("ray", reason="the extra ray is not installed")

NODE = {"num_cpus": 1, "object_store_memory": 80 * 2**20}


@pytest.fixture(scope="module")
def cluster() -> Iterator[object]:
    from ray.cluster_utils import Cluster

    with pytest.MonkeyPatch.context() as patch:
        # Workers must find batch_makers, and must not depend on a network.
        patch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
        patch.setenv("RAY_USAGE_STATS_ENABLED", "0")
        cluster = Cluster(initialize_head=True, head_node_args=NODE)
        yield cluster
        ray.shutdown()
        cluster.shutdown()


@pytest.fixture
def node(cluster) -> Iterator[object]:
    """A second node, of one core as the first."""
    node = cluster.add_node(**NODE)
    yield node
    cluster.remove_node(node, allow_graceful=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "houses"


def batch(cluster, folder: Path, units: list[Unit], workers: int | None = None, **options) -> Done:
    gpus = options.get("gpus", 0.0)
    engine = RayEngine(cluster.address, workers, cpus=1, gpus=gpus, folder=folder)
    return run_batch(units, makers.order(folder), engine, load=makers.troubled(folder))


def in_background(*actions: Callable[[], object]) -> threading.Thread:
    def act() -> None:
        for action in actions:
            action()

    thread = threading.Thread(target=act)
    thread.start()
    return thread


def wait_for(file: Path) -> None:
    deadline = time.monotonic() + 60.0
    while not file.exists() and time.monotonic() < deadline:
        time.sleep(0.05)


def test_only_units_that_crash_their_worker_fail(cluster, node, folder: Path) -> None:
    done = batch(cluster, folder, makers.units("a", "crash", "b"))
    assert sorted(makers.made(folder)) == ["a", "b"]
    assert [result.unit.name for result in done.failures] == ["crash"]
    assert "died 3 times" in done.failures[0].why


def test_more_workers_than_cores_make_all_units_once(cluster, node, folder: Path) -> None:
    names = [f"long_{number}" for number in range(5)]
    done = batch(cluster, folder, makers.units(*names), workers=3)
    assert len(done.made) == 5
    assert sorted(makers.made(folder)) == names


def test_a_worker_that_is_killed_takes_no_unit_with_it(cluster, node, folder: Path) -> None:
    names = [f"long_{number}" for number in range(4)]
    mark = folder.parent / "long_1.pid"
    killer = in_background(
        lambda: wait_for(mark), lambda: os.kill(int(mark.read_text().split()[0]), signal.SIGKILL)
    )
    done = batch(cluster, folder, makers.units(*names))
    killer.join()
    assert len(done.made) == 4
    assert sorted(makers.made(folder)) == names


def test_a_node_that_is_killed_takes_no_unit_with_it(cluster, node, folder: Path) -> None:
    """While units run on both nodes, each longer than a death goes unseen."""
    names = [f"long_{number}" for number in range(6)]
    raylet = node.all_processes["raylet"][0].process.pid

    def runs_there() -> bool:
        marks = [mark.read_text().split() for mark in folder.parent.glob("long_*.pid")]
        return any(mark[1:] == [str(raylet)] for mark in marks)

    def wait() -> None:
        deadline = time.monotonic() + 60.0
        while not runs_there() and time.monotonic() < deadline:
            time.sleep(0.05)

    killer = in_background(wait, lambda: os.kill(raylet, signal.SIGKILL))
    done = batch(cluster, folder, makers.units(*names))
    killer.join()
    assert runs_there()
    assert len(done.made) == 6
    # The worker of a dead node may yet finish a unit that another one makes again.
    assert set(makers.made(folder)) == set(names)
    houses = Counter(path.parent.name for path in folder.glob("*/house.json"))
    assert houses == dict.fromkeys(names, 1)


def test_what_finds_no_room_is_told_with_what_it_needs(
    cluster, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ray_engine, "PLACE_SECONDS", 1.0)
    with pytest.raises(
        ChordError, match=r"no node has room .* 1 CPU .* and 0\.5 GPU \(0 of 0 free\)"
    ):
        batch(cluster, folder, makers.units("a"), gpus=0.5)
    assert not folder.exists()


def test_a_cluster_that_loses_its_room_ends_the_batch(
    cluster, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its only node with a GPU dies; what was made stays."""
    monkeypatch.setattr(ray_engine, "LOOK_SECONDS", 0.5)
    node = cluster.add_node(**NODE, num_gpus=1)
    mark = folder.parent / "long_0.pid"
    killer = in_background(
        lambda: wait_for(mark),
        lambda: monkeypatch.setattr(ray_engine, "PLACE_SECONDS", 1.0),
        lambda: cluster.remove_node(node, allow_graceful=False),
    )
    with pytest.raises(ChordError, match="no node has room"):
        batch(cluster, folder, makers.units("a", "long_0", "b"), gpus=1.0)
    killer.join()
    assert makers.made(folder)[:1] == ["a"]


def test_a_cluster_that_does_not_start_is_one_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(**options: object) -> None:
        raise Exception("The current node timed out during startup.\nMore of it")

    monkeypatch.setattr(ray, "is_initialized", lambda: False)
    monkeypatch.setattr(ray, "init", fail)
    engine = RayEngine(None, None, cpus=1, gpus=0.0, folder=folder)
    with pytest.raises(ChordError) as told:
        run_batch(makers.units("a"), makers.order(folder), engine, load=makers.honest(folder))
    assert "cannot start (The current node timed out during startup.)" in str(told.value)
    assert "\n" not in str(told.value)
