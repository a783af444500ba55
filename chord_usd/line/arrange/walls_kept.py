"""Footprints cut off at the walls of their room: boxes around torn patches stand out into them.

Metres, world axes.
"""

from __future__ import annotations

from dataclasses import replace

from shapely.geometry import Polygon

from chord_usd.base.scene.oriented_rect import Edge, Footprint, OrientedRect

_OUT_SHARE = 0.005
"""Share of a footprint that may lie out of its room..."""
_OUT_M = 0.004
"""...and how deep: a corner of a slanted piece is a small share and in the wall all the same."""
_STEPS = 24
_GRID_M = 1e-9
"""Without a grid GEOS errs now and then where edges lie on each other, as these do."""

_INWARDS: tuple[tuple[Edge, Edge], ...] = (("u0", "u1"), ("u1", "u0"), ("v0", "v1"), ("v1", "v0"))
"""Each edge, and the opposite one."""


def cut_at_walls(footprint: Footprint, room: Polygon) -> Footprint:
    """Cut off what stands out of the room, edge by edge, each time the cut that costs least."""
    rect = footprint.rect
    for _ in range(4):
        if _fits(rect, room):
            break
        cuts = [_cut(rect, *edges, room) for edges in _INWARDS]
        rect = max(cuts, key=lambda cut: (cut[0], cut[1].area))[1]
    return replace(footprint, rect=rect)


def _cut(
    rect: OrientedRect, edge: Edge, opposite: Edge, room: Polygon
) -> tuple[bool, OrientedRect]:
    """One edge moved in by the least that puts the rest into the room, half way at most.

    Also whether that does it.
    """
    start, limit = getattr(rect, edge), getattr(rect, opposite)
    for step in range(1, _STEPS + 1):
        place = start + (limit - start) * 0.5 * step / _STEPS
        cut = rect.moved_edge(edge, place)
        if _fits(cut, room):
            return True, cut
    return False, cut


def _fits(rect: OrientedRect, room: Polygon) -> bool:
    """Whether next to nothing lies out of the room, and that nowhere deep."""
    shape = rect.polygon
    out = shape.difference(room, grid_size=_GRID_M)
    if out.area > _OUT_SHARE * shape.area:
        return False
    return bool(out.buffer(-_OUT_M / 2).is_empty)
