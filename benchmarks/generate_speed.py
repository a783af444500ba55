"""How long `chord-usd generate` takes on one plan, and how much memory.

    python benchmarks/generate_speed.py [PLAN] [--runs N] [--steps N]

The first run warms the file cache and is not counted. Figures are medians over the runs; each run
is a process of its own, as for a user.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from results import write_section

from chord_usd.base.runtime import resident

ROOT = Path(__file__).parents[1]
IMPORTS = (
    "onnxruntime, chord_usd.line.plan.read, chord_usd.line.layout.sample, chord_usd.line.graph."
    "extract, chord_usd.library.database, chord_usd.line.stage.author.author_stage"
)
LOADED_S = 15.0
"""In which a worker has loaded everything."""


@dataclass(frozen=True)
class Run:
    """One process."""

    wall_s: float
    processor_s: float
    peak_mib: float
    output: str


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plan", type=Path, nargs="?", default=ROOT / "examples/two_bedrooms.png")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--steps", type=int)
    options = parser.parse_args()
    os.environ[resident.VARIABLE] = "0"
    imports = [_process(sys.executable, "-c", f"import {IMPORTS}") for _ in range(options.runs + 1)]
    generates = [_generate(options.plan, options.steps) for _ in range(options.runs + 1)]
    told = [json.loads(run.output) for run in generates[1:]]
    rows = [
        ("plan", f"{options.plan.name}, {told[0]['rooms']} rooms, {told[0]['furniture']} pieces"),
        ("whole process", f"{_median([run.wall_s for run in generates[1:]]):.2f} s"),
        ("processor time", f"{_median([run.processor_s for run in generates[1:]]):.2f} s"),
        ("of which imports", f"{_median([run.wall_s for run in imports[1:]]):.2f} s"),
    ]
    if sys.platform == "linux":
        through = [run.wall_s for run in _through_workers(options)]
        rows.append(("through a worker that waits", f"{_median(through):.2f} s"))
    rows += [
        (f"step {step}", f"{_median([run['seconds'][step] for run in told]):.2f} s")
        for step in told[0]["seconds"]
    ]
    rows.append(("peak memory", f"{max(run.peak_mib for run in generates):.0f} MiB"))
    note = f"Medians of {options.runs} runs, warm."
    if os.getloadavg()[0] > (os.cpu_count() or 1):
        note += " The machine had other work: of these figures, the processor time alone counts."
    sys.stdout.write(write_section("generate", rows, note))


def _generate(plan: Path, steps: int | None) -> Run:
    with tempfile.TemporaryDirectory() as folder:
        words = ["generate", str(plan), "-o", f"{folder}/house.usda", "--json"]
        words += ["--steps", str(steps)] if steps else []
        return _process(sys.executable, "-m", "chord_usd.cli", *words)


def _through_workers(options: argparse.Namespace) -> Iterator[Run]:
    """Runs that each find a worker which has loaded everything; the first only starts one."""
    os.environ[resident.VARIABLE] = "1"
    for number in range(options.runs + 1):
        run = _generate(options.plan, options.steps)
        time.sleep(LOADED_S)
        if number:
            yield run
    os.environ[resident.VARIABLE] = "0"


def _process(*words: str) -> Run:
    """Run a process to its end. Raises CalledProcessError when it fails."""
    started = time.perf_counter()
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout
        output = child.stdout.read()
        # wait4 knows the peak of this child alone; RUSAGE_CHILDREN keeps the largest of all.
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in (0, 1):  # 1: the certificate does not hold
        raise subprocess.CalledProcessError(child.returncode, words)
    spent_s = usage.ru_utime + usage.ru_stime
    return Run(time.perf_counter() - started, spent_s, usage.ru_maxrss / 1024, output)


def _median(values: list[float]) -> float:
    return statistics.median(values)


if __name__ == "__main__":
    main()
