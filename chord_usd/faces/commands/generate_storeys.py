"""What generate does with several plans, the storeys of one house."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.counting import counted, counted_rooms
from chord_usd.base.runtime.files import Delivery, deliver
from chord_usd.faces.commands.certified import certified, holds, reported
from chord_usd.faces.commands.common import Outcome, UsageError, existing_file

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Stopwatch
    from chord_usd.base.scene.json_stairs import StoreyPlan
    from chord_usd.line.pipeline import Settings
    from chord_usd.line.pipeline.whole_house import StoreyHouse


def storeys_given(
    options: argparse.Namespace, settings: Settings, watch: Stopwatch
) -> tuple[StoreyPlan, ...]:
    """The storeys, the lowest first, where the plans given are a house of several; else none.

    Raises UsageError for options that such a house cannot have, PlanError for odd files.
    """
    from chord_usd.line.pipeline.whole_house import read_storeys, storeys_in

    files = [existing_file(file) for file in options.plan]
    if len(files) == 1 and not options.storeys and not storeys_in(files[0]):
        return ()
    for name in ("text", "outline"):
        if getattr(options, name):
            raise UsageError(
                "is for one plan, and there are several storeys",
                where=f"--{name.replace('_', '-')}",
            )
    with watch.step("plan"):
        return read_storeys(files, settings, every=options.storeys)


def run_storeys(
    options: argparse.Namespace,
    given: Sequence[StoreyPlan],
    settings: Settings,
    watch: Stopwatch,
) -> Outcome:
    """Furnishes the storeys and writes their stage. All outputs appear together, at the end."""
    from chord_usd.line.pipeline.whole_house import generate_storeys

    with deliver() as delivery:
        stage = delivery.place(options.output)
        view, preview, graph_out = (
            delivery.place(path) if path else None
            for path in (options.view, options.preview, options.graph_out)
        )
        house = generate_storeys(given, options.plan, stage, settings, watch)
        if preview:
            from chord_usd.line.image.preview import draw_storeys

            draw_storeys([one.graph for one in house.furnished], preview)
        if graph_out:
            _write_graphs(house, graph_out)
        if options.layout_out:
            _write_layouts(house, options.layout_out, delivery)
        if options.keep:
            _write_kept(house, delivery.place_folder(options.keep))
        if view:
            from chord_usd.line.stage.export.gltf import write_view

            with watch.step("view"):
                write_view(stage, view)
        report = None if options.no_check else certified(stage, watch)
    data = _summary(house, options.output, watch.seconds, report)
    return Outcome(_text(data), data, holds(report), data["warnings"])


def _write_graphs(house: StoreyHouse, path: Path) -> None:
    """All storeys as CHOrD JSON, each with its name and furniture."""
    from chord_usd.base.runtime.files import write_atomic
    from chord_usd.base.scene.chord_json import json_text, scene_to_json
    from chord_usd.base.scene.json_stairs import STOREYS

    rows = [
        {"name": storey.name, **scene_to_json(made.graph)}
        for storey, made in zip(house.building.storeys, house.furnished, strict=True)
    ]
    write_atomic(path, json_text({STOREYS: rows}))


def _write_layouts(house: StoreyHouse, path: Path, delivery: Delivery) -> None:
    """The layout of each storey, with the storey's number behind the name."""
    from chord_usd.base.raster.raster_files import write_raster

    for storey, made in zip(house.building.storeys, house.furnished, strict=True):
        own = path.with_name(f"{path.stem}_{storey.index}{path.suffix}")
        write_raster(made.layout, delivery.place(own))


def _write_kept(house: StoreyHouse, folder: Path) -> None:
    """What every step made of each storey, in a folder of its own."""
    from chord_usd.faces.commands.kept import write_kept
    from chord_usd.line.pipeline import House

    for storey, image, made in zip(
        house.building.storeys, house.plan_images, house.furnished, strict=True
    ):
        own = folder / f"storey_{storey.index}"
        own.mkdir()
        write_kept(House(storey.plan, image, made.layout, made.graph, house.stage, made.first), own)


def _summary(
    house: StoreyHouse, stage: Path, seconds: dict[str, float], check: dict[str, Any] | None
) -> dict[str, Any]:
    graphs = [one.graph for one in house.furnished]
    storeys = []
    for storey, graph in zip(house.building.storeys, graphs, strict=True):
        laid = storey.registration
        storeys.append(
            {
                "name": storey.name,
                "elevation_m": storey.elevation_m,
                "rooms": len(graph.rooms),
                "furniture": len(graph.items),
                "registered_by": laid.by if laid else None,
                "shift_m": list(laid.shift_m) if laid else [0.0, 0.0],
                "on_walls": laid.on_walls if laid else None,
                "residual_m": laid.residual_m if laid else None,
            }
        )
    told = [str(one) for storey in house.building.storeys
            for one in storey.plan.extra.get("warnings", ())]  # fmt: skip
    return {
        "stage": str(stage),
        "style": graphs[0].style,
        "storeys": storeys,
        "stairs": [
            {"form": one.built.stair.form, "rise_m": round(one.built.rise_m, 3),
             "going_m": round(one.built.going_m, 3), "from": one.foot.joined, "to": one.top.joined}
            for one in house.building.climbs
        ],
        "rooms": sum(len(graph.rooms) for graph in graphs),
        "furniture": sum(len(graph.items) for graph in graphs),
        "openings": sum(len(graph.openings) for graph in graphs),
        "dressing": sum(len(graph.dressing) for graph in graphs),
        "left_out": [item for one in house.furnished for item in one.left_out],
        "seconds": seconds,
        "certificate": check,
        "warnings": list(dict.fromkeys((*house.building.warnings, *told))),
    }  # fmt: skip


def _text(data: dict[str, Any]) -> str:
    lines = [
        f"{data['stage']}: {counted(len(data['storeys']), 'storey')}, {counted_rooms(data)}, "
        f"in {sum(data['seconds'].values()):.1f} s"
    ]
    lines += [
        f"  {one['name']}: laid over the storey below by its {one['registered_by']}, "
        f"{one['on_walls']:.0%} of its outer walls on walls, {one['residual_m'] * 100:.1f} cm off"
        for one in data["storeys"][1:]
    ]
    lines += [
        f"  {one['form']} stair, rise {one['rise_m'] * 100:.1f} cm, going "
        f"{one['going_m'] * 100:.1f} cm, from {one['from']} to {one['to']}"
        for one in data["stairs"]
    ]
    return reported(data["certificate"], *lines)
