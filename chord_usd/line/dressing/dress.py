"""SceneGraph -> SceneGraph: the rooms dressed.

Windows first, since what hangs there needs a place of its own; then what hangs from ceilings and
over worktops and basins; then floors, seats and beds; last walls that are still bare, and boards.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import shapely

from chord_usd.base.metrics.clear_floor import clearances
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View, view_home
from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.metrics.walk import entrance, free_floor
from chord_usd.base.places.free_places import Borders, Walkways
from chord_usd.base.places.room_space import (
    take_clearances,
    take_fronts,
    take_pieces,
    take_swings,
    take_walls,
)
from chord_usd.base.places.taken_space import TakenSpace, as_underfoot
from chord_usd.base.places.wall_frames import faces_of
from chord_usd.base.scene.geometry import Floors, footprint_polygon, room_polygon
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.styles import HomeStyle
from chord_usd.base.scene.tunnels import as_cut
from chord_usd.base.scene.types import WET_KINDS, Item, Opening, Room, SceneGraph
from chord_usd.library.asset_shapes import leaves_of
from chord_usd.library.database import AssetDatabase
from chord_usd.line.dressing.dress_art import dress_art
from chord_usd.line.dressing.dress_bathrooms import dress_bathroom
from chord_usd.line.dressing.dress_boards import dress_boards
from chord_usd.line.dressing.dress_floors import dress_floor, dress_rugs
from chord_usd.line.dressing.dress_kitchens import dress_kitchen
from chord_usd.line.dressing.dress_pieces import dress_pieces
from chord_usd.line.dressing.dress_walls import (
    dress_ceilings,
    dress_fittings,
    hang_television,
    heated_alike,
)
from chord_usd.line.dressing.dress_windows import dress_windows
from chord_usd.line.dressing.room_frame import ReliefsOf, RoomFrame, named
from chord_usd.line.dressing.stock import Draws, Stock, taste_of


def dress(
    graph: SceneGraph,
    database: AssetDatabase,
    style: HomeStyle,
    seed: int,
    rooms: Collection[str] = (),
    keep: Collection[str] = (),
) -> SceneGraph:
    """The house with its rooms dressed in a style.

    rooms: ids of the rooms to dress again, by default all; the others keep their dressing. keep:
    ids of dressing that stays as it is. What a room gets depends on the seed, its id and what
    stands in it. Categories of which the database has nothing are left out.
    """
    chosen = set(rooms) or {room.id for room in graph.rooms}
    house = _House(graph, database, style, seed)
    dressing: list[Item] = []
    new: set[str] = set()
    for room in graph.rooms:
        old = tuple(graph.dressing_of(room.id))
        if room.id in chosen:
            kept = _kept(old, keep)
            made = house.dressed(room, kept)
            new |= {item.id for item in made} - {item.id for item in kept}
            dressing += made
        else:
            dressing += old
    return replace(graph, dressing=tuple(heated_alike(graph.rooms, dressing, new)))


def _kept(old: Sequence[Item], keep: Collection[str]) -> list[Item]:
    """What stays of a room's dressing, and what that hangs at or stands on."""
    ids = set(keep)
    ids |= {item.facts.rests_on for item in old if item.id in ids and item.facts.rests_on}
    return [item for item in old if item.id in ids]


