"""Floors and walls of wood: planks, herringbone, chevron, basket parquet, laminate, panelling."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from chord_usd.base.scene.types import ROOM_HEIGHT_M
from chord_usd.library.looks.look_colours import WOODS, lit, mixed, plain, rgb_of, toned
from chord_usd.library.textures.boards import (
    Boards,
    basket,
    chevron,
    herringbone,
    herringbone_tile_m,
    running,
    upright,
    years,
)
from chord_usd.library.textures.fields import Ground, Raster, looked_up, noise

_RING_M = 0.0085
"""Mean width of a year; finer ones would be finer than the pixels."""


@dataclass(frozen=True, eq=False)
class Maps:
    """One repeat of a surface."""

    ground: Ground
    rgb: Raster
    """(H, W, 3) sRGB, 0 to 255."""
    roughness: Raster
    """(H, W), 0 to 1."""
    height_m: Raster
    """(H, W) relief in metres."""
    standing: bool = False
    """Whether row 0 of the repeat belongs to the ceiling and the last one to the floor."""


def planks(
    rng: np.random.Generator, px: int, *, wood: str, tone: float, width_m: float, length_m: float,
    joint_m: float, wear: float, sheen: float,
) -> Maps:  # fmt: skip
    """Boards of random lengths about length_m, laid by eye."""
    rows = max(8, round(2.2 / width_m))
    ground = Ground(px, (2 * length_m, rows * width_m))
    boards = running(ground, rows, 2, rng=rng)
    return timber(rng, boards, wood, tone, joint_m, wear, sheen)


def laid_herringbone(
    rng: np.random.Generator, px: int, *, wood: str, tone: float, width_m: float, ratio: float,
    joint_m: float, wear: float, sheen: float,
) -> Maps:  # fmt: skip
    """Blocks ratio times as long as wide; the zigzag runs along y."""
    blocks = round(ratio)
    across = max(1, round(1.8 / (math.sqrt(2.0) * blocks * width_m)))
    along = max(6, round(1.8 / (math.sqrt(2.0) * width_m)))
    ground = Ground(px, herringbone_tile_m(width_m, blocks, (across, along)))
    boards = herringbone(ground, width_m, blocks)
    return timber(rng, boards, wood, tone, joint_m, wear, sheen)


def laid_chevron(
    rng: np.random.Generator, px: int, *, wood: str, tone: float, width_m: float, length_m: float,
    angle_deg: float, joint_m: float, wear: float, sheen: float,
) -> Maps:  # fmt: skip
    """Boards cut to points at an angle; the points run along y."""
    cosine = math.cos(math.radians(angle_deg))
    columns = 2 * max(1, round(0.9 / (length_m * cosine)))
    rows = max(8, round(1.9 * cosine / width_m))
    ground = Ground(px, (columns * length_m * cosine, rows * width_m / cosine))
    boards = chevron(ground, columns, rows, angle_deg)
    return timber(rng, boards, wood, tone, joint_m, wear, sheen)


def parquet(
    rng: np.random.Generator, px: int, *, wood: str, tone: float, block_m: float, strips: float,
    joint_m: float, wear: float, sheen: float,
) -> Maps:  # fmt: skip
    """Squares of strips that lie and stand in turn."""
    blocks = 2 * max(2, round(0.9 / block_m))
    ground = Ground(px, (blocks * block_m, blocks * block_m))
    return timber(rng, basket(ground, blocks, round(strips)), wood, tone, joint_m, wear, sheen)


def laminate(
    rng: np.random.Generator, px: int, *, wood: str, tone: float, strip_m: float, length_m: float,
    sheen: float,
) -> Maps:  # fmt: skip
    """Boards of three strips each, with hardly a joint."""
    rows = 3 * max(4, round(0.65 / strip_m))
    ground = Ground(px, (2 * length_m, rows * strip_m))
    boards = running(ground, rows, 5, rng=rng)
    return timber(rng, boards, wood, tone, 0.0004, 0.0, sheen, variation=0.045)


def timber(
    rng: np.random.Generator, boards: Boards, wood: str, tone: float, joint_m: float, wear: float,
    sheen: float, *, variation: float = 0.06, bevel_m: float = 0.0009,
) -> Maps:  # fmt: skip
    """Boards with the grain of their own trees. wear: 0 new to 1 trodden for decades."""
    ground = boards.ground
    # As if all boards were cut from one long log: the grain is drawn along x of this ground.
    log = Ground(ground.px, (2.4, 1.6))
    jump = rng.uniform(0.0, 1.0, (boards.count, 2)) * log.tile_m
    along = boards.along_m + boards.each(jump[:, 0])
    across = boards.across_m + boards.each(jump[:, 1])
    fibre = noise(rng, log, 0.6, longest_m=0.05, stretch=(26.0, 1.0))
    streak = noise(rng, log, 1.3, longest_m=0.3, shortest_m=0.008, stretch=(14.0, 1.0))
    wander = noise(rng, log, 2.0, longest_m=0.5, shortest_m=0.012, stretch=(7.0, 1.0))
    fine = looked_up(fibre + 0.9 * streak, log, along, across)
    width_m = float(boards.across_m.max())
    rings = years(
        rng, boards, along, looked_up(wander, log, along, across),
        ring_m=_RING_M, period_m=2.4, waves=2,
        heart_m=rng.uniform(-0.9, 1.9, boards.count) * width_m,
        deep_m=rng.uniform(0.008, 0.05, boards.count),
    )  # fmt: skip
    late_share = rings * rings * np.clip((1.0 - rings) * 6.0, 0.0, 1.0)
    late, early = (toned(colour, tone) for colour in WOODS[wood])
    share = 0.62 + 0.09 * fine - 0.42 * late_share
    gain = 1.0 + boards.each(_tones(rng, boards.count, variation * (1.0 + 0.5 * wear)))
    joint = boards.joint(joint_m)
    trodden = np.zeros(1, dtype=np.float32)
    if wear > 0.05:
        trodden = noise(rng, ground, 1.2, longest_m=0.8, shortest_m=0.01) * np.float32(wear)
        gain = gain * (1.0 + 0.045 * trodden - 0.1 * wear * _near(boards, 0.006))
    rgb = lit(mixed(late, early, share), gain * (1.0 - (0.62 + 0.2 * wear) * joint))
    warmth = boards.each(_tones(rng, boards.count, 0.012))
    rgb[..., 2] *= 1.0 - warmth
    rise = np.clip(boards.edge_m / np.float32(max(2.5 * joint_m, 0.002)), 0.0, 1.0) - 1.0
    height = bevel_m * rise + 3e-5 * fine + 1.2e-4 * trodden
    rough = 0.85 - 0.55 * sheen - 0.03 * fine + 0.22 * joint + 0.07 * trodden
    return Maps(ground, rgb, rough, height)


def _near(boards: Boards, reach_m: float) -> Raster:
    return np.clip(1.0 - boards.edge_m / np.float32(reach_m), 0.0, 1.0)


def _tones(rng: np.random.Generator, count: int, deviation: float) -> Raster:
    """One number per board; no outliers, which would betray the repeat."""
    return deviation * np.clip(rng.standard_normal(count), -1.6, 1.6)


def panelling(
    rng: np.random.Generator, px: int, *, wood: str, tone: float, pattern: str, board_m: float,
    joint_m: float, sheen: float,
) -> Maps:  # fmt: skip
    """Boards or slats that stand side by side."""
    count = max(4, 2 * round(0.75 / board_m))
    lying = running(Ground(px, (ROOM_HEIGHT_M, count * board_m)), count, 1, offset=0.0)
    boards = upright(lying)
    if pattern == "boards":
        maps = timber(rng, boards, wood, tone, joint_m, 0.0, sheen, bevel_m=0.003)
        return replace(maps, standing=True)
    gap_m = 0.38 * board_m
    maps = timber(rng, boards, wood, tone, 0.0, 0.0, sheen, bevel_m=0.0)
    deep = np.clip((gap_m / 2 - boards.edge_m) / boards.ground.px_m + 0.5, 0.0, 1.0)
    rgb = lit(maps.rgb, 1.0 - 0.8 * deep)
    rough, height = maps.roughness + 0.3 * deep, maps.height_m - 0.006 * deep
    return Maps(maps.ground, rgb, rough, height, standing=True)


def wainscot(
    rng: np.random.Generator, px: int, *, colour: str, above: str, height_m: float, panel_m: float,
    moulding_m: float, sheen: float,
) -> Maps:  # fmt: skip
    """Painted panels in frames up to a rail, paint above; as high as a room."""
    ground = Ground(px, (3 * panel_m, ROOM_HEIGHT_M))
    x = (ground.x_m % np.float32(panel_m))[None, :]
    y = ground.y_m[:, None]
    stile_m, rail_m = 0.06, 0.1
    inner = np.minimum(
        np.minimum(x - stile_m, panel_m - stile_m - x),
        np.minimum(y - 2 * rail_m, height_m - rail_m - 0.02 - y),
    )
    groove = np.sin(np.clip(inner / moulding_m, 0.0, 1.0) * 2.0 * np.pi) * (inner < moulding_m)
    cap = np.clip(1.0 - np.abs(y - height_m + 0.02) / 0.025, 0.0, 1.0) + np.zeros_like(x)
    height = 0.004 * groove * (inner > 0.0) - 0.006 * (inner > moulding_m) + 0.014 * np.sqrt(cap)
    stipple = noise(rng, ground, 0.9, longest_m=0.06, shortest_m=0.005)
    below = (y < height_m).astype(np.float32) + np.zeros_like(x)
    rgb = mixed(plain(ground.shape, rgb_of(above)), rgb_of(colour), below)
    edge = np.clip(1.0 - np.abs(inner) / 0.004, 0.0, 1.0) * below
    inside = np.clip(1.0 - np.abs(inner - moulding_m) / 0.004, 0.0, 1.0) * below
    under = np.clip(1.0 - np.abs(y - height_m + 0.05) / 0.006, 0.0, 1.0)
    rgb = lit(rgb, 1.0 + 0.004 * stipple - 0.16 * edge - 0.1 * inside - 0.18 * under)
    rough = 0.86 - (0.5 * sheen + 0.02) * below
    return Maps(ground, rgb, rough, (height * below + 1e-4 * stipple).astype(np.float32), True)
