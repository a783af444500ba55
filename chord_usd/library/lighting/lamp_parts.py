"""Parts that lamps share: bulbs, cloth shades, shades of metal, arms of two rods, paper boxes."""

from __future__ import annotations

from dataclasses import dataclass

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.forms import hollow, outward, sphere_profile
from chord_usd.library.kit.model import Collider, Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    at_corners,
    block,
    joined,
    lathe,
    pair,
    tube,
)


def bulb(radius_m: float = 0.03) -> Solid:
    """A bulb, its neck at the origin, its top 2.4 radii higher."""
    crown = sphere_profile(radius_m, -0.7, 1.0, 8, 1.4 * radius_m)
    return outward(lathe([(0.4 * radius_m, 0.0), (0.42 * radius_m, 0.3 * radius_m), *crown], 16))


@dataclass(frozen=True)
class ShadeMake:
    """How a cloth shade is made, in metres."""

    cloth_m: float
    rim_m: float
    """Thickness of the rims, which are over the cloth by out_m and beyond its ends by over_m."""
    rim_high_m: float
    out_m: float
    over_m: float
    spoke_m: tuple[float, float, float]
    """Width, height and bevel of the spokes."""
    spoke_down_m: float
    """From the upper rim to the first spoke; the second crosses it step_m higher."""
    step_m: float
    turn_deg: float
    sides: int


FLOOR_SHADE = ShadeMake(
    0.0025, 0.005, 0.007, 0.001, 0.0006, (0.004, 0.003, 0.001), 0.022, 0.004, 0.0, 40
)
TABLE_SHADE = ShadeMake(
    0.0022, 0.0034, 0.005, 0.0006, 0.0004, (0.003, 0.002, 0.0006), 0.014, 0.0025, 15.0, 36
)


def cloth_shade(
    low_m: float, high_m: float, wide_m: float, narrow_m: float, make: ShadeMake,
    colliders: tuple[Solid, ...] = (),
) -> tuple[Part, ...]:  # fmt: skip
    """A shade with its rims and the spokes that carry it. wide_m, narrow_m: radii below and above.

    colliders: solids whose bounding boxes collide; without them the shade collides with nothing.
    """
    out, over, rim = make.out_m, make.over_m, make.rim_high_m
    skin = hollow([(wide_m, low_m), (narrow_m, high_m)], make.cloth_m, make.sides)
    rims = [
        hollow([(radius + out, low), (radius + out, high)], make.rim_m, make.sides)
        for radius, low, high in (
            (wide_m, low_m - over, low_m + rim),
            (narrow_m, high_m - rim, high_m + over),
        )
    ]
    across, tall, bevel = make.spoke_m
    spokes = [
        block((2 * narrow_m - 0.004, across, tall), bevel)
        .turned("z", make.turn_deg + 90 * i)
        .moved(z=high_m - make.spoke_down_m + make.step_m * i)
        for i in range(2)
    ]
    return (
        Part("Shade", skin, "shade", "boundingCube" if colliders else None, colliders=colliders),
        Part("Rims", joined(rims), "trim", None),
        Part("Spokes", joined(spokes), "metal", None),
    )


def metal_shade(
    outside_m: list[tuple[float, float]], inside_m: list[tuple[float, float]], light: Solid, *,
    thick_m: float = 0.0025, sides: int = 32, name: str = "Cone", collider: Collider | None = None,
) -> tuple[Part, ...]:  # fmt: skip
    """A turned shade, (radius, z) from its rim upwards, pale inside, with its bulb."""
    return (
        Part(name, hollow(outside_m, thick_m, sides), "metal", collider),
        Part("Inside", hollow(inside_m, thick_m / 2, sides), "lining", None),
        Part("Bulb", light, "bulb", None),
    )


def two_rods(start_m: FloatArray, end_m: FloatArray, aside_m: float, radius_m: float) -> Solid:
    """Two parallel rods from a joint to the next, aside_m to either side along y."""
    return joined(pair(tube([start_m, end_m], radius_m, 8), y=aside_m))


def paper_box(
    size_m: Size, rails: tuple[float, ...], *, post_m: float, deep_m: float, tall_m: float,
    paper_m: float, long_m: float,
) -> tuple[list[Solid], Solid]:  # fmt: skip
    """The posts and rails of a box with paper walls, and the walls.

    rails: heights as shares of the height. deep_m, tall_m: section of a rail. paper_m: thickness of
    the walls, which reach over long_m from a tenth of the height.
    """
    length, width, height = size_m
    at_x, at_y = (length - post_m) / 2, (width - post_m) / 2
    frame = at_corners(block((post_m, post_m, height), post_m / 9), at_x, at_y)
    for share in rails:
        # Rails that cross do not meet in one plane.
        along = block((length - 2 * post_m + 0.002, deep_m, tall_m), 0.001)
        across = block((deep_m, width - 2 * post_m + 0.002, tall_m - 0.0005), 0.001)
        frame += pair(along.moved(z=share * height), y=at_y)
        frame += pair(across.moved(z=share * height + 0.0002), x=at_x)
    long = block((length - 2 * post_m + 0.005, paper_m, long_m), paper_m / 4)
    short = block((paper_m, width - 2 * post_m - 0.0035, long_m), paper_m / 4)
    walls = [*pair(long, y=at_y - 0.0055), *pair(short, x=at_x - 0.0055)]
    return frame, joined(walls).moved(z=0.1035 * height)