class _House:
    """What the rooms of a house share."""

    def __init__(
        self, graph: SceneGraph, database: AssetDatabase, style: HomeStyle, seed: int
    ) -> None:
        self._graph, self._style, self._seed = graph, style, seed
        self._house = Draws(seed)
        self._stock = Stock(database, style.name, self._house)
        self._floors = Floors(graph.rooms)
        stairs = [room_polygon(room) for room in graph.rooms if is_cell(room)]
        self._free = free_floor(graph).difference(shapely.union_all(stairs))
        self._borders = Borders(graph)
        door = entrance(graph)
        self._door_id = door and door.id
        self._reliefs = ReliefsOf()
        self._openings = as_cut(graph.rooms, graph.openings)
        self._clear = list(clearances(graph.rooms, self._openings))
        self._clear_floors = shapely.STRtree([floor for _, floor in self._clear])
        self._holes = shapely.STRtree(
            [footprint_polygon(opening.box) for opening in self._openings]
        )
        balconies = [room for room in graph.rooms if room.kind == "balcony"]
        near = {
            index
            for room in balconies
            for index in self._near(room)
            if graph.openings[index].kind == "door"
        }
        watched = view_home(graph).watched_in_bed
        self._watched_in_bed = watched and watched.shell.room.id
        self._balcony_doors = frozenset(graph.openings[index].id for index in near)

    def _near(self, room: Room) -> Sequence[int]:
        """Indices of openings in the walls of a room, perhaps of more."""
        floor = self._floors.polygons[self._floors.index_of[room.id]]
        return sorted(self._holes.query(floor.buffer(0.3), predicate="intersects").tolist())

    def _seen_from(self, room: Room) -> list[Opening]:
        """Openings in the walls of other rooms that keep floor free in this one, open to them."""
        floor = self._floors.polygons[self._floors.index_of[room.id]]
        near = {self._openings[index].id for index in self._near(room)}
        seen = [self._clear[index] for index in sorted(self._clear_floors.query(floor))]
        return [
            opening
            for opening, clear in seen
            if opening.id not in near and clear.intersection(floor).area > MIN_OVERLAP_M2
        ]

    def dressed(self, room: Room, kept: Sequence[Item]) -> list[Item]:
        """The dressing of a room; kept: what stays."""
        frame = self._frame(room, kept)
        shell = shells(self._graph.rooms, self._graph.openings)[room.id]
        _dress_room(frame, View(shell, frame.pieces), room.id == self._watched_in_bed)
        taken_ids = {item.id for item in kept}
        return list(named(frame.placed, room.id, taken_ids))

    def _frame(self, room: Room, kept: Sequence[Item]) -> RoomFrame:
        near = self._near(room)
        openings = [self._openings[index] for index in near]
        nearby = [self._graph.openings[index] for index in near]
        faces = faces_of(room, openings, self._floors)
        pieces = tuple(self._graph.items_of(room.id))
        taken = TakenSpace()
        take_walls(taken, faces)
        take_clearances(taken, [*openings, *nearby, *self._seen_from(room)])
        take_pieces(taken, pieces, self._reliefs)
        take_fronts(taken, pieces)
        take_swings(taken, pieces, leaves_of)
        floor = self._floors.polygons[self._floors.index_of[room.id]]
        walkways = Walkways(self._free, floor, pieces, self._borders)
        for item in kept:
            reason = as_underfoot(item.box) if is_underfoot(item) else "dressing"
            taken.add(item.box, reason, item.id)
            if item.category == "radiator" or category(item.category).mount is Mount.FLOOR:
                walkways.take(item.box)
        door = next(
            (
                (face, hole)
                for face in faces
                for hole in face.holes
                if hole.opening.id == self._door_id
            ),
            None,
        )
        return RoomFrame(
            room, faces, pieces, taken, walkways, self._stock, taste_of(self._style.name),
            Draws(self._seed, room.id), self._house, self._reliefs, self._balcony_doors,
            door, (self._floors.index_of[room.id], len(self._graph.rooms)), list(kept),
        )  # fmt: skip


def _dress_room(frame: RoomFrame, view: View, is_watched_in: bool) -> None:
    if is_watched_in or view.shell.is_lived_in:  # before curtains, which fit beside it
        hang_television(frame, view)
    dress_windows(frame)
    dress_ceilings(frame)
    if frame.kind == "kitchen" or frame.of("cooker_cabinet", "sink_cabinet"):
        dress_kitchen(frame)
    if frame.kind in WET_KINDS or frame.of("washbasin"):
        dress_bathroom(frame)
    dress_fittings(frame)
    dress_rugs(frame)
    dress_pieces(frame)
    dress_floor(frame)
    dress_art(frame)
    dress_boards(frame)
