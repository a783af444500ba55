"""Twins by judges from outside: the share of faulty twins that they rate worse.

    python benchmarks/twins_outside.py TWINS NAME=COMMAND... [--stages] [--most N]

TWINS is a folder of dataset twins. COMMAND judges the file that is put at its end; one that ends
with 0 for the house and with another code for the twin has found the fault, as has one that prints
JSON of which any number falls that is a share of what is right. --stages judges the layers over
stages in place of JSON; --most takes so many pairs of each kind.
"""

from __future__ import annotations

import argparse
import json
import shlex
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

_SHARES = ("complete", "right", "rules_kept", "keep_all")
"""Keys of numbers that are the better the higher."""


@cache
def verdict(command: str, path: Path) -> tuple[int, tuple[tuple[str, float], ...]]:
    """Exit code, and the shares that the tool printed."""
    done = subprocess.run(
        [*shlex.split(command), str(path)], capture_output=True, text=True, check=False
    )
    try:
        return done.returncode, tuple(_shares(json.loads(done.stdout)))
    except ValueError:
        return done.returncode, ()


def _shares(value: object, place: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            if key in _SHARES and isinstance(inner, (int, float)):
                yield f"{place}/{key}", float(inner)
            yield from _shares(inner, f"{place}/{key}")


def is_found(command: str, house: Path, twin: Path) -> bool:
    """Whether the tool says that the twin is worse."""
    (code, before), (other, after) = verdict(command, house), verdict(command, twin)
    then = dict(after)
    return (code == 0 != other) or any(then.get(key, value) < value for key, value in before)


def main() -> None:
    """Prints, by kind of fault, how many each tool finds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("twins", type=Path)
    parser.add_argument("tools", nargs="+", metavar="NAME=COMMAND")
    parser.add_argument("--stages", action="store_true")
    parser.add_argument("--most", type=int, default=1_000_000)
    options = parser.parse_args()
    lines = (options.twins / "twins.jsonl").read_text().splitlines()
    keys = ("stage", "twin_stage") if options.stages else ("house", "twin")
    pairs, worse = Counter[str](), Counter[tuple[str, str]]()
    named: dict[str, bool] = {}
    for row in map(json.loads, lines):
        kind = row["fault"]
        if pairs[kind] >= options.most:
            continue
        pairs[kind] += 1
        named[kind] = row["named_by_a_rule"]
        house, twin = (options.twins / row[key] for key in keys)
        for tool in options.tools:
            name, _, command = tool.partition("=")
            worse[name, kind] += is_found(command, house, twin)
    lines = []
    for tool in options.tools:
        name = tool.partition("=")[0]
        for kind, count in pairs.items():
            said = "named" if named[kind] else "unnamed"
            lines.append(f"{name}: {kind} ({said}): {worse[name, kind]} of {count}")
        for is_named, said in ((True, "named"), (False, "unnamed")):
            kinds = [kind for kind in pairs if named[kind] == is_named]
            part = sum(worse[name, kind] for kind in kinds)
            lines.append(f"{name}: all {said}: {part} of {sum(pairs[kind] for kind in kinds)}")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
