"""Floors and walls of tile and stone: slabs, small tiles, glazed tiles, terrazzo, marble, brick."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.looks.look_colours import CHIPS, MARBLES, lit, mixed, plain, rgb_of
from chord_usd.library.looks.look_wood import Maps
from chord_usd.library.textures.boards import Boards, hexagons, running, upright
from chord_usd.library.textures.fields import (
    Ground,
    Points,
    Raster,
    Rgb,
    looked_up,
    noise,
    stamped,
)

OFFSETS = {"stack": 0.0, "half": 0.5, "third": 1.0 / 3.0}
"""Bonds of tiles: share of a tile by which each row is shifted."""


def bonded(px: int, size_m: float, aspect: float, bond: str, least_m: float) -> Boards:
    """Tiles size_m long and 1 / aspect of it high, on a repeat of least_m or more."""
    columns = max(2, math.ceil(least_m / size_m - 0.3))
    multiple = {"stack": 1, "half": 2, "third": 3}[bond]
    rows = multiple * max(1, round(columns * aspect / multiple))
    if bond == "stack":
        rows = max(2, rows)
    ground = Ground(px, (columns * size_m, rows * size_m / aspect))
    return running(ground, rows, columns, offset=OFFSETS[bond])


def laid(
    rng: np.random.Generator, boards: Boards, face: Raster, *, grout: str, joint_m: float,
    sheen: float, variation: float = 0.012, cushion_m: float = 0.0012, waviness_m: float = 0.0,
) -> Maps:  # fmt: skip
    """Tiles with this face (H, W, 3) and grout between them; glazed ones may be a little wavy."""
    ground = boards.ground
    joint = boards.joint(joint_m)
    grain = noise(rng, ground, 0.4, longest_m=0.03)
    tones = np.clip(rng.standard_normal(boards.count), -1.6, 1.6) * variation
    rgb = lit(face, 1.0 + boards.each(tones))
    rgb = mixed(rgb, lit(plain(ground.shape, rgb_of(grout)), 1.0 + 0.03 * grain), joint)
    rise = np.clip((boards.edge_m - joint_m / 2) / np.float32(0.004), 0.0, 1.0)
    height = cushion_m * np.sqrt(1.0 - (1.0 - rise) ** 2)
    if waviness_m > 0.0:
        lean = boards.each(rng.normal(0.0, 1.0, (boards.count, 2)))
        waves = noise(rng, ground, 2.0, longest_m=0.12, shortest_m=0.02)
        tilt = lean[..., 0] * boards.along_m + lean[..., 1] * boards.across_m
        height += (waviness_m * waves + waviness_m * 12.0 * tilt) * (1.0 - joint)
    rough = (0.75 - 0.68 * sheen) * (1.0 - joint) + 0.88 * joint
    return Maps(ground, rgb, rough, height.astype(np.float32))


def stone_tile(
    rng: np.random.Generator, px: int, *, colour: str, second: str, pattern: str, size_m: float,
    aspect: float, bond: str, joint_m: float, grout: str, mottle: float, sheen: float,
) -> Maps:  # fmt: skip
    """Stone or porcelain slabs, each another piece; of one colour or as a chessboard."""
    boards = bonded(px, size_m, aspect, bond, 1.9)
    if pattern == "checker":
        count = 2 * max(1, round(0.95 / size_m))
        boards = running(Ground(px, (count * size_m,) * 2), count, count, offset=0.0)
    first = rgb_of(colour)
    tone = _stone(rng, boards, mottle)
    face = lit(plain(boards.ground.shape, first), 1.0 + tone)
    if pattern == "checker":
        columns = round(boards.ground.tile_m[0] / size_m)
        number = np.arange(boards.count)
        alternate = boards.each((number // columns + number % columns) % 2)
        face = mixed(
            face, lit(plain(boards.ground.shape, rgb_of(second)), 1.0 + 1.2 * tone), alternate
        )
    return laid(rng, boards, face, grout=grout, joint_m=joint_m, sheen=sheen)


def _stone(rng: np.random.Generator, boards: Boards, mottle: float) -> Raster:
    """Clouds and specks, another piece of them on every tile; about 0."""
    ground = Ground(boards.ground.px, (1.6, 1.6))
    cloud = noise(rng, ground, 1.4, longest_m=0.7)
    speck = noise(rng, ground, 0.4, longest_m=0.02)
    jump = rng.uniform(0.0, 1.6, (boards.count, 2))
    return looked_up(
        (0.042 * mottle) * cloud + (0.03 * mottle) * speck,
        ground,
        boards.along_m + boards.each(jump[:, 0]),
        boards.across_m + boards.each(jump[:, 1]),
    )


def mosaic(
    rng: np.random.Generator, px: int, *, colour: str, second: str, share: float, shape: str,
    size_m: float, joint_m: float, grout: str, variation: float, sheen: float,
) -> Maps:  # fmt: skip
    """Small tiles: squares, hexagons, pennies, fingers; a share of them in a second colour."""
    count = max(6, round((0.9 if size_m < 0.025 else 1.5) / size_m))
    if shape in ("hexagon", "penny"):
        rows = 2 * round(count / math.sqrt(3.0))
        ground = Ground(px, (count * size_m, rows * size_m * math.sqrt(3.0) / 2))
        boards = hexagons(ground, count, rows, round_=shape == "penny")
    elif shape == "finger":
        tall = 6.0 * size_m
        rows = max(2, round(1.2 / tall))
        lying = Ground(px, (rows * tall, count * size_m))
        boards = upright(running(lying, count, rows, offset=0.0))
    else:
        boards = running(Ground(px, (count * size_m,) * 2), count, count, offset=0.0)
    chosen = boards.each(rng.random(boards.count) < share)
    face = mixed(plain(boards.ground.shape, rgb_of(colour)), rgb_of(second), chosen)
    return laid(
        rng, boards, face, grout=grout, joint_m=joint_m, sheen=sheen,
        variation=0.09 * variation, cushion_m=0.0008,
    )  # fmt: skip


def glazed(
    rng: np.random.Generator, px: int, *, colour: str, size_m: float, aspect: float, bond: str,
    joint_m: float, grout: str, variation: float, waviness: float, sheen: float,
) -> Maps:  # fmt: skip
    """Glazed wall tiles; handmade ones vary and wave. bond `column` stands them on end."""
    if bond == "column":
        lying = bonded(px, size_m, aspect, "stack", 1.0)
        boards = upright(lying)
    elif bond == "hexagon":
        count = max(4, round(1.0 / size_m))
        rows = 2 * max(2, round(count / math.sqrt(3.0)))
        ground = Ground(px, (count * size_m, rows * size_m * math.sqrt(3.0) / 2))
        boards = hexagons(ground, count, rows)
    else:
        boards = bonded(px, size_m, aspect, bond, 1.0)
    pool = noise(rng, boards.ground, 1.4, longest_m=0.2, shortest_m=0.01)
    edge = np.clip(1.0 - (boards.edge_m - joint_m / 2) / np.float32(0.006), 0.0, 1.0)
    face = lit(
        plain(boards.ground.shape, rgb_of(colour)),
        1.0 + 0.03 * variation * pool + 0.05 * variation * edge,
    )
    return laid(
        rng, boards, face, grout=grout, joint_m=joint_m, sheen=sheen,
        variation=0.05 * variation, cushion_m=0.0016, waviness_m=0.00025 * waviness,
    )  # fmt: skip


def marble(
    rng: np.random.Generator, px: int, *, kind: str, slab_m: float, aspect: float, joint_m: float,
    veins: float, sheen: float,
) -> Maps:  # fmt: skip
    """Polished slabs with branching veins."""
    boards = bonded(px, slab_m, aspect, "stack", 1.7)
    ground, stone = boards.ground, Ground(px, (2.4, 2.4))
    body, vein, cloud = MARBLES[kind]
    jump = rng.uniform(0.0, 2.4, (boards.count, 2))
    along = boards.along_m + boards.each(jump[:, 0])
    across = boards.across_m + boards.each(jump[:, 1])
    warp = noise(rng, stone, 1.9, longest_m=1.2, shortest_m=0.02)
    warped = looked_up(warp, stone, along, across)
    lines = np.zeros(ground.shape, dtype=np.float32)
    for longest_m, strength, width in ((1.2, 1.0, 13.0), (0.5, 0.5, 20.0)):
        field = noise(rng, stone, 2.1, longest_m=longest_m, shortest_m=0.03, stretch=(1.0, 1.8))
        place = looked_up(field, stone, along + 0.07 * warped, across - 0.06 * warped)
        lines = np.maximum(lines, strength * np.exp(-np.abs(place) * width))
    mist = looked_up(noise(rng, stone, 1.9, longest_m=0.9), stone, along, across)
    faint = np.clip(0.55 + 0.45 * mist, 0.0, 1.0)
    face = mixed(plain(ground.shape, body), cloud, 0.16 * np.clip(mist + 0.5, 0.0, 2.0))
    face = mixed(face, vein, veins * lines * faint)
    grout = "#{:02x}{:02x}{:02x}".format(*(round(0.86 * part) for part in body))
    return laid(
        rng, boards, face, grout=grout, joint_m=joint_m, sheen=sheen, variation=0.006,
        cushion_m=0.0004,
    )  # fmt: skip


def terrazzo(
    rng: np.random.Generator, px: int, *, colour: str, chips: str, chip_m: float, density: float,
    sheen: float,
) -> Maps:  # fmt: skip
    """Polished cement with broken stones in three sizes."""
    side = 1.5
    ground = Ground(px, (side, side))
    shapes: list[tuple[Points, Rgb]] = []
    for size_m, part in ((0.35 * chip_m, 0.3), (0.65 * chip_m, 0.35), (chip_m, 0.35)):
        count = round(density * part * side * side / (0.55 * size_m * size_m))
        shapes += _chips(rng, min(count, 3500), size_m, side, CHIPS[chips])
    body = rgb_of(colour)
    rgb = stamped(ground, shapes, body)
    rgb = lit(rgb, 1.0 + 0.014 * noise(rng, ground, 0.3, longest_m=0.03))
    cloud = noise(rng, ground, 1.6, longest_m=0.4)
    flat = np.zeros(ground.shape, dtype=np.float32)
    return Maps(ground, rgb, 0.72 - 0.6 * sheen + 0.02 * cloud, flat)


def _chips(
    rng: np.random.Generator, count: int, size_m: float, side_m: float, colours: tuple[Rgb, ...]
) -> list[tuple[Points, Rgb]]:
    """Angular stones, strewn over a square."""
    corners = 6
    angles = np.sort(rng.uniform(0.0, 2 * np.pi, (count, corners)), axis=1)
    radii = size_m / 2 * rng.uniform(0.7, 1.15, (count, corners))
    flat = rng.uniform(0.55, 1.0, (count, 1))
    turn = rng.uniform(0.0, np.pi, (count, 1))
    x, y = radii * np.cos(angles), flat * radii * np.sin(angles)
    middle = rng.uniform(0.0, side_m, (count, 2))
    points = np.stack(
        [
            middle[:, :1] + x * np.cos(turn) - y * np.sin(turn),
            middle[:, 1:] + x * np.sin(turn) + y * np.cos(turn),
        ],
        axis=-1,
    )
    which = rng.integers(0, len(colours), count)
    shade = rng.normal(1.0, 0.05, count)
    tints = np.clip(np.array(colours)[which] * shade[:, None], 0, 255).astype(int)
    return [
        (stone, (red, green, blue))
        for stone, (red, green, blue) in zip(points.tolist(), tints.tolist(), strict=True)
    ]


def brick(
    rng: np.random.Generator, px: int, *, colour: str, paint: str, painted: float, mortar: str,
    wear: float,
) -> Maps:  # fmt: skip
    """Bricks of 24 by 7.1 cm with a joint; painted covers them, as lofts are."""
    columns, rows = 6, 20
    ground = Ground(px, (columns * 0.25, rows * 0.0833))
    boards = running(ground, rows, columns, offset=0.5)
    wavy = noise(rng, ground, 1.2, longest_m=0.08)
    fine = noise(rng, ground, 0.5, longest_m=0.02)
    edge = boards.edge_m + 0.0012 * (0.5 + wear) * wavy
    face = np.clip((edge - 0.005) / 0.0025, 0.0, 1.0)
    fired = boards.each(rng.normal(0.0, 1.0, (boards.count, 1)).clip(-1.7, 1.7)[:, 0])
    rgb = lit(plain(ground.shape, rgb_of(colour)), 1.0 + 0.13 * fired + 0.07 * fine + 0.05 * wavy)
    dark = boards.each((rng.random(boards.count) < 0.06) * 0.16)
    rgb = lit(rgb, 1.0 - dark)
    rgb = mixed(lit(plain(ground.shape, rgb_of(mortar)), 1.0 + 0.05 * fine), rgb, face)
    if painted > 0.0:
        worn = np.clip(painted + 0.5 - wear * (0.5 + 0.35 * wavy + 0.15 * fine), 0.0, 1.0)
        cover = np.clip(worn * 2.0, 0.0, 1.0) * min(1.0, painted * 1.6)
        coat = lit(plain(ground.shape, rgb_of(paint)), 0.97 + 0.03 * face + 0.012 * fine)
        rgb = mixed(rgb, coat, cover)
    height = 0.006 * np.clip((edge - 0.0035) / 0.006, 0.0, 1.0) + 0.0004 * fine + 0.0005 * wavy
    rough = np.full(ground.shape, 0.93 - 0.25 * painted, dtype=np.float32)
    return Maps(ground, rgb, rough, height * np.float32(1.0 - 0.35 * painted))
