"""A roof over a house: the choice of its variant set `roof`, behind a payload of its own.

    /House{roof=none}          selected: what simulators and pictures of rooms see
    /House{roof=hip}Roof       component; Geometry/{Roof, Underside, Eaves, Gable}

The bounds of the house include the roof only where it is selected.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from pxr import Sdf, Usd
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.roof_forms import NO_ROOF, RoofForm
from chord_usd.base.scene.roof_planes import RoofPlane, roof_planes
from chord_usd.base.scene.types import ROOM_HEIGHT_M, FloatArray, Plan
from chord_usd.line.stage.author.lighting import SCOPE as LIGHTING
from chord_usd.line.stage.author.prims import add_variants, hint_extent, label
from chord_usd.line.stage.author.stage_levels import Level
from chord_usd.line.stage.author.surfaces import Fitout
from chord_usd.line.stage.shell.mesh import Face, flat, moved
from chord_usd.line.stage.shell.shell_layers import ShellComponent, refer
from chord_usd.line.stage.shell.slabs import covered
from chord_usd.line.stage.shell.walls import build_walls
from chord_usd.line.stage.views.cameras import set_outside

ROOF = "Roof"
ROOF_SET = "roof"
"""Variant set of the house."""

_THICK_M = {"flat": 0.28, "gable": 0.16, "hip": 0.16}
_LEAST_M = 1e-3

_BESIDE_SUN_DEG = 40.0
"""The camera outside stands so far beside the sun: two sides are seen, one of them lit."""

_EYE_SHARE = 0.9
"""Highest place of that camera over the top of the walls; higher ones are taken to look in."""


def require_roof(plan: Plan, form: RoofForm) -> None:
    """Raises PlanError where no roof of this form fits over a storey."""
    if form not in (NO_ROOF, "flat"):
        roof_planes(covered(build_walls(plan)), form)


def select_roof(stage: Usd.Stage) -> None:
    """Select the roof of an open house, where it offers one; on the session layer."""
    offered = stage.GetDefaultPrim().GetVariantSet(ROOF_SET)
    roofs = [name for name in offered.GetVariantNames() if name != NO_ROOF]
    if roofs:
        with Usd.EditContext(stage, stage.GetSessionLayer()):
            offered.SetVariantSelection(roofs[0])


def raise_roof(
    layer: Sdf.Layer, levels: Sequence[Level], form: RoofForm, folder: Path, fitout: Fitout
) -> None:
    """Write the variant set with a roof over the top storey.

    form: any but none. folder: where payload layers go. The house must have its extentsHint.
    """
    top = levels[-1]
    base_m = top.elevation_m + ROOM_HEIGHT_M
    outline = covered(top.walls)
    planes = roof_planes(outline, form)
    component = ShellComponent(folder / f"{ROOF}_{form}.usdc", ROOF, fitout)
    for name, faces, surface in _parts(planes, outline, _THICK_M[form]):
        component.mesh(name, moved(faces, np.eye(2), (0.0, 0.0, base_m)), surface)
    component.save()
    house = layer.GetPrimAtPath("/House")
    bare = np.array(house.attributes["extentsHint"].default)
    house.RemoveProperty(house.attributes["extentsHint"])
    without, roofed = add_variants(house, ROOF_SET, (NO_ROOF, form))
    extent = refer(layer, roofed.path.AppendChild(ROOF), component)
    label(roofed.nameChildren[ROOF], "category", "roof")
    hint_extent(without, bare)
    both = np.array([bare, extent])
    bounds = np.array([both[:, 0].min(axis=0), both[:, 1].max(axis=0)])
    hint_extent(roofed, bounds)
    order = [name for name in house.nameChildrenOrder if name != ROOF]
    house.nameChildrenOrder = [*order[:2], ROOF, *order[2:]]
    sun_deg = layer.GetAttributeAtPath(f"{LIGHTING}.chord:sun_yaw_deg").default
    set_outside(layer, bounds, sun_deg + _BESIDE_SUN_DEG, base_m * _EYE_SHARE)


def _parts(
    planes: Sequence[RoofPlane], outline: BaseGeometry, thick_m: float
) -> Iterator[tuple[str, list[Face], str]]:
    """Name, faces and surface of each mesh, over the top of the walls."""
    whole = shapely.union_all([plane.area_m for plane in planes], grid_size=1e-6)
    # Where three planes meet there may be a hole of a micrometre.
    whole = whole.buffer(1e-4, join_style="mitre").buffer(-1e-4, join_style="mitre")
    rim = shapely.union_all([part.boundary for part in polygons_of(whole)])
    tops, soffits, edges, gables = [], [], [], []
    for plane in planes:
        tops += _sloped(plane.area_m, plane, thick_m, up=True)
        for part in polygons_of(plane.area_m.difference(outline)):
            if part.area > _LEAST_M**2:
                soffits += _sloped(part, plane, 0.0, up=False)
        edges += _sheets((side, plane.heights_m(side), thick_m) for side in _rim_of(plane, rim))
        walls = _walls_under(plane, outline)
        gables += _sheets((side, np.zeros(2), plane.heights_m(side)) for side in walls)
    yield "Roof", tops, "RoofTiles" if planes[0].slope else "WallTop"
    yield "Underside", soffits, "Trim"
    yield "Eaves", edges, "Trim"
    yield "Gable", gables, "Facade"


def _sloped(area: Polygon, plane: RoofPlane, lift_m: float, *, up: bool) -> list[Face]:
    faces = []
    for face in flat(area, 0.0, up=up):
        corners = face.corners_m.copy()
        corners[:, 2] = plane.heights_m(corners) + lift_m
        faces.append(Face(corners, face.uvs_m))
    return faces


def _rim_of(plane: RoofPlane, rim: BaseGeometry) -> Iterator[FloatArray]:
    """(2, 2) the sides of a plane that no other one joins, the outside to their right."""
    near = rim.buffer(1e-4)
    for part in polygons_of(plane.area_m):
        ring = orient(part)
        for line in (ring.exterior, *ring.interiors):
            for ends in pairwise(np.asarray(line.coords)[:, :2]):
                side = np.array(ends)
                if near.covers(LineString(side)) and np.hypot(*(side[1] - side[0])) > _LEAST_M:
                    yield side


def _walls_under(plane: RoofPlane, outline: BaseGeometry) -> Iterator[FloatArray]:
    """(2, 2) the outer walls below a plane, the outside to their right."""
    for part in map(orient, polygons_of(outline)):
        for ring in (part.exterior, *part.interiors):
            for start, end in pairwise(np.asarray(ring.coords)[:, :2]):
                met = LineString([start, end]).intersection(plane.area_m)
                for piece in shapely.get_parts(met):
                    if piece.length > _LEAST_M:
                        ends = np.asarray(piece.coords)[[0, -1], :2]
                        ahead = (ends[1] - ends[0]) @ (end - start) > 0.0
                        yield ends if ahead else ends[::-1]


def _sheets(
    sides: Iterable[tuple[FloatArray, FloatArray, FloatArray | float]],
) -> list[Face]:
    """Upright sheets, where there is anything of them.

    sides: (2, 2) ground line, (2,) heights of the foot at its ends, and what stands on that.
    """
    sheets = []
    for (start, end), foot, high in sides:
        tall = np.broadcast_to(high, 2)
        if tall.max() < _LEAST_M:
            continue
        length = float(np.hypot(*(end - start)))
        rows = [(start, 0.0, foot[0]), (end, length, foot[1])]
        for point, along, at in ((end, length, 1), (start, 0.0, 0)):
            if tall[at] >= _LEAST_M:
                rows.append((point, along, foot[at] + tall[at]))
        corners = np.array([[*point, height] for point, _, height in rows])
        sheets.append(Face(corners, np.array([[along, height] for _, along, height in rows])))
    return sheets
