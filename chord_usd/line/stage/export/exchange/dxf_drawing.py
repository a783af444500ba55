"""A house as a plan for CAD: layers by kind, metres, furniture as blocks.

Outlines carry an elevation and a thickness, as DXF has them: from above a plan, turned a model. So
the heights of sills and heads are in it, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from pxr import Usd
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.fonts import fonts_kept
from chord_usd.base.scene.geometry import footprint, polygons_of, room_polygon, to_world
from chord_usd.base.scene.palette import CATEGORIES, Level
from chord_usd.base.scene.tunnels import Tunnel
from chord_usd.base.scene.types import ROOM_HEIGHT_M, FloatArray, Room
from chord_usd.line.stage.author.names import identifier
from chord_usd.line.stage.export.exchange.built_house import (
    BuiltStairs,
    House,
    houses_of,
    span_in_plan,
)
from chord_usd.line.stage.export.exchange.placed_pieces import Piece, pieces_of
from chord_usd.line.stage.shell.opening_parts import leaves_of, railing_guard

_LAYERS = {
    "WALLS": 7, "WALLS-FILL": 8, "DOORS": 30, "WINDOWS": 150, "PASSAGES": 40, "RAILINGS": 9,
    "ROOMS": 92, "FURNITURE": 33, "FURNITURE-DRESSING": 53, "DIMENSIONS": 1,
}  # fmt: skip
"""Colours by AutoCAD's index."""

_STAIRS = {"STAIRS": 40}
"""What storeys have, too."""

_METRES = 6
_GRID_M = 1e-4
_SHORTEST_TEXT_M, _TEXT_M = 0.08, 0.16
_DIMENSIONS_OFF_M = 0.8
_SIMPLER_M = 3e-3
_LEAST_PART = 0.02
"""Share of a piece's footprint below which a part of it is not drawn by itself."""


def write_dxf(stage: Usd.Stage, target: Path) -> None:
    """Write the house on a stage as a .dxf file. Raises StageError, MissingExtraError."""
    houses = houses_of(stage)
    blocks: dict[str, str] = {}
    with _drawing([house.storey for house in houses]) as document:
        for house in houses:
            before = len(document.modelspace())
            _draw(_Sheet(document, house, blocks), pieces_of(stage, house))
            if house.storey:
                _lift(document.modelspace()[before:], house)
        _note_extents(document)
        document.saveas(target)


def _note_extents(document: Any) -> None:
    """Say how far the drawing reaches, which programs zoom to."""
    from ezdxf import bbox

    reach = bbox.extents(document.modelspace(), fast=True)
    if reach.has_data:
        document.modelspace().reset_extents(reach.extmin, reach.extmax)
        document.header["$EXTMIN"], document.header["$EXTMAX"] = reach.extmin, reach.extmax


def _draw(sheet: _Sheet, pieces: Iterable[Piece]) -> None:
    sheet.draw_walls()
    for tunnel in sheet.house.walls.tunnels.values():
        sheet.draw_opening(tunnel)
    for room in sheet.house.plan.rooms:
        sheet.draw_room(room)
    for stair in sheet.house.stairs:
        sheet.draw_stair(stair)
    for piece in pieces:
        sheet.draw_piece(piece)
    sheet.draw_dimensions()


def _lift(entities: Iterable[Any], house: House) -> None:
    """Put what is drawn of a storey on its layers, and to its height."""
    for entity in entities:
        entity.dxf.layer = storey_layer(house.storey, entity.dxf.layer)
        if entity.dxftype() != "DIMENSION":
            entity.translate(0.0, 0.0, house.elevation_m)


def storey_layer(storey: str, layer: str) -> str:
    """Name of a layer of a storey; line/plan/vector/dxf.py reads storeys by it."""
    return f"{storey}-{layer}"


@contextmanager
def _drawing(storeys: Sequence[str]) -> Iterator[Any]:
    """An empty drawing; whatever is saved in the block has no time and no random number in it.

    storeys: names of those that have layers of their own; "" for none.
    """
    with needed_for("writing DXF"), fonts_kept():
        import ezdxf
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        document = ezdxf.new("R2010", setup=["linetypes", "dimstyles"])
        document.header["$INSUNITS"] = _METRES
        document.header["$MEASUREMENT"] = 1
        for storey in storeys:
            for name, colour in (_LAYERS | _STAIRS if storey else _LAYERS).items():
                layer_name = storey_layer(storey, name) if storey else name
                layer = document.layers.add(layer_name, color=colour)
                if name == "PASSAGES":
                    layer.dxf.linetype = "DASHED"
        yield document
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


