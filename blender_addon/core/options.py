"""Options of a house, as chord-usd lists them in its table (options.json is a copy of it)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .errors import InputError

ROWS: tuple[Mapping[str, Any], ...] = tuple(
    json.loads(Path(__file__).with_name("options.json").read_text(encoding="utf-8"))
)
"""In the order of the panel: name, label, help, kind, default, range or choices, word, verbs."""

FOLDERS = "asset_folders"
"""The row of folders; the panel has a field for one."""

OF_FILES = ("m_per_px", "part")
"""Rows that decide how a file is read: a text has none."""


def usual(row: Mapping[str, Any]) -> Any:
    """The value of a field at first; 0 and "" are none."""
    return row["default"] if row["default"] not in (None, []) else 0 if "least" in row else ""


def words_of(chosen: Mapping[str, Any], verb: str) -> list[str]:
    """Words of a verb's command line for fields by name; none for usual values.

    Raises InputError for a folder that does not exist.
    """
    words: list[str] = []
    for row in ROWS:
        value = chosen.get(row["name"], usual(row))
        if verb not in row["verbs"] or value in (usual(row), ""):
            continue
        if row["name"] == FOLDERS:
            value = _existing_folder(value)
        words.append(
            f"--{row['word']}" if row["kind"] == "check" else f"--{row['word']}={_text(value)}"
        )
    return words


def _existing_folder(text: str) -> str:
    path = Path(text).expanduser()
    if not path.is_dir():
        raise InputError(f"The assets folder {path} is not there.")
    return str(path)


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value).strip()
