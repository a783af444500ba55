"""Every reader and every verb with inputs made wrong, under watch: until nothing is found.

    python benchmarks/fuzz.py [--minutes N] [--seed N] [--only KIND]...
    python benchmarks/fuzz.py --seed N --case KIND/NUMBER    one case of it again

Exit code 1 says that something was found.

A run is good if it ends with exit code 0, 1 or 2, on 2 with one error line and nothing else, never
with a traceback or an "unexpected" error, in under 60 s of processor time, with under 1 GiB more
of resident memory in any of its processes, and without a byte changed outside of what -o names.
Most runs share one process; one in SHARE_WHOLE is a process of its own. Every kind gets the same
time, so that quick readers see thousands of inputs. A case depends on the seed, its kind and its
number only; what is found is kept in --folder, with the words to run it again.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from outside import odd_words, samples, watch  # noqa: E402
from outside.kinds import KINDS, NEEDS, mutator_of  # noqa: E402
from results import write_section  # noqa: E402

SHARE_WHOLE = 25
"""One in so many runs is a process of its own."""

WORDS = {"text": odd_words.text, "options": odd_words.options}
"""Kinds that are no files: what makes the words."""


@dataclass
class Case:
    """One input and the command line that reads it."""

    name: str
    words: list[str]
    env: dict[str, str] = field(default_factory=dict)


class Bench:
    """The folders of a run: samples, a case's own, and what is somebody else's."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder, self.seed = folder, seed
        self.env = os.environ | {
            "PYTHONPATH": str(ROOT), "CHORD_USD_CACHE": str(folder / "cache"),
            "HOME": str(folder / "home"), "TMPDIR": str(folder / "tmp"),
        }  # fmt: skip
        for name in ("cache", "home", "tmp", "found"):
            (folder / name).mkdir()
        os.environ["CHORD_USD_CACHE"] = str(folder / "cache")
        self.samples = samples.make(folder / "samples")
        samples.make_stranger(folder / samples.STRANGER)
        self.server = watch.Server(folder, self.env)

    def case(self, kind: str, number: int) -> Case:
        """Case of this number, its files laid out."""
        rng = Random(f"{self.seed}/{kind}/{number}")
        place = self.folder / "case"
        if place.exists():
            shutil.rmtree(place)
        (place / "in").mkdir(parents=True)
        (place / "out").mkdir()
        if kind in WORDS:
            words = WORDS[kind](rng)
            said, there = " ".join(words), self.samples.iterdir()
            self._lay(place / "in", {one.name for one in there if f"{{in}}/{one.name}" in said})
            return Case(f"{kind}/{number}", [_filled(word, "") for word in words])
        chosen = KINDS[kind]
        sample = rng.choice(chosen.samples)
        words = list(rng.choice(chosen.commands))
        said = " ".join(words)
        beside = {one for one in NEEDS if f"{{dir}}/{one}" in said}
        self._lay(place / "in", {sample, *beside})
        changed = place / "in" / sample
        if changed.is_dir():
            files = [one for pattern in chosen.changed for one in sorted(changed.rglob(pattern))]
            changed = rng.choice(files)
        data = mutator_of(changed.name)(changed.read_bytes(), rng)
        changed.unlink()  # it may be a link to the sample
        changed.write_bytes(data)
        env = {key: _filled(value, sample) for key, value in chosen.env.items()}
        return Case(f"{kind}/{number}", [_filled(word, sample) for word in words], env)

    def _lay(self, place: Path, names: set[str]) -> None:
        for name in names:
            source = self.samples / name
            if source.is_dir():
                shutil.copytree(source, place / name, copy_function=os.link)
            else:
                shutil.copyfile(source, place / name)

    def run(self, case: Case, *, whole: bool) -> tuple[watch.Run, list[str]]:
        """The run, and what is wrong with it."""
        outside = [self.folder / "cache", self.folder / "case" / "out", self.folder / "found"]
        before = watch.look(self.folder, outside)
        words = case.words if case.words[0] == "call" else [*case.words, "--progress", "none"]
        if whole and words[0] != "call":
            run = watch.whole(words, self.folder, self.env | case.env)
        else:
            run = self.server.run(words, case.env)
        return run, [*run.faults(), *watch.changes(before, watch.look(self.folder, outside))]

    def keep(self, case: Case, run: watch.Run, faults: list[str]) -> Path:
        """Keep what was found; returns its folder."""
        kept = self.folder / "found" / case.name.replace("/", "_").replace(" ", "_")
        if not kept.exists():
            shutil.copytree(self.folder / "case" / "in", kept)
            again = f"python benchmarks/fuzz.py --seed {self.seed} --case '{case.name}'"
            text = "\n".join([again, " ".join(map(repr, case.words)), *faults, run.told])
            (kept / "found.txt").write_text(text, errors="backslashreplace")
        return kept


