"""What has to be true of a house after a sentence changed it: the facts of sentences.json."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import sides_of
from chord_usd.base.scene.geometry import footprint_polygon, front_direction
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.base.scene.units import wrap_deg

OPENINGS = ("window", "door")


class Facts:
    """Looks at a house before and after. rooms: ids by what sentences.json calls rooms."""

    def __init__(
        self, before: SceneGraph, after: SceneGraph, rooms: Mapping[str, str],
        styles: Mapping[str, str], locked: Sequence[str],
        looks: Mapping[tuple[str, Any], str] | None = None,
    ) -> None:  # fmt: skip
        """looks: names of their families, by the id of a room and its surface."""
        self._looks = looks or {}
        self._before, self._after, self._rooms = before, after, rooms
        self._styles, self._locks = styles, locked

    def is_true(self, fact: Sequence[Any]) -> bool:
        """Whether one of them holds."""
        name, room, *rest = fact
        return bool(getattr(self, f"_{name}")(self._rooms[room], *rest))

    def _of(self, graph: SceneGraph, room: str, names: str) -> list[Item]:
        wanted = names.split("|")
        things = (*graph.items, *graph.dressing)
        return [one for one in things if one.room_id == room and one.category in wanted]

    def _count(self, room: str, names: str, count: int) -> bool:
        return len(self._of(self._after, room, names)) == count

    def _more(self, room: str, names: str, count: int) -> bool:
        before = len(self._of(self._before, room, names))
        return self._count(room, names, before + count)

    def _style(self, room: str, name: str) -> bool:
        return self._styles.get(room) == name

    def _look(self, room: str, surface: str, family: str) -> bool:
        return self._looks.get((room, surface)) == family

    def _locked(self, room: str, names: str) -> bool:
        return all(one.id in self._locks for one in self._of(self._after, room, names))

    def _new(self, room: str, names: str) -> list[Item]:
        """Those that are new, else all."""
        old = {one.id for one in (*self._before.items, *self._before.dressing)}
        own = self._of(self._after, room, names)
        return [one for one in own if one.id not in old] or own

    def _target(self, graph: SceneGraph, room: str, name: str) -> shapely.Geometry:
        corners = next(own for own in graph.rooms if own.id == room).polygon_m
        if name == "corner":
            return shapely.MultiPoint(corners)
        if name == "west wall":
            x = corners[:, 0].min()
            return shapely.LineString([(x, corners[:, 1].min()), (x, corners[:, 1].max())])
        if name in OPENINGS:
            beside = sides_of(graph.openings, graph.rooms)
            holes = [o.box for o, own in beside if own.id == room
                     and (o.kind == "window") == (name == "window")]  # fmt: skip
            return shapely.union_all([footprint_polygon(box) for box in holes])
        return shapely.union_all([footprint_polygon(i.box) for i in self._of(graph, room, name)])

    def _longer(self, room: str, names: str, least: float, most: float) -> bool:
        (was,), (now,) = (self._of(graph, room, names) for graph in (self._before, self._after))
        return least <= now.box.size_m[0] / was.box.size_m[0] <= most

    def _near(self, room: str, names: str, other: str, most_m: float) -> bool:
        to = self._target(self._after, room, other)
        own = self._new(room, names)
        return bool(own) and all(footprint_polygon(i.box).distance(to) <= most_m for i in own)

    def _pair(self, room: str, names: str) -> tuple[Item, Item]:
        (was,), (now,) = (self._of(graph, room, names) for graph in (self._before, self._after))
        return was, now

    def _nearer(self, room: str, names: str, other: str, by_m: float, sign: float = 1.0) -> bool:
        was, now = (
            footprint_polygon(item.box).distance(self._target(graph, room, other))
            for item, graph in zip(
                self._pair(room, names), (self._before, self._after), strict=True
            )
        )
        return bool(sign * (was - now) >= by_m - 0.02)

    def _farther(self, room: str, names: str, other: str, by_m: float) -> bool:
        return self._nearer(room, names, other, by_m, -1.0)

    def _faces(self, room: str, names: str, other: str) -> bool:
        _, now = self._pair(room, names)
        to = self._target(self._after, room, other)
        front = front_direction(now.box.yaw_deg)
        middle = np.array(now.box.center_m[:2])
        ray = shapely.LineString([middle, middle + front * 8.0]).buffer(0.6)
        return bool(ray.intersects(to))

    def _turned(self, room: str, names: str, deg: float) -> bool:
        was, now = self._pair(room, names)
        return abs(wrap_deg(now.box.yaw_deg - was.box.yaw_deg - deg)) < 1.0

    def _moved(self, room: str, names: str, x_m: float, y_m: float) -> bool:
        was, now = self._pair(room, names)
        by = np.subtract(now.box.center_m[:2], was.box.center_m[:2])
        return math.dist(by, (x_m, y_m)) < 0.06

    def _swapped(self, room: str, one: str, other: str) -> bool:
        (a0, a1), (b0, b1) = self._pair(room, one), self._pair(room, other)
        near = math.dist(a1.box.center_m[:2], b0.box.center_m[:2]) < 0.7
        order = np.subtract(a0.box.center_m[:2], b0.box.center_m[:2]) @ np.subtract(
            a1.box.center_m[:2], b1.box.center_m[:2]
        )
        return near and float(order) < 0

    def others_are_still(self, said: Mapping[str, Any]) -> bool:
        """Whether nothing that no fact speaks of was moved, added or taken away."""
        named = {
            (self._rooms[room], one)
            for _, room, *parts in said["true"]
            for part in parts if isinstance(part, str) for one in part.split("|")
        }  # fmt: skip
        follow = said.get("follow", ())

        def rest(graph: SceneGraph) -> dict[str, tuple[Any, ...]]:
            return {
                one.id: (one.category, one.box)
                for one in (*graph.items, *graph.dressing)
                if (one.room_id, one.category) not in named
                and one.category not in follow
                and one.facts.rests_on is None
                and one.room_id not in self._styles
            }

        return rest(self._before) == rest(self._after)
