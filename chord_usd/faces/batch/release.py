"""A folder of houses as a data set: what tells others what it holds, how it was made and what may
be done with it, beside the houses."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, median
from typing import Any

from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.targets import Manifest, not_ours
from chord_usd.faces.batch.failures import failures_in
from chord_usd.faces.batch.lock import LOCK_FILE
from chord_usd.faces.batch.make import SCENE_FILE
from chord_usd.faces.batch.records import (
    HOUSE_RECORD,
    Digests,
    Record,
    files_in,
    read_costs,
    read_record,
)
from chord_usd.faces.batch.release_card import card

CARD_FILE = "README.md"
LICENCE_FILE = "LICENSE.txt"
SPLITS_FILE = "splits.json"
STATISTICS_FILE = "statistics.json"
CHECKSUMS_FILE = "checksums.sha256"

_MANY = 100_000
"""Houses that the cost is worked out for, too."""

_LICENCE = """\
The houses of this data set are dedicated to the public domain: CC0 1.0 Universal
(SPDX: CC0-1.0, https://creativecommons.org/publicdomain/zero/1.0/).

That holds for the stages, their built-in furniture, materials and textures, the plans, layouts,
scene graphs and pictures. The skies are those that come with Blender, CC0-1.0, too. A house with
furniture of other libraries says so in its house_attribution.txt, whose terms hold for that.
The program that made them, chord-usd, is AGPL-3.0-or-later; that does not bind what it makes.
"""


@dataclass(frozen=True)
class Release:
    """What a data set holds."""

    records: dict[str, Record]
    """Of the houses that were made, by name."""
    bytes: int
    """On disk; what houses share counts once."""
    cpu_s: float
    """Seconds of a processor core for a house, the median: neighbours do not slow these."""

    @property
    def holding(self) -> list[str]:
        """Names of the houses whose certificate holds: the splits are of these."""
        return [name for name, record in self.records.items() if record.told["holds"]]

    @property
    def splits(self) -> dict[str, list[str]]:
        """Names by part; a house keeps its part whatever other houses come and go."""
        from chord_usd.workshop.data.splits import part_of

        parts: dict[str, list[str]] = {"train": [], "test": []}
        for name in self.holding:
            parts[part_of(name)].append(name)
        return parts

    @property
    def split_hash(self) -> str:
        """What names this set of houses."""
        from chord_usd.workshop.data.splits import split_hash

        return split_hash(self.holding)

    def figure(self, name: str) -> float:
        """Mean over the houses of a figure of their records."""
        return mean([float(record.told[name]) for record in self.records.values()] or [0.0])

    @property
    def megabytes(self) -> float:
        """Of a house on disk, its part of what is shared included."""
        return self.bytes / 1e6 / max(len(self.records), 1)

    @property
    def summary(self) -> str:
        """In words, with what many houses would cost."""
        days = self.cpu_s * _MANY / 86400
        return (
            f"{len(self.holding)} of {len(self.records)} houses in the splits; a house takes "
            f"{self.cpu_s:.1f} s of a core and {self.megabytes:.1f} MB: {_MANY:,} of them "
            f"{days:.0f} days of one core and {self.megabytes * _MANY / 1e6:.1f} TB"
        )

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "houses": len(self.records),
            "holding": len(self.holding),
            "split_hash": self.split_hash,
            **{name: len(part) for name, part in self.splits.items()},
            "cpu_s_per_house": round(self.cpu_s, 2),
            "megabytes_per_house": round(self.megabytes, 2),
            "bytes": self.bytes,
        }


def require_own(folder: Path) -> None:
    """Raises OutputError where a file of somebody else has the name of one of the release's."""
    manifest = Manifest(folder)
    for name in (CARD_FILE, LICENCE_FILE, SPLITS_FILE, STATISTICS_FILE, CHECKSUMS_FILE):
        if (folder / name).exists() and not manifest.lists(folder / name):
            raise not_ours(folder / name)


def write_release(folder: Path, names: Sequence[str]) -> Release:
    """Write card, licence, splits, statistics and checksums beside the houses of these names.

    Houses that were not made are left out; those whose certificate does not hold are in the folder
    and in no split. Files that somebody changed are kept as NAME.changed. checksums.sha256 is what
    `sha256sum -c` takes. Raises OutputError.
    """
    failed = failures_in(folder)
    files = {
        name: read_record(folder / name / HOUSE_RECORD) for name in names if name not in failed
    }
    records = {name: record for name, record in files.items() if record}
    release = Release(records, _bytes_of(folder), _cpu_s(folder, records))
    splits = {"hash": release.split_hash, **release.splits}
    _write(folder / SPLITS_FILE, json.dumps(splits, indent=1) + "\n")
    _write(folder / STATISTICS_FILE, json.dumps(_statistics(folder, release), indent=1) + "\n")
    _write(folder / LICENCE_FILE, _LICENCE)
    _write(folder / CARD_FILE, card(release))
    # Last: they are of all the others.
    _write(folder / CHECKSUMS_FILE, "".join(f"{d}  {n}\n" for n, d in _digests(folder)))
    return release


def _write(path: Path, text: str) -> None:
    write_atomic(path, text, asked=False)


def _cpu_s(folder: Path, names: Iterable[str]) -> float:
    """Median over the houses that note their costs."""
    costs = [read_costs(folder / name).get("house") for name in names]
    return float(median([cost["cpu_s"] for cost in costs if cost] or [0.0]))


def _bytes_of(folder: Path) -> int:
    """What is there, each hard link once."""
    sizes = {(stat.st_dev, stat.st_ino): stat.st_size for stat in map(Path.stat, files_in(folder))}
    return sum(sizes.values())


def _digests(folder: Path) -> Iterator[tuple[str, str]]:
    """Paths and SHA-256 of all files, by path."""
    digests = Digests()
    for file in files_in(folder):
        name = file.relative_to(folder).as_posix()
        if name not in (CHECKSUMS_FILE, LOCK_FILE):
            yield name, digests.of(file)


def _statistics(folder: Path, release: Release) -> dict[str, Any]:
    from chord_usd.base.scene.chord_json import read_scene
    from chord_usd.workshop.data.statistics import count_houses

    return count_houses(
        read_scene(folder / name / SCENE_FILE) for name in release.records
    ).as_json()
