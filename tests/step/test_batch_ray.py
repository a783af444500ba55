"""Batches on a Ray cluster of two nodes on this machine, one of which is killed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import batch_makers as makers
import pytest

from chord_usd.batch.ray_engine import RayEngine
from chord_usd.batch.run import Done, run_batch
from chord_usd.batch.work_units import Unit
from chord_usd.errors import ChordError

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
        cluster.add_node(**NODE)
        yield cluster
        ray.shutdown()
        cluster.shutdown()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "houses"


def batch(cluster, folder: Path, units: list[Unit], **options) -> Done:
    engine = RayEngine(cluster.address, None, cpus=1, gpus=options.get("gpus", 0.0), folder=folder)
    load = options.get("load", makers.troubled)
    return run_batch(units, makers.order(folder), engine, load=load(folder))


def test_units_are_made_on_both_nodes_and_only_those_that_crash_fail(cluster, folder: Path) -> None:
    done = batch(cluster, folder, makers.units("a", "crash", "b"))
    assert sorted(makers.made(folder)) == ["a", "b"]
    assert [result.unit.name for result in done.failures] == ["crash"]
    assert "died 3 times" in done.failures[0].why


def test_a_cluster_without_room_is_told(cluster, folder: Path) -> None:
    with pytest.raises(ChordError, match="no node has room"):
        batch(cluster, folder, makers.units("a"), gpus=0.5)
    assert not folder.exists()


def test_a_node_that_dies_takes_no_unit_with_it(cluster, folder: Path) -> None:
    """Last: the cluster has one node less then."""
    (node,) = cluster.worker_nodes
    doomed = folder.parent / "node.pid"
    doomed.write_text(str(node.all_processes["raylet"][0].process.pid))
    batch(cluster, folder, makers.units("a", "b", "c"))
    assert not doomed.exists()
    assert sorted(makers.made(folder)) == ["a", "b", "c"]
