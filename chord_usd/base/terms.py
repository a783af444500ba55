"""How each surface names options and steps: one table, so that a message says them in its terms.

A message refers to an option or a step by its name in terms.tsv, in angle brackets, with a value
where one is meant: <m_per_px>, <device=cpu>, <plan read>. An empty cell says that a surface has
nothing of the kind; whatever refers to it is left out there.
"""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path

VARIABLE = "CHORD_USD_SURFACE"
"""Names the surface for which a process words its messages; another program than ours may set it
before it calls the command line."""

SURFACES = ("command", "python", "page", "panel", "agent")

_JOINED = {"command": " ", "python": "=", "page": ": ", "panel": ": ", "agent": "="}
"""What stands between a name and its value where the cell has no brackets for it."""

_REFERENCE = re.compile(r"<([a-z_]+(?: [a-z]+)?)(?:=([^<>]*))?>")
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
_PLACE = re.compile(r"\[([^\]]*)\]")


def surface() -> str:
    """The surface for which this process words its messages; python where nobody has said so."""
    chosen = os.environ.get(VARIABLE, "")
    return chosen if chosen in SURFACES else "python"


@contextmanager
def wording_for(name: str) -> Iterator[None]:
    """Word messages for a surface, here and in processes that are started meanwhile."""
    before = os.environ.get(VARIABLE)
    os.environ[VARIABLE] = name
    try:
        yield
    finally:
        if before is None:
            del os.environ[VARIABLE]
        else:
            os.environ[VARIABLE] = before


@cache
def names() -> Mapping[str, Mapping[str, str]]:
    """The rows of the table by name: the cell of each surface."""
    with Path(__file__).with_name("terms.tsv").open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)
        return {row["name"]: {key: row[key] or "" for key in SURFACES} for row in rows}


def named(name: str, value: str = "", to: str = "", *, is_bare: bool = False) -> str:
    """An option or a step as a surface calls it, with a value; "" where it has none.

    to: one of SURFACES; "" for that of this process. is_bare: without the word that stands for a
    value.
    """
    to = to or surface()
    cell = names()[name][to]
    if not cell or not value:
        return _PLACE.sub("" if is_bare else r"\1", cell).strip()
    if _PLACE.search(cell):
        return _PLACE.sub(lambda _: value, cell)
    return f"{cell}{_JOINED[to]}{value}"


def worded(text: str, to: str = "", *, is_bare: bool = False) -> str:
    """A message, or a part of it, with references in a surface's terms; "" where one is missing.

    Brackets with other names stay: they are part of what a user wrote.
    """
    references = [m for m in _REFERENCE.finditer(text) if m[1] in names()]
    said = {m[0]: named(m[1], m[2] or "", to, is_bare=is_bare) for m in references}
    if not all(said.values()):
        return ""
    for reference, words in said.items():
        text = text.replace(reference, words)
    return text


def without_options(text: str, to: str) -> str:
    """What the command line says of its own options, in the terms of another surface."""
    rows = {row["command"].split(" ")[0].rstrip(","): row[to] for row in names().values()}

    def named_there(match: re.Match[str]) -> str:
        return _PLACE.sub(r"\1", rows.get(match[0], "")) or match[0].strip("-").replace("-", " ")

    return _OPTION.sub(named_there, text)


def reference_in(text: str) -> str:
    """The name of the first reference of a text; "" without any."""
    return next((m[1] for m in _REFERENCE.finditer(text) if m[1] in names()), "")


def with_step(message: str, step: str) -> str:
    """A warning, and what would help, where the surface of this process has it."""
    said = worded(step)
    return f"{message}{said}" if said else message


def either(steps: Sequence[str]) -> str:
    """Several steps in words: "a, b, or c"."""
    *first, last = steps
    return f"{', '.join(first)}, or {last}" if first else last
