"""Ctrl-C, a farm's SIGTERM and SIGKILL in every verb that takes time, at random moments.

    python benchmarks/interrupts.py [--rounds N] [--seed N] [--only VERB]... [--write]

After SIGINT and SIGTERM a verb ends within 2 s with the documented code and one true line: where it
says that nothing was written, nothing was; what it started is gone with it. After SIGKILL what it
started (Blender) is gone within 2 s, and the next run clears away what it left. Each round makes a
folder of its own. Measure on a machine that has little else to do: while a library is imported it
keeps Python from answering, for longer the busier the machine is. Exit code 1 is a fault.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from outside import samples, watch  # noqa: E402
from results import write_section  # noqa: E402

SOON_S = 2.0
_LATEST_S = 9.0
_STARTS_S = 0.2

VERBS: dict[str, str] = {
    "generate": "generate plan.png -o out/house.usda",
    "regenerate": "regenerate house/house.usda --room Bedroom_0 -o out/house.usda",
    "render": "render house/house.usda -o out --camera Top --samples 4000 --resolution 640x360",
    "check": "check house/house.usda",
    "stage": "stage scene.json -o out/house.usda",
    "export": "export house/house.usda --for gltf -o out/house.glb",
    "plan read": "plan read lines.png -o out/plan.json",
    "plan from-text": "plan from-text bedrooms -o out/plan.png",
    "layout": "layout plan.png -o out/layout.png --steps 1000",
    "dataset synth": "dataset synth -o out --count 500",
    "batch": "batch --synth 4 -o out --steps 2 --workers 2",
    "farm bundle": "farm bundle house/house.usda -o out",
    "evaluate layouts": "evaluate layouts --n 4 --no-fid",
    "train bubbles": "train bubbles -o out --houses 300 --minutes 1",
    "train lists": "train lists -o out --minutes 1",
    "train reader": "train reader -o out --minutes 1",
    "train plan2layout": "train plan2layout -o out --minutes 1",
    "assets add": "assets add library -o out",
    "assets build": "assets build -o out",
}
_RUNS = ("train",)
"""Verbs whose folder keeps what was learned so far."""
_KILLED = ("render", "generate", "batch")
_INPUTS = ("plan.png", "lines.png", "scene.json", "house", "library")
_CODES = {signal.SIGINT: 130, signal.SIGTERM: 143}


@dataclass(frozen=True)
class Ended:
    """How a verb took a signal."""

    verb: str
    how: signal.Signals
    at_s: float
    code: int
    took_s: float
    told: str
    faults: list[str]

    @property
    def was_hit(self) -> bool:
        """Whether the signal came while it ran."""
        return self.code not in (0, 1)


def interrupted(
    verb: str, how: signal.Signals, at_s: float, place: Path, env: dict[str, str]
) -> Ended:
    """Start a verb in a folder of its own, send the signal, look at what is left."""
    before = watch.look(place)
    process = subprocess.Popen(
        [sys.executable, "-m", "chord_usd.cli", *VERBS[verb].split(), "--progress", "none"],
        cwd=place, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )  # fmt: skip
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(at_s)
    children = list(below(process.pid))
    start = time.monotonic()
    process.send_signal(how)
    try:
        told = process.communicate(timeout=60)[1]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        told = f"it went on for a minute {process.communicate()[1]}"
    took_s = time.monotonic() - start
    faults = [] if took_s <= SOON_S else [f"ended after {took_s:.1f} s"]
    faults += _alive(children, start)
    made = watch.changes(before, watch.look(place))
    if process.returncode not in (0, 1):
        faults += _wrong(verb, how, process.returncode, told, made)
    if how == signal.SIGKILL:
        faults += _not_swept(place, env)
    return Ended(verb, how, at_s, process.returncode, took_s, told.strip(), faults)


def _wrong(verb: str, how: signal.Signals, code: int, told: str, made: list[str]) -> list[str]:
    found = [f"took: {one}" for one in made if not one.startswith("made")]
    if how == signal.SIGKILL:
        return found
    if code != _CODES[how]:
        found.append(f"exit code {code}")
    if not re.fullmatch(r"error: (?:interrupted|terminated), [^\n]+\n", told):
        found.append("standard error is not one true line")
    if "nothing was written" in told and made:
        found.append(f"not nothing: {made[:3]}")
    if ".chord-usd-" in str(made):
        found.append("a hidden folder is left")
    if made and not verb.startswith(_RUNS) and not re.search("written|kept", told):
        found.append(f"left {made[:3]} without a word")
    return found


def _not_swept(place: Path, env: dict[str, str]) -> list[str]:
    """What is still hidden after the next run in the same folders."""
    left = list(place.rglob(".chord-usd-*/"))
    for folder in {one.parent for one in left}:
        words = ["plan", "draw", "plan.json", "-o", str(folder / "next.png"), "--progress", "none"]
        command = [sys.executable, "-m", "chord_usd.cli", *words]
        cwd = place.parent / "samples"
        subprocess.run(command, cwd=cwd, env=env, check=False, capture_output=True)
    still = [one.name for one in left if one.exists()]
    return [f"not cleared away: {still}"] if still else []


def below(pid: int) -> Iterator[tuple[int, str]]:
    """Processes that one has started, and what tells each from a later one of its number."""
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            for child in map(int, (task / "children").read_text().split()):
                with contextlib.suppress(OSError):
                    yield child, _started(child)
                    yield from below(child)


def _started(pid: int) -> str:
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[19]


def _alive(children: list[tuple[int, str]], since: float) -> list[str]:
    """Those that are not gone SOON_S after the signal."""
    while True:
        there = []
        for pid, started in children:
            with contextlib.suppress(OSError):
                state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
                if state != "Z" and _started(pid) == started:
                    there.append(pid)
        if not there or time.monotonic() - since > SOON_S:
            break
        time.sleep(0.05)
    names = [Path(f"/proc/{pid}/cmdline").read_bytes()[-60:] for pid in there if _is(pid)]
    return [f"still runs: {names}"] if names else []


def _is(pid: int) -> bool:
    return Path(f"/proc/{pid}").exists()


def prepared(folder: Path) -> dict[str, str]:
    """Lay out the samples; returns the environment of the runs."""
    for name in ("cache", "tmp"):
        (folder / name).mkdir()
    os.environ["CHORD_USD_CACHE"] = str(folder / "cache")
    samples.make(folder / "samples")
    return os.environ | {"TMPDIR": str(folder / "tmp"), "PYTHONPATH": str(ROOT)}


def work(folder: Path, verbs: list[str], rounds: int, rng: Random, write: bool) -> int:
    """So many rounds over the verbs; 1 if there was a fault."""
    env, ended = prepared(folder), []
    for number in range(rounds):
        for verb in verbs:
            signals = [signal.SIGINT, signal.SIGTERM]
            for how in [*signals, *([signal.SIGKILL] if verb in _KILLED else [])]:
                place = folder / f"{number}_{verb.replace(' ', '_')}_{how.name}"
                place.mkdir()
                for name in _INPUTS:
                    source = folder / "samples" / name
                    copy = shutil.copytree if source.is_dir() else shutil.copyfile
                    copy(source, place / name)
                at_s = rng.uniform(_STARTS_S, _LATEST_S)
                one = interrupted(verb, how, at_s, place, env)
                ended.append(one)
                shutil.rmtree(place)
                told = one.told[-110:]
                line = (
                    f"{verb:18} {how.name:7} at {at_s:4.1f} s: {one.code:4} in {one.took_s:4.2f} s"
                )
                sys.stdout.write(f"{line}  {told!r} {one.faults or ''}\n")
                sys.stdout.flush()
    hit = [one for one in ended if one.was_hit]
    slow = [one for one in hit if one.took_s > SOON_S]
    faulty = [one for one in hit if one.faults]
    rows = [
        ("signals sent", f"{len(ended)} to {len(verbs)} verbs, {len(hit)} before the verb's end"),
        ("faults", f"{len(faulty)}, of which {len(slow)} ended later than {SOON_S:g} s"),
        ("time to the end", f"median {_median(hit):.2f} s, most {_most(hit):.2f} s"),
    ]
    if write:
        write_section("Interrupts", rows, "`python benchmarks/interrupts.py`")
    sys.stdout.write("".join(f"{name}: {value}\n" for name, value in rows))
    return 1 if faulty else 0


def _median(ended: list[Ended]) -> float:
    times = sorted(one.took_s for one in ended)
    return times[len(times) // 2] if times else 0.0


def _most(ended: list[Ended]) -> float:
    return max((one.took_s for one in ended), default=0.0)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", action="append", choices=list(VERBS), metavar="VERB")
    parser.add_argument("--write", action="store_true", help="write the figures to RESULTS.md")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="chord-usd-interrupts-") as folder:
        verbs = options.only or list(VERBS)
        rng = Random(options.seed)
        return work(Path(folder).resolve(), verbs, options.rounds, rng, options.write)


if __name__ == "__main__":
    sys.exit(main())