def _filled(word: str, sample: str) -> str:
    names = {"{in}": f"case/in/{sample}", "{dir}": "case/in", "{out}": "case/out/made"}
    for mark, name in names.items():
        word = word.replace(mark, name)
    return word


def say(*lines: object) -> None:
    """Tell the terminal, at once."""
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    sys.stdout.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", action="append", choices=[*KINDS, *WORDS], metavar="KIND")
    parser.add_argument("--case", metavar="KIND/NUMBER", help="one case again, as a whole process")
    parser.add_argument("--folder", type=Path, help="a new folder (one of temporary files)")
    parser.add_argument("--write", action="store_true", help="write the figures to RESULTS.md")
    options = parser.parse_args()
    folder = options.folder or Path(tempfile.mkdtemp(prefix="chord-usd-fuzz-"))
    folder.mkdir(parents=True, exist_ok=True)
    bench = Bench(folder.resolve(), options.seed)
    try:
        if options.case:
            return again(bench, options.case)
        return fuzz(bench, options.only or [*KINDS, *WORDS], options.minutes * 60.0, options.write)
    finally:
        bench.server.close()


def again(bench: Bench, name: str) -> int:
    """One case, alone."""
    kind, number = name.rsplit("/", 1)
    case = bench.case(kind, int(number))
    run, faults = bench.run(case, whole=True)
    say(" ".join(map(repr, case.words)), run, *faults)
    return 1 if faults else 0


def fuzz(bench: Bench, kinds: list[str], seconds: float, write: bool) -> int:
    """Run cases of all kinds until the time is over; 1 if there was a finding."""
    spent, runs, codes = dict.fromkeys(kinds, 0.0), Counter[str](), Counter[object]()
    found: Counter[str] = Counter()
    longest, most_cpu, largest, wholes = 0.0, 0.0, 0, 0
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        kind = min(kinds, key=lambda one: (spent[one], one))
        start = time.monotonic()
        case = bench.case(kind, runs[kind])
        whole = runs[kind] % SHARE_WHOLE == SHARE_WHOLE - 1
        run, faults = bench.run(case, whole=whole)
        runs[kind] += 1
        wholes += whole
        codes[run.code] += 1
        spent[kind] += time.monotonic() - start
        longest, most_cpu = max(longest, run.wall_s), max(most_cpu, run.cpu_s)
        largest = max(largest, run.grown_bytes)
        if faults:
            kept = bench.keep(case, run, faults)
            found[kind] += 1
            say(f"{case.name}: {'; '.join(faults)[:300]}", f"    {run.told.strip()[-300:]}",
                f"    {kept}")  # fmt: skip
    rows = [
        ("runs", f"{runs.total()}, {wholes} of them as whole processes, in {seconds / 60:.0f} min"),
        ("by kind", ", ".join(f"{kind} {runs[kind]}" for kind in kinds)),
        ("exit codes", ", ".join(f"{code}: {codes[code]}" for code in sorted(codes, key=str))),
        ("findings", str(found.total())),
        ("longest run", f"{longest:.1f} s; most computing in one run {most_cpu:.1f} s"),
        ("most resident memory above the start", f"{largest / 2**20:.0f} MiB in one process"),
    ]  # fmt: skip
    if write:
        write_section("Inputs made wrong", rows, f"`python benchmarks/fuzz.py --seed {bench.seed}`")
    say(*(f"{name}: {value}" for name, value in rows))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
