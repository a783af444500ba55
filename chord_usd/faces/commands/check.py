"""check: stage -> report, exit code 0 only if the certificate holds."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.certified import holds
from chord_usd.faces.commands.check_preview import draw_report, worst_of
from chord_usd.faces.commands.common import Outcome, Verbs, add_verb, existing_file, stopwatch
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.base.metrics.design import Design
    from chord_usd.line.stage.check.check_stage import Report
    from chord_usd.line.stage.check.pulled import Pulled

OUTLIERS_TOLD = 3
"""How many of the least expected items the report names."""


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "check", run, "certify a stage: valid, walkable, free of collisions")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    parser.add_argument(
        "--preview", type=output_file, metavar="PNG",
        help="also draw the house from above with all that was found",
    )  # fmt: skip
    parser.add_argument(
        "--open", action="store_true",
        help="also pull every door, drawer and flap by force, alone, in MuJoCo (30 N m or 80 N)",
    )  # fmt: skip
    add_options(parser, "standard")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.metrics.design.standard import standards_in
    from chord_usd.line.stage.check.check_stage import certificate, check_stage

    standards = standards_in(options.standard or "")
    watch = stopwatch(options)
    with watch.step("check"):
        report = check_stage(existing_file(options.stage), standards=standards)
        if options.preview:
            draw_report(options.stage, report, options.preview)
    data = certificate(report)
    text = _text(options.stage, report, data)
    if not options.open:
        return Outcome(text, data, holds(data))
    with watch.step("open"):
        from chord_usd.line.stage.check.pulled import pull_joints

        pulled = pull_joints(options.stage)
    data["pulled"] = [asdict(pull) for pull in pulled]
    text = "\n".join([text, *_by_force(report, pulled)])
    return Outcome(text, data, holds(data) and not any(pull.is_stuck for pull in pulled))


def _text(stage: Path, report: Report, data: dict[str, Any]) -> str:
    lines = [f"{stage}: the certificate {'holds' if report.holds else 'does not hold'}"]
    lines += [f"  {fault}" for fault in report.faults]
    lines.append(
        f"  walkable {data['walkable']:.0%}, reachable rooms {data['reachable_rooms']:.0%}, "
        f"POR {data['por']:.4f} and PIoU {data['piou']:.4f} over {data['pairs']} pairs"
    )
    lines.append(f"  rooms complete {data['complete']:.0%}, right {data['right']:.0%}")
    lines += [f"    {flaw}" for flaw in report.flaws]
    lines += _opens(report)
    lines += _design(report.design)
    for kept in report.standards:
        lines += [f"  {kept.summary}", *(f"    {line}" for line in kept.lines)]
        lines += [f"    not checked: {clause.name}, {clause.text}" for clause in kept.unchecked]
    lines += _outliers(data["ood"])
    return "\n".join(lines)


def _design(design: Design) -> list[str]:
    """Planning rules by room, the broken ones in centimetres with source and place."""
    lines = [f"  planning rules kept {design.share:.0%}"]
    for judged in (*design.rooms, design.home):
        lines.append(
            f"    {judged.place or 'home'} ({judged.kind}): {len(judged.kept)} of {judged.asked}"
        )
        for finding in worst_of(judged):
            x, y = finding.at
            lines.append(f"      {finding.said} ({finding.source}), at {x:.2f}, {y:.2f} m")
    return lines


def _opens(report: Report) -> list[str]:
    """How many doors and drawers open; flaws and faults name the others."""
    if not report.opens:
        return []
    free = len(report.opens) - len(report.shut)
    leaves = counted(len(report.opens), "leaf", "leaves")
    return [f"  {free} of {leaves} of furniture (doors, drawers, flaps) open"]


def _by_force(report: Report, pulled: Sequence[Pulled]) -> list[str]:
    """How many joints open by force, the others, and where the certificate says otherwise."""
    from chord_usd.line.stage.check.pulled import OPEN_SHARE, contradictions

    shut = [pull for pull in pulled if not pull.is_open]
    count = counted(len(pulled), "joint")
    return [
        f"  by force {len(pulled) - len(shut)} of {count} open to {OPEN_SHARE:.0%} of their range",
        *(f"    {pull.path} stops at {pull.share:.0%}" for pull in shut),
        *(f"    {line}" for line in contradictions(report.opens, pulled)),
    ]


def _outliers(ood: list[dict[str, Any]]) -> list[str]:
    """What the layout model expected least."""
    if not ood:
        return []
    mean = sum(outlier["score"] for outlier in ood) / len(ood)
    lines = [
        f"  out of distribution: {mean:.2f} on average over {counted(len(ood), 'item')}; most:"
    ]
    return lines + [
        f"    {outlier['score']:.2f} {outlier['path']}" for outlier in ood[:OUTLIERS_TOLD]
    ]
