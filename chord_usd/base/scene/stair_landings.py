"""Floor beyond the last step of a stair: landings that are too shallow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.types import Plan

if TYPE_CHECKING:
    from chord_usd.base.scene.stair_forms import BuiltStair

LEAST_LANDING_M = 0.8
"""A landing is as deep as the stair is wide, and no home's stair is narrower."""

_HALF_WAY_M = 0.2
"""Half the width of the way that is measured, from the middle of the last step."""

_LEAST_M2 = 1e-3
_SEAM_M = 0.002


def landing_depth_m(plan: Plan, built: BuiltStair) -> float:
    """Floor straight ahead of a stair on the storey that it leads to, up to LEAST_LANDING_M.

    plan: of that storey, with the stair's cell.
    """
    edge = np.asarray(built.arrival_m.coords)[[0, -1]]
    along = (edge[1] - edge[0]) / np.linalg.norm(edge[1] - edge[0])
    ahead = np.array([-along[1], along[0]])
    middle = edge.mean(axis=0)
    if ahead @ (built.walk_m[-1, :2] - built.walk_m[-2, :2]) < 0.0:
        ahead = -ahead
    near, far = middle + _SEAM_M * ahead, middle + LEAST_LANDING_M * ahead
    aside = _HALF_WAY_M * along
    way = shapely.Polygon([near - aside, near + aside, far + aside, far - aside])
    rooms = [room_polygon(room) for room in plan.rooms if not is_cell(room)]
    doorways = [footprint_polygon(each.box) for each in plan.openings if each.kind != "window"]
    floor = shapely.union_all([*rooms, *doorways]).buffer(_SEAM_M, join_style="mitre")
    missing = [part for part in polygons_of(way.difference(floor)) if part.area > _LEAST_M2]
    corners = [shapely.get_coordinates(part) for part in missing]
    depths = [float(((points - middle) @ ahead).min()) for points in corners]
    return min([LEAST_LANDING_M, *depths])
