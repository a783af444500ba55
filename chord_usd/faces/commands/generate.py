"""generate: plan -> furnished stage, the whole line."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted, counted_rooms
from chord_usd.base.runtime.files import deliver
from chord_usd.faces.commands.certified import add_check, certified, holds, reported
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_stage_output,
    add_verb,
    add_view,
    stopwatch,
)
from chord_usd.faces.commands.generate_storeys import run_storeys, storeys_given
from chord_usd.faces.commands.house_options import add_options, settings_of
from chord_usd.faces.commands.paths import output_file, output_folder
from chord_usd.faces.commands.planned import add_sources, plan_source, planned_report, without_scale

if TYPE_CHECKING:
    from chord_usd.line.pipeline import House


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "generate", run, "furnish a floor plan and write it as a USD stage")
    parser.add_argument(
        "plan", type=Path, nargs="*", metavar="PLAN",
        help="plan picture, PDF page, SVG, DXF, IFC, Sweet Home 3D or CHOrD JSON; several are the "
        "storeys of a house, the lowest first",
    )  # fmt: skip
    parser.add_argument(
        "--storeys",
        action="store_true",
        help="take all storeys that a sheet, IFC or Sweet Home 3D file shows, as one house",
    )
    add_sources(parser)
    add_stage_output(parser)
    add_options(
        parser, "seed", "style", "texture_px", "articulation", "steps", "lists", "arrange",
        "furniture", "redraws", "m_per_px", "part", "rooms", "tabletop", "dressing", "sky", "roof",
        "asset_folders", "device",
    )  # fmt: skip
    parser.add_argument(
        "--layout-out",
        type=output_file,
        metavar="PNG",
        help="also write the layout; of several storeys, PNG_0, PNG_1 ...",
    )
    parser.add_argument(
        "--graph-out", type=output_file, metavar="JSON", help="also write the scene graph"
    )
    parser.add_argument(
        "--preview",
        type=output_file,
        metavar="PNG",
        help="also draw the house from above, labelled",
    )
    add_view(parser)
    add_check(parser)
    parser.add_argument(
        "--keep",
        type=output_folder,
        metavar="DIR",
        help="also keep what every step made, with a contact sheet, in a folder, new or empty",
    )


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb. All outputs appear together, at the end."""
    from chord_usd.line.pipeline import generate, require

    settings = settings_of(options)
    if settings.rooms and not options.plan:
        raise UsageError(
            "names rooms of a plan that is not drawn yet", where="--rooms",
            expected="PLAN, a plan that was read before",
        )  # fmt: skip
    require(settings)
    watch = stopwatch(options)
    if options.plan:
        storeys = storeys_given(options, settings, watch)
        if storeys:
            return run_storeys(options, storeys, settings, watch)
    options.plan = options.plan[0] if options.plan else None
    with plan_source(options, settings, watch) as (plan_file, planned), deliver() as delivery:
        stage_path = delivery.place(options.output)
        extras = {
            kind: delivery.place(path)
            for kind, path in (
                ("layout", options.layout_out),
                ("graph", options.graph_out),
                ("preview", options.preview),
                ("view", options.view),
            )
            if path
        }
        settings = without_scale(settings) if planned else settings
        house = generate(plan_file, stage_path, settings, watch)
        _write_extras(house, extras)
        if options.view:
            from chord_usd.line.stage.export.gltf import write_view

            with watch.step("view"):
                write_view(stage_path, extras["view"])
        if options.keep:
            from chord_usd.faces.commands.kept import write_kept

            write_kept(house, delivery.place_folder(options.keep))
        report = None if options.no_check else certified(stage_path, watch)
    data = _summary(house, options.output, watch.seconds, report)
    if planned:
        data["planned"] = planned_report(planned)
        data["warnings"] = [*planned.warnings, *data["warnings"]]
    return Outcome(_text(data), data, holds(report), data["warnings"])


def _write_extras(house: House, paths: dict[str, Path]) -> None:
    if "layout" in paths:
        from chord_usd.base.raster.raster_files import write_raster

        write_raster(house.layout, paths["layout"])
    if "graph" in paths:
        from chord_usd.base.scene.chord_json import write_scene

        write_scene(house.graph, paths["graph"])
    if "preview" in paths:
        from chord_usd.line.image.preview import draw_preview

        draw_preview(house.graph, paths["preview"])


def _summary(
    house: House, stage: Path, seconds: dict[str, float], check: dict[str, Any] | None
) -> dict[str, Any]:
    from chord_usd.line.arrange.rules import edits_told

    furniture = len(house.graph.items)
    tabletop = sum(len(item.children) for item in house.graph.items)
    return {
        "stage": str(stage),
        "style": house.graph.style,
        "rooms": len(house.graph.rooms),
        "furniture": furniture,
        "items": furniture + tabletop,
        "tabletop": _tabletop(house, tabletop),
        "dressing": len(house.graph.dressing),
        "openings": len(house.graph.openings),
        "redrawn": list(house.redrawn),
        "left_out": list(house.left_out),
        "edits": edits_told(house.graph),
        "seconds": seconds,
        "m_per_px": house.plan_image.frame.m_per_px,
        "scale": house.plan.extra.get("scale"),
        "certificate": check,
        "warnings": list(house.plan.extra.get("warnings", ())),
    }


def _tabletop(house: House, items: int) -> dict[str, Any]:
    """How many pieces were laid with how much, and which were left empty, by node id."""
    tables = house.tabletops
    return {
        "pieces": len(tables.laid) + len(tables.too_small) if tables else 0,
        "items": items,
        "too_small": list(tables.too_small) if tables else [],
        "bare": list(tables.bare) if tables else [],
        "left_out": tables.left_out if tables else 0,
    }


def _text(data: dict[str, Any]) -> str:
    carried = data["tabletop"]["items"]
    small = f" and {counted(carried, 'item')} on them" if carried else ""
    dressed = f", dressed with {counted(data['dressing'], 'thing')}" if data["dressing"] else ""
    return reported(
        data["certificate"],
        f"{data['stage']}: {counted_rooms(data)}{small}{dressed}, "
        f"{counted(data['openings'], 'opening')}, "
        f"in {sum(data['seconds'].values()):.1f} s",
    )
