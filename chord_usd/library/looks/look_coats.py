"""What is spread, woven or pasted: plaster, limewash, concrete, wallpaper, carpet, tatami."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from chord_usd.library.looks.look_colours import lit, mixed, plain, rgb_of
from chord_usd.library.looks.look_wood import Maps
from chord_usd.library.textures.boards import running
from chord_usd.library.textures.fields import Ground, Points, Raster, Rgb, noise, stamped

_WALL_M = (2.0, 2.0)


def plaster(
    rng: np.random.Generator, px: int, *, colour: str, finish: str, relief: float, sheen: float
) -> Maps:
    """Painted plaster: smooth, the stipple of a roller, or sand."""
    ground = Ground(px, _WALL_M)
    longest_m, slope, deep_m = {
        "smooth": (0.3, 1.8, 8e-5), "roller": (0.016, 0.6, 1.6e-4), "sand": (0.01, 0.3, 2.4e-4),
    }[finish]  # fmt: skip
    grain = noise(rng, ground, slope, longest_m=longest_m)
    cloud = noise(rng, ground, 2.0, longest_m=1.5, shortest_m=0.1)
    rgb = lit(plain(ground.shape, rgb_of(colour)), 1.0 + 0.005 * cloud + 0.006 * relief * grain)
    rough = 0.92 - 0.5 * sheen + 0.01 * cloud
    return Maps(ground, rgb, rough, deep_m * relief * grain)


def limewash(
    rng: np.random.Generator, px: int, *, colour: str, cloud: float, relief: float, straw: float
) -> Maps:
    """Lime or clay brushed on: clouds, strokes, and chopped straw where it is clay."""
    ground = Ground(px, (2.4, 2.4))
    mist = noise(rng, ground, 1.35, longest_m=0.8, shortest_m=0.02)
    strokes = noise(rng, ground, 1.0, longest_m=0.05, stretch=(5.0, 1.0))
    others = noise(rng, ground, 1.0, longest_m=0.05, stretch=(1.0, 5.0))
    turn = np.clip(0.5 + 0.8 * noise(rng, ground, 2.0, longest_m=0.5, shortest_m=0.1), 0.0, 1.0)
    brush = strokes * turn + others * (1.0 - turn)
    gain = 1.0 + 0.024 * cloud * mist + 0.013 * cloud * brush
    rgb = lit(plain(ground.shape, rgb_of(colour)), gain)
    if straw > 0.0:
        stalks = stamped(ground, _stalks(rng, round(1500 * straw), ground), (0, 0, 0))[..., 0]
        pale = tuple(min(255, round(part * 1.16 + 10)) for part in rgb_of(colour))
        rgb = mixed(rgb, (pale[0], pale[1], pale[2]), stalks / 255.0 * 0.75)
    return Maps(ground, rgb, 0.93 + 0.02 * mist, 9e-5 * relief * (brush + 0.5 * mist))


def _stalks(rng: np.random.Generator, count: int, ground: Ground) -> list[tuple[Points, Rgb]]:
    """Thin rods of 1 to 3 cm, strewn about."""
    at = rng.uniform(0.0, 1.0, (count, 2)) * ground.tile_m
    angle = rng.uniform(0.0, np.pi, count)
    half = rng.uniform(0.005, 0.015, count)
    step = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    side = np.stack([-step[:, 1], step[:, 0]], axis=-1) * 0.0011
    long = step * half[:, None]
    corners = np.stack([at - long - side, at + long - side, at + long + side, at - long + side], 1)
    shade = rng.integers(90, 255, count)
    return [(rod, (int(s),) * 3) for rod, s in zip(corners.tolist(), shade, strict=True)]


def concrete(
    rng: np.random.Generator, px: int, *, colour: str, joints: str, slab_m: float, cloud: float,
    pores: float, sheen: float,
) -> Maps:  # fmt: skip
    """Fair-faced or trowelled concrete; joints of slabs or of formwork, or none."""
    aspect = 2.0 if joints == "formwork" else 1.0
    side = slab_m if joints != "none" else 1.5
    ground = Ground(px, (2 * side, 2 * side / aspect * (2.0 if aspect > 1.0 else 1.0)))
    boards = running(ground, 4 if aspect > 1.0 else 2, 2, offset=0.0)
    mist = noise(rng, ground, 1.4, longest_m=1.1)
    sand = noise(rng, ground, 0.4, longest_m=0.03)
    holes = np.clip(noise(rng, ground, 0.5, longest_m=0.02, shortest_m=0.006) - 2.5, 0.0, 1.0)
    holes *= np.float32(2.0 * pores)
    gain = 1.0 + 0.031 * cloud * mist + 0.018 * sand - 0.35 * holes
    height = 5e-5 * sand * (1.0 - sheen) - 0.0006 * holes
    if joints != "none":
        line = boards.joint(0.003)
        gain = gain * (1.0 + boards.each(rng.normal(0.0, 0.012, boards.count))) - 0.3 * line
        height = height - 0.001 * line
    if joints == "formwork":
        ties = _ties(boards.along_m, boards.across_m, side)
        gain, height = gain - 0.28 * ties, height - 0.003 * ties
    rgb = lit(plain(ground.shape, rgb_of(colour)), gain)
    rough = 0.85 - 0.5 * sheen + 0.04 * mist + 0.1 * holes
    return Maps(ground, rgb, rough, height.astype(np.float32))


def _ties(along_m: Raster, across_m: Raster, side_m: float) -> Raster:
    """The round holes of formwork, four on a panel."""
    from_middle_x = np.abs(np.abs(along_m - side_m / 2) - side_m * 0.28)
    from_middle_y = np.abs(np.abs(across_m - side_m / 4) - side_m * 0.12)
    return np.clip((0.013 - np.hypot(from_middle_x, from_middle_y)) / 0.003, 0.0, 1.0)


def carpet(rng: np.random.Generator, px: int, *, colour: str, pile: str, fleck: float) -> Maps:
    """Loop, cut or ribbed pile of mixed yarn."""
    ground = Ground(px, (1.3, 1.3))
    shortest_m = {"loop": 0.005, "cut": 0.0035, "rib": 0.005}[pile]
    loops = noise(rng, ground, 0.15, longest_m=0.013, shortest_m=shortest_m)
    trodden = noise(rng, ground, 2.0, longest_m=1.2, shortest_m=0.12)
    yarn = noise(rng, ground, 0.6, longest_m=0.1, shortest_m=0.008)
    gain = 1.0 + 0.09 * loops + 0.09 * fleck * yarn + 0.02 * trodden
    height = 0.0011 * loops
    if pile == "rib":
        ribs = np.sin(ground.x_m * np.float32(2 * np.pi * 100 / 1.3))[None, :]
        gain, height = gain + 0.08 * ribs, height + 0.0012 * ribs
    rgb = lit(plain(ground.shape, rgb_of(colour)), gain)
    return Maps(ground, rgb, np.full(ground.shape, 0.97, np.float32), height.astype(np.float32))


def tatami(rng: np.random.Generator, px: int, *, mat_m: float, age: float, border: str) -> Maps:
    """Mats of rush twice as long as wide, half a mat shifted, with cloth along their sides."""
    ground = Ground(px, (2 * mat_m, 2 * mat_m))
    boards = running(ground, 2, 1, offset=0.5)
    green, straw = np.array((182, 182, 138)), np.array((214, 194, 146))
    body = tuple(int(part) for part in green + (straw - green) * age)
    reeds = noise(rng, ground, 0.15, longest_m=0.05, shortest_m=0.004, stretch=(1.0, 26.0))
    long = noise(rng, ground, 1.2, longest_m=0.6, stretch=(1.0, 6.0))
    # The weave shows as fine ribs across the reeds, 1.5 cm apart.
    ribs = np.abs(np.sin(ground.x_m * np.float32(np.pi * round(mat_m / 0.016) / mat_m)))[None, :]
    gain = 1.0 + 0.03 * reeds + 0.012 * long - 0.12 * (1.0 - ribs) ** 2
    gain = gain + boards.each(rng.normal(0.0, 0.015, boards.count))
    side = np.minimum(boards.across_m, np.float32(mat_m) - boards.across_m)
    cloth = np.clip((0.032 - side) / ground.px_m + 0.5, 0.0, 1.0)
    weave = noise(rng, ground, 0.2, longest_m=0.012)
    band = lit(plain(ground.shape, rgb_of(border)), 1.0 + 0.06 * weave)
    rgb = mixed(lit(plain(ground.shape, (body[0], body[1], body[2])), gain), band, cloth)
    seam = boards.joint(0.003)
    rgb = lit(rgb, 1.0 - 0.45 * seam)
    height = 2.5e-4 * reeds + 4e-4 * ribs - 0.002 * seam + 4e-4 * cloth
    return Maps(ground, rgb, 0.78 + 0.12 * cloth, height.astype(np.float32))


def wallpaper(
    rng: np.random.Generator, px: int, *, pattern: str, ground_colour: str, ink: str, second: str,
    repeat_m: float,
) -> Maps:  # fmt: skip
    """Paper with stripes, leaves, a lattice, arches, or the plain weave of grass cloth."""
    times = max(1, round(1.06 / repeat_m))
    ground = Ground(px, (times * repeat_m, times * repeat_m))
    body, first, other = (rgb_of(colour) for colour in (ground_colour, ink, second))
    if pattern == "stripes":
        rgb = _stripes(ground, repeat_m, body, first, other)
    elif pattern == "grasscloth":
        rgb = plain(ground.shape, body)
    else:
        draw = {"leaves": _leaves, "lattice": _lattice, "arches": _arches, "damask": _damask}
        motif = [*draw[pattern](rng, first, other, body)]
        shapes = [
            (_shifted(points, repeat_m, i, j), colour)
            for i in range(times)
            for j in range(times)
            for points, colour in motif
        ]
        rgb = stamped(ground, shapes, body)
    rough = pattern == "grasscloth"
    warp = noise(rng, ground, 0.1, longest_m=0.02, shortest_m=0.003, stretch=(1.0, 30.0))
    weft = noise(rng, ground, 0.1, longest_m=0.02, shortest_m=0.003, stretch=(30.0, 1.0))
    weave = (0.5 * warp + 1.5 * weft if rough else warp + weft) / 1.5
    rgb = lit(rgb, 1.0 + (0.07 if rough else 0.012) * weave)
    matt = np.full(ground.shape, 0.86, dtype=np.float32)
    return Maps(ground, rgb, matt, (2e-4 if rough else 4e-5) * weave)


def _shifted(points: Points, repeat_m: float, i: int, j: int) -> Points:
    return [((x + i) * repeat_m, (y + j) * repeat_m) for x, y in points]


def _stripes(ground: Ground, repeat_m: float, body: Rgb, ink: Rgb, thin: Rgb) -> Raster:
    """Four broad stripes a repeat, each between two thin lines."""
    pitch = repeat_m / 4
    phase = ground.x_m / np.float32(pitch) % 1.0
    soft = 0.5 * ground.px_m / pitch
    broad = np.clip((0.25 - np.abs(phase - 0.5)) / soft + 0.5, 0.0, 1.0)
    line = np.clip((0.012 - np.abs(np.abs(phase - 0.5) - 0.31)) / soft + 0.5, 0.0, 1.0)
    row = mixed(mixed(plain((1, ground.px), body), ink, broad[None, :]), thin, line[None, :])
    return np.broadcast_to(row, (*ground.shape, 3))


def _leaf(x: float, y: float, angle: float, length: float, width: float) -> list[Points]:
    """A pointed leaf from its foot, as two halves beside its rib."""
    t = np.linspace(0.0, 1.0, 9)
    half = width * length * np.sin(np.pi * t**0.8)
    cosine, sine = math.cos(angle), math.sin(angle)
    halves: list[Points] = []
    for side in (-1.0, 1.0):
        across = np.concatenate([side * half, side * 0.06 * half[::-1]])
        along = length * np.concatenate([t, t[::-1]])
        xs, ys = x + along * cosine - across * sine, y + along * sine + across * cosine
        halves.append([*zip(xs.tolist(), ys.tolist(), strict=True)])
    return halves


def _leaves(rng: np.random.Generator, ink: Rgb, second: Rgb, body: Rgb) -> list[tuple[Points, Rgb]]:
    """Two bent sprigs in a half drop."""
    shapes: list[tuple[Points, Rgb]] = []
    for at_x, at_y, lean in ((0.25, 0.22, 1.0), (0.75, 0.72, -1.0)):

        def bend(step: float, at_x: float = at_x, lean: float = lean) -> float:
            return at_x + lean * 0.08 * math.sin(step * 5.2)

        steps = np.linspace(-0.36, 0.36, 25)
        stem = [(bend(s) - 0.004, at_y + s) for s in steps]
        stem += [(bend(s) + 0.004, at_y + s) for s in steps[::-1]]
        shapes.append((stem, second))
        for number, step in enumerate(np.linspace(-0.3, 0.3, 8)):
            for side in (-1.0, 1.0):
                angle = math.radians(90.0 - side * (58.0 - 3.5 * number))
                size = 0.175 - 0.011 * number + rng.uniform(-0.008, 0.008)
                tint = ink if side > 0 else second
                shapes += [(h, tint) for h in _leaf(bend(step), at_y + step, angle, size, 0.19)]
        top = _leaf(bend(0.36), at_y + 0.35, math.radians(90.0), 0.12, 0.2)
        shapes += [(half, ink) for half in top]
    return shapes


def _lattice(
    rng: np.random.Generator, ink: Rgb, second: Rgb, body: Rgb
) -> list[tuple[Points, Rgb]]:
    """Lines to a lattice of rhombs, with a small rhomb in each."""
    shapes: list[tuple[Points, Rgb]] = []
    w = 0.011
    for n in range(4):
        for m in range(4):
            x, y = n / 4, m / 4
            for sign in (1.0, -1.0):
                ends = ((x, y), (x + sign / 8, y + 1 / 8), (x, y + 1 / 4))
                for (ax, ay), (bx, by) in pairwise(ends):
                    shapes.append(([(ax - w, ay), (ax + w, ay), (bx + w, by), (bx - w, by)], ink))
            middle = (x, y + 1 / 8)
            r = 0.026
            shapes.append((
                [(middle[0] - r, middle[1]), (middle[0], middle[1] - r),
                 (middle[0] + r, middle[1]), (middle[0], middle[1] + r)], second,
            ))  # fmt: skip
    return shapes


def _arches(rng: np.random.Generator, ink: Rgb, second: Rgb, body: Rgb) -> list[tuple[Points, Rgb]]:
    """Scales of three arches each, in a half drop, as on Japanese and art-deco papers."""
    shapes: list[tuple[Points, Rgb]] = []
    for row in range(7, -2, -1):
        for column in range(-1, 5):
            x, y = column / 4 + (row % 2) / 8, row / 8
            for radius, colour in ((0.125, ink), (0.112, None), (0.078, second), (0.068, None),
                                   (0.034, ink)):  # fmt: skip
                turn = np.linspace(0.0, 2 * np.pi, 40)
                ring = [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in turn]
                shapes.append((ring, body if colour is None else colour))
    return shapes


def _damask(rng: np.random.Generator, ink: Rgb, second: Rgb, body: Rgb) -> list[tuple[Points, Rgb]]:
    """Palmettes in a half drop, each a fan of leaves within an ogee."""
    shapes: list[tuple[Points, Rgb]] = []
    for at_x, at_y in ((0.25, 0.25), (0.75, 0.75)):
        for sign in (-1.0, 1.0):
            t = np.linspace(0.0, 1.0, 25)
            out = 0.24 * np.sin(np.pi * t) ** 0.8
            line = [
                *zip((at_x + sign * out).tolist(), (at_y - 0.25 + t * 0.5).tolist(), strict=True)
            ]
            inner = [(x - sign * 0.014, y) for x, y in line[::-1]]
            shapes.append(([*line, *inner], second))
        for number in range(9):
            angle = math.radians(90.0 + (number - 4) * 24.0)
            size = 0.2 - 0.018 * abs(number - 4)
            shapes += [(h, ink) for h in _leaf(at_x, at_y - 0.07, angle, size, 0.15)]
        for number in range(5):
            angle = math.radians(270.0 + (number - 2) * 30.0)
            shapes += [(h, ink) for h in _leaf(at_x, at_y - 0.06, angle, 0.11, 0.17)]
    return shapes
