"""Things of a house as copies of what they are made from: meshes once, placements many."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
import shapely
import trimesh
from pxr import Usd, UsdGeom
from shapely.geometry.base import BaseGeometry

from chord_usd.base.scene.palette import CATEGORIES, Level, Mount
from chord_usd.base.scene.types import FloatArray, Item
from chord_usd.line.stage.check.check_contact import Solid
from chord_usd.line.stage.export.exchange.built_house import House

_STRAIGHT = 1e-4
"""Axes that are less square than this are skewed, and no placement says so."""

_DECIMALS, _SLIVER_M2 = 3, 1e-7
"""Of shadows: corners are rounded to millimetres, smaller triangles cover nothing."""

_NEARLY_ALL = 0.999


@dataclass(frozen=True, eq=False)
class Piece:
    """A thing, and how a copy of its model becomes it: scaled, turned, moved."""

    item: Item
    model: str
    """Key of what it is a copy of; things of one model have the same solids."""
    asset: str
    """Name of that model, as people know it."""
    at_m: FloatArray
    """(3,)"""
    turn: FloatArray
    """(3, 3) columns are its axes in the world."""
    scale: FloatArray
    """(3,) along the model's axes."""
    solids: tuple[Solid, ...]
    """In the world."""

    def in_model(self, solid: Solid) -> trimesh.Trimesh:
        """One of its solids in the frame of the model, not scaled."""
        local = (solid.mesh.vertices - self.at_m) @ self.turn / self.scale
        return trimesh.Trimesh(local, solid.mesh.faces, process=False)

    def shadow(self, solid: Solid) -> BaseGeometry:
        """What one of its solids covers seen from above, in the frame of the model."""
        mesh = self.in_model(solid)
        corners = np.round(mesh.vertices[:, :2], _DECIMALS)[mesh.faces]
        sides = np.diff(corners, axis=1)
        area = (sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
        up, down = area > _SLIVER_M2, area < -_SLIVER_M2
        # Of what is closed, what faces up covers as much as all of it.
        is_closed = area[up].sum() >= -_NEARLY_ALL * area[down].sum()
        return shapely.union_all(shapely.polygons(corners[up if is_closed else up | down]))

    def shadow_in_world(self, shadow: BaseGeometry) -> BaseGeometry:
        """A shadow of the model, where this copy of it stands."""
        matrix = self.turn[:2, :2] * self.scale[:2]
        return shapely.transform(shadow, lambda at: at @ matrix.T + self.at_m[:2])

    @property
    def is_upright(self) -> bool:
        """Whether it stands as its model does."""
        return float(self.turn[2, 2]) > 1.0 - _STRAIGHT

    @property
    def yaw_deg(self) -> float:
        """Counter-clockwise, seen from above."""
        return float(np.degrees(np.arctan2(self.turn[1, 0], self.turn[0, 0])))


def pieces_of(stage: Usd.Stage, house: House) -> Iterator[Piece]:
    """Furniture, and the dressing that is fixed to the house or stands on its floor.

    Left out is what lies on furniture or stands on boards: cushions, books, bowls.
    """
    transforms = UsdGeom.XformCache()
    for item in house.things():
        if item.id in house.bodies and _is_fixed(item.category):
            yield _piece(stage.GetPrimAtPath(item.id), item, house, transforms)


@cache
def _is_fixed(category: str) -> bool:
    row = CATEGORIES.get(category)
    if row is None or row.level is not Level.DRESSING:
        return True
    return row.mount not in (Mount.PIECE, Mount.BOARD)


def _piece(prim: Usd.Prim, item: Item, house: House, transforms: UsdGeom.XformCache) -> Piece:
    matrix = np.array(transforms.GetLocalToWorldTransform(prim)).T
    matrix[2, 3] -= house.elevation_m
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    turn = matrix[:3, :3] / np.maximum(scale, 1e-9)
    path = str(prim.GetPath())
    model = str(prim.GetPrototype().GetPath()) if prim.IsInstance() else path
    is_straight = np.allclose(turn.T @ turn, np.eye(3), atol=_STRAIGHT)
    at_m = matrix[:3, 3]
    if not is_straight or np.linalg.det(turn) < 0.0 or scale.min() < 1e-9:
        model, at_m, turn, scale = path, np.zeros(3), np.eye(3), np.ones(3)
    solids = house.bodies[item.id].solids
    return Piece(item, model, _asset_name(prim), at_m, turn, scale, solids)


def _asset_name(prim: Usd.Prim) -> str:
    arcs = Usd.PrimCompositionQuery.GetDirectReferences(prim).GetCompositionArcs()
    named = (str(arc.GetTargetLayer().defaultPrim) for arc in arcs)
    return next((name for name in named if name), prim.GetName())
