"""The certificate of a house as lines that an artist can read and click."""

from __future__ import annotations

import re
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
    entries = [
        Finding(f"{short(pair['a'])} and {short(pair['b'])} collide", (pair["a"], pair["b"]))
        for pair in report.get("collisions", ())
    ]
    for key, words in (
        ("out_of_room", "stands out of its room"),
        ("blocked_openings", "is blocked"),
        ("unsupported", "hangs in the air"),
        ("empty_rooms", "is empty"),
    ):
        entries += [Finding(f"{short(path)} {words}", (path,)) for path in report.get(key, ())]
    for room in report.get("unreachable", ()):
        entries.append(Finding(f"{short(room['path'])} cannot be reached", (room["path"],)))
    for fault in report.get("stairs", ()):
        entries.append(Finding(short(fault), (fault.split(" ")[0],)))
    for error in report.get("errors", ()):
        path = str(error.get("path", ""))
        entries.append(Finding(f"{error.get('rule')}: {error.get('message')}", (path,)))
    return entries


def planning(report: Mapping[str, Any]) -> list[Finding]:
    """Published planning numbers that `check --json` finds missed, the worst room first."""
    design = report.get("design") or {}
    places = [*design.get("rooms", ()), *filter(None, [design.get("home")])]
    places.sort(key=lambda place: place["rules_kept"] - place["rules"])
    return [
        Finding(
            f"{short(place['path']) if place['path'] else 'The home'}, {finding['rule']}: "
            f"{_in_units(finding, 'have')}, not {_in_units(finding, 'need')} "
            f"({finding['source']})",
            tuple(finding["items"] or filter(None, [place["path"]])),
        )
        for place in places
        for finding in place["findings"]
    ]


def _in_units(finding: Mapping[str, Any], which: str) -> str:
    unit = finding["unit"]
    if unit == "m":
        value = finding[f"{which}_m"]
        return "endless" if value is None else f"{100 * value:.0f} cm"
    value = finding[which]
    shown = {"deg": f"{value:.0f}°", "share": f"{value:.0%}"}
    return shown.get(unit, f"{value:g}")


def requests(contents: Mapping[str, Any], room: str) -> str:
    """What `describe --json` says that a room must and must not hold, in words."""
    rooms = (entry for entry in contents.get("rooms", ()) if entry["name"] == room)
    return str(next((entry.get("requests", "") for entry in rooms), ""))


def past(report: Mapping[str, Any]) -> list[tuple[int, str]]:
    """Number and words of each change that `history --json` lists, the latest first."""
    here = report["number"]
    lines = []
    for change in reversed(report["changes"]):
        verb = _VERBS_OF_OTHERS.get(change["verb"], change["verb"])
        words = f"{verb} {change['words']}".strip() if change["verb"] != "begin" else "As it was"
        mark = " (now)" if change["number"] == here else ""
        lines.append((int(change["number"]), f"{change['number']}: {words}{mark}"))
    return lines


_VERBS_OF_OTHERS = {"outside": "by hand, or by another program"}
"""What no verb of the program did; edits that this panel saves are among it."""


def planned(report: Mapping[str, Any]) -> list[str]:
    """What `generate --json` understood and planned, in words; nothing for a plan."""
    plan = report.get("planned")
    if not plan:
        return []
    rooms = "1 room" if plan["rooms"] == 1 else f"{plan['rooms']} rooms"
    wish = [f"Understood: {plan['understood']}"] if plan.get("understood") else []
    return [*wish, f"Planned: {rooms}, {plan['area_m2']:.0f} m²"]


def understood(report: Mapping[str, Any]) -> list[str]:
    """What `edit --dry-run --json` takes a sentence to mean, a line for each change."""
    slips = [f"Read {slip}" for slip in report.get("read_as", ())]
    texts = [str(entry["told"]) for entry in report["understood"]]
    return [*slips, *(f"{text[:1].upper()}{text[1:]}" for text in texts)]


def warnings(report: Mapping[str, Any]) -> list[str]:
    """What `generate --json` warns of, as sentences."""
    return [f"{text[:1].upper()}{text[1:]}" for text in report.get("warnings", ())]


def headline(report: Mapping[str, Any]) -> str:
    """The certificate in one line."""
    count = len(findings(report))
    walkable = float(report.get("walkable", 0.0))
    text = "1 finding" if count == 1 else f"{count} findings"
    verdict = "Certified" if report.get("holds", report.get("valid")) and not count else text
    return f"{verdict}; {walkable:.0%} of the floor is walkable"


def short(path: str) -> str:
    """Room and piece of a USD path: /House/Rooms/Bedroom_0/Furniture/Bed_0 is Bedroom_0/Bed_0."""
    parts = [part for part in path.split("/") if part]
    kept = [
        part for part in parts[2:] if part not in ("Furniture", "Dressing", "Architecture", "Items")
    ]
    return "/".join(kept) or path


@dataclass(frozen=True)
class Look:
    """A choice that a room or the house has."""

    path: str
    variant_set: str
    chosen: str
    offered: tuple[str, ...]

    @property
    def label(self) -> str:
        """What is chosen here: floorMaterial is Floor."""
        return _LOOK_LABELS.get(self.variant_set, spaced(self.variant_set))


_LOOK_LABELS = {
    "floorMaterial": "Floor",
    "wallMaterial": "Walls",
    "lighting": "Light",
    "roof": "Roof in pictures",
}


def spaced(name: str) -> str:
    """A name in words: OakHerringbone is Oak Herringbone, TVCabinet_0 is TV Cabinet 0."""
    starts = r"(?<=[a-z])(?=[A-Z0-9])|(?<=[A-Z])(?=[A-Z][a-z])"
    words = re.sub(starts, " ", name.replace("_", " "))
    return words[:1].upper() + words[1:]


def looks(contents: Mapping[str, Any]) -> list[Look]:
    """All choices of a house in the report of `describe --json`, the house's own first.

    The colours of its pieces are among them.
    """
    choices = _choices("/House", contents.get("looks", {}))
    for room in contents.get("rooms", ()):
        choices += _choices(room["path"], room.get("looks", {}))
        for piece in _pieces(room):
            choices += _choices(piece["component"], piece.get("looks", {}))
    return choices


def is_offered(contents: Mapping[str, Any], path: str, variant_set: str, variant: str) -> bool:
    """Whether a room, a piece or the house has this choice."""
    matches = (
        look for look in looks(contents) if (look.path, look.variant_set) == (path, variant_set)
    )
    return any(variant in look.offered for look in matches)


def models(contents: Mapping[str, Any]) -> dict[str, str]:
    """The model's name of each piece, by the path of what refers to it."""
    return {
        piece["component"]: piece["asset"]
        for room in contents.get("rooms", ())
        for piece in _pieces(room)
    }


def _pieces(room: Mapping[str, Any]) -> list[Any]:
    """Furniture and dressing; older programs report no dressing."""
    return [*room.get("furniture", ()), *room.get("dressing", ())]


def _choices(path: str, offered: Mapping[str, Any]) -> list[Look]:
    return [
        Look(path, name, choice["chosen"], tuple(choice["offered"]))
        for name, choice in offered.items()
        if len(choice["offered"]) > 1
    ]
