"""A kept set: chosen houses to learn from, as one compact file that later runs extend.

Gzip of UTF-8 lines. The first is a header, {"format": FORMAT, "version": VERSION}; each further
line holds the first 16 hex digits of the SHA-256 of the rest of the line, a tab, and a JSON object
{"name", "scores", "house"}: the house is CHOrD JSON of its shell and its furniture.
"""

from __future__ import annotations

import gzip
import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.errors import SceneError
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.json_lines import read_lines
from chord_usd.base.scene.chord_json import scene_from_json, scene_to_json
from chord_usd.base.scene.types import Provenance, SceneGraph
from chord_usd.workshop.data.searched import price_of

FORMAT, VERSION = "chord-usd kept set", 1
SUFFIX = ".jsonl.gz"


@dataclass(frozen=True, eq=False)
class KeptHouse:
    """A house that was chosen."""

    name: str
    """Unique in the set; its hash decides whether the house is held out (splits.part_of)."""
    house: SceneGraph
    scores: Mapping[str, float] = field(default_factory=dict)
    """Why it was chosen, by the names of the scores."""


def best_of(houses: Sequence[KeptHouse], share: float) -> list[KeptHouse]:
    """This share of the houses, in (0, 1], with their prices: those whose rooms break the fewest
    planning rules, in their order."""
    if share >= 1.0:
        return list(houses)
    price = [price_of(kept.house) / len(kept.house.rooms) for kept in houses]
    best = np.argsort(price, kind="stable")[: max(1, round(share * len(price)))]
    return [replace(houses[at], scores={"price": round(price[at], 4)}) for at in sorted(best)]


def write_kept(houses: Iterable[KeptHouse], target: Path) -> int:
    """Write a set, and return how many houses it holds; of several with one name the first stays.

    The same houses give the same bytes.
    """
    lines = {kept.name: _line_of(kept) for kept in reversed(list(houses))}
    header = json.dumps({"format": FORMAT, "version": VERSION})
    text = "\n".join([header, *(lines[name] for name in sorted(lines))]) + "\n"
    write_atomic(target, gzip.compress(text.encode(), compresslevel=9, mtime=0))
    return len(lines)


def read_kept(source: Path) -> list[KeptHouse]:
    """The houses of a set. Raises SceneError where it is none, or a row of it was changed."""
    lines = read_lines(source, SceneError)
    _, header = next(lines, (1, b""))
    _require_header(header, source)
    return [_house_of(line, number, source) for number, line in lines]


def _line_of(kept: KeptHouse) -> str:
    bare = replace(
        kept.house,
        items=tuple(replace(item, asset=None, children=()) for item in kept.house.items),
        dressing=(),
        provenance=Provenance(),
    )
    row = {"name": kept.name, "scores": dict(kept.scores), "house": scene_to_json(bare)}
    text = json.dumps(row, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return f"{_hash_of(text.encode())}\t{text}"


def _hash_of(text: bytes) -> str:
    return hashlib.sha256(text).hexdigest()[:16]


def _require_header(line: bytes, source: Path) -> None:
    try:
        header = json.loads(line)
    except ValueError:
        header = None
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise _unusable(source, "is no kept set")
    if header.get("version") != VERSION:
        raise _unusable(source, f"is a kept set of another version ({header.get('version')!r})")


def _house_of(line: bytes, number: int, source: Path) -> KeptHouse:
    digest, _, text = line.rstrip(b"\n").partition(b"\t")
    if digest.decode(errors="replace") != _hash_of(text):
        raise _unusable(source, f"line {number} was changed: its hash does not match")
    row: dict[str, Any] = json.loads(text)
    house = scene_from_json(row["house"], f"{source.name}, line {number}")
    return KeptHouse(row["name"], house, row["scores"])


def _unusable(source: Path, what: str) -> SceneError:
    return SceneError(
        what,
        where=str(source),
        expected=f"a kept set of version {VERSION}",
        try_="chord-usd dataset keep HOUSES -o FILE.jsonl.gz",
    )
