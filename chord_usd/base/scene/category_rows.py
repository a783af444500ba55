"""The cells of categories.tsv, for readers that need no numbers: command lines, label sets."""

from __future__ import annotations

import csv
from functools import cache
from pathlib import Path

_FILE = Path(__file__).with_name("categories.tsv")


@cache
def category_rows() -> dict[str, dict[str, str]]:
    """By name, cells by column; rows of the level `label` included."""
    lines = _FILE.read_text(encoding="utf-8").splitlines()
    return {row["name"]: row for row in csv.DictReader(lines, delimiter="\t", restval="")}
