"""generate: plan -> furnished stage, the whole line."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted, counted_rooms
from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.house_history import Deed, recorded
from chord_usd.base.scene.settings import OPTIONS
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
from chord_usd.faces.commands.house_options import add_options, settings_of
from chord_usd.faces.commands.paths import output_file, output_folder
from chord_usd.faces.commands.planned import add_sources, plan_source, planned_report, without_scale

if TYPE_CHECKING:
    from chord_usd.base.runtime.files import Delivery
    from chord_usd.base.scene.types import ByteArray
    from chord_usd.line.pipeline.whole_house import FurnishedStorey, House

_READ = {
    "right": "probably read right", "wrong": "probably read wrong: plan read --overlay shows it",
    "look": "read with doubts: plan read --overlay shows them",
}  # fmt: skip


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
    add_options(parser, *(name for name in OPTIONS if name != "sampler"))
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
    deed = Deed("generate", ", ".join(plan.name for plan in options.plan) or options.text or "")
    with (
        plan_source(options, settings, watch) as (plans, planned),
        recorded(options.output, deed), deliver() as delivery,
    ):  # fmt: skip
        stage = delivery.place(options.output)
        settings = without_scale(settings) if planned else settings
        house = generate(plans, stage, settings, watch, every=options.storeys)
        _write_extras(house, options, delivery)
        if options.view:
            from chord_usd.line.stage.export.gltf import write_view

            with watch.step("view"):
                write_view(stage, delivery.place(options.view))
        report = None if options.no_check else certified(stage, watch, settings.standard)
    data = _summary(house, options.output, watch.seconds, report)
    if planned:
        data["planned"] = planned_report(planned)
        data["warnings"] = [*planned.warnings, *data["warnings"]]
    return Outcome(_text(data), data, holds(report), data["warnings"])


def _write_extras(house: House, options: argparse.Namespace, delivery: Delivery) -> None:
    """Layouts, scene graph, preview and artefacts of steps, where an option names a place."""
    if options.layout_out:
        from chord_usd.base.raster.raster_files import write_raster

        for made, path in _numbered(house, options.layout_out):
            write_raster(made.layout, delivery.place(path))
    if options.graph_out:
        from chord_usd.base.scene.json_stairs import write_storeys

        names = [made.storey.name for made in house.storeys]
        write_storeys(house.graphs, names, delivery.place(options.graph_out))
    if options.preview:
        from chord_usd.line.image.preview import draw_storeys

        draw_storeys(house.graphs, delivery.place(options.preview))
    if options.keep:
        write_kept(house.storeys, delivery.place_folder(options.keep))


def _numbered(house: House, path: Path) -> Iterator[tuple[FurnishedStorey, Path]]:
    """A file for each storey: of several, with the number of the storey behind the name."""
    for made in house.storeys:
        number = f"_{made.storey.index}" if len(house.storeys) > 1 else ""
        yield made, path.with_name(f"{path.stem}{number}{path.suffix}")


def _summary(
    house: House, stage: Path, seconds: dict[str, float], check: dict[str, Any] | None
) -> dict[str, Any]:
    from chord_usd.line.arrange.rules import edits_told
    from chord_usd.line.pipeline.as_drawn import drawn_told

    graphs, storeys = house.graphs, house.storeys
    furniture = sum(len(graph.items) for graph in graphs)
    tabletop = sum(len(item.children) for graph in graphs for item in graph.items)
    return {
        "stage": str(stage),
        "style": house.ground.style.name,
        "rooms": sum(len(graph.rooms) for graph in graphs),
        "furniture": furniture,
        "items": furniture + tabletop,
        "tabletop": _tabletop(storeys, tabletop),
        "dressing": sum(len(graph.dressing) for graph in graphs),
        "openings": sum(len(graph.openings) for graph in graphs),
        "redrawn": [room for made in storeys for room in made.redrawn],
        "left_out": [item for made in storeys for item in made.left_out],
        "drawn": [piece for made in storeys for piece in drawn_told(made.drawn, made.graph)],
        "edits": [edit for graph in graphs for edit in edits_told(graph)],
        "seconds": seconds,
        "m_per_px": house.ground.plan_image.frame.m_per_px,
        "scale": house.ground.plan.extra.get("scale"),
        "verdict": house.verdict,
        "storeys": [_storey(made) for made in storeys],
        "stairs": [
            {"form": climb.built.stair.form, "rise_m": round(climb.built.rise_m, 3),
             "going_m": round(climb.built.going_m, 3), "from": climb.foot.joined,
             "to": climb.top.joined}
            for climb in house.building.climbs
        ],
        "certificate": check,
        "warnings": list(house.warnings),
    }  # fmt: skip


def _storey(made: FurnishedStorey) -> dict[str, Any]:
    """What a storey holds, and how it was registered to the storey below."""
    registered = made.storey.registration
    return {
        "name": made.storey.name,
        "elevation_m": made.storey.elevation_m,
        "rooms": len(made.graph.rooms),
        "furniture": len(made.graph.items),
        "registered_by": registered.by if registered else None,
        "shift_m": list(registered.shift_m) if registered else [0.0, 0.0],
        "on_walls": registered.on_walls if registered else None,
        "residual_m": registered.residual_m if registered else None,
    }


def _tabletop(storeys: Sequence[FurnishedStorey], items: int) -> dict[str, Any]:
    """Counts of pieces with objects and of objects; empty pieces by node id."""
    tables = [made.tabletops for made in storeys if made.tabletops]
    return {
        "pieces": sum(len(top.laid) + len(top.too_small) for top in tables),
        "items": items,
        "too_small": [item for top in tables for item in top.too_small],
        "bare": [item for top in tables for item in top.bare],
        "left_out": sum(top.left_out for top in tables),
    }


def _text(data: dict[str, Any]) -> str:
    carried = data["tabletop"]["items"]
    small = f" and {counted(carried, 'item')} on them" if carried else ""
    dressed = f", dressed with {counted(data['dressing'], 'thing')}" if data["dressing"] else ""
    several = f"{counted(len(data['storeys']), 'storey')}, " if len(data["storeys"]) > 1 else ""
    lines = [
        f"{data['stage']}: {several}{counted_rooms(data)}{small}{dressed}, "
        f"{counted(data['openings'], 'opening')}, in {sum(data['seconds'].values()):.1f} s"
    ]
    lines += [f"  the plan is {_READ[data['verdict']]}"] if data["verdict"] in _READ else []
    lines += [
        f"  {storey['name']}: registered to the storey below by its {storey['registered_by']}, "
        f"{storey['on_walls']:.0%} of its outer walls on walls, "
        f"{storey['residual_m'] * 100:.1f} cm off"
        for storey in data["storeys"][1:]
    ]
    lines += [
        f"  {stair['form']} stair, rise {stair['rise_m'] * 100:.1f} cm, going "
        f"{stair['going_m'] * 100:.1f} cm, from {stair['from']} to {stair['to']}"
        for stair in data["stairs"]
    ]
    return reported(data["certificate"], *lines)


# Everything that one run of generate makes, in a folder to look into, with a contact -------------


def write_kept(storeys: Sequence[FurnishedStorey], folder: Path) -> None:
    """What every step made of each storey: of several, in a folder of its own."""
    for made in storeys:
        target = folder / f"storey_{made.storey.index}" if len(storeys) > 1 else folder
        target.mkdir(exist_ok=True)
        _write_storey(made, target)


def _write_storey(made: FurnishedStorey, folder: Path) -> None:
    """plan, list, first layout, what was read in it, last layout and house, as CHOrD JSON and as
    pictures of the layouts; sheet.png has them side by side."""
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import write_scene
    from chord_usd.line.image.picture_sheet import write_sheet

    graphs = {"plan": made.plan.scene(), "list": made.listed, "read": made.first_graph,
              "house": made.graph}  # fmt: skip
    for name, graph in graphs.items():
        if graph is not None:
            write_scene(graph, folder / f"{name}.json")
    for name, image in (("plan", made.plan_image), ("layout_first", made.first_layout),
                        ("layout", made.layout)):  # fmt: skip
        write_raster(image, folder / f"{name}.png")
    write_sheet(list(_pictures(made)), folder / "sheet.png")


def _pictures(made: FurnishedStorey) -> Iterator[tuple[str, ByteArray]]:
    from chord_usd.base.raster.canvas import layout_image
    from chord_usd.line.image.preview import preview_rgb

    yield "plan", made.plan_image.rgb
    if made.listed is not None:
        yield "list", layout_image(made.plan_image, made.listed.items).rgb
    yield "first layout", made.first_layout.rgb
    yield "read and arranged", layout_image(made.plan_image, made.first_graph.items).rgb
    yield "last layout", made.layout.rgb
    yield "house", preview_rgb(made.graph)
