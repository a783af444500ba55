"""plan: drawings and vector plans into one another."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import deliver
from chord_usd.faces.commands import planned
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_group,
    add_output,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options, settings_of
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.base.scene.types import PixelFrame, Plan


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "plan", "read and draw floor plans")
    read = add_verb(group, "read", run_read, "turn a drawing into a vector plan (CHOrD JSON)")
    read.add_argument(
        "image", type=Path, metavar="IMAGE",
        help="floor plan: picture, PDF page, SVG, DXF, IFC or Sweet Home 3D",
    )  # fmt: skip
    add_output(read, "the vector plan, plan.json", suffixes=(".json",))
    add_options(read, "m_per_px", "part", "dwelling", "rooms", "drawn")
    read.add_argument(
        "--overlay",
        type=output_file,
        metavar="PNG",
        help="also draw what was read over the drawing, with numbers and doubts",
    )
    read.add_argument(
        "--drawing", type=output_file, metavar="PNG",
        help="also write the drawing, straightened, for programs that draw over it",
    )  # fmt: skip
    draw = add_verb(group, "draw", run_draw, "turn a vector plan into a plan raster")
    draw.add_argument("plan", type=Path, metavar="PLAN", help="vector plan, CHOrD JSON")
    add_output(draw, "the plan raster, plan.png", suffixes=(".png",))
    planned.add(group)


def run_read(options: argparse.Namespace) -> Outcome:
    """Runs plan read."""
    from chord_usd.base.scene.chord_json import write_plan
    from chord_usd.line.pipeline import read_plan, require
    from chord_usd.line.plan.placement import WARNINGS
    from chord_usd.line.plan.verdict import SAID

    image = existing_file(options.image)
    settings = settings_of(options)
    require(settings)
    with deliver() as delivery:
        target = delivery.place(options.output)
        overlay = delivery.place(options.overlay) if options.overlay else None
        drawing = delivery.place(options.drawing) if options.drawing else None
        with stopwatch(options).step("plan"):
            plan = read_plan(image, settings)
            write_plan(plan, target)
        if overlay:
            from chord_usd.line.plan.overlay import draw_overlay

            draw_overlay(plan, image, overlay)
        frame = None
        if drawing:
            from chord_usd.line.plan.overlay import write_drawing

            frame = write_drawing(plan, image, drawing)
    warnings = list(plan.extra.get(WARNINGS, ()))
    kinds = [opening.kind for opening in plan.openings]
    data = {
        "plan": str(options.output),
        "rooms": len(plan.rooms),
        "openings": len(kinds),
        "doors": kinds.count("door"),
        "windows": kinds.count("window"),
        "passages": kinds.count("passage"),
        **reading_report(plan),
        **({"drawing": _frame_told(frame)} if frame else {}),
        "warnings": warnings,
    }
    judged = f"{SAID[data['verdict']]}, " if data["verdict"] in SAID else ""
    return Outcome(
        f"{data['plan']}: {judged}{counted(data['rooms'], 'room')}, "
        f"{counted(data['doors'], 'door')}, "
        f"{counted(data['windows'], 'window')}, {counted(data['passages'], 'passage')}",
        data,
        warnings=warnings,
    )


def _frame_told(frame: PixelFrame) -> dict[str, Any]:
    """Where a picture lies in the plan: metres a pixel, the lower left corner, how high it is."""
    low = list(frame.origin_m)
    return {"m_per_px": frame.m_per_px, "origin_m": low, "height_px": frame.height_px}


def reading_report(plan: Plan) -> dict[str, Any]:
    """For --json: the verdict, doubts with their places, where the scale is from, how sure the
    reading is of rooms and openings, and which pieces are drawn."""
    from chord_usd.line.pipeline.as_drawn import drawn_told, placed_pieces
    from chord_usd.line.plan.openings import CONFIDENCE
    from chord_usd.line.plan.scale_choice import SCALE
    from chord_usd.line.plan.verdict import VERDICT, doubts_placed

    extras = [(room.id, room.extra) for room in plan.rooms]
    extras += [(opening.id, opening.extra) for opening in plan.openings]
    sure = {name: extra[CONFIDENCE] for name, extra in extras if CONFIDENCE in extra}
    return {
        "verdict": plan.extra.get(VERDICT),
        "doubts": doubts_placed(plan),
        "scale": plan.extra.get(SCALE),
        "confidence": sure,
        "drawn": drawn_told(placed_pieces(plan)),
    }


def run_draw(options: argparse.Namespace) -> Outcome:
    """Runs plan draw."""
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import read_plan
    from chord_usd.line.pipeline import draw_plan

    plan_file = existing_file(options.plan)
    with stopwatch(options).step("plan"):
        image = draw_plan(read_plan(plan_file))
        write_raster(image, options.output)
    m_per_px = image.frame.m_per_px
    return Outcome(
        f"{options.output}: {m_per_px * 100:.1f} cm per pixel",
        {"plan": str(options.output), "m_per_px": m_per_px},
    )
