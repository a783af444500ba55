"""Which lamps shine on a picture, and what shadow rays are sent to.

A shadow ray to a lamp behind two walls costs as much as one that arrives.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy
import numpy as np

from chord_usd.image.job import Job
from chord_usd.image.joined import lit_with

EVEN_SKY = 8.0
"""A sky whose brightest point is at most this many times its mean needs no shadow rays."""

_POWER = "chord_usd_power"
"""Property that keeps what a lamp gives when it shines."""


def switch_lamps(scene: Any, job: Job, room: str) -> None:
    """Let lamps shine whose light can reach a room; all of them for "", a view of no room.

    The others are turned down, not hidden: Cycles numbers lamps as they come in sight, and with the
    numbers the noise of a picture would depend on the pictures before it.
    """
    lit = lit_with(room, job.joined) if room and job.quality.own_lamps else set(job.rooms)
    shining = 0
    for thing in bpy.data.objects:
        if thing.type == "LIGHT":
            owner, lamp = _room_of(thing, job.rooms), thing.data
            if _POWER not in lamp:
                lamp[_POWER] = lamp.energy
            lamp.energy = lamp[_POWER] if not owner or owner in lit else 0.0
            shining += lamp.energy > 0.0
    scene.cycles.use_light_tree = shining >= job.quality.light_tree_lamps


def _room_of(lamp: Any, rooms: Iterable[str]) -> str:
    above = lamp.parent
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
    if _is_even(scene.world):
        scene.world.cycles.sampling_method = "NONE"


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
