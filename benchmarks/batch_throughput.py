"""How many houses a batch makes in an hour, by the number of workers, and their memory.

    python benchmarks/batch_throughput.py [--houses N] [--workers 1 2] [--ray]

Procedural plans with everything on, the certificate included. The first house of each worker comes
with loading the models, which a batch of thousands does not feel, so it is not counted. --ray
measures as many Ray nodes of one core on this machine, too.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from results import write_section

from chord_usd.faces.batch.engine import Engine
from chord_usd.faces.batch.local import LocalEngine
from chord_usd.faces.batch.lock import locked
from chord_usd.faces.batch.make import Make, Maker
from chord_usd.faces.batch.ray_engine import RayEngine
from chord_usd.faces.batch.work_units import Order, Unit, list_units
from chord_usd.line.pipeline import Settings


@dataclass(frozen=True)
class Figures:
    """Of one batch, once all workers are warm."""

    houses_per_hour: float
    cpu_s_per_house: float
    peak_mib: float
    """Largest resident set of a worker."""

    @property
    def told(self) -> str:
        """For the table."""
        return (
            f"{self.houses_per_hour:.0f} houses an hour, {self.cpu_s_per_house:.1f} processor "
            f"seconds a house, {self.peak_mib:.0f} MiB a worker"
        )


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--houses", type=int, default=20, help="of each batch, all warm (20)")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--ray", action="store_true")
    options = parser.parse_args()
    rows = []

    def row(name: str, figures: Figures) -> None:
        rows.append((name, figures.told))
        sys.stderr.write(f"{name}: {figures.told}\n")

    for count in options.workers:
        row(f"{count} local", measure(options.houses, count))
    for count in options.workers if options.ray else ():
        with ray_nodes(count) as address:
            row(f"{count} Ray nodes", measure(options.houses, count, address))
    note = f"{options.houses} procedural houses by each number of workers, which share the cores."
    sys.stdout.write(write_section("batch", rows, note))


def measure(houses: int, workers: int, address: str = "") -> Figures:
    """A batch by local workers, or by those of a Ray cluster. Raises RuntimeError if any fails."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name, "houses")
        folder.mkdir()
        order = Order(folder, Settings())
        units = list_units([], houses + workers, [0], order.settings)
        engine: Engine = LocalEngine(workers)
        if address:
            engine = RayEngine(address, workers, cpus=1, gpus=0.0, folder=folder)
        with locked(folder), closing(engine.run(units, partial(noting, order))) as results:
            for count, result in enumerate(results, start=1):
                if result.why:
                    raise RuntimeError(f"{result.unit.name}: {result.why}")
                if count == workers:
                    begun = time.perf_counter()
        seconds = time.perf_counter() - begun
        notes = [json.loads(line) for file in folder.glob("*.note") for line in file.open()]
    # The first line of each worker is its warming up.
    cpu_s = [note["cpu_s"] for note in notes if not note["first"]]
    return Figures(
        3600.0 * houses / seconds,
        sum(cpu_s) / max(len(cpu_s), 1),
        max(note["peak_mib"] for note in notes),
    )


def noting(order: Order) -> Make:
    """A Maker that notes, in the worker, what each house took."""
    maker = Maker(order)
    file = order.folder / f"{os.getpid()}.note"

    def make(unit: Unit) -> None:
        before = time.process_time()
        maker(unit)
        note = {
            "first": not file.exists(),
            "cpu_s": time.process_time() - before,
            "peak_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        }
        with file.open("a") as lines:
            lines.write(json.dumps(note) + "\n")

    return make


@contextmanager
def ray_nodes(count: int) -> Iterator[str]:
    """The address of a cluster of nodes of one core each, on this machine."""
    import ray
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    try:
        for _ in range(count - 1):
            cluster.add_node(num_cpus=1)
        yield cluster.address
    finally:
        ray.shutdown()
        cluster.shutdown()


if __name__ == "__main__":
    main()
