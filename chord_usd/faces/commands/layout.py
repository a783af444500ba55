"""layout: plan raster -> layout raster, the diffusion model alone."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.files import deliver
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_output,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options, settings_of

if TYPE_CHECKING:
    from chord_usd.faces.commands.results import LayoutDrawn


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(
        verbs, "layout", run, "furnish a plan as a picture: what the diffusion model paints"
    )
    parser.add_argument("plan", type=Path, metavar="PLAN", help="plan picture or CHOrD JSON")
    add_output(parser, "the layout raster, layout.png", suffixes=(".png",))
    add_options(parser, "seed", "steps", "lists", "sampler", "m_per_px", "device")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.line.pipeline import (
        draw_layout,
        draw_plan,
        load_lists,
        load_model,
        read_plan,
        sampling,
    )
    from chord_usd.line.plan.read import WARNINGS
    from chord_usd.line.plan.text import let_go

    settings = settings_of(options)
    plan_file = existing_file(options.plan)
    watch = stopwatch(options)
    with deliver() as delivery:
        target = delivery.place(options.output)
        with watch.step("plan"):
            plan = read_plan(plan_file, settings)
            plan_image = draw_plan(plan)
            let_go()  # before the layout model takes as much again
        with watch.step("load"):
            model = load_model(settings)
            lists = load_lists(settings, model)
        with watch.step("list"):
            listed = sampling(settings, lists).listed(plan.scene(), plan.rooms)
        with watch.step("layout") as progress:
            layout = draw_layout(plan, plan_image, model, plan_file, settings, listed, progress)
        write_raster(layout, target)
    warnings = list(plan.extra.get(WARNINGS, ()))
    m_per_px = layout.frame.m_per_px
    data: LayoutDrawn = {
        "layout": str(options.output),
        "m_per_px": m_per_px,
        "seconds": watch.seconds,
        "warnings": warnings,
    }
    text = f"{options.output}: {m_per_px * 100:.1f} cm per pixel"
    return Outcome(text, data, warnings=warnings)
