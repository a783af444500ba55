"""Files of scores, a JSON line each: a long measurement goes on where it was stopped."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from chord_usd.base.errors import OutputError
from chord_usd.base.runtime.files import write_atomic

Entry = TypeVar("Entry")


def add_record(path: Path, values: Mapping[str, Any]) -> None:
    """Add a line, at once."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(values) + "\n")


def read_records(
    path: Path, entry_of: Callable[[dict[str, Any]], Entry], what: str, verb: str
) -> list[Entry]:
    """The lines of a file, which need not exist; a last one that was cut short is taken off.

    what: of what they are scores, and verb: which command wrote them, for errors. Raises
    OutputError where entry_of cannot make an entry of a line.
    """
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    whole = text[: text.rfind("\n") + 1]
    entries = []
    for place, line in enumerate(whole.splitlines(), 1):
        try:
            entries.append(entry_of(json.loads(line)))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise OutputError(
                f"is no score of {what}",
                where=f"{path}: line {place}",
                expected=f"the file that {verb} --records wrote",
                try_="another file",
            ) from error
    # A run that was stopped may have left half a line. Somebody else's file is not cut short.
    if whole != text and (entries or text.startswith('{"')):
        write_atomic(path, whole)
    return entries
