"""Which lamps shine on a picture, and what shadow rays are sent to.

A shadow ray to a lamp behind two walls costs as much as one that arrives.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

from chord_usd.image.job import Job
from chord_usd.image.joined import lit_with
from chord_usd.image.worker.outside import panes
from chord_usd.image.worker.scene import CEILING

EVEN_SKY = 16.0
"""A sky whose brightest point is at most this many times its mean needs no shadow rays."""

FILM_K = 4300.0
"""Colour temperature that pictures by lamplight are balanced for: still warm, but not orange."""

_DAYLIGHT_K = 6500.0
_BY_LAMPS_K = 4000.0
"""Where area lights are warmer than this, lamps light the house."""

_MOST_BELOW_CEILING = 24
"""Faces of curtains, rails and lamps that may hang between a window and the ceiling."""

_POWER = "chord_usd_power"
"""Property that keeps what a lamp gives when it shines."""


def balance(scene: Any, job: Job) -> bool:
    """Whether lamps light the rooms, as in the evening; film is then balanced for them.

    Each lamp becomes colder by as many mired as lie between daylight and FILM_K; the sky stays.
    """
    lamps = [lamp for lamp in bpy.data.lights if lamp.type in ("AREA", "POINT")]
    panels = [lamp for lamp in lamps if lamp.type == "AREA" and lamp.use_temperature]
    if not job.rooms or not panels or min(lamp.temperature for lamp in panels) > _BY_LAMPS_K:
        return False
    shift = 1e6 / FILM_K - 1e6 / _DAYLIGHT_K
    for lamp in lamps:
        if lamp.use_temperature:
            lamp.temperature = 1e6 / max(1e6 / lamp.temperature - shift, 1e6 / 15000.0)
    return True


def switch_lamps(scene: Any, job: Job, room: str) -> None:
    """Let lamps shine whose light can reach a room; all of them for "", a view of no room.

    The others are turned down, not hidden: Cycles numbers lamps as they come in sight, and with the
    numbers the noise of a picture would depend on the pictures before it.
    """
    lit = lit_with(room, job.joined) if room and job.quality.own_lamps else set(job.rooms)
    shining = 0
    for thing in bpy.data.objects:
        if thing.type == "LIGHT" and not thing.data.cycles.is_portal:
            owner, lamp = room_of(thing, job.rooms), thing.data
            if _POWER not in lamp:
                lamp[_POWER] = lamp.energy
            lamp.energy = lamp[_POWER] if not owner or owner in lit else 0.0
            shining += lamp.energy > 0.0
    scene.cycles.use_light_tree = shining >= job.quality.light_tree_lamps


def room_of(thing: Any, rooms: Iterable[str]) -> str:
    """Name of the room that an object belongs to; "" for none."""
    above = thing.parent
    while above is not None:
        name = above.name.split(".")[0]  # Blender numbers what has one name, behind a dot
        if name in rooms:
            return str(name)
        above = above.parent
    return ""


def aim_at_lamps(scene: Any, job: Job) -> None:
    """Send no shadow rays to screens and to an even sky; bounces find these well enough.

    Only in houses with rooms: elsewhere what glows may be all the light there is.
    """
    if job.quality.sample_glow or not job.rooms:
        return
    for material in bpy.data.materials:
        material.cycles.emission_sampling = "NONE"
    if not hang_portals(scene, job) and _is_even(scene.world):
        scene.world.cycles.sampling_method = "NONE"


def hang_portals(scene: Any, job: Job) -> int:
    """Tell Cycles through which holes the sky is seen; returns how many there are."""
    if not job.quality.portals or not job.has_dome:
        return 0
    count = 0
    for pane in panes():
        matrix = _portal_matrix(scene, pane)
        if matrix is None:
            continue
        turn, width, height = matrix
        lamp = bpy.data.lights.new("Portal", "AREA")
        lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", width, height
        lamp.cycles.is_portal = True
        portal = bpy.data.objects.new("Portal", lamp)
        portal.matrix_world = turn
        scene.collection.objects.link(portal)
        count += 1
    return count


def _portal_matrix(scene: Any, pane: Any) -> tuple[Any, float, float] | None:
    """Where a portal stands, on the room's side of a pane, and its size; None for glass indoors."""
    corners = np.array([pane.matrix_world @ Vector(corner) for corner in pane.bound_box])
    turn = pane.matrix_world.to_3x3().normalized()
    along, across = np.array(turn.col[0]), np.array(turn.col[1])
    middle = corners.mean(axis=0)
    widths = [float(np.ptp(corners @ axis)) for axis in (along, across)]
    if widths[0] < widths[1]:
        along, across, widths = across, along, widths[::-1]
    height = float(np.ptp(corners[:, 2]))
    graph = bpy.context.evaluated_depsgraph_get()
    indoors = [_has_ceiling(scene, graph, middle + side * across * 0.45) for side in (1.0, -1.0)]
    if indoors[0] == indoors[1]:
        return None
    inwards = across if indoors[0] else -across
    # A portal looks along its own -z.
    up = np.array([0.0, 0.0, 1.0])
    axes = np.column_stack([np.cross(up, -inwards), up, -inwards])
    matrix = Matrix([[*axes[row], middle[row]] for row in range(3)] + [[0.0, 0.0, 0.0, 1.0]])
    return matrix, widths[0], height


def _has_ceiling(scene: Any, graph: Any, at_m: np.ndarray) -> bool:
    """Whether there is a ceiling above a point, whatever hangs below it."""
    at, up = Vector(at_m), Vector((0.0, 0.0, 1.0))
    for _ in range(_MOST_BELOW_CEILING):
        hit, place, _, _, found, _ = scene.ray_cast(graph, at, up)
        if not hit:
            return False
        if found.name.startswith(CEILING):
            return True
        at = place + 1e-3 * up
    return False


def _is_even(world: Any) -> bool:
    skies = [node.image for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT"]
    for sky in skies:
        if sky is None or not sky.size[0]:
            continue
        rgba = np.empty(sky.size[0] * sky.size[1] * sky.channels, dtype=np.float32)
        sky.pixels.foreach_get(rgba)
        light = rgba.reshape(-1, sky.channels)[:, :3].mean(axis=1)
        if light.max() > EVEN_SKY * light.mean():
            return False
    return True
