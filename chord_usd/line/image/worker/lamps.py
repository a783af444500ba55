"""Which lamps shine on a picture, and what shadow rays are sent to.

A shadow ray to a lamp behind two walls costs as much as one that arrives.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

from chord_usd.line.image.job import Job
from chord_usd.line.image.joined import lit_with

FILM_K = 4300.0
"""Colour temperature that pictures by lamplight are balanced for: still warm, but not orange."""

_DAYLIGHT_K = 6500.0
_BY_LAMPS_K = 4000.0
"""Where area lights are warmer than this, lamps light the house."""

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
        if thing.type == "LIGHT":
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


def aim_at_lamps(job: Job) -> None:
    """Send no shadow rays to screens; bounces find these well enough.

    Only in houses with rooms: elsewhere what glows may be all the light there is.
    """
    if job.quality.sample_glow or not job.rooms:
        return
    for material in bpy.data.materials:
        material.cycles.emission_sampling = "NONE"
