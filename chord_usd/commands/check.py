"""check: stage -> report, exit code 0 only if the certificate holds."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from chord_usd.commands.common import Outcome, Verbs, add_verb, existing_file, stopwatch

OUTLIERS_TOLD = 3
"""How many of the least expected items the report names."""


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "check", run, "certify a stage: valid, walkable, free of collisions")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.stage.check import certificate, check_stage

    with stopwatch(options).step("check"):
        report = check_stage(existing_file(options.stage))
    data = certificate(report)
    return Outcome(_text(options.stage, report.holds, data), data, report.holds)


def _text(stage: Path, holds: bool, data: dict[str, Any]) -> str:
    lines = [f"{stage}: the certificate {'holds' if holds else 'does not hold'}"]
    lines += [f"  {e['rule']}: {e['path']}: {e['message']}" for e in data["errors"]]
    lines += [
        f"  collision {c['depth_m'] * 100:.1f} cm: {c['a']} and {c['b']}"
        for c in data["collisions"]
    ]
    for key in ("out_of_room", "blocked_openings", "unsupported", "empty_rooms", "stairs"):
        lines += [f"  {key.replace('_', ' ')}: {path}" for path in data[key]]
    lines.append(
        f"  walkable {data['walkable']:.0%}, reachable rooms {data['reachable_rooms']:.0%}, "
        f"POR {data['por']:.4f} and PIoU {data['piou']:.4f} over {data['pairs']} pairs"
    )
    lines.append(f"  rooms complete {data['complete']:.0%}, right {data['right']:.0%}")
    if data["home_lacks"]:
        lines.append(f"    the home has no {', no '.join(data['home_lacks'])}")
    lines += [f"    {one['path']} lacks {', '.join(one['pieces'])}" for one in data["missing"]]
    lines += [f"    {one['item']} is {one['fault']}" for one in data["misplaced"]]
    lines += _outliers(data["ood"])
    return "\n".join(lines)


def _outliers(ood: list[dict[str, Any]]) -> list[str]:
    """What the layout model expected least."""
    if not ood:
        return []
    mean = sum(one["score"] for one in ood) / len(ood)
    lines = [f"  out of distribution: {mean:.2f} on average over {len(ood)} items; most:"]
    return lines + [f"    {one['score']:.2f} {one['path']}" for one in ood[:OUTLIERS_TOLD]]
