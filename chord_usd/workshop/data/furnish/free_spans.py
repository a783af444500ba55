"""Free spans along a wall: where along it, and how deep, something may stand.

Every question is asked in the wall's own frame: s runs along the wall from its first corner, t
points into the room, both metres. What stands in a room is known to each of its walls as a block,
the bounding rectangle of the thing in that wall's frame: exact for parallel and perpendicular
things, on the safe side for slanted ones.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

SOLID = 1
"""Blocks that are furniture."""
ZONE = 2
"""Blocks that must stay empty: in front of doors and windows, along open sides."""
REACH = 4
"""Blocks that people use: in front of a cabinet, beside a bed. Two of these may overlap."""
ANY = SOLID | ZONE | REACH

MARGIN_M = 0.08
"""Pieces that do not belong together stand no nearer to each other than this where they can: about
a pixel of a layout raster.
"""

NO_SILL_M = -1.0
"""Sill of a block that keeps out things of every height."""

TOUCH_M = 1e-6
"""Things nearer than this only touch."""


Thing = tuple[float, float, float, float, float, float, int, float, float, float]
"""What takes floor, in the world: middle x and y, the direction of its length, half length, half
width, bits, sill, and half its extent along the world's x and y. Only what is higher than the sill
meets it.
"""

Block = tuple[float, float, float, float, int, float]
"""A thing as a wall sees it: s from and to, t from and to, bits, sill."""


class Wall:
    """One side of a room, seen from inside: corners run counter-clockwise, the room is left."""

    __slots__ = ("_blocks", "_things", "clear_m", "edges", "has_door", "has_window", "index",
                 "length", "margin_m", "ux", "uy", "x", "y", "yaw_deg")  # fmt: skip

    def __init__(
        self, index: int, start: Sequence[float], end: Sequence[float], things: list[Thing]
    ) -> None:
        """start, end: corners in the world, metres, not equal. things: shared by the room."""
        dx, dy = end[0] - start[0], end[1] - start[1]
        self.index = index
        self.length = math.hypot(dx, dy)
        self.x, self.y = start[0], start[1]
        self.ux, self.uy = dx / self.length, dy / self.length
        self.yaw_deg = _turned_back_deg(dx, dy)
        self._things = things
        self._blocks: list[Block] = []
        self.edges: list[tuple[float, float, float, float]] = []
        self.clear_m = math.inf
        """No other side of the room is nearer."""
        self.has_door = False
        self.has_window = False
        self.margin_m = 0.0
        """What gaps keep from furniture; fits does not, for pieces that belong together."""

    def local(self, x: float, y: float) -> tuple[float, float]:
        """(s, t) of a world point."""
        dx, dy = x - self.x, y - self.y
        return dx * self.ux + dy * self.uy, dy * self.ux - dx * self.uy

    def world(self, s: float, t: float) -> tuple[float, float]:
        """World point of (s, t)."""
        return self.x + s * self.ux - t * self.uy, self.y + s * self.uy + t * self.ux

    def see_edges(self, corners: Sequence[Sequence[float]]) -> None:
        """Learn the other sides of the room, so that spans end where the room does."""
        wx, wy, x0, y0 = self.ux, self.uy, self.x, self.y
        end = self.length - TOUCH_M
        points = [
            ((x - x0) * wx + (y - y0) * wy, (y - y0) * wx - (x - x0) * wy) for x, y in corners
        ]
        s0, t0 = points[-1]
        for s1, t1 in points:
            # Sides beyond the wall's own ends cut nothing off its spans.
            if (t0 > TOUCH_M or t1 > TOUCH_M) and (
                (s0 > TOUCH_M or s1 > TOUCH_M) and (s0 < end or s1 < end)
            ):
                self.edges.append((s0, t0, s1, t1))
                self.clear_m = min(self.clear_m, max(0.0, t0 if t0 < t1 else t1))
            s0, t0 = s1, t1

    def forget(self, count: int) -> None:
        """Keep the first `count` things only; the room has taken the others back."""
        del self._blocks[count:]

    def gaps(
        self,
        depth: float,
        height: float,
        reach: float = 0.0,
        least: float = 0.3,
        near: float = 0.0,
    ) -> list[tuple[float, float]]:
        """Spans [s_from, s_to] in which something may stand, in order.

        The thing takes t in [near, near + depth], is `height` high (its top above the floor), and
        needs `reach` in front of it free of walls and furniture. Spans shorter than `least` are
        left out. Everything in a span is seen from the wall, hence inside the room, and margin_m
        from all furniture.
        """
        far, margin = near + depth, self.margin_m
        reached = far + reach - TOUCH_M
        cuts = _edge_cuts(self.edges, far + reach) if far + reach > self.clear_m else []
        near, far = near + TOUCH_M, far - TOUCH_M
        for s_from, s_to, t_from, t_to, bits, sill in self._seen():
            if t_from >= reached:
                continue
            if bits == SOLID:
                if t_to > near - margin and (reach or t_from < far):
                    cuts.append((s_from - margin, s_to + margin))
            elif t_to > near and t_from < far and height > sill:
                cuts.append((s_from, s_to))
        return self._between(cuts, least)

    def bare_spans(self, depth: float, least: float) -> list[tuple[float, float]]:
        """Spans in which the empty room is at least this deep."""
        return self._between(_edge_cuts(self.edges, depth), least)

    def fits(
        self,
        s_from: float,
        s_to: float,
        t_from: float,
        t_to: float,
        height: float = 9.0,
        bits: int = ANY,
    ) -> bool:
        """Whether the rectangle is inside the room and meets no block of these bits."""
        if s_from < -TOUCH_M or s_to > self.length + TOUCH_M:
            return False
        low, high = s_from + TOUCH_M, s_to - TOUCH_M
        for b_from, b_to, b_near, b_far, b_bits, sill in self._seen():
            if (
                b_bits & bits
                and b_from < high
                and b_to > low
                and b_near < t_to - TOUCH_M
                and b_far > t_from + TOUCH_M
                and height > sill
            ):
                return False
        if t_to <= self.clear_m:
            return True
        return all(b <= low or a >= high for a, b in _edge_cuts(self.edges, t_to))

    def _seen(self) -> list[Block]:
        """All things of the room as blocks of this wall; new ones are looked at when asked for."""
        blocks = self._blocks
        if len(blocks) < len(self._things):
            wx, wy, x0, y0 = self.ux, self.uy, self.x, self.y
            level, upright = wy == 0.0, wx == 0.0
            for thing in self._things[len(blocks) :]:
                x, y, ux, uy, half_length, half_width, bits, sill, half_s, half_t = thing
                if level:
                    s, t = (x - x0) * wx, (y - y0) * wx
                elif upright:
                    s, t = (y - y0) * wy, (x0 - x) * wy
                    half_s, half_t = half_t, half_s
                else:
                    dx, dy = x - x0, y - y0
                    s, t = dx * wx + dy * wy, dy * wx - dx * wy
                    along, across = abs(ux * wx + uy * wy), abs(ux * wy - uy * wx)
                    half_s = along * half_length + across * half_width
                    half_t = across * half_length + along * half_width
                blocks.append((s - half_s, s + half_s, t - half_t, t + half_t, bits, sill))
        return blocks

    def _between(self, cuts: list[tuple[float, float]], least: float) -> list[tuple[float, float]]:
        """What the cuts leave of the wall, in pieces of at least this length."""
        least -= TOUCH_M
        if not cuts:
            return [(0.0, self.length)] if self.length >= least else []
        cuts.sort()
        gaps = []
        start, end = 0.0, self.length
        for s_from, s_to in cuts:
            if s_from >= end:
                break
            if s_from - start >= least:
                gaps.append((start, s_from))
            if s_to > start:
                start = s_to
        if end - start >= least:
            gaps.append((start, end))
        return gaps


def _edge_cuts(
    edges: Iterable[tuple[float, float, float, float]], far: float
) -> list[tuple[float, float]]:
    """What the room's other sides cut off from the strip t in [0, far]."""
    cuts = []
    far -= TOUCH_M
    for s0, t0, s1, t1 in edges:
        if (t0 >= far and t1 >= far) or (t0 <= TOUCH_M and t1 <= TOUCH_M):
            continue
        if t0 > far:
            s0 += (s1 - s0) * (t0 - far) / (t0 - t1)
        elif t1 > far:
            s1 += (s0 - s1) * (t1 - far) / (t1 - t0)
        cuts.append((s0, s1) if s0 < s1 else (s1, s0))
    return cuts


def _turned_back_deg(dx: float, dy: float) -> float:
    """Yaw of an item with its back to a wall that runs along (dx, dy); exact quarter turns."""
    if dy == 0.0:
        return 180.0 if dx > 0.0 else 0.0
    if dx == 0.0:
        return -90.0 if dy > 0.0 else 90.0
    yaw_deg = math.degrees(math.atan2(-dy, -dx))
    quarter = round(yaw_deg / 90.0) * 90.0
    yaw_deg = quarter if abs(yaw_deg - quarter) < 1e-6 else yaw_deg
    return 180.0 if yaw_deg == -180.0 else yaw_deg
