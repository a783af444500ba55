"""The skies a house can stand under: one table. What their pictures are is in hdri.py."""

from __future__ import annotations

import math
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.inputs import refuse_odd_file

Time = Literal["day", "evening", "night"]
"""Choices of a house's variant set `lighting`."""

TIMES: tuple[Time, ...] = ("day", "evening", "night")

PICTURE_SUFFIXES = (".hdr", ".exr")
"""Of pictures that can be a sky."""

Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Sun:
    """Direct light."""

    height_deg: float
    irradiance: float
    """Of a surface that faces it; a lit wall has a radiance of about one."""
    kelvin: float = 5500.0


@dataclass(frozen=True)
class Sky:
    """What a house is lit by from outside."""

    name: str
    time: Time
    picture: str
    """Stem of an HDRI that comes with Blender's wheel; "" for one of the user's."""
    title: str
    """The HDRI's own name, for its credit."""
    radiance: float
    """Mean of the upper half; a lit wall has a radiance of about one."""
    sun: Sun | None
    sun_at_deg: float
    """Longitude in the picture that is turned to where most windows look: its sun."""
    tint: Rgb = (1.0, 1.0, 1.0)
    """What the picture is multiplied with, linear."""
    stops: tuple[tuple[float, Rgb], ...] = ()
    """Where there is no picture: (height from -1 below to 1 above, sRGB in [0, 1])."""
    file: Path | None = None
    """A picture of the user's."""


_DAY_STOPS = (
    (-1.0, (0.58, 0.56, 0.54)),
    (-0.01, (0.68, 0.66, 0.64)),
    (0.01, (0.98, 0.99, 1.0)),
    (0.4, (0.81, 0.90, 1.0)),
    (1.0, (0.66, 0.80, 1.0)),
)
_DUSK_STOPS = (
    (-1.0, (0.10, 0.10, 0.13)),
    (-0.01, (0.22, 0.20, 0.24)),
    (0.01, (0.98, 0.66, 0.48)),
    (0.25, (0.45, 0.47, 0.68)),
    (1.0, (0.16, 0.22, 0.45)),
)
_NIGHT_STOPS = (
    (-1.0, (0.05, 0.05, 0.08)),
    (-0.01, (0.10, 0.10, 0.14)),
    (0.01, (0.35, 0.38, 0.52)),
    (0.3, (0.16, 0.20, 0.36)),
    (1.0, (0.06, 0.08, 0.18)),
)

SKIES = (
    Sky("noon", "day", "forest", "Ninomaru Teien", 4.5, Sun(42.0, 16.0), 215.7, stops=_DAY_STOPS),
    Sky("morning", "day", "sunrise", "Spruit Sunrise", 4.0, Sun(16.0, 13.0, 4200.0), 215.7,
        stops=_DAY_STOPS),
    Sky("overcast", "day", "city", "Portland Landing Pad", 6.5, None, 216.0, stops=_DAY_STOPS),
    Sky("evening", "evening", "sunset", "Venice Sunset", 0.30, None, 216.0,
        (0.62, 0.78, 1.15), _DUSK_STOPS),
    Sky("night", "night", "night", "Moonless Golf", 0.035, None, 101.8,
        (0.50, 0.72, 1.25), _NIGHT_STOPS),
)  # fmt: skip
"""The first of each time is the one that is taken where nobody has chosen."""

OWN_SKY_RADIANCE = 4.5
"""Mean of the upper half of a user's picture."""


def sky_named(name: str) -> Sky:
    """The sky of this name, or one of a picture's file; "" for the usual one by day.

    Raises ChordError for an unknown name and a file that is not there; hdri.require_picture
    checks whether a file holds a picture.
    """
    names = [sky.name for sky in SKIES]
    if not name:
        return SKIES[0]
    if name in names:
        return SKIES[names.index(name)]
    file = Path(name)
    expected = f"one of {', '.join(names)}, or an HDRI ({', '.join(PICTURE_SUFFIXES)})"
    if file.suffix.lower() not in PICTURE_SUFFIXES:
        near = get_close_matches(name, names, n=1)
        raise ChordError(
            f"there is no sky {name!r}", where="<sky>", value=name, expected=expected,
            try_=f"<sky={near[0]}>" if near else "",
        )  # fmt: skip
    refuse_odd_file(file)
    return Sky(file.stem, "day", "", file.name, OWN_SKY_RADIANCE, None, math.nan, file=file)


def skies_with(chosen: Sky) -> dict[Time, Sky]:
    """A sky for each time; the chosen one comes first."""
    usual = {time: next(sky for sky in SKIES if sky.time == time) for time in TIMES}
    return {chosen.time: chosen} | {time: usual[time] for time in TIMES if time != chosen.time}


def dome_turn_deg(at_deg: float, yaw_deg: float) -> float:
    """How far a Z-up DomeLight is turned about the vertical, so that what is at this longitude of
    its picture (0 at its left edge) stands in this direction, counter-clockwise from +x."""
    return (at_deg + yaw_deg - 90.0) % 360.0
