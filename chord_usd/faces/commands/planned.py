"""plan from-text, plan from-outline, and what generate does of the same."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import deliver
from chord_usd.faces.commands.common import (
    Outcome,
    Parser,
    UsageError,
    Verbs,
    add_output,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options, settings_of

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Stopwatch
    from chord_usd.line.pipeline import Settings
    from chord_usd.line.pipeline.planner import Planned


def add(group: Verbs) -> None:
    """Adds the verbs to plan."""
    text = add_verb(group, "from-text", run_from_text, "plan the floor that a text asks for")
    text.add_argument("text", metavar="TEXT", help='such as "a two-bed flat of about 70 m²"')
    _add_options(text)
    outline = add_verb(
        group, "from-outline", run_from_outline, "divide an open plan, outer walls only, into rooms"
    )
    outline.add_argument(
        "outline", type=Path, metavar="OPEN_PLAN",
        help="drawing of outer walls with windows and doors, or a plan of one room",
    )  # fmt: skip
    outline.add_argument("--text", default="", metavar="TEXT", help="rooms of the home")
    add_options(outline, "m_per_px")
    _add_options(outline)


def _add_options(parser: Parser) -> None:
    add_output(
        parser, "the plan: plan.png, the raster, or plan.json, the vectors (CHOrD JSON)",
        suffixes=(".png", ".json"),
    )  # fmt: skip
    add_options(parser, "seed", "steps", "device")


def add_sources(parser: Parser) -> None:
    """generate's options in place of a plan."""
    source = parser.add_argument_group("instead of PLAN")
    source.add_argument("--text", default="", metavar="TEXT", help="furnish what a text asks for")
    source.add_argument(
        "--outline", type=Path, metavar="OPEN_PLAN",
        help="divide an open plan into rooms first; with --text, into these",
    )  # fmt: skip


def run_from_text(options: argparse.Namespace) -> Outcome:
    """Runs plan from-text."""
    return _run(options, None)


def run_from_outline(options: argparse.Namespace) -> Outcome:
    """Runs plan from-outline."""
    return _run(options, existing_file(options.outline))


def _run(options: argparse.Namespace, outline: Path | None) -> Outcome:
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import write_plan
    from chord_usd.line.pipeline import draw_plan

    suffix = options.output.suffix.lower()
    settings = settings_of(options)
    watch = stopwatch(options)
    with deliver() as delivery:
        target = delivery.place(options.output)
        planned = _planned(options.text, outline, settings, watch)
        if suffix == ".json":
            write_plan(planned.plan, target)
        else:
            write_raster(draw_plan(planned.plan), target)
    data = {"plan": str(options.output), **planned_report(planned), "seconds": watch.seconds}
    understood = f", for {data['understood']}" if data["understood"] else ""
    return Outcome(
        f"{options.output}: {counted(data['rooms'], 'room')}, {data['area_m2']:.0f} m²{understood}",
        data,
        warnings=planned.warnings,
    )


def _planned(text: str, outline: Path | None, settings: Settings, watch: Stopwatch) -> Planned:
    from chord_usd.line.pipeline.planner import plan_from_outline, plan_from_text

    with watch.step("plan") as progress:
        if outline is None:
            return plan_from_text(text, settings, progress)
        return plan_from_outline(outline, settings, text, progress)


def planned_report(planned: Planned) -> dict[str, Any]:
    """For --json: what was planned, and what of it was asked for."""
    from chord_usd.base.scene.wish import floor_area_m2, room_counts

    plan = planned.plan
    return {
        "understood": planned.commission.understood,
        "rooms": len(plan.rooms),
        "room_counts": {kind: n for kind, n in room_counts(plan).items() if n},
        "area_m2": round(floor_area_m2(plan), 2),
        "openings": len(plan.openings),
        "candidates": len(planned.tried),
        "warnings": planned.warnings,
    }


@contextmanager
def plan_source(
    options: argparse.Namespace, settings: Settings, watch: Stopwatch
) -> Iterator[tuple[list[Path], Planned | None]]:
    """generate's plan files: those given, or one that was planned and is gone afterwards.

    Raises UsageError where none or several kinds are given, ChordError where none can be planned.
    """
    wanted = bool(options.text) or options.outline is not None
    if options.plan:
        _refuse_two_plans(options)
        yield [existing_file(plan) for plan in options.plan], None
        return
    if not wanted:
        raise UsageError(
            "one plan is needed", where="PLAN, --text, --outline",
            expected="a plan file, or a text, or an open plan, with a text or without",
        )  # fmt: skip
    from chord_usd.base.runtime.scratch import scratch_folder
    from chord_usd.base.scene.chord_json import write_plan

    outline = existing_file(options.outline) if options.outline else None
    planned = _planned(options.text, outline, settings, watch)
    with scratch_folder() as folder:
        path = folder / "planned.json"
        write_plan(planned.plan, path)
        yield [path], planned


def _refuse_two_plans(options: argparse.Namespace) -> None:
    for name in ("text", "outline"):
        if not getattr(options, name):
            continue
        if len(options.plan) > 1 or options.storeys:
            raise UsageError("is for one plan, and there are several storeys", where=f"--{name}")
        raise UsageError(
            "there are two plans", where="PLAN, --text, --outline",
            expected="a plan file, or a text, or an open plan, with a text or without",
        )  # fmt: skip


def without_scale(settings: Settings) -> Settings:
    """The settings for a plan that was planned: vectors have their scale."""
    return replace(settings, m_per_px=None, part=1)
