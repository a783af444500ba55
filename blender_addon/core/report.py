"""The certificate of a house as lines that an artist can read and click."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong, and the prims to look at."""

    text: str
    paths: tuple[str, ...]


def findings(report: Mapping[str, Any]) -> list[Finding]:
    """What `check --json` complains about, worst first. Unknown keys are passed over."""
    found = [
        Finding(f"{short(pair['a'])} and {short(pair['b'])} collide", (pair["a"], pair["b"]))
        for pair in report.get("collisions", ())
    ]
    for key, words in (
        ("out_of_room", "stands out of its room"),
        ("blocked_openings", "is blocked"),
        ("unsupported", "hangs in the air"),
        ("empty_rooms", "is empty"),
    ):
        found += [Finding(f"{short(path)} {words}", (path,)) for path in report.get(key, ())]
    for error in report.get("errors", ()):
        path = str(error.get("path", ""))
        found.append(Finding(f"{error.get('rule')}: {error.get('message')}", (path,)))
    return found


def headline(report: Mapping[str, Any]) -> str:
    """The certificate in one line."""
    count = len(findings(report))
    walkable = float(report.get("walkable", 0.0))
    verdict = "Certified" if report.get("valid") and not count else f"{count} findings"
    return f"{verdict}; {walkable:.0%} of the floor is walkable"


def short(path: str) -> str:
    """Room and piece of a USD path: /House/Rooms/Bedroom_0/Furniture/Bed_0 is Bedroom_0/Bed_0."""
    parts = [part for part in path.split("/") if part]
    kept = [part for part in parts[2:] if part not in ("Furniture", "Architecture", "Items")]
    return "/".join(kept) or path