class _Sheet:
    """The drawing in model space."""

    def __init__(self, document: Any, house: House, blocks: dict[str, str]) -> None:
        """blocks: names by model; filled."""
        self._document, self._space, self.house = document, document.modelspace(), house
        self._blocks = blocks

    def draw_walls(self) -> None:
        """Outlines of what a cut through windows and doors leaves, filled; and railings."""
        walls = self.house.walls
        cut = unary_union([tunnel.area_m for tunnel in walls.cuts()])
        left = shapely.difference(walls.solid_m, cut, grid_size=_GRID_M)
        for part in polygons_of(left):
            fill = self._space.add_hatch(dxfattribs={"layer": "WALLS-FILL"})
            for ring in (part.exterior, *part.interiors):
                corners = list(ring.coords)[:-1]
                fill.paths.add_polyline_path(corners, is_closed=True)
                self._outline(corners, "WALLS", 0.0, ROOM_HEIGHT_M)
        for _, tunnel in walls.railings:
            guard = railing_guard(tunnel)
            bar = to_world(tunnel.opening.box, footprint(guard))
            self._outline(bar, "RAILINGS", tunnel.low_m, guard.size_m[2])

    def draw_opening(self, tunnel: Tunnel) -> None:
        """A door with its leaves open and their swing, a window with its pane, a passage."""
        opening = tunnel.opening
        height_m = tunnel.high_m - tunnel.low_m
        if opening.kind == "door":
            self._draw_door(tunnel, height_m)
            return
        layer = "WINDOWS" if opening.kind == "window" else "PASSAGES"
        span = span_in_plan(tunnel)
        hole = box(span.left, span.front, span.right, span.back)
        corners = to_world(opening.box, list(hole.exterior.coords)[:-1])
        self._outline(corners, layer, tunnel.low_m, height_m)
        if opening.kind == "window":
            start, end = to_world(
                opening.box, [(span.left, span.middle), (span.right, span.middle)]
            )
            self._space.add_line(start, end, dxfattribs={"layer": layer})

    def _draw_door(self, tunnel: Tunnel, height_m: float) -> None:
        """Leaves as wide as the hole, so that arcs end at its jambs."""
        opening, span = tunnel.opening, span_in_plan(tunnel)
        opens = self.house.opens_to(opening)
        width = span.right - span.left
        leaves = [(span.left, width, 1.0)]
        if len(leaves_of(tunnel)) > 1:
            leaves = [(span.left, width / 2, 1.0), (span.right, width / 2, -1.0)]
        for hinge, long, way in leaves:
            foot, tip, shut = to_world(opening.box, [
                (hinge, span.middle), (hinge, span.middle + opens * long),
                (hinge + way * long, span.middle),
            ])  # fmt: skip
            drawn = {"layer": "DOORS", "thickness": height_m}
            self._space.add_line(foot, tip, dxfattribs=drawn)
            angles = [float(np.degrees(np.arctan2(*(end - foot)[::-1]))) for end in (shut, tip)]
            if (angles[1] - angles[0]) % 360.0 > 180.0:
                angles.reverse()  # arcs run counter-clockwise
            self._space.add_arc(foot, long, *angles, dxfattribs=drawn)

    def draw_room(self, room: Room) -> None:
        """Its outline, with its name and area in it."""
        floor = room_polygon(room)
        self._outline(room.polygon_m, "ROOMS")
        name = _escaped(self.house.title(room))
        west, south, east, north = floor.bounds
        height = min(_TEXT_M, (east - west) / (0.8 * max(len(name), 7)), (north - south) / 4)
        place = floor.representative_point()
        words = self._space.add_mtext(
            f"{name}\\P{floor.area:.1f} m²",
            dxfattribs={"layer": "ROOMS", "char_height": max(height, _SHORTEST_TEXT_M)},
        )
        words.set_location((place.x, place.y), attachment_point=5)

    def draw_stair(self, stair: BuiltStairs) -> None:
        """An outline of each step at its height, and the line that one walks up."""
        for solid in stair.solids:
            if not solid.path.rsplit("/", 1)[-1].startswith("Steps"):
                continue
            triangles = solid.mesh.vertices[solid.mesh.faces]
            level = np.ptp(triangles[:, :, 2], axis=1) < _GRID_M
            heights = triangles[:, 0, 2].round(3)
            upward = _double_area(triangles) > _GRID_M
            for height_m in np.unique(heights[level & upward]):
                faces = triangles[level & upward & (heights == height_m)][:, :, :2]
                step = shapely.union_all(shapely.polygons(faces), grid_size=_GRID_M)
                for part in polygons_of(step):
                    self._outline(list(part.exterior.coords)[:-1], "STAIRS", float(height_m))
        walk = np.round(stair.walk_m[:, :2], 5).tolist()
        self._space.add_lwpolyline(walk, dxfattribs={"layer": "STAIRS"})

    def draw_piece(self, piece: Piece) -> None:
        """A copy of its model's block."""
        row = CATEGORIES.get(piece.item.category)
        dressing = row is not None and row.level is Level.DRESSING
        if not piece.is_upright:
            return  # its block, seen from above, is not it
        if piece.model not in self._blocks:
            self._blocks[piece.model] = self._block(piece)
        where = {
            "layer": "FURNITURE-DRESSING" if dressing else "FURNITURE",
            "rotation": piece.yaw_deg,
            "xscale": float(piece.scale[0]), "yscale": float(piece.scale[1]),
            "zscale": float(piece.scale[2]),
        }  # fmt: skip
        self._space.add_blockref(self._blocks[piece.model], piece.at_m, dxfattribs=where)

    def _block(self, piece: Piece) -> str:
        """Its outline, and the outlines of its larger parts, seen from above."""
        stem = identifier(piece.asset)[:200]
        name, number = stem, 1
        while name in self._document.blocks:
            number += 1
            name = f"{stem}_{number}"
        block = self._document.blocks.new(name)
        shadows = [piece.shadow(solid) for solid in piece.solids]
        whole = unary_union(shadows)
        drawn: list[Polygon] = []
        for shadow in (whole, *shadows):
            for part in polygons_of(shadow.simplify(_SIMPLER_M)):
                known = any(part.symmetric_difference(other).area < 1e-3 for other in drawn)
                if not known and part.area > _LEAST_PART * whole.area:
                    drawn.append(part)
                    for ring in (part.exterior, *part.interiors):
                        block.add_lwpolyline(np.array(ring.coords)[:-1].tolist(), close=True)
        return name

    def draw_dimensions(self) -> None:
        """How wide and how deep the house is, over all."""
        west, south, east, north = box(*self.house.walls.solid_m.bounds).bounds
        off = _DIMENSIONS_OFF_M
        for base, start, end, angle in (
            ((west, south - off), (west, south), (east, south), 0.0),
            ((west - off, south), (west, south), (west, north), 90.0),
        ):
            self._space.add_linear_dim(
                base=base, p1=start, p2=end, angle=angle, dimstyle="EZDXF",
                override={"dimtxt": _TEXT_M, "dimasz": 0.12, "dimdec": 2, "dimlfac": 1.0},
                dxfattribs={"layer": "DIMENSIONS"},
            ).render()  # fmt: skip

    def _outline(
        self, corners: Iterable[Sequence[float]] | FloatArray, layer: str, low_m: float = 0.0,
        height_m: float = 0.0,
    ) -> None:  # fmt: skip
        points = np.round(np.array(list(corners)), 5) + 0.0
        self._space.add_lwpolyline(points.tolist(), close=True, dxfattribs={
            "layer": layer, "elevation": low_m, "thickness": height_m
        })  # fmt: skip


def _double_area(triangles: FloatArray) -> FloatArray:
    """(M,) seen from above; negative from below."""
    (ax, ay), (bx, by) = ((triangles[:, at, :2] - triangles[:, 0, :2]).T for at in (1, 2))
    return np.asarray(ax * by - ay * bx)


def _escaped(name: str) -> str:
    """A name in the markup of MTEXT."""
    for sign in ("\\", "{", "}"):
        name = name.replace(sign, f"\\{sign}")
    return name.replace("^", "^ ").replace("%%", "% %")
