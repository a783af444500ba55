"""Rooms that the painter tore: where the list of a room keeps more planning rules than what was
painted after it, the room stands as it is listed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from chord_usd.base.raster import canvas
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Item, LayoutImage, PixelFrame, PlanImage, SceneGraph
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.pipeline.redraw import Draw, faults_by_room
from chord_usd.line.pipeline.resample import pasted, with_furniture

TORN = 0.02
"""Share of a room's rules that the painter may break."""


def as_listed(
    graph: SceneGraph,
    listed: SceneGraph,
    layout: LayoutImage,
    plan_image: PlanImage,
    draw: Draw,
    settle: Callable[[SceneGraph], SceneGraph],
) -> tuple[SceneGraph, LayoutImage]:
    """The house with rooms as they are listed where that costs less once settled; its picture.

    graph: as it was read in the layout, which was painted over plan_image.
    """
    from chord_usd.base.metrics.design.price import room_prices

    def prices(house: SceneGraph) -> dict[str, float]:
        there = settle(house)
        return room_prices(there, faults_by_room(there, draw))

    painted, wanted = prices(graph), room_prices(listed, {})
    torn = [room for room in graph.rooms if painted[room.id] > wanted[room.id] + TORN]
    while torn:
        tried = graph
        for room in torn:
            own = (_seen(item, layout.frame) for item in listed.items_of(room.id))
            tried = with_furniture(tried, room, own)
        costs = prices(tried)
        better = [room for room in torn if costs[room.id] < painted[room.id] - TORN]
        if len(better) == len(torn):
            picture = canvas.layout_image(plan_image, listed.items)
            for room in torn:
                layout = pasted(layout, replace(layout, rgb=picture.rgb), room)
            return tried, layout
        torn = better
    return graph, layout


def _seen(item: Item, frame: PixelFrame) -> Item:
    """The piece as the picture shows it, which does not tell its height."""
    corners = px_from_m(footprint(item.box), frame).round(2).tolist()
    return item.found(source_px=tuple((x, y) for x, y in corners), front_from="mark")
