"""The tables of designs beside the geometry: what retrieval knows without drawing a mesh.

A folder of the library has `designs.tsv`, a row a family of designs that differ in size only, and
`colours.tsv`, a row a colourway. CONTRIBUTING.md has the columns. Nothing here imports geometry.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from pathlib import Path

FOLDERS = (
    *("seating", "beds", "tables", "storage", "lighting", "plants", "kitchen", "bath"),
    *("textiles", "pictures", "objects", "fittings"),
)
"""Folders of the library that hold designs."""

SHARED = "*"
"""Colourway of a row whose finishes all colourways of the set have."""

_EDITIONS = tuple(f"_{letter}" for letter in "BCDEFGH")
"""Ends of ids of further editions."""

SizeM = tuple[float, float, float]
Colourways = dict[str, dict[str, str]]


@dataclass(frozen=True)
class Entry:
    """A design of the tables: its facts, and the cells that say how it is drawn."""

    id: str
    category: str
    size_m: SizeM
    styles: tuple[str, ...]
    """Names of the styles whose form it has; empty where it suits them all."""
    tags: tuple[str, ...]
    folder: str
    draw: str
    """`module.function(key=value)` of the folder, as catalogue.resolved reads it."""
    colours: str
    """Name of a set of colourways in the folder's colours.tsv."""
    finishes: str
    light: str
    """`x y z, radius, lumens` in metres and lumens; "" where it does not shine."""


@lru_cache(maxsize=1)
def entries() -> dict[str, Entry]:
    """All designs by id, sorted by category and id."""
    designs = [entry for folder in FOLDERS for row in _rows(folder, "designs") for entry in
             _family(folder, row)]  # fmt: skip
    designs.sort(key=lambda entry: (entry.category, entry.id))
    return {entry.id: entry for entry in designs}


@lru_cache(maxsize=len(FOLDERS))
def colour_sets(folder: str) -> dict[str, Colourways]:
    """Sets of colourways of a folder by name: colourway to slot to finish, the first is default."""
    shared: dict[str, dict[str, str]] = {}
    sets: dict[str, Colourways] = {}
    for row in _rows(folder, "colours"):
        slots = dict(pair.split("=") for pair in (row["finishes"] or "").split())
        if row["colourway"] == SHARED:
            shared[row["set"]] = slots
            continue
        ways = sets.setdefault(row["set"], {})
        ways[row["colourway"]] = {**shared.get(row["set"], {}), **slots}
    return sets


def _rows(folder: str, table: str) -> Iterator[dict[str, str]]:
    path = Path(__file__).parent / folder / f"{table}.tsv"
    with path.open(encoding="utf-8", newline="") as file:
        yield from csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE, restval="")


def _family(folder: str, row: dict[str, str]) -> Iterator[Entry]:
    """A design for each size and edition of a row; {l}, {w} and {h} of its id are centimetres.

    Editions differ in name alone, by which drawings draw their chances.
    """
    styles, tags = tuple(row["styles"].split()), tuple(row["tags"].split())
    drawn = (folder, row["draw"], row["colours"], row["finishes"], row["light"])
    for size_m in sizes_m(row["size_m"]):
        length, width, height = (f"{100 * side:.0f}" for side in size_m)
        name = row["id"].format(l=length, w=width, h=height)
        for edition in ("", *_EDITIONS[: int(row.get("editions") or 1) - 1]):
            yield Entry(name + edition, row["category"], size_m, styles, tags, *drawn)


def sizes_m(cell: str) -> Iterator[SizeM]:
    """Sizes of a cell `lengths, widths, heights; …`: every combination of each such group.

    A side is `0.5 0.65 0.8`, or `0.5:0.8:0.15` for first, last and step, in metres.
    """
    for group in cell.split(";"):
        lengths, widths, heights = (tuple(_side_m(side)) for side in group.split(","))
        yield from product(lengths, widths, heights)


def _side_m(cell: str) -> Iterator[float]:
    if ":" not in cell:
        yield from map(float, cell.split())
        return
    first, last, step = map(float, cell.split(":"))
    for index in range(round((last - first) / step) + 1):
        yield round(first + step * index, 3)
